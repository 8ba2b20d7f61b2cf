"""Units of OP: the span that a unit stands for, reported, and asked for where it decides the severity."""

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.audit.labels import label_of
from lostmotion.audit.row_facts import of_what
from lostmotion.diagnose.op_span import op_span
from lostmotion.diagnose.pooled.together import _same_span
from lostmotion.evaluate import random_faulty_loop
from lostmotion.plant import PlantLoop
from lostmotion.plant.propose import op_limits
from lostmotion.plant.reading import told
from lostmotion.store.rows import UNDATED, AssessmentRow
from tests.e2e.test_commands import run
from tests.support.packed_files import workbook

LOOP = random_faulty_loop(4, samples=700, cause="stiction", process="flow")  # a band of 2.23 % of span


def rows(low, high):
    """OP, 48 to 52 % of a span, PV and SP."""
    return low + (high - low) * LOOP.op / 100.0, LOOP.pv, LOOP.sp


def written(path, names, low, high, units=()):
    table = [",".join(names), *([",".join(units)] if units else [])]
    table += [f"{k},{op:.5f},{pv:.4f},{sp:.4f}" for k, (op, pv, sp) in enumerate(zip(*rows(low, high), strict=True))]
    path.write_text("\n".join([*table, ""]))
    return path


@pytest.mark.parametrize(
    ("op", "units", "span"),
    [
        ("OP_mA", (), (4, 20)),
        ("OP [mA]", (), (4, 20)),
        ("OP (mA)", (), (4, 20)),
        ("OP mA", (), (4, 20)),
        ("OP [4-20 mA]", (), (4, 20)),
        ("OP", ("s", "mA", "m3/h", "m3/h"), (4, 20)),
        ("OP", ("s", "[mA]", "[m3/h]", "[m3/h]"), (4, 20)),
        ("OP [0..20 mA]", (), (0, 20)),
        ("OP_psi", (), (3, 15)),
        ("OP [bar]", (), (0.2, 1)),
        ("OP [kPa]", (), (20, 100)),
        ("OP_V", (), (1, 5)),
        ("OP [V]", (), (0, 10)),
        ("OP_pct", (), (0, 100)),
        ("OP (percent)", (), (0, 100)),
        ("Stellgrad %", (), (0, 100)),
        ("OP [p.u.]", (), (0, 1)),
    ],
)
def test_a_unit_of_a_signal_gives_the_span_and_says_so(tmp_path, op, units, span):
    names = ("Time" if units else "t_s", op, "PV", "SP")
    record = lm.read_loop(written(tmp_path / "a.csv", names, *span, units))
    assert record.op_span == span
    notes = " ".join(record.notes)
    assert (f"its span was taken as {span[0]:g} .. {span[1]:g}" in notes) == (span != (0, 100))
    assert op_span(record).known
    assert op_span(record).percent == pytest.approx(0.01 * (span[1] - span[0]))


def test_a_bad_valve_in_ma_is_as_bad_as_in_percent(tmp_path, capsys):
    """The band of 2.23 % of 4 .. 20 mA is 0.357 mA: not 0.357 % and low."""
    found = lm.diagnose(lm.LoopRecord(*rows(4.0, 20.0), dt=1.0, op_unit="mA"))
    assert (found.verdict, found.severity) == ("stiction", "high")
    assert found.size_percent == pytest.approx(2.23, rel=0.05)
    path = written(tmp_path / "FIC1.csv", ("t_s", "OP_mA", "PV", "SP"), 4.0, 20.0)
    text = " ".join(run(capsys, "diagnose", path)[1].split())
    assert "% of span" in text
    assert "severity high" in text
    assert "OP is in mA: its span was taken as 4 .. 20, not 0 .. 20; give --op-span LOW HIGH" in text
    assert "OP is in mA" in run(capsys, "check", path)[1]


def test_a_span_that_is_given_comes_before_the_unit():
    record = lm.LoopRecord(*rows(4.0, 20.0), dt=1.0, op_unit="mA", op_span=(0.0, 25.0))
    assert (record.op_span, record.notes) == ((0.0, 25.0), ())


@pytest.mark.parametrize(("unit", "low", "high"), [("counts", 0, 100), ("mA", 0, 100), ("t/h", 0, 60)])
def test_a_unit_without_a_span_is_asked_for(unit, low, high):
    record = lm.LoopRecord(*rows(low, high), dt=1.0, op_unit=unit)
    assert record.op_span is None
    assert any(f"OP is in {unit}" in note and "give op_span=(low, high)" in note for note in record.notes)
    assert replace(record, tag="again").notes == record.notes  # once
    assert not op_span(record).known


def test_no_severity_is_given_in_percent_of_an_unknown_unit(tmp_path, capsys):
    path = written(tmp_path / "FIC1.csv", ("t_s", "OP [counts]", "PV", "SP"), 0, 100)
    text = " ".join(run(capsys, "diagnose", path)[1].split())
    assert "% of the OP range seen" in text
    assert "severity unknown (give --op-span LOW HIGH)" in text
    assert "- Give --op-span LOW HIGH, the span of OP" in text
    assert "severity high" in " ".join(run(capsys, "diagnose", path, "--op-span", 0, 100)[1].split())


