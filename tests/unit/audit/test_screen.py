from dataclasses import asdict, replace
from datetime import UTC, datetime
from functools import cache
from importlib import import_module

import numpy as np
import pytest
from scipy.signal import lfilter

from lostmotion.audit.screen.harris import first_answer
from lostmotion.audit.screen.scatter import scatter
from lostmotion.audit.screen.screen import screen
from lostmotion.audit.settings import AuditSettings
from lostmotion.diagnose.control_error.spectrum import BINS, spectrum_of
from lostmotion.diagnose.control_error.swing import amplitude_spread, nonlinearity, phase_at, swing_of, thinned
from lostmotion.diagnose.oscillation import find_oscillation, oscillation_near
from lostmotion.evaluate import random_faulty_loop
from lostmotion.kernels.turns import turns
from lostmotion.plant.loop import PlantLoop
from lostmotion.records import LoopRecord
from lostmotion.records.movement import reversals, travel
from lostmotion.store.rows import UNDATED, Stage

LOOP = PlantLoop("FIC-1", op_span=(0.0, 100.0), pv_span=(0.0, 100.0))
ROWS = 6000


@cache
def base():
    loop = random_faulty_loop(11, ROWS, "stiction", "flow")
    return LoopRecord(loop.op, loop.pv, loop.sp, dt=1.0)


def row_of(record, loop=LOOP, **settings):
    return screen(loop, record, UNDATED, UNDATED, AuditSettings(**settings))[0]


def said(row, words):
    return any(words in one for one in row.health)


def test_a_record_without_dates_is_told():
    row = row_of(base())
    assert row.health == ("no dates: whether loops of other files swing at the same time cannot be told",)
    assert row.fit_for_use


@pytest.mark.parametrize("band", [0.0, 0.3, 2.0])
def test_turns_and_travel_are_those_of_the_slow_way(band):
    values = np.round(np.cumsum(np.random.default_rng(1).normal(size=2000)), 1)
    assert turns(values, band) == (reversals(values, band), pytest.approx(travel(values)))
    broken = np.r_[values[:900], np.nan, np.nan, values[900:]]
    parts = [values[:900], values[900:]]
    expected = sum(reversals(part, band) for part in parts), pytest.approx(sum(travel(part) for part in parts))
    assert turns(broken, band) == expected
    assert turns(np.full(5, np.nan), band) == (0, 0.0)


def test_healthy_data_say_nothing_and_are_fit():
    row = row_of(replace(base(), start=datetime(2026, 3, 2, tzinfo=UTC)))
    assert row.stage is Stage.SCREENED
    assert row.fit_for_use
    assert row.health == ()
    assert row.error == ""
    assert row.value > 0.3
    assert row.fingerprint == replace(base(), start=datetime(2026, 3, 2, tzinfo=UTC)).fingerprint
    assert (row.manual, row.limited, row.missing) == (0.0, 0.0, 0.0)


def test_rows_are_the_same_every_time():
    first, second = (screen(LOOP, base(), UNDATED, UNDATED, AuditSettings()) for _ in range(2))
    assert asdict(replace(first[0], seconds=0.0)) == asdict(replace(second[0], seconds=0.0))
    assert first[1] == second[1]


def test_numbers_of_operation_are_those_of_the_exact_ones():
    record, row = base(), row_of(base())
    hours = (ROWS - 1) / 3600.0
    assert row.travel == pytest.approx(travel(record.op) / hours)
    assert row.variability == pytest.approx(np.std(record.pv - record.sp))
    exact = find_oscillation(record.pv - record.sp)
    assert row.period == pytest.approx(exact.period, rel=0.05)
    assert row.power == pytest.approx(exact.share, abs=0.15)
    assert row.regularity > 1.0
    assert exact.regular


def stale():
    op, pv = base().op.copy(), base().pv.copy()
    op[1000:3500], pv[1000:3500] = op[1000], pv[1000]
    return replace(base(), op=op, pv=pv)


def missing():
    return replace(base(), pv=np.where(np.arange(ROWS) < 0.3 * ROWS, np.nan, base().pv))


def compressed():
    at = np.arange(0, ROWS, 12)
    return replace(base(), pv=np.interp(np.arange(ROWS), at, base().pv[at]))


