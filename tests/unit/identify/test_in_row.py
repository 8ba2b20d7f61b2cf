"""A flow that is recorded more slowly than its loop: PV answers OP within a row, and moves of SP tell which way."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identify.data import collect
from lostmotion.identify.likelihood.feedback import feedback
from lostmotion.identify.likelihood.in_row import answers_in_row
from lostmotion.identify.scaled import ScaledData, Scaling
from lostmotion.identify.settled import settled_by

BAND = 4.0


def flow(scans, *, band=BAND, rows=1500, seed=1, gain=1.2, noise=0.05, slower=1.0, step=0.0, moves=True):
    """Every row has so many scans of a PI loop that settles in about five; SP moves, and a load drifts."""
    random = np.random.default_rng(seed)
    n = rows * scans
    sp = np.repeat(random.uniform(-8.0, 8.0, rows // 60 + 1), 60 * scans)[:n] * moves
    load = 0.02 / np.sqrt(scans) * random.normal(size=n).cumsum()
    op, pv = np.zeros(n), np.zeros(n)
    valve = state = integral = 0.0
    for k in range(n):
        state += 0.5 / slower * (gain * valve + load[k] - state)
        pv[k] = state + noise * random.standard_normal()
        integral += 0.15 / slower * (sp[k] - pv[k]) / gain
        op[k] = 0.2 * (sp[k] - pv[k]) / gain + integral
        valve = min(max(valve, op[k] - band / 2), op[k] + band / 2)
    at = slice(None, None, scans)
    if step:
        op, pv = step * np.round(op / step), step * np.round(pv / step)
    return lm.LoopRecord(50 + op[at], 50 + pv[at], 50 + sp[at], dt=float(scans), op_span=(0.0, 100.0))


def scaled(record):
    data = collect(record, None, None)
    return ScaledData.of(data, Scaling(data.u_centre, data.u_scale, data.y_centre, data.y_scale))


@pytest.mark.parametrize("gain", [1.2, -0.7])
def test_moves_of_sp_tell_the_direction_which_pv_confuses(gain):
    by_all, by_pv = (feedback(data).direction for data in (scaled(flow(10, gain=gain)), _without_sp(gain)))
    assert by_all == -np.sign(gain)
    assert by_pv == np.sign(gain)  # why SP is asked


def _without_sp(gain):
    record = flow(10, gain=gain)
    return scaled(lm.LoopRecord(record.op, record.pv, dt=record.dt, op_span=record.op_span))


@pytest.mark.parametrize(("scans", "in_row"), [(10, True), (1, False), (2, False)])
def test_pv_answers_within_a_row_where_the_row_is_long(scans, in_row):
    assert answers_in_row(scaled(flow(scans))) is in_row


def test_without_moves_of_sp_nothing_tells_the_process_from_the_inverse_of_the_controller():
    assert not answers_in_row(_without_sp(1.2))


def test_an_open_loop_is_not_meant():
    u = np.random.default_rng(2).normal(size=1000)
    assert not answers_in_row(scaled(lm.LoopRecord(u, u + 0.1 * np.random.default_rng(3).normal(size=1000), dt=1.0)))


@pytest.mark.statistics
@pytest.mark.parametrize("band", [0.0, BAND])
def test_a_valve_that_sticks_is_not_named_where_the_loop_settles_between_the_rows(band):
    """It fits better behind a sound valve too, and its size is off by half."""
    found = lm.diagnose(flow(10, band=band, seed=3), loop_type="flow")
    assert found.verdict not in ("backlash", "stiction", "dead zone", "none")
    if band > 0.0:
        assert "settles between the rows" in found.why


@pytest.mark.statistics
@pytest.mark.parametrize(("scans", "slower"), [(4, 3.0), (6, 5.0)])
def test_a_slower_loop_tells_its_lost_motion(scans, slower):
    found = lm.diagnose(flow(scans, seed=1, slower=slower), loop_type="flow")
    assert found.verdict in ("backlash", "stiction")
    assert abs(found.size - BAND) < 0.1 * BAND


@pytest.mark.statistics
def test_how_large_it_is_is_not_said_where_much_happens_between_the_rows():
    """It would be 2.8 of 4."""
    found = lm.diagnose(flow(10, seed=1, slower=3.0), loop_type="flow")
    assert found.verdict in ("backlash", "stiction")
    assert np.isnan(found.size)
    assert "between the rows" in " ".join(found.notes)


@pytest.mark.statistics
@pytest.mark.parametrize("scans", [6, 10])
def test_nothing_is_excluded_where_the_loop_settles_between_the_rows(scans):
    """A backlash of 4 had been excluded down to 0.02."""
    found = lm.diagnose(flow(scans, seed=0), loop_type="flow")
    assert not found.excluded or not np.isfinite(list(found.excluded.values())).any()


def test_a_loop_that_takes_rows_to_settle_is_not_meant():
    for scans in (1, 2):
        record = flow(scans)
        assert not collect(record, None, None).unseen.settled
        assert settled_by(record.pv, record.sp, np.array([[0, len(record)]])) < 0.2


def one_row_behind(*, band=3.0, moves=True, rows=2500, seed=1, step=0.0):
    """PV of a row answers OP of the same row; the controller knows PV of the row before: a common way to simulate."""
    random = np.random.default_rng(seed)
    sp = np.repeat(random.uniform(-6.0, 6.0, rows // 150 + 1), 150)[:rows] * moves
    load = 0.03 * random.normal(size=rows).cumsum()
    op, pv = np.zeros(rows), np.zeros(rows)
    valve = state = integral = 0.0
    for k in range(1, rows):
        error = sp[k] - pv[k - 1]
        integral += 0.04 * error
        op[k] = 0.4 * error + integral
        valve = min(max(valve, op[k] - band / 2), op[k] + band / 2)
        state = 0.9 * state + 0.1 * (valve + load[k])
        pv[k] = state + 0.05 * random.normal()
    if step:
        op, pv = step * np.round(op / step), step * np.round(pv / step)
    return lm.LoopRecord(50 + op, 50 + pv, 50 + sp, dt=1.0, op_span=(0.0, 100.0))


@pytest.mark.parametrize("moves", [True, False])
@pytest.mark.parametrize("step", [0.0, 0.01])
def test_a_controller_that_knows_the_rows_before_only_ties_nothing(moves, step):
    record = one_row_behind(moves=moves, step=step)
    assert collect(record, None, None).of_past_rows
    assert answers_in_row(scaled(record))


@pytest.mark.parametrize("options", [{}, {"noise": 0.0}, {"noise": 0.0, "step": 0.05}, {"step": 0.05}, {"step": 0.5}])
@pytest.mark.parametrize("scans", [1, 2, 4])
def test_one_that_knows_its_own_row_or_acts_between_them_is_told_from_it(scans, options):
    assert not collect(flow(scans, **options), None, None).of_past_rows


@pytest.mark.statistics
@pytest.mark.parametrize("seed", [1, 2])
def test_its_lost_motion_is_found_with_a_delay_of_0(seed):
    """With delays from 1 on half of such loops were not told at all."""
    found = lm.diagnose(one_row_behind(seed=seed))
    assert (found.verdict, found.fit.chosen.delay) == ("backlash", 0)
    assert abs(found.size - 3.0) < 0.1 * 3.0


@pytest.mark.statistics
def test_a_sound_one_is_cleared():
    found = lm.diagnose(one_row_behind(band=0.0))
    assert found.verdict in ("none", "other oscillation")
    assert max(found.excluded[kind] for kind in ("backlash", "stiction")) < 0.2
