import math
import re
from dataclasses import replace

import numpy as np
import pytest

from lostmotion.diagnose.loop_stability import LoopStability
from lostmotion.diagnose.oscillation import Oscillation
from lostmotion.records.compression import Compression, MadeUp
from lostmotion.report import diagnosis_line, diagnosis_table
from lostmotion.report.diagnosis_text import bar, probability, verdict_sentence, where_from
from lostmotion.report.digits import signed
from tests.support.diagnoses import CASES, KINDS, example, loop_record, variant


@pytest.mark.parametrize(("verdict", "kind"), CASES)
def test_every_verdict_has_a_first_sentence_and_a_report(verdict, kind):
    found = variant(verdict, kind)
    first = verdict_sentence(found)
    assert first.split("(")[0].isprintable()
    assert first.endswith(".")
    assert first.startswith("NOTHING WRONG" if verdict == "none" else verdict.upper())
    text = found.summary()
    assert "nan" not in text.lower()
    assert max(map(len, text.splitlines())) <= 110
    for part in ("Evidence", "Oscillation", "Actuators compared", "Performance", "What to do", "Note", "fingerprint"):
        assert part in text


def test_size_interval_severity_and_confidence_are_in_the_first_sentence():
    found = example()
    first = verdict_sentence(found)
    size, low, high = (float(number) for number in re.findall(r"\d+\.\d+", first))
    assert [size, low, high] == pytest.approx([found.size_percent, *found.interval], abs=0.006)
    assert " % of span (95 % interval " in first
    assert first.endswith("severity high (high to severe over the interval), confidence 93 %.")
    within = replace(found, interval=(found.size, found.size))
    assert within.size_percent > 4.0
    assert verdict_sentence(within).endswith("severity high, confidence 93 %.")


def test_percent_of_an_unknown_span_are_not_called_percent_of_span():
    record = loop_record()
    moved = replace(record, op=record.op - 60.0)
    assert "% of span" not in verdict_sentence(replace(example(), record=moved))
    known = replace(moved, op_span=(-100.0, 100.0))
    assert "% of span" in verdict_sentence(replace(example(), record=known))


def test_an_apparent_size_says_so_and_a_missing_one_too():
    apparent = variant("stiction", "actuator", interval=(math.nan, math.nan))
    assert "apparent, no interval" in verdict_sentence(apparent)
    unknown = variant("stiction", "actuator", size=math.nan, size_percent=math.nan, interval=(math.nan, math.nan))
    assert "STICTION of unknown size" in verdict_sentence(unknown)


def test_a_size_of_another_kind_than_the_verdict_says_so():
    assert "full width of the dead zone that was fitted" in " ".join(variant("stiction", "actuator").summary().split())
    assert "that was fitted" not in example().summary()


@pytest.mark.parametrize(("fault", "seen"), [(0.21, True), (0.9, False)])
def test_a_limit_that_op_shows_needs_no_likely_fault(fault, seen):
    said = where_from(variant("saturation", "actuator", probabilities={"none": 1.0 - fault, "actuator": fault}))
    assert ("stands at its limit" in said) == ("of anything else:" in said) == seen
    assert ("comes from the actuator" in said) == (not seen)


@pytest.mark.parametrize(("drawn", "said"), [(0.5, True), (0.9, False)])
def test_rows_that_a_historian_drew_point_at_no_actuator(drawn, said):
    found = variant("cannot tell", "unknown", probabilities={"none": 0.1, "actuator": 0.9})
    made_up = MadeUp(Compression(0.0, 0.0), Compression(drawn, 0.0))
    found = replace(found, fit=replace(found.fit, data=replace(found.fit.data, made_up=made_up)))
    assert ("looks like the actuator" in where_from(found)) == said


def test_the_weights_add_up_to_the_odds_of_the_probabilities():
    found = example()
    rows = {line[2:20].strip(): line.split() for line in found.summary().splitlines() if line.startswith("  ")}
    column = [rows["dead zone predicts"][4], rows["wave shape"][3], rows["before evidence"][2], rows["together"][1]]
    *parts, total = map(float, column)
    assert sum(parts) == pytest.approx(total, abs=0.011)
    assert total == pytest.approx(math.log(0.93 / 0.07), abs=0.006)


def test_signs_and_bars():
    assert (signed(1.234), signed(-0.5), signed(0.001)) == ("+1.23", "-0.50", "0")
    assert (bar(1.0), bar(-2.0), bar(0.1), bar(99.0)) == ("++", "----", "", "+" * 12)


def test_probabilities_are_never_certain():
    assert [probability(p) for p in (1.0, 0.5, 0.0)] == ["over 99 %", "50 %", "under 1 %"]


def test_oscillation_is_in_seconds():
    measured = replace(example().measured, op=Oscillation(40.0, 3.0, 0.8, 10.0), pv=Oscillation(np.nan, 0.0, 0.0, 0.0))
    text = replace(example(), measured=measured).summary()
    assert "OP swings regularly: period 200 s" in text
    assert "PV does not move" in text
    irregular = replace(measured, pv=Oscillation(40.0, 0.4, 0.2, 10.0))
    assert "PV does not swing regularly" in replace(example(), measured=irregular).summary()


@pytest.mark.parametrize(
    ("stability", "said"),
    [
        (None, "no feedback"),
        (LoopStability(0.4, 0.1, 0.5, 0.3, 20.0), "cannot be judged"),
        (LoopStability(0.4, 0.1, 0.0, 0.05, 20.0), "lightly damped"),
        (LoopStability(0.4, 0.1, 0.0, 0.05, 20.0), "reset time 20 s"),
        (LoopStability(0.4, 0.0, 0.0, 1.0, math.inf), "no root of the loop oscillates"),
    ],
)
def test_what_is_said_of_the_controller(stability, said):
    assert said in " ".join(replace(example(), stability=stability).summary().split())


def test_limits_of_a_class_say_whose_they_are_and_time_at_a_limit_what_it_counts():
    found = example()
    found = replace(found, performance=replace(found.performance, loop_type="level", limited=0.24))
    assert "limits for: level, for it behaves like one" in found.summary()
    named = replace(found, record=replace(found.record, loop_type="level"))
    assert "(limits for: level)" in named.summary()
    assert "24 % of the time, touches and rows within 0.1 % of " in found.summary()


def test_lines_and_table_of_several():
    error = ValueError("expected numbers")
    rows = [(f"loop {k}", variant(verdict, KINDS[verdict][0])) for k, verdict in enumerate(KINDS)]
    assert "dead zone" in diagnosis_line("FC1", rows[1][1])
    assert diagnosis_line("FC2", None, error) == f"{'FC2':20} error: expected numbers"
    assert "confidence" not in diagnosis_line("FC3", variant("cannot tell", "unknown"))
    table = diagnosis_table([*rows, ("FC2", None)]).splitlines()
    assert table[0].startswith("loop")
    order = [line.split("  ")[0] for line in table[2:-1]]
    assert order[-1] == "loop 0"
    assert set(order[:4]) == {"loop 1", "loop 2", "loop 3", "loop 4"}
    assert table[-1].startswith("8 loops: 1 none, 1 dead zone")
    assert table[-1].endswith("1 without a result.")


def test_the_table_puts_the_worst_first():
    low, severe = variant("backlash", "actuator", severity="low"), variant("stiction", "actuator", severity="severe")
    lines = diagnosis_table([("a", variant("none", "none")), ("b", low), ("c", severe)]).splitlines()
    assert [line[0] for line in lines[2:5]] == ["c", "b", "a"]
