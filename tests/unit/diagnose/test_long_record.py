"""A long record: its looks, what they say together, and that all of it tells how it was recorded."""

from dataclasses import replace
from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest

from lostmotion.diagnose.control_error.amplitude import error_oscillation
from lostmotion.diagnose.control_error.rows import ScreenRows
from lostmotion.diagnose.long_record.diagnose_long import another, believed, diagnose_long, mean_size, with_span
from lostmotion.diagnose.long_record.disagreement import about_looks
from lostmotion.diagnose.long_record.stretches import EACH, ROWS, looks, recording
from lostmotion.diagnose.op_span import op_span
from lostmotion.errors import DataError
from lostmotion.evaluate import random_faulty_loop
from lostmotion.identify.data import collect
from lostmotion.identify.unseen_moves import unseen_moves
from lostmotion.records import LoopRecord, prepare


def rarely_moved(every=900, rows=8000, scans=5):
    """A flow that settles between its rows, each of so many scans; SP moves every 900 rows."""
    random = np.random.default_rng(1)
    n = rows * scans
    sp = np.repeat(random.uniform(-8.0, 8.0, rows // every + 1), every * scans)[:n]
    load, noise = 0.01 * random.normal(size=n).cumsum(), 0.05 * random.normal(size=n)
    op, pv = np.zeros(n), np.zeros(n)
    state = integral = 0.0
    for k in range(n):
        state += 0.5 * (1.2 * (op[k - 1] if k else 0.0) + load[k] - state)
        pv[k] = state + noise[k]
        integral += 0.125 * (sp[k] - pv[k])
        op[k] = 0.17 * (sp[k] - pv[k]) + integral
    at = slice(None, None, scans)
    return LoopRecord(50.0 + op[at], 50.0 + pv[at], 50.0 + sp[at], dt=float(scans))


def test_how_a_loop_is_recorded_is_told_by_the_whole_window(monkeypatch):
    """Two moves of SP in a stretch leave open whether the loop settles between the rows; nine tell it."""
    record = rarely_moved()
    rows = ScreenRows(record)
    whole, part = recording(rows, None), next(looks(rows, None)).record
    assert unseen_moves(collect(prepare(part), None, None)).untold
    assert not whole.unseen.untold
    assert whole.unseen.settled
    assert whole.unseen.mostly
    assert recording(ScreenRows(record.cut(0, 3000)), None) is None, "looked at whole"
    known = replace(collect(prepare(part), None, None), recording=whole)
    assert (known.unseen, known.foretold) == (whole.unseen, whole.foretold)
    given = []

    def refused(part, known, **_):
        given.append(known)
        raise DataError("no more is asked here")

    monkeypatch.setattr(import_module("lostmotion.diagnose.long_record.diagnose_long"), "diagnose_part", refused)
    with pytest.raises(DataError, match="no more is asked"):
        diagnose_long(record)
    period = error_oscillation(record).period
    again = recording(rows, period)
    assert given
    assert all(one.unseen == again.unseen for one in given)
    assert all(np.array_equal(one.foretold.errors, again.foretold.errors) for one in given)


def test_that_op_foretells_pv_is_told_by_the_whole_window():
    """A controller that sees PV a row earlier than the historian: three thousand rows hardly show it, all do."""
    random = np.random.default_rng(1)
    n = 19_000
    load, noise = 0.05 * random.normal(size=n).cumsum(), 0.1 * random.normal(size=n)
    pv, op = np.zeros(n), np.zeros(n)
    for now in range(1, n):
        pv[now] = 0.8 * pv[now - 1] + 0.2 * op[now - 1] + 0.02 * load[now] + noise[now]
        op[now] = op[now - 1] - 0.02 * (pv[now] - pv[now - 1]) - 0.01 * pv[now] + 0.02 * random.normal()
    record = LoopRecord(50.0 + op[1:], 50.0 + pv[:-1], np.full(n - 1, 50.0), dt=1.0)
    rows = ScreenRows(record)
    whole, part = recording(rows, None), next(looks(rows, None)).record
    assert whole.foretold.against(0.2)
    assert np.min(whole.foretold.errors) < 1.5 * np.min(collect(prepare(part), None, None).foretold.errors)


def long_rows(**more):
    random = np.random.default_rng(1)
    n = 20_000
    wave = np.sin(np.arange(n) / 9.0)
    record = LoopRecord(50.0 + wave, wave + 0.1 * random.normal(size=n), np.zeros(n), dt=1.0, **more)
    return ScreenRows(record)


def test_looks_are_apart_and_short():
    found = list(looks(long_rows(), None))
    assert len(found) == 20_000 // ROWS // EACH
    places = np.sort(np.concatenate([look.places for look in found]))
    assert (np.diff(places) >= ROWS).all()
    assert all(len(look.record) == EACH * ROWS and look.record.gaps == (ROWS,) for look in found)


def test_looks_leave_manual_and_limits_alone():
    mode = np.where(np.arange(20_000) < 12_000, "MAN", "AUTO")
    places = [place for look in looks(long_rows(mode=mode), None) for place in look.places]
    assert places
    assert min(places) >= 12_000 - 0.1 * ROWS
    assert not list(looks(long_rows(mode=np.full(20_000, "MAN")), None))


def test_a_slow_swing_is_thinned():
    look = next(looks(long_rows(), 1000.0))
    assert look.record.dt == 4.0
    assert look.rows == 4 * ROWS


class Look:
    """One that was diagnosed, of an OP with a span."""

    def __init__(self, kind, verdict, probability=0.9, percent=np.nan):
        self.kind, self.verdict, self.size_percent = kind, verdict, percent
        self.probabilities = {"actuator": probability}
        self.record = LoopRecord(np.arange(10.0), np.arange(10.0), dt=1.0, op_span=(0.0, 100.0))


def test_looks_that_disagree_name_no_fault():
    fault, weaker, weak = (Look("actuator", "stiction", chance) for chance in (0.9, 0.7, 0.6))
    other, silent = Look("tuning", "other oscillation", 0.3), Look("unknown", "cannot tell", 0.2)
    assert believed([fault, other]) is other
    assert believed([silent, other]) is other
    assert believed([fault, silent]) is silent
    assert believed([fault, weaker]) is fault
    assert believed([silent, fault, weaker]) is fault
    assert believed([weak, silent, weak]) is silent  # together not likelier than none
    assert believed([weak, weak]) is weak
    assert believed([fault, weaker, other]) is other


def test_a_second_look_confirms_a_fault_or_tells_what_the_first_could_not():
    fault, other, silent = Look("actuator", "stiction"), Look("tuning", "other oscillation"), Look("", "cannot tell")
    assert [another(seen) for seen in ([fault], [silent], [other])] == [True, True, False]
    assert [another(seen) for seen in ([fault, silent], [fault, other], [silent, silent])] == [True, False, False]
    assert not another([fault, silent, fault])


def test_a_look_that_cannot_tell_contradicts_none():
    fault, silent = Look("actuator", "backlash", percent=2.51), Look("unknown", "cannot tell")
    said = "one of three stretches shows a backlash of 2.5 % of span, the others cannot tell"
    assert about_looks([fault, silent, silent]) == said
    assert about_looks([silent, fault]) == said.replace("three", "two").replace("others", "other")
    denied = [fault, silent, Look("none", "none")]
    assert about_looks(denied) == "stretches of the record disagree: 'backlash' and 'none'"
    weak = [fault, Look("actuator", "stiction", percent=3.5), silent]
    said = (
        "two of three stretches show a backlash and a stiction, the other cannot tell: together not likelier than none"
    )
    assert about_looks(weak) == said
    assert about_looks([fault, silent, fault]).startswith("two of three stretches show a backlash, the other")
    unsized = Look("actuator", "saturation")
    assert about_looks([unsized, silent]) == "one of two stretches shows a saturation, the other cannot tell"


def test_sizes_of_two_looks_are_weighed_and_no_narrower_than_they_differ():
    one, other = (
        SimpleNamespace(size=size, interval=(size - half, size + half), confidence=0.9)
        for size, half in ((2.0, 0.1), (2.6, 0.3))
    )
    size, low, high = mean_size([one, other])
    assert size == pytest.approx(2.06)
    assert (low, high) == pytest.approx((1.76, 2.36))


@pytest.mark.statistics
def test_records_of_many_stretches_are_told_apart():
    found = {}
    for seed, cause in ((1002, "none"), (1005, "stiction"), (1008, "tuning")):
        said = []
        found[cause] = diagnose_long(record_of(seed, cause), said.append)
        assert len(said) == len(found[cause].looks)
    stiction = found["stiction"]
    assert stiction.verdict == "stiction"
    assert len(stiction.looks) == 2, "a fault is confirmed"
    assert stiction.fingerprint == record_of(1005, "stiction").fingerprint
    said = " ".join(stiction.summary().split())
    assert "samples every 1 s, of 7000 of the record" in said
    assert "Of 7000 rows the most informative 4500 were diagnosed in 2 looks" in said
    assert stiction.to_dict()["long_record"]["diagnosed_rows"] == stiction.diagnosed_rows == 4500
    assert found["none"].kind != "actuator"
    assert found["tuning"].kind != "actuator"


@pytest.mark.statistics
def test_op_at_its_limit_for_long_is_what_is_wrong_where_only_the_rest_is_looked_at():
    record = record_of(1005, "stiction")
    found = diagnose_long(replace(record, op=np.where(np.arange(7000) < 4900, 100.0, record.op)))
    assert (found.verdict, found.kind, found.severity) == ("saturation", "actuator", "unknown")
    assert np.isnan([found.size, *found.interval]).all()
    assert found.evidence[0].value == pytest.approx(0.7)


def test_a_look_has_the_span_that_all_of_the_record_tells():
    """The stretches alone look like 0..1; somewhere else OP is at 60 of 100."""
    look = LoopRecord(np.linspace(0.2, 0.8, 10), np.arange(10.0), dt=1.0)
    assert op_span(look).ends == (0.0, 1.0)
    whole = op_span(replace(look, op=np.linspace(0.2, 60.0, 10)))
    assert op_span(with_span(look, whole)).ends == (0.0, 100.0)
    assert with_span(look, op_span(look)) is look


def record_of(seed, cause):
    loop = random_faulty_loop(seed, 7000, cause)
    return LoopRecord(loop.op, loop.pv, loop.sp, dt=1.0, loop_type=loop.process)
