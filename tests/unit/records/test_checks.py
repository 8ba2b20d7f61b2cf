import json

import numpy as np
import pytest

from lostmotion.diagnose.op_span import op_span
from lostmotion.records import Finding, LoopRecord, check, prepare
from lostmotion.records.loop_facts import reversals

N = 1000
T = np.arange(N)


def loop(op=None, pv=None, seed=0, **settings):
    rng = np.random.default_rng(seed)
    op = 50 + 10 * np.sin(T / 15) + 0.1 * rng.standard_normal(N) if op is None else op
    pv = np.sin(T / 15 - 1) + 0.02 * rng.standard_normal(N) if pv is None else pv
    return LoopRecord(op=op, pv=pv, dt=settings.pop("dt", 2.0), **settings)


def found(record, level):
    return [finding.what for finding in check(record).findings if finding.level == level]


def test_good_record_has_nothing_to_report():
    report = check(loop(sp=np.zeros(N), op_span=(0, 100), notes=("dt was given.",)))
    assert report.usable
    assert report.findings == []
    assert report.sampling.seconds == 2000.0
    assert report.loop.mode == "automatic, SP constant"
    assert report.loop.op_reversals == 21
    assert report.op.amplitude_of_span == pytest.approx(0.198, abs=0.005)
    assert report.notes == ("dt was given.",)


def test_report_prints_and_turns_into_json():
    pv = np.where(T == 500, np.nan, np.sin(T / 15))
    report = check(loop(pv=pv, tag="FIC-101", notes=("dt was given.",), gaps=(100,)))
    text = str(report)
    for part in (
        "FIC-101",
        "every 2 s",
        "PV:",
        "note    dt was given.",
        "Time is missing in 1 place.",
        "usable",
    ):
        assert part in text
    assert json.loads(json.dumps(report.to_dict()))["op"]["levels"] == N


@pytest.mark.parametrize("name", ["op", "pv"])
def test_constant_signal_is_an_error(name):
    report = check(loop(**{name: np.full(N, 3.0)}))
    assert not report.usable
    assert report.findings[0].what == f"{name.upper()} is constant (3)."
    assert "not usable" in report.summary()


def test_manual():
    assert check(loop(op=np.full(N, 3.0))).loop.mode == "manual: OP constant"


@pytest.mark.parametrize("name", ["op", "pv"])
def test_all_missing(name):
    report = check(loop(**{name: np.full(N, np.nan)}))
    assert not report.usable
    assert f"Every sample of {name.upper()} is missing." in [finding.what for finding in report.findings]
    json.dumps(report.to_dict())


def test_short_records():
    assert found(loop().cut(0, 100), "warning")[0] == "Only 100 samples."
    assert not check(loop().cut(0, 20)).usable


def test_missing_rows_and_gaps():
    pv = np.sin(T / 15)
    pv[100:106] = pv[400] = np.nan
    report = check(loop(pv=pv, gaps=(700,)))
    assert (report.sampling.missing, report.sampling.gaps, report.sampling.longest_piece) == (7, 1, 594)
    pv[::3] = np.nan
    assert any("rows miss OP or PV" in what for what in found(loop(pv=pv), "warning"))


def test_saturation_with_and_without_span():
    op = np.clip(50 + 70 * np.sin(T / 15), 0, 100)
    for span in ((0.0, 100.0), None):
        report = check(loop(op=op, op_span=span))
        assert report.loop.saturated_low == pytest.approx(0.25, abs=0.03)
        assert report.loop.saturated_high == pytest.approx(0.25, abs=0.03)
        assert len([what for what in found(loop(op=op, op_span=span), "warning") if "limit" in what]) == 2
    assert check(loop(op=op, op_span=(-50.0, 150.0))).loop.saturated_high == 0.0


def test_steps_by_hand_are_no_saturation():
    op = np.repeat([0.0, 2.0, 4.0, 2.0, 0.0, -2.0, -4.0, -2.0, 0.0, 1.0], 100)
    report = check(loop(op=op))
    assert (report.loop.saturated_low, report.loop.saturated_high) == (0.0, 0.0)
    assert "in steps" in report.loop.mode


def test_small_amplitude_of_span():
    what = found(loop(op=50 + 0.5 * np.sin(T / 15), op_span=(0, 100)), "warning")
    assert "OP moved over 0.99 % of span only (5-95 %)." in what


def test_no_reversals():
    assert any("turned round only 0 times" in what for what in found(loop(op=T / 10.0), "warning"))


def test_modes():
    assert check(loop()).loop.mode == "no SP recorded"
    assert check(loop(sp=np.repeat([0, 1, 2, 1.0], 250))).loop.mode == "automatic, SP moved 3 times"
    assert check(loop(sp=np.sin(T / 50))).loop.mode == "cascade: SP moves all the time"
    assert check(loop(sp=np.full(N, np.nan))).loop.sp_moves is None


def test_quantised_pv():
    report = check(loop(pv=np.round(2 * np.sin(T / 15))))
    assert (report.pv.levels, report.pv.step) == (5, 1.0)
    assert any("only 5 levels, 1 or more apart" in finding.what for finding in report.findings)