def slow():
    return replace(base(), op=np.repeat(base().op[::5], 5), pv=np.repeat(base().pv[::5], 5))


def coarse():
    step = 0.4 * float(np.ptp(base().pv))
    return replace(base(), pv=np.round(base().pv / step) * step)


def ranged():
    op = base().op
    return replace(base(), op=100.6 + 40.0 * (op - float(np.quantile(op, 0.97))) / float(np.ptp(op)))


@pytest.mark.parametrize(
    ("record", "words", "fit"),
    [
        (stale, "stale for 42 %", True),
        (missing, "bad or missing for 30 %", True),
        (compressed, "compressed", False),
        (slow, "change every 5 s, rows are 1 s apart", True),
        (coarse, "PV is coarse", True),
        (ranged, "OP is outside its span 0 .. 100", True),
        (lambda: replace(base(), pv=base().op), "OP and PV are the same signal", False),
        (lambda: replace(base(), sp=base().sp + 900.0), "never come near each other", True),
        (lambda: replace(base(), sp=base().pv), "SP and PV are the same signal", True),
        (lambda: replace(base(), sp=None), "no SP recorded", True),
        (lambda: replace(base(), pv=np.full(ROWS, 3.0)), "PV is constant (3)", False),
        (lambda: replace(base(), op=np.full(ROWS, np.nan)), "OP is missing all the time", False),
        (lambda: base().cut(0, 150), "only 150 rows of live data", False),
    ],
)
def test_what_is_wrong_with_the_data_is_told(record, words, fit):
    row = row_of(record())
    assert said(row, words), row.health
    assert row.fit_for_use is fit
    assert row.stage is Stage.SCREENED
    assert (row.value > 0.0) is fit
    if not fit:
        assert row.reason.startswith("data not fit for use")


def test_modes_count_and_without_them_held_op_counts():
    mode = np.where(np.arange(ROWS) < 1500, "MAN", "AUTO")
    assert row_of(replace(base(), mode=mode)).manual == 0.25
    assert row_of(replace(base(), mode=np.full(ROWS, "7"))).manual == 0.0  # a word that means nothing
    op = base().op.copy()
    op[1000:2500] = op[1000]
    held = row_of(replace(base(), op=op))
    assert held.manual == pytest.approx(0.25, abs=0.01)
    assert said(held, "no mode recorded")


def test_hand_and_limits_leave_nothing_to_be_told():
    by_hand = row_of(replace(base(), mode=np.full(ROWS, "MAN")))
    assert by_hand.value == 0.0
    assert by_hand.performance == "open loop"
    assert "manual" in by_hand.reason
    op = np.where(np.arange(ROWS) < 5900, 100.0, base().op)
    full = row_of(replace(base(), op=op))
    assert full.limited == pytest.approx(5900 / ROWS)
    assert full.value == 0.0
    assert "limit of OP" in full.reason


def test_a_master_has_no_valve_to_be_diagnosed():
    """28 % "likely at fault, move OP in manual" was said of levels whose OP is the set point of a flow."""
    alone, master = row_of(base()), row_of(base(), replace(LOOP, slave="FIC-2"))
    assert alone.value > 0.0
    assert master.value == 0.0
    assert "that of its slave, FIC-2, is the one to look at" in master.reason
    assert (master.period, master.power, master.travel) == (alone.period, alone.power, alone.travel)
    by_hand = row_of(replace(base(), mode=np.full(ROWS, "MAN")), replace(LOOP, slave="FIC-2"))
    assert "manual" in by_hand.reason, "what is wrong with the data comes first"


