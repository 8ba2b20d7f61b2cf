"""What an audit tells of a run: strict JSON, and one thing of each loop."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from lostmotion.audit.audit_run import AuditRun
from lostmotion.audit.health import health_of
from lostmotion.audit.rank import ranked
from lostmotion.audit.row_facts import order
from lostmotion.audit.rules import FORCED, FROZEN, NOISY, RINGING, RULES, WEARING, rule_of
from lostmotion.errors import DataError
from lostmotion.plant import PlantLoop
from lostmotion.report.audit_text import audit_summary
from lostmotion.report.plant import loop_report, plant_report, table
from lostmotion.report.plant.svg.bars import size_bar
from lostmotion.report.plant.words import excluded_words, next_command, next_step, sure_words
from lostmotion.store.rows import FAULTS, FINDINGS, MEASUREMENT, UNDATED, AssessmentRow, Stage
from tests.support.plant_rows import END, START, finding, plant, sound
from tests.support.plant_stores import plant_store


def test_a_size_of_which_any_is_possible_is_null_in_json(tmp_path) -> None:
    run = AuditRun.of(plant_store(tmp_path, view=plant(), data=False))
    assert any(row.excluded_percent == float("inf") for row in run.rows)
    found = json.loads(json.dumps(run.to_dict(), allow_nan=False))
    assert next(one for one in found["assessments"] if one["tag"] == "FIC-3")["excluded_percent"] is None
    assert next(one for one in found["assessments"] if one["tag"] == "FIC-1")["window_start"].startswith("2026-11-15")


def judged(tag: str = "FIC-1", **values: object) -> AssessmentRow:
    """A row as an audit ranks it."""
    made = AssessmentRow(tag, UNDATED, UNDATED, stage=Stage.ASSESSED, **values)  # type: ignore[arg-type]
    return ranked([made], {})[0]


ENDED = {"verdict": "saturation", "kind": "actuator", "confidence": 0.8, "advice": ("Check its range.",)}
SWINGS = {"regularity": 40.0, "power": 0.9, "period": 300.0}
OTHER = {"verdict": "other oscillation", "confidence": 0.99, **SWINGS}
UPSTREAM, RETUNE = ("Look upstream: the loop itself is damped.",), ("Retune: lower the gain.",)
TEST = {"verdict": "cannot tell", "probability": 0.2, "confidence": 0.8, "advice": ("Move SP or OP by more than 8.6.",)}
DECIDED = [
    (FROZEN, judged(indices={"stuck": 0.23}, **ENDED), "measured", "check", "saturation, 80 % sure"),
    (NOISY, judged(indices={"scatter_percent": 2.5}, **TEST), "measured", "check", "cannot tell"),
    (
        RINGING,
        judged(kind="disturbance", indices={"amplitude_spread": 0.5}, advice=UPSTREAM, **OTHER),
        "80 %", "diagnose", "other oscillation, 99 % sure",
    ),
    (
        FORCED,
        judged(kind="tuning", indices={"amplitude_spread": 0.03}, advice=RETUNE, **OTHER),
        "99 %", "diagnose", "other oscillation, 99 % sure",
    ),
    (WEARING, judged(travel=4200.0, **TEST), "measured", "diagnose", "cannot tell"),
]  # fmt: skip


@pytest.mark.parametrize(("rule", "row", "sure", "command", "second"), DECIDED)
def test_a_loop_whose_priority_a_rule_decides_says_one_thing(rule, row, sure, command, second) -> None:
    """Reason, what is said, how sure, what to do and to type; the diagnosis is a second opinion."""
    view = replace(plant(), rows=(row,), traces=(), history=(), previous=())
    assert rule_of(row) is rule
    assert next_step(row) == rule.advice[0]
    assert sure_words(row) == sure
    assert next_command(view.by_tag["FIC-1"], row, view.run).startswith(f"lostmotion {command} ")
    for page in (plant_report(view), loop_report(view.loop_view("FIC-1"))):
        assert rule.advice[0].split(":")[0] in page
        assert row.advice[0] not in page
        assert f"diagnosis: {second}" in page
    assert rule.name in audit_summary(view)
    line = table(view.rows, view.by_tag).row(0, named=True)
    assert (line["rule"], line["verdict"], line["advice"]) == (rule.name, row.verdict, " ".join(rule.advice))


def test_the_rule_stands_in_the_row_and_is_not_read_from_its_words() -> None:
    """Ranked again without its reason it is gone; a rule of another version is refused."""
    _, frozen, *_ = DECIDED[0]
    assert frozen.rule == "frozen measurement"
    assert rule_of(replace(frozen, priority_reason="in other words")) is FROZEN
    assert rule_of(replace(frozen, rule="")) is None
    assert ranked([replace(frozen, indices={})], {})[0].rule == ""
    assert [RULES[name].name for name in RULES] == list(RULES)
    with pytest.raises(DataError, match=r"expected one of frozen measurement, .*, got 'broken wire'; run the audit"):
        rule_of(replace(frozen, rule="broken wire"))


def test_a_ringing_loop_is_labelled_normal_only_where_its_valve_is_cleared() -> None:
    _, rings, *_ = DECIDED[2]
    assert rings.label == ""
    assert judged(
        **{**OTHER, "kind": "disturbance"}, indices={"amplitude_spread": 0.5}, excluded_percent=0.4
    ).label == ("normal")


def test_noise_and_ringing_decide_before_the_wear_that_they_make() -> None:
    noisy = judged(travel=20_000.0, indices={"scatter_percent": 1.0}, **TEST)
    rings = judged(travel=20_000.0, indices={"amplitude_spread": 0.5}, **{**TEST, **SWINGS, "power": 0.2})
    assert (rule_of(noisy), rule_of(rings)) == (NOISY, RINGING)
    assert noisy.priority_reason.endswith("OP travels 200 full strokes an hour: wear")


def test_a_loop_that_a_rule_decides_counts_as_what_the_rule_says(tmp_path) -> None:
    """A frozen measurement whose diagnosis reads saturation is a sensor to look at, and no valve at its limits."""
    frozen, forced = DECIDED[0][1], replace(DECIDED[3][1], tag="FIC-2")
    unfit = replace(sound("FIC-3"), rule="noisy measurement")
    tags = ("FIC-1", "FIC-2", "FIC-3")
    view = replace(plant(), rows=(frozen, forced, unfit), loops=tuple(map(PlantLoop, tags)), traces=(), previous=())
    view = replace(view, history=(), groups=())
    text = " ".join(audit_summary(view).split())
    assert "Findings: 2 sensors to look at." in text
    assert "Verdicts: 1 frozen measurement, 1 noisy measurement, 1 forced swing." in text
    assert "3 of 3 loops could be judged. Of those judged 3 are told by a rule" in text
    page = plant_report(view)
    assert "Findings: 2 sensors to look at." in page
    assert 'data-verdict="frozen measurement"' in page
    assert 'data-verdict="saturation"' not in page
    assert not unfit.cleared, "by a measurement that scatters"
    assert order(frozen)[1] == 0
    kept = replace(view, rows=tuple(replace(row, window_start=START, window_end=END) for row in view.rows))
    run = AuditRun.of(plant_store(tmp_path, tags, kept, data=False))
    assert [row.tag for row in run.findings] == ["FIC-1", "FIC-3"], "a swing from elsewhere is none"
    told = run.to_dict()
    assert [(one["tag"], one["said"], one["finding"]) for one in told["findings"]] == [
        ("FIC-1", "frozen measurement", "sensor to look at"), ("FIC-3", "noisy measurement", "sensor to look at"),
    ]  # fmt: skip
    assert [one["said"] for one in told["assessments"]] == ["frozen measurement", "forced swing", "noisy measurement"]
    assert run.loop("FIC-1").to_dict()["windows"][-1]["said"] == "frozen measurement"


def test_a_measurement_at_fault_excludes_no_size_on_any_page() -> None:
    told = sound("FIC-1")
    frozen = replace(told, rule="frozen measurement", priority=35.0)
    pages = [loop_report(replace(plant().loop_view("FIC-1"), row=row)) for row in (told, frozen)]
    assert [("Largest lost motion that is not excluded" in page) for page in pages] == [True, False]
    assert [bool(excluded_words(row)) for row in (told, frozen)] == [True, False]
    assert [('class="open"' in size_bar(row, 4.0)) for row in (told, frozen)] == [True, False]


def test_what_rules_find_is_known_to_the_store() -> None:
    """Its names are there, for counts and news, and what each finds has words."""
    assert {rule.name for rule in RULES.values() if rule.finding} == set(FINDINGS) - set(FAULTS)
    assert {FROZEN.name, NOISY.name} == set(MEASUREMENT)


@pytest.mark.parametrize(
    ("changed", "command"),
    [
        ({}, "lostmotion simulate data/FIC-1.csv"),
        ({"indices": {"gate_open": 0.0}}, "lostmotion diagnose data/FIC-1.csv --figure FIC-1.png"),
        ({"indices": {}}, "lostmotion diagnose data/FIC-1.csv --figure FIC-1.png"),
        ({"verdict": "cannot tell", "size": None}, "lostmotion diagnose data/FIC-1.csv --figure FIC-1.png"),
        ({"fit_for_use": False}, "lostmotion check data/FIC-1.csv"),
    ],
)
def test_a_study_is_proposed_only_where_its_gate_is_open(changed, command) -> None:
    view = plant()
    row = replace(finding(), **changed)
    assert next_command(PlantLoop("FIC-1", where="FIC-1.csv"), row, view.run) == command
    alone = next_command(PlantLoop("FIC-1", where="FIC-1.csv"), finding(indices={}), replace(view.run, number=0))
    assert alone == "lostmotion solve data/FIC-1.csv", "it is diagnosed: what opens the gate is the question"


def test_loops_that_could_not_be_told_are_not_said_to_need_nothing() -> None:
    """In the treemap they stand apart from those with a label, and both pages say what that means."""
    untold = tuple(judged(f"FIC-{number}", probability=0.1) for number in (6, 7))
    view = replace(plant(), rows=(sound(), *untold), loops=(), groups=(), traces=())
    page = plant_report(view)
    assert "no area given: 2 loops without a label: not cleared, priority low or none" in page
    assert "no area given: 1 loops normal, priority low or none" in page
    assert "need nothing" not in page
    assert "those of the tile without a letter are not cleared" in page


def test_reasons_that_differ_in_numbers_show_their_ends() -> None:
    """Not a template with points in the place of the numbers."""
    said = "dead zone up to {} % of span is not excluded; the tolerance is 1 %"
    rows = tuple(judged(f"FIC-{size}", why=said.format(size)) for size in ("2.5", "11", "1.2"))
    (reason,) = health_of(replace(plant(), rows=rows, loops=())).not_judged
    assert reason.text == f"cannot tell: {said.format('1.2 to 11')}"
    assert len(reason.tags) == 3
    dated = tuple(judged(f"FIC-{one}", why=f"recorded -{one} by v{one}.3.4") for one in (1, 2))
    assert (
        health_of(replace(plant(), rows=dated, loops=()))
        .not_judged[0]
        .text.startswith("cannot tell: recorded -2 to -1")
    )


def test_what_could_not_be_told_is_not_cleared_and_that_is_said_first() -> None:
    view = replace(plant(), rows=(sound(), *(judged(f"LIC-{n}") for n in range(41))), loops=())
    said = "1 of 42 loops could be judged; 41 cannot be told from these records: they are not cleared."
    assert health_of(view).sentence() == said
    assert " ".join(audit_summary(view).split()).index(said) < audit_summary(view).index("Verdicts")
    assert "cleared" not in health_of(replace(view, rows=(sound(),))).sentence()


def test_the_summary_says_how_many_are_worth_a_look() -> None:
    rows = tuple(finding(f"FIC-{n}", priority=20.0 if n < 3 else 1.0) for n in range(14))
    text = " ".join(audit_summary(replace(plant(), rows=rows, loops=())).split())
    assert "3 of the 14 with a priority are worth a look (priority 5 and more); 4 more are in the report." in text


def test_a_percentage_is_of_a_span_only_where_one_is_known() -> None:
    view = plant().loop_view("FIC-1")
    seen = replace(view, row=replace(view.row, indices={"op_span_known": 0.0, "pv_span_known": 0.0}))
    assert "2.1 % of the range of PV seen" in loop_report(seen)
    assert "% of the OP range seen an hour" in loop_report(seen)
    known = replace(view, loop=replace(view.loop, pv_span=(0.0, 50.0)))
    assert "2.1 % of the span of PV" in loop_report(known)
    assert "2.1 % of the range of PV seen" in loop_report(view), "a row of an older run, a loop without a span"
