"""Results in a notebook: what they say, and nothing of a name taken for markup."""

from dataclasses import replace
from functools import cache
from html.parser import HTMLParser

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lostmotion as lm
from lostmotion.diagnose import PooledDiagnosis
from lostmotion.diagnose.diagnosis import Item
from lostmotion.diagnose.pooled.pooled_diagnosis import RecordShare
from lostmotion.evaluate.solution import Solution, Step
from lostmotion.html_table import html_list, html_panel, html_table
from lostmotion.printable import printable
from tests.support.diagnoses import CASES, example, loop_record, variant
from tests.support.fits import VALVES, made_fit

OURS = {"div", "p", "b", "table", "tr", "th", "td", "ul", "li"}
HOSTILE = "<script>alert(1)</script>&\"'"


class Markup(HTMLParser):
    """Tags, attributes and text of HTML, all tags closed in order."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.values, self.open, self.words = set(), set(), [], ""
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.values.update(attrs)
        self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words += data


def clean(result):
    """Words of a result, with no tag but ours, no attribute but the alignment, no colour and no address."""
    found = Markup(result._repr_html_())
    assert found.tags <= OURS
    assert found.values <= {("style", "text-align:left;vertical-align:top")}
    return found.words


@cache
def gear():
    model = lm.Hammerstein(lm.Backlash(2.0), lm.LinearModel([-0.95], [0.05], 3, 1.0))
    small = {"samples": 150, "runs": 2, "cycle_samples": 300, "draws": 2}
    return lm.compensation_study(model, lm.PI(2.0, 0.1), noise=1e-4, op_now=50.0, **small)


@cache
def estimate():
    tank = lm.platforms.level_tank()
    u = lm.signals.prs(1500, -5, 5, hold=10, seed=1)
    estimator = lm.RecursiveIV(na=3, nb=2, delay=3, gain=tank.linear.gain)
    return estimator.run(u, tank.simulate(u)) and estimator.estimate


def pooled(name="day 1", records=3):
    alone = {key: getattr(example(), key) for key in lm.Diagnosis.__dataclass_fields__}
    shares = tuple(RecordShare(name, k, 400, "dead zone", 9.0, 4.0, (3.5, 4.5)) for k in range(records))
    return PooledDiagnosis(**alone, shares=shares, totals={"none": 0.0, "dead zone": 40.0}, kind_confidence=0.9)


def hostile_results(name):
    """One of every kind, with the name wherever a file or a user may put one."""
    record = replace(loop_record(), tag=name, source=name, notes=(name,), op_unit=name, pv_unit=name)
    fit = made_fit("dead zone")
    fit = replace(fit, data=replace(fit.data, tag=name, source=name, op_unit=name, pv_unit=name))
    items = (Item(name, 1.0, 2.0, name),)
    diagnosis = replace(example(), record=record, fit=fit, evidence=items, advice=(name,), why=name, notes=(name,))
    study = replace(gear(), reasons=(name, name), block=replace(gear().block, accepted=name))
    block = replace(gear().block, notes=(name,), accepted=name)
    solution = Solution("closed", (Step("check", False, name, name),))
    many = replace(pooled(name), advice=(name,), record=record, carried_by=name)
    excluded = replace(diagnosis, excluded={name: 1.0})
    return [record, record.check(), fit, fit.facts, diagnosis, excluded, many, study, block, solution]


def test_a_script_in_a_name_stays_text():
    for result in hostile_results(HOSTILE):
        assert HOSTILE in clean(result), type(result).__name__
        assert "<script" not in result._repr_html_()


@settings(max_examples=25, deadline=None)
@given(st.text(st.sampled_from("<>&\"'/=; aAsSpt\n{}%"), min_size=1, max_size=30))
def test_no_name_becomes_markup(name):
    for result in hostile_results(name):
        clean(result)


@settings(max_examples=20, deadline=None)
@given(st.lists(st.lists(st.text(), min_size=2, max_size=2), min_size=1), st.text())
def test_tables_and_panels_hold_their_texts(rows, headline):
    rows = [[cell.replace("\r", "").replace("\0", "") for cell in row] for row in rows]
    text = html_panel(headline.replace("\r", "").replace("\0", ""), html_table(rows), html_list([rows[0][0]]))
    words = Markup(text).words
    for row in rows:
        assert all(printable(cell) in words for cell in row)


@pytest.mark.parametrize("status", list(lm.Status))
@pytest.mark.parametrize("kind", list(VALVES))
def test_every_fit(kind, status):
    fit = made_fit(kind, status, widest=2.0)
    words = clean(fit)
    assert status.name in words
    assert "FIC-101" in words
    assert "Linear part" in words
    for text in (words, clean(fit.facts)):
        hidden = kind == "backlash" and status in (lm.Status.NOT_SEEN, lm.Status.CANNOT_TELL, lm.Status.SAME_SIGNAL)
        assert ("1.70 " in text) <= (not hidden)  # no number where the report gives none


def test_a_fit_says_what_its_report_says():
    fit = made_fit("dead zone")
    table = dict(zip(("left", "right"), (48.7, 51.9), strict=True))
    words = clean(fit)
    for name, value in table.items():
        assert fit.parameters[name] == value
        assert f"{value:.1f}" in words
    assert "Dead zone of width 3.2" in words


@pytest.mark.parametrize(("verdict", "kind"), CASES)
def test_every_verdict(verdict, kind):
    found = variant(verdict, kind)
    words = clean(found)
    assert str(found).splitlines()[2][:20] in words
    assert "Check the range." in words
    assert ("not excluded" in words) == bool(found.excluded)


def test_open_ends_of_what_is_excluded():
    found = replace(variant("none", "none"), excluded={"dead zone": 0.6, "stiction": np.inf})
    assert "stictionany size" in clean(found)


def test_pooled_diagnosis_shows_its_records():
    words = clean(pooled())
    assert words.count("day 1") == 3
    assert "3 records" in words
    assert "The first 20 are shown, 10 more are not." in clean(pooled(records=30))


def test_study_and_its_block():
    words = clean(gear())
    assert gear().reasons[0] in words
    assert "block and retuned" in words
    words = clean(gear().block)
    assert words.startswith("Backlash block, one scan every 1 s")
    assert "LEAD_UP" in words
    assert all(note in words for note in gear().block.notes)


def test_solutions():
    closed = Solution("closed", (Step("check", True, "Fine."), Step("diagnose", False, "No.", "Look again.")))
    words = clean(closed)
    assert "NO BLOCK: the gate at step 'diagnose' is closed." in words
    assert "What opens it: Look again." in words
    assert "What opens it" not in clean(Solution("nothing wrong", (Step("check", True, "Fine."),)))


def test_recursive_estimates():
    words = clean(estimate())
    assert words.startswith("After 1500 samples: OK")
    for name in ("left", "right", "width", "gain"):
        assert name in words
        assert f"\n{name} " in estimate().summary()


def test_a_checked_record():
    found = lm.LoopRecord(np.full(300, 42.0), np.arange(300.0), dt=1.0, tag="FIC-1").check()
    words = clean(found)
    assert "NOT USABLE" in words
    assert "OP is constant" in words
    assert str(found) == found.summary()
