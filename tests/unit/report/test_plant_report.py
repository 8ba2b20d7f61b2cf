"""Reports of an audit: whole, harmless, and nothing claimed that rows do not say."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise

import pytest

from lostmotion.audit.plant_view import PlantView, RunFacts
from lostmotion.plant import PlantLoop
from lostmotion.printable import printable
from lostmotion.report.plant import loop_page, loop_report, loop_section, pages, plant_report, script, stylesheet
from lostmotion.report.plant.pages import MOST_PAGES, MOST_RANKED
from lostmotion.report.plant.words import next_command, next_step
from lostmotion.store.rows import UNDATED, AssessmentRow, Stage
from tests.support.plant_rows import HOSTILE, finding, plant, sound

VOID = {"meta", "br", "img", "input", "link", "hr"}


class Page(HTMLParser):
    """Elements, their attributes and the text that people see."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.elements, self.open, self.text, self.faults = [], [], [], []
        self.feed(text)
        self.close()
        self.faults += self.open

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.faults.append(tag)

    def handle_data(self, data):
        if "script" not in self.open and "style" not in self.open:
            self.text.append(data)

    @property
    def words(self):
        return " ".join(" ".join(self.text).split())

    def all(self, name):
        return [attrs for tag, attrs in self.elements if tag == name]


@pytest.fixture(scope="module")
def page():
    return Page(plant_report(plant()))


def test_it_is_one_well_formed_file_that_fetches_nothing(page):
    assert page.faults == []
    addresses = [attrs[key] for _, attrs in page.elements for key in ("href", "src", "action") if key in attrs]
    assert addresses
    assert all(address.startswith("#") for address in addresses)
    names = Counter(attrs["id"] for _, attrs in page.elements if "id" in attrs)
    assert max(names.values()) == 1
    assert {address[1:] for address in addresses} <= set(names)


def test_script_and_style_can_be_taken_out(page):
    text = plant_report(plant())
    assert len(page.all("script")) == len(page.all("style")) == 1
    assert script() in text
    assert stylesheet() in text
    handlers = [key for _, attrs in page.elements for key in attrs if key.startswith("on") or key == "style"]
    assert handlers == []


def test_findings_come_first_and_undecided_loops_last(page):
    words = page.words
    places = (
        "could be judged",
        "Valves at fault",
        "Group 1",
        "Treemap by area",
        "What to do about the undecided loops",
    )
    found = [words.index(one) for one in places]
    assert found == sorted(found)
    said = "2 of 5 loops could be judged; 1 cannot be told from these records, 1 not assessed, 1 failed"
    assert f"{said}: they are not cleared." in words
    assert "not assessed: in manual for 97 % of the time" in words
    assert "failed: expected a column 'OP', got none; name it" in words
    assert "stale for 31 % of it" in words
    assert "any size not excluded" in words


def test_the_ranking_has_size_interval_confidence_priority_and_next_step(page):
    words = page.words
    for said in ("3.00 % of span", "2.70 .. 3.30", "93 %", "severity x weight x confidence", "Repack the valve."):
        assert said in words
    assert "Next command: lostmotion simulate data/FIC-1.csv" in words
    assert "new finding" in words
    assert "Group 1: 2 loops, period 10 min" in words
    assert "larger than at first" in words


def test_the_same_advice_for_undecided_loops_is_given_once_and_all_of_it_is_folded():
    advice = ("Move SP by {} % a few times.",)
    undecided = [
        finding(f"FIC-{n}", 9.0 + n, verdict="cannot tell", kind="unknown", advice=(advice[0].format(n),), label="")
        for n in range(1, 8)
    ]
    view = replace(plant(), rows=(finding("FIC-9"), *undecided), traces=(), history=(), groups=())
    text = plant_report(view)
    opened = re.sub(r"<details.*?</details>", "", text, flags=re.DOTALL)
    assert opened.count("Move SP by") == 1
    assert "<strong>7 loops</strong>" in opened
    assert "Move SP by 1 to 7 % a few times." in opened
    assert "7 undecided loops, one by one" in text
    assert '<section class="loop"' not in opened
    assert text.count('<section class="loop"') == 8


def test_a_link_leads_into_what_is_folded_and_paper_shows_it():
    assert "beforeprint" in script()
    assert "hashchange" in script()
    assert "details::details-content" in stylesheet()


def test_evidence_has_what_stands_before_it_and_the_sum():
    row = finding(evidence=(("memory", 2.0, 3.0), ("shape", 0.1, 0.5)), indices={"log_odds": 2.25})
    page = Page(loop_report(replace(plant(), rows=(row,)).loop_view("FIC-1")))
    assert "before evidence -1.2" in page.words
    assert "together +2.2" in page.words
    assert "a fault of the actuator is 90 % likely" in page.words
    older = replace(plant(), rows=(replace(row, indices={}),))
    assert "before evidence" not in Page(loop_report(older.loop_view("FIC-1"))).words