def test_interpolated_pv():
    points = np.random.default_rng(4).standard_normal(51)
    pv = np.round(np.interp(T, np.linspace(0, N, 51), points), 7)
    report = check(loop(pv=pv))
    assert report.pv.linear_share > 0.9
    assert any("straight lines" in what for what in found(loop(pv=pv), "warning"))


def test_held_pv():
    pv = np.repeat(np.random.default_rng(5).standard_normal(100), 10)
    report = check(loop(pv=pv))
    assert (report.pv.longest_flat, report.pv.flat_share) == (10, 1.0)
    assert any("PV stands still in 100 %" in what for what in found(loop(pv=pv), "warning"))


def test_record_faster_than_its_scan():
    slow = loop()
    what = found(loop(op=np.repeat(slow.op[:250], 4), pv=np.repeat(slow.pv[:250], 4)), "warning")
    assert what[0].startswith("OP and PV change only every 4.0 rows")


def test_frozen_record():
    base = loop()
    op, pv = base.op.copy(), base.pv.copy()
    op[300:340], pv[300:340] = op[300], pv[300]
    assert "OP and PV both stand still for 40 samples (80 s)." in found(loop(op=op, pv=pv), "warning")


def test_spikes_but_not_steps():
    pv = np.sin(T / 15) + 0.02 * np.random.default_rng(6).standard_normal(N)
    pv[500:] += 20
    assert check(loop(pv=pv)).pv.spikes == ()
    pv[200] += 30
    report = check(loop(pv=pv))
    assert report.pv.spikes == (200,)
    assert "PV has 1 spike (row 201)." in [finding.what for finding in report.findings]


def test_findings_are_ordered_by_level():
    levels = [finding.level for finding in check(loop(op=np.full(N, 1.0), gaps=(5,)).cut(0, 150)).findings]
    assert levels == sorted(levels, key=["error", "warning", "info"].index)


def test_finding_prints_what_why_and_remedy():
    assert str(Finding("info", "A.", "", "B.")) == "info    A. B."


def test_notes_survive_a_cut():
    assert loop(notes=("x.",)).cut(0, 10).notes == ("x.",)


SWING = 10 * np.sin(T / 15) + 0.1 * np.random.default_rng(3).standard_normal(N)


@pytest.mark.parametrize(
    ("op", "span", "kept"),
    [
        (0.2 * SWING, (0.0, 100.0), False),
        (50.0 + SWING, (0.0, 1.0), False),
        (50.0 + SWING, (4.0, 20.0), False),
        (5.0 * SWING, (0.0, 100.0), False),
        (52.0 + 5.5 * SWING, (0.0, 100.0), True),
        (52.0 + SWING, (0.0, 100.0), True),
        (52.0 + SWING, None, True),
    ],
)
def test_a_span_of_other_units_is_left_out_and_told(op, span, kept):
    record = loop(op=op, op_span=span)
    said = [what for what in found(record, "warning") if "outside of its span" in what]
    assert bool(said) == (span is not None and bool(np.mean((op < span[0]) | (op > span[1])) > 0.05))
    prepared = prepare(record)
    (stretch,) = prepared.stretches
    assert stretch.op_span == (span if kept else None)
    assert kept == (not any("other units" in note for note in prepared.notes))
    assert op_span(record).known == (kept or op.min() >= 0)
    if not kept:
        np.testing.assert_array_equal(stretch.op, op)
        assert not any("limit" in what for what in found(record, "warning"))


def test_span_of_pv_in_other_units_is_told():
    assert any(what.startswith("PV is outside") for what in found(loop(pv_span=(50.0, 60.0)), "warning"))


def test_small_moves_may_be_those_of_other_units():
    (small,) = [one for one in check(loop(op=0.5 + 0.02 * SWING, op_span=(0, 100))).findings if "span only" in one.what]
    assert "other units" in small.remedy


def naive_reversals(values, size):
    """Sample by sample."""
    count, direction = 0, 0
    low = high = extreme = None
    for value in values[~np.isnan(values)].tolist():
        if direction == 0:
            low, high = (value, value) if low is None else (min(low, value), max(high, value))
            if high - low > size:
                direction, extreme = (1 if value == high else -1), value
        elif (value - extreme) * direction > 0:
            extreme = value
        elif (extreme - value) * direction > size:
            count, direction, extreme = count + 1, -direction, value
    return count


@pytest.mark.parametrize("seed", range(40))
def test_reversals_by_stretches_are_those_sample_by_sample(seed):
    random = np.random.default_rng(seed)
    n = int(random.integers(0, 2000))
    values = np.cumsum(random.normal(size=n)) * 10.0 ** random.integers(-2, 1) + 0.1 * random.normal(size=n)
    values = np.round(values, int(random.integers(0, 4)))
    values[random.random(n) < 0.05] = np.nan
    for size in (0.0, 0.3, 3.0):
        assert reversals(values, size) == naive_reversals(values, size)


def test_op_that_is_held_by_hand_is_at_no_limit():
    op = np.sin(T / 15)
    op[:300] = -1.2
    mode = np.where(np.arange(op.size) < 300, "Man", "Auto")
    by_hand = check(loop(op=op, mode=mode)).loop
    assert (by_hand.saturated_low, by_hand.saturated_high) == (0.0, 0.0)
    assert check(loop(op=op, mode=np.full(op.size, "Auto"))).loop.saturated_low > 0.1
