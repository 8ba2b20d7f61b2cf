"""Scattered missing samples are bridged by their most likely values; long runs and other reasons still cut."""

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.records import LoopRecord, limits, prepare
from lostmotion.records.absent_rows import with_absent_rows
from lostmotion.records.missing import bridge_missing
from lostmotion.records.pieces import bridge

N = 3000
LOOP = lm.routine_operation(N, drift="mild", seed=3)
DEAD_ZONE = {"nonlinearity": "dead zone", "orders": (3, 2, 3)}


def scattered(share=0.02, seed=1, first=60):
    rows = np.random.default_rng(seed).random(N) < share
    rows[:first] = rows[-1] = False
    return rows


def holed(op=None, pv=None, loop=LOOP, **settings):
    """The loop with missing cells; in rows without both SP is missing too."""
    op, pv = (np.zeros(N, dtype=bool) if rows is None else rows for rows in (op, pv))
    sp = np.where(op & pv, np.nan, loop.reference)
    signals = np.where(op, np.nan, loop.command), np.where(pv, np.nan, loop.measured)
    return LoopRecord(*signals, sp, **({"dt": 0.1} | settings))


HOLES = {"PV": {"pv": scattered()}, "OP": {"op": scattered()}, "rows": {"op": scattered(), "pv": scattered()}}
HOLES["apart"] = {"op": scattered(seed=2), "pv": scattered()}


@pytest.mark.parametrize("where", HOLES)
def test_nothing_is_cut_and_nothing_taken_for_a_historian(where):
    record = holed(**HOLES[where])
    prepared = prepare(record)
    whole = prepare(LoopRecord(LOOP.command, LOOP.measured, LOOP.reference, dt=0.1))
    assert prepared.share == 1.0
    assert len(prepared.stretches) == 1
    count = int(record.missing.sum())
    assert prepared.notes[0].startswith(f"{count} missing samples ({100 * count / N:.2g} %) bridged, at most ")
    assert prepared.notes[1:] == whole.notes
    assert (prepared.op_step, prepared.pv_step) == (0.0, 0.0)
    assert prepared.made_up == whole.made_up
    assert np.isfinite(prepared.stretches[0].sp).all()


@pytest.fixture(scope="module")
def whole():
    return lm.identify(LoopRecord(LOOP.command, LOOP.measured, LOOP.reference, dt=0.1), **DEAD_ZONE)


@pytest.mark.parametrize("where", HOLES)
def test_the_estimate_is_that_of_the_whole_record(where, whole):
    fit = lm.identify(holed(**HOLES[where]), **DEAD_ZONE)
    assert fit.status is whole.status
    for name in ("left", "right", "width"):
        assert abs(fit.parameters[name] - whole.parameters[name]) < 0.3 * whole.standard_errors[name]
        assert fit.standard_errors[name] == pytest.approx(whole.standard_errors[name], rel=0.1)


def test_in_a_loop_without_noise_of_its_controller_the_values_are_exact():
    for holes in HOLES.values():
        (stretch,) = prepare(holed(**holes)).stretches
        away = np.abs(np.arange(N)[:, None] - np.flatnonzero(np.diff(LOOP.reference))).min(axis=1) > 20
        for bridged, truth in ((stretch.pv, LOOP.measured), (stretch.op, LOOP.command)):
            errors = np.abs(bridged - truth)[away]
            assert np.sum(errors > 1e-6) <= 1  # an extreme of the record that is missing is not gone beyond
            assert errors.max() < 0.05


def test_dead_zone_is_exact_without_noise():
    tank = lm.platforms.level_tank()
    u = lm.signals.prs(N, -5, 5, hold=10, seed=1)
    pv = np.where(scattered(), np.nan, tank.simulate(u))
    fit = lm.identify(LoopRecord(u, pv, dt=0.1), gain=tank.linear.gain, **DEAD_ZONE)
    assert fit.status is lm.Status.OK
    for name, truth in (("left", -1.0), ("right", 1.0)):
        assert fit.parameters[name] == pytest.approx(truth, abs=0.01)


def test_open_loop_with_noise():
    tank, rows = lm.platforms.level_tank(), scattered()
    u = lm.signals.prs(N, -5, 5, hold=10, seed=1)
    y = tank.simulate(u) + np.random.default_rng(1).normal(scale=0.17, size=N)
    whole = lm.identify(LoopRecord(u, y, dt=0.1), **DEAD_ZONE)
    fit = lm.identify(LoopRecord(np.where(scattered(seed=2), np.nan, u), np.where(rows, np.nan, y), dt=0.1))
    assert fit.kinds.best == "dead zone"
    assert abs(fit.parameters["width"] - whole.parameters["width"]) < 1.5 * whole.standard_errors["width"]


def test_what_is_longer_or_more_still_cuts():
    rows = scattered()
    rows[1000 : 1001 + limits.BRIDGE_ROWS] = True
    prepared = prepare(holed(pv=rows))
    assert [part.kind for part in prepared.left_out] == ["missing"]
    assert len(prepared.stretches) == 2
    assert prepare(holed(pv=scattered(1.5 * limits.BRIDGE_SHARE))).share < 0.6