def test_tables_have_scopes_and_charts_have_words_and_a_table(page):
    assert all(attrs.get("scope") in ("col", "row") for attrs in page.all("th"))
    assert len(page.all("caption")) == len(page.all("table"))
    charts = [attrs for attrs in page.all("svg") if attrs.get("class", "").startswith("chart")]
    assert len(charts) == 5  # PV, OP, PV over OP, actuator, history
    assert all(attrs["role"] == "img" and attrs["aria-label"] for attrs in charts)
    assert "The stretch in numbers" in page.words
    assert "The runs in numbers" in page.words
    levels = [int(tag[1]) for tag, _ in page.elements if re.fullmatch("h[1-6]", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after - before <= 1 for before, after in pairwise(levels))


def test_hostile_names_are_only_text():
    view = plant(HOSTILE)
    view = replace(view, loops=tuple(replace(loop, area=loop.tag, op_unit=loop.tag) for loop in view.loops))
    view = replace(view, run=replace(view.run, plant=HOSTILE[0], sources=HOSTILE))
    for text in (plant_report(view), loop_report(view.loop_view(HOSTILE[0]))):
        page = Page(text)
        assert page.faults == []
        assert (len(page.all("script")), page.all("img")) == (1, [])
        assert HOSTILE[0] in page.words
        assert not any(key.startswith("on") for _, attrs in page.elements for key in attrs)
    assert all(printable(tag) in Page(plant_report(view)).words for tag in HOSTILE)


def test_many_loops_stay_usable_and_it_is_said_what_is_left_out(monkeypatch):
    monkeypatch.setattr(pages, "MOST_LISTED", 200)
    count = 3000
    rows = tuple(finding(f"FIC-{n}", 1.0 + n % 99) if n % 2 else sound(f"FIC-{n}") for n in range(count))
    view = PlantView(plant().run, tuple(PlantLoop(row.tag, area=f"U{n % 40}") for n, row in enumerate(rows)), rows)
    text = plant_report(view)
    page = Page(text)
    assert len([attrs for attrs in page.all("section") if attrs.get("class") == "loop"]) == MOST_PAGES
    assert f"The {MOST_PAGES} most urgent of {count // 2} loops that are worth a page" in page.words
    assert f"The first {MOST_RANKED} of {count} loops" in page.words
    assert "the CSV of the audit has all" in page.words
    assert len(text) < 4e6


def test_an_empty_plant_says_so():
    words = Page(plant_report(PlantView(plant().run, (), ()))).words
    for said in ("0 of 0 loops could be judged", "No loop was assessed", "no earlier run", "None was found"):
        assert said in words


def test_a_page_without_trace_and_without_numbers_stands():
    bare = replace(finding(), size=None, low=None, high=None, size_percent=None, period=None, evidence=(), dt=None)
    view = replace(plant(), rows=(bare,), traces=(), history=())
    page = Page(loop_report(view.loop_view("FIC-1")))
    assert page.faults == []
    assert "no oscillation was measured" in page.words
    assert "Trend" not in page.words


def test_a_trace_that_cannot_be_read_costs_its_picture_only():
    view = plant()
    for model in ("{", '{"actuator": 3}', '{"actuator": {"kind": "unheard of"}}', "[]"):
        broken = replace(view, traces=(replace(view.traces[0], model=model),))
        shown = loop_page(broken.loop_view("FIC-1"))
        assert (shown.actuator, shown.parameters) == ("", [])
        assert shown.plane


def test_the_section_fits_into_another_page():
    text = loop_section(loop_page(plant().loop_view("FIC-1"), "here"), 3)
    assert text.lstrip().startswith('<section class="loop" id="here"')
    assert "<h3" in text
    assert "<h2" not in text


def test_one_row_a_loop_leads_and_the_others_are_listed():
    weak, strong = finding(priority=20.0), finding(priority=70.0, window_start=plant().rows[0].window_end)
    view = replace(plant(), rows=(weak, strong))
    assert [row.priority for row in view.leading] == [70.0]
    assert len(loop_page(view.loop_view("FIC-1")).windows) == 2
    with pytest.raises(KeyError):
        view.loop_view("FIC-9")


@pytest.mark.parametrize(
    ("other", "words"),
    [
        ({"probability": 0.48}, "neither shown nor excluded: its probability is 48 %"),
        ({"why": "OP hardly moved"}, "the evidence lacks what is said above"),
        ({"status": "CANNOT_TELL"}, ""),
        ({"verdict": "stiction"}, ""),
    ],
)
def test_a_good_fit_beside_cannot_tell_is_explained(other, words):
    row = finding(**{"verdict": "cannot tell", "kind": "unknown", **other})
    view = replace(plant().loop_view("FIC-1"), row=row)
    said = "The fit is OK, and does not contradict this" in loop_report(view)
    assert said == bool(words)
    assert words in loop_report(view)


def test_a_loop_that_failed_is_looked_at_by_its_file():
    """The same audit would fail again; `check` prints the commands that read it."""
    row = AssessmentRow("FIC-1", UNDATED, UNDATED, stage=Stage.FAILED, error="expected one sampling time")
    run = RunFacts(1, plant="data", sources=("data",), store="a.db")
    loop = PlantLoop("FIC-1", where="unit 1/FIC-1.csv")
    assert next_command(loop, row, run) == "lostmotion check 'data/unit 1/FIC-1.csv'"
    assert next_command(PlantLoop("FIC-1"), row, run) == "lostmotion audit data --store a.db"
    assert "loop list" in next_step(row)