@pytest.mark.parametrize(("every", "share"), [(100, 0.5), (4000, 0.0)])
def test_integral_action_that_creeps_on_tells_a_sensor_that_stands_from_a_recording(every, share):
    """PV stands near SP: OP goes by a step in a hundred rows, which row by row is a recording that stopped."""
    rng = np.random.default_rng(3)
    pv = np.round(50.0 + 0.05 * rng.normal(size=8000), 2)
    op = np.round(40.0 + np.cumsum(0.05 * rng.normal(size=8000)), 2)
    pv[2000:6000] = pv[2000]
    op[2000:6000] = op[2000] + 0.2 * (np.arange(4000) // every)
    row = row_of(LoopRecord(op, pv, np.full(8000, 50.0), dt=1.0))
    assert row.indices["stuck"] == pytest.approx(share, abs=0.01)
    assert row.indices["stale"] == pytest.approx(0.5, abs=0.01)


def test_output_limits_inside_the_span_are_seen():
    op = base().op
    cut = np.minimum(op, np.quantile(op, 0.8))
    assert 0.1 < row_of(replace(base(), op=cut)).limited <= 0.2  # turning points at the limit are short
    assert row_of(base()).limited == 0.0


def test_op_that_hardly_moves_is_worth_nothing_unless_it_swings():
    random = np.random.default_rng(3)
    op, pv = 50.0 + 0.05 * random.normal(size=(2, ROWS))
    quiet = row_of(LoopRecord(op, pv, np.full(ROWS, 50.0), dt=1.0))
    assert quiet.value == 0.0
    assert "cannot show" in quiet.reason
    wave = 0.2 * np.sin(np.arange(ROWS) / 10.0)
    assert row_of(LoopRecord(op + wave, pv - wave, np.full(ROWS, 50.0), dt=1.0)).value > 0.0


def test_a_swing_is_worth_more_than_none():
    still = random_faulty_loop(2, ROWS, "none", "flow")
    calm = row_of(LoopRecord(still.op, still.pv, still.sp, dt=1.0))
    assert row_of(base()).value > calm.value


def test_spectrum_adds_up_and_finds_the_line():
    n, period = 20_000, 250.0
    x = np.sin(2 * np.pi * np.arange(n) / period) + 0.3 * np.random.default_rng(0).normal(size=n)
    spectrum = spectrum_of(x, 2.0)
    assert spectrum.bins.size == BINS
    assert spectrum.bins.sum() == pytest.approx(1.0)
    at = int(np.argmax(spectrum.bins))
    assert spectrum.edges[at] <= 1.0 / (2.0 * period) * 1.05
    assert spectrum.edges[at + 1] >= 1.0 / (2.0 * period) * 0.95
    swing = swing_of(x, spectrum, 2.0)
    assert swing.period == pytest.approx(2.0 * period, rel=0.02)
    assert swing.steady
    assert spectrum_of(np.zeros(500), 1.0) is None
    assert spectrum_of(np.full(500, np.nan), 1.0) is None


@pytest.mark.parametrize("period", [12.0, 300.0, 4000.0])
def test_period_is_found_at_its_own_time_scale(period):
    n = 86_400
    random = np.random.default_rng(1)
    x = (
        np.sin(2 * np.pi * np.arange(n) / period)
        + np.cumsum(random.normal(size=n)) / 300.0
        + 0.5 * random.normal(size=n)
    )
    swing = swing_of(x - x.mean(), spectrum_of(x - x.mean(), 1.0), 1.0)
    assert swing.period == pytest.approx(period, rel=0.03)
    assert swing.regularity > 1.0


def test_known_period_gives_the_same_oscillation_as_the_search():
    x = np.sin(np.arange(1500) / 7.0) + 0.2 * np.random.default_rng(2).normal(size=1500)
    assert oscillation_near(x, 2 * np.pi * 7.0) == find_oscillation(x)


def test_phase_counts_from_the_clock_of_the_window():
    t = np.arange(5000.0)
    x = np.cos(2 * np.pi * t / 100.0)
    early, late = phase_at(x, t, 100.0, 1.0), phase_at(x[25:], t[25:], 100.0, 1.0)
    assert early == pytest.approx(late, abs=0.02)
    moved = phase_at(x, t + 25.0, 100.0, 1.0)  # a wave that is a quarter of a period late
    assert (early - moved) % (2 * np.pi) == pytest.approx(np.pi / 2, abs=0.02)


def test_a_relay_wave_is_more_nonlinear_than_filtered_noise():
    random = np.random.default_rng(5)
    t = np.arange(4000.0)
    saw = (t / 50.0) % 1.0 + 0.05 * random.normal(size=t.size)
    noise = lfilter([1.0], [1.0, -1.9 * np.cos(2 * np.pi / 50.0), 0.95**2], random.normal(size=t.size))
    assert nonlinearity(saw, 50.0, 1.0) > 10.0
    assert nonlinearity(noise, 50.0, 1.0) < 1.0
    assert nonlinearity(np.sin(t / 8.0) + 0.1 * random.normal(size=t.size), 16.0 * np.pi, 1.0) < 1.0
    assert nonlinearity(saw[:100], 50.0, 1.0) is None


def test_delay_is_seen_through_a_loop():
    random = np.random.default_rng(6)
    op = np.cumsum(random.normal(size=3000)) * 0.1
    pv = np.r_[np.zeros(4), op[:-4]] + 0.05 * random.normal(size=3000)
    assert first_answer(pv, op) == 4
    assert first_answer(random.normal(size=3000), op) is None
    assert first_answer(np.zeros(3000), op) is None


def test_blocks_are_means_of_what_is_known():
    assert thinned(np.array([1.0, 3.0, np.nan, 5.0, np.nan, np.nan, 9.0]), 2).tolist()[:2] == [2.0, 5.0]
    assert np.isnan(thinned(np.array([1.0, 3.0, np.nan, np.nan]), 2)[1])


def test_an_unexpected_error_is_a_row(monkeypatch):
    def broken(rows):
        raise ZeroDivisionError("a\nsurprise")

    monkeypatch.setattr(import_module("lostmotion.audit.screen.screen"), "health_of", broken)
    row, spectrum = screen(LOOP, base(), UNDATED, UNDATED, AuditSettings())
    assert (row.stage, row.error, spectrum) == (Stage.FAILED, "ZeroDivisionError: a surprise", None)


def test_scatter_is_that_of_the_rows_not_of_what_moves():
    rng, rows = np.random.default_rng(3), np.arange(20_000)
    for period, amplitude in ((2000.0, 30.0), (40.0, 10.0), (10.0, 5.0)):
        values = amplitude * np.sin(2.0 * np.pi * rows / period) + 0.8 * rng.normal(size=rows.size)
        values[500:700] = np.nan
        assert scatter(values, 1.0) == pytest.approx(0.8, rel=0.05)
    assert scatter(values, 10.0) is scatter(values[:100], 1.0) is None
    assert scatter(np.repeat(values, 100), 1.0) == 0.0, "held values"


def test_the_amplitude_of_what_rings_comes_and_goes_and_of_a_forced_swing_stays():
    random, t = np.random.default_rng(4), np.arange(60000.0)
    radius = np.exp(-0.02 * 2.0 * np.pi / 50.0)  # damping of 2 %
    rings = lfilter([1.0], [1.0, -2.0 * radius * np.cos(2.0 * np.pi / 50.0), radius**2], random.normal(size=t.size))
    forced = np.sign(np.sin(2.0 * np.pi * t / 50.0)) + 0.2 * random.normal(size=t.size)
    assert 0.4 < amplitude_spread(rings, 50.0, 1.0) < 0.65, "0.52 after Rayleigh"
    assert amplitude_spread(forced, 50.0, 1.0) < 0.1
    holes = np.where((t // 1000) % 2 == 0, np.nan, forced)
    assert amplitude_spread(holes, 50.0, 1.0) < 0.1
    assert amplitude_spread(forced[:400], 50.0, 1.0) is None
    assert amplitude_spread(np.zeros(5000), 50.0, 1.0) is None


@pytest.mark.parametrize(
    ("loop", "dt", "words"),
    [
        (replace(LOOP, pv_span=None), 1.0, "span of PV unknown: a noisy measurement cannot be told"),
        (LOOP, 10.0, "rows are 10 s apart: a noisy measurement cannot be told"),
        (LOOP, 5.0, ""),
    ],
)
def test_where_a_noisy_measurement_cannot_be_seen_that_is_told(loop, dt, words):
    row = row_of(replace(base(), dt=dt), loop)
    assert said(row, "a noisy measurement cannot be told") == bool(words)
    assert said(row, words)
    assert row.indices["pv_span_known"] == float(loop.pv_span is not None)
    assert ("scatter_percent" in row.indices) != bool(words)