def test_rows_beside_those_left_out_for_another_reason_are_not_bridged():
    mode = np.full(N, "AUTO", dtype="<U8")
    mode[1000:1100] = "LOCAL"
    rows = np.zeros(N, dtype=bool)
    rows[[999, 1050, 1100, 2000]] = True
    prepared = prepare(holed(pv=rows, mode=mode))
    assert [(part.start, part.stop, part.kind) for part in prepared.left_out] == [
        (999, 1000, "missing"),
        (1000, 1100, "mode"),
        (1100, 1101, "missing"),
    ]
    assert prepared.notes[0].startswith("1 missing sample ")


def test_values_at_a_step_of_an_unknown_set_point_are_not_made_up():
    """The controller moves OP by what nobody recorded; a PV that explains the move would be wild."""
    rows = scattered()
    rows[np.flatnonzero(np.diff(LOOP.reference)) + 1] = True
    for op in (None, rows):
        prepared = prepare(replace(holed(op=op, pv=rows), sp=None))
        for stretch, (start, stop) in zip(prepared.stretches, prepared.rows, strict=True):
            assert np.abs(stretch.pv - LOOP.measured[start:stop]).max() < 1.5


def test_a_transmitter_that_fails_is_no_scattered_missing_sample():
    pv, rows = LOOP.measured.copy(), np.zeros(N, dtype=bool)
    pv[1000:1012] = [-14.0, -14.5, -20.0, -20.0, -9.0, -8.0, -7.0, -6.0, -5.0, -4.0, -3.0, -2.0]
    rows[[999, 1001, 2000]] = True
    prepared = prepare(LoopRecord(LOOP.command, np.where(rows, np.nan, pv), LOOP.reference, dt=0.1))
    assert {part.start for part in prepared.left_out if part.kind == "missing"} == {999, 1001}
    assert prepared.notes[0].startswith("1 missing sample ")


def test_values_stay_on_the_steps_and_within_the_range_of_the_record():
    pv, rows = np.round(LOOP.measured, 1), scattered(0.05)
    record = LoopRecord(LOOP.command, np.where(rows, np.nan, pv), LOOP.reference, dt=0.1)
    bridged, filled = bridge_missing(record, ~rows, rows)
    assert filled.sum() == rows.sum()
    assert np.isin(bridged.pv, pv[~rows]).all()
    assert prepare(record).pv_step == 0.1
    assert lm.identify(record, **DEAD_ZONE).data.y_step == 0.1


def test_raw_records_have_holes_still():
    with pytest.raises(lm.DataError, match="finite PV"):
        lm.identify(holed(pv=scattered()), raw=True)


def test_too_few_complete_rows_and_constant_signals():
    short = LoopRecord(np.arange(40.0), np.where(np.arange(40) == 20, np.nan, np.arange(40.0)), dt=1.0)
    assert bridge_missing(short, ~short.missing, short.missing)[0] is short
    flat = LoopRecord(np.ones(400), np.where(np.arange(400) == 20, np.nan, np.arange(400.0)), dt=1.0)
    assert bridge_missing(flat, ~flat.missing, flat.missing)[0] is flat


def test_absent_rows_are_missing_samples():
    keep = np.ones(N, dtype=bool)
    keep[[500, 700, 701, *range(900, 920)]] = False
    mode = np.where(np.arange(N) < 600, "AUTO", "MAN")
    gaps, seconds = (500, 699, 897), (0.1, 0.2, 2.0)
    signals = LOOP.command[keep], LOOP.measured[keep], LOOP.reference[keep]
    record = LoopRecord(*signals, dt=0.1, gaps=gaps, gap_seconds=seconds, mode=mode[keep], start="2026-03-01 06:00")
    whole = with_absent_rows(record)
    assert (len(whole), whole.gaps, whole.gap_seconds) == (N - 20, (900,), (2.0,))
    assert np.flatnonzero(whole.missing).tolist() == [500, 700, 701]
    np.testing.assert_array_equal(whole.op[~whole.missing], record.op)
    np.testing.assert_array_equal(whole.mode, np.delete(mode, range(900, 920)))
    assert whole.moment(950) == record.moment(947)
    assert prepare(whole).rows == ((0, 900), (900, N - 20))
    jittering = LoopRecord(*signals, dt=0.1, gaps=gaps, gap_seconds=(0.1, 0.24, 2.0))
    assert with_absent_rows(jittering) is jittering


def test_missing_cells_of_sp_alone_are_held():
    gone = np.random.default_rng(4).random(N) < 0.02
    gone[0] = True
    whole = LoopRecord(LOOP.command, LOOP.measured, LOOP.reference, dt=0.1)
    holed_sp = replace(whole, sp=np.where(gone, np.nan, LOOP.reference))
    prepared = prepare(holed_sp)
    assert prepared.notes[0] == f"SP is missing in {gone.sum()} rows and was held there."
    assert set(np.flatnonzero(prepared.stretches[0].sp != LOOP.reference)) <= set(np.flatnonzero(gone))


def test_sp_is_not_held_over_long_runs_nor_across_a_gap():
    sp = np.repeat([1.0, 2.0], 100)
    sp[50 : 50 + limits.BRIDGE_ROWS + 1] = np.nan
    sp[100] = sp[140] = np.nan
    record = LoopRecord(np.arange(200.0), np.arange(200.0), sp, dt=1.0, gaps=(100,))
    held = bridge(record)[0].sp
    assert np.flatnonzero(np.isnan(held)).tolist() == list(range(50, 51 + limits.BRIDGE_ROWS))
    assert (held[100], held[140]) == (2.0, 2.0)