@pytest.mark.parametrize(
    ("unit", "span", "others"), [("", (4, 20), ((4.0, 20.0), (3.0, 15.0))), ("%", (0, 1), ((0.0, 1.0),))]
)
def test_values_that_several_spans_hold_leave_the_severity_open(unit, span, others):
    """Without a unit 12 may be % or mA; a cell in % of a spreadsheet holds a share of 1."""
    record = lm.LoopRecord(*rows(*span), dt=1.0, op_unit=unit)
    assert (record.op_span, op_span(record).ends, op_span(record).others) == (None, (0.0, 100.0), others)
    found = lm.diagnose(record)
    assert (found.verdict, found.severity) == ("stiction", "unknown")
    assert found.advice[0].startswith(
        "Give op_span=(low, high), the span of OP: the severity is low for 0 .. 100, high"
    )
    said = " ".join(found.summary().split())
    assert "% of an assumed span 0 .. 100" in said
    assert "severity unknown (give op_span=(low, high))" in said
    narrowest = min(high - low for low, high in others)
    assert found.tolerance == pytest.approx(0.01 * narrowest)  # what is nothing of 0 .. 100 may be too much
    in_percent = replace(record, op=3.0 * record.op if span[0] else 50.0 + record.op)
    assert _same_span([record, in_percent]).others == ()


def test_the_same_severity_for_every_span_is_given():
    span = op_span(lm.LoopRecord([10.0, 14.0], [0.0, 1.0], dt=1.0))
    assert span.severity(0.05) == "low"
    assert span.severity(5.0) == "severe"
    assert span.request(0.05) == ""


def test_a_share_of_one_without_a_unit_is_one():
    record = lm.LoopRecord(*rows(0.0, 1.0), dt=1.0)
    found = lm.diagnose(record)
    assert (found.verdict, found.severity) == ("stiction", "high")
    assert found.size_percent == pytest.approx(2.23, rel=0.05)


@pytest.mark.parametrize(
    ("values", "span"),
    [
        ([3.8, 12.0], (4.0, 20.0)),
        ([4.0, 20.5], (4.0, 20.0)),
        ([0.0, 12.0], (0.0, 20.0)),
        ([4.0, 21.0], (4.0, 20.0)),
        ([5.0, 60.0], None),
    ],
)
def test_currents_beyond_their_span(values, span):
    assert lm.LoopRecord(np.resize(values, 100), np.arange(100), dt=1.0, op_unit="mA").op_span == span


def test_percent_beyond_the_limits_of_the_controller_and_in_deviations():
    beyond = lm.LoopRecord(np.linspace(-6.9, 106.9, 300), np.arange(300), dt=1.0, op_unit="%")
    assert beyond.op_span == (0.0, 100.0)
    about_zero = lm.LoopRecord(np.linspace(-3.0, 3.0, 300), np.arange(300), dt=1.0, op_unit="%")
    assert about_zero.op_span is None


def test_the_list_of_a_plant_takes_the_span_of_the_unit():
    in_ma = lm.LoopRecord(*rows(4.0, 20.0), dt=1.0, op_unit="mA")
    assert op_limits(in_ma)[0] == (4.0, 20.0)
    span, notes = op_limits(replace(in_ma, op_unit="", op_span=None))
    assert span is None
    assert "0 .. 100 or 4 .. 20 or 3 .. 15" in notes[0]
    by_list = told(lm.LoopRecord(*rows(4.0, 20.0), dt=1.0, op_unit="%"), PlantLoop("FIC1", op_unit="mA"))
    assert by_list.op_span == (4.0, 20.0)


def test_fits_blocks_and_studies_use_the_span_of_the_unit():
    record = lm.LoopRecord(*rows(4.0, 20.0), dt=1.0, op_unit="mA")
    fit = lm.identify(record, nonlinearity="stiction")
    assert "% of the OP span" in " ".join(fit.summary().split())
    facts = lm.FitFacts.from_dict(fit.to_dict())
    assert facts.op_span == fit.facts.op_span == (4.0, 20.0)
    assert facts.to_dict()["data"]["op_span"] == [4.0, 20.0]
    block = facts.block(accept="to look at the clamps")
    assert (block.settings["low"], block.settings["high"]) == (4.0, 20.0)


def test_units_in_a_column_of_a_row_for_each_value(tmp_path):
    lines = ["Tag;Timestamp;Value;Units"]
    for k, (op, pv, _) in enumerate(zip(*rows(4.0, 20.0), strict=True)):
        stamp = f"2026-03-02 06:{k // 60:02}:{k % 60:02}"
        lines += [f"FIC1.OP;{stamp};{op:.5f};mA", f"FIC1.PV;{stamp};{pv:.4f};m3/h"]
    path = tmp_path / "long.csv"
    path.write_text("\n".join([*lines, ""]))
    record = lm.read_loop(path)
    assert (record.op_unit, record.pv_unit, record.op_span) == ("mA", "m3/h", (4.0, 20.0))


def test_units_below_the_header_of_a_sheet(tmp_path):
    pytest.importorskip("fastexcel")
    op, pv, _ = rows(4.0, 20.0)
    cells = [[k, float(one), float(other)] for k, (one, other) in enumerate(zip(op, pv, strict=True))]
    path = tmp_path / "FIC1.xlsx"
    path.write_bytes(workbook([["Trend", "", ""], ["Time", "OP", "PV"], ["s", "mA", "m3/h"], *cells]))
    assert lm.read_loop(path).op_span == (4.0, 20.0)


def test_a_share_of_the_range_seen_is_no_label_of_a_plant():
    known = {"kind": "actuator", "verdict": "stiction", "size": 2.0, "size_percent": 65.0, "severity": "unknown"}
    row = AssessmentRow("FIC1", UNDATED, UNDATED, **known, indices={"op_span_known": 0.0})
    assert (label_of(row), of_what(row)) == ("maintenance required", "of the OP range seen")
    assert label_of(replace(row, indices={})) == "failure"
    assumed = replace(row, severity="severe", indices={"op_span_known": 0.0, "op_span_assumed": 100.0})
    assert (label_of(assumed), of_what(assumed)) == ("out of specification", "of an assumed span of 100")
