"""The form of a swing that a load has as well names no valve."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.diagnose.features import SILENT, Features, Measured, _indices
from lostmotion.diagnose.form_alone import (
    BETTER,
    FORETOLD,
    LOPSIDED,
    NO_BETTER,
    NOTHING_SWINGS,
    ONLY_FED_BACK,
    without_proof,
)
from lostmotion.diagnose.lopsided import lopsided_index
from lostmotion.errors import DataError
from lostmotion.models import Hammerstein, LinearModel
from lostmotion.simulate import PI, simulate_loop

TIME = np.arange(2000.0)
FORM = Features(shape=0.4, waveform=4.0)
BETTER_A_LITTLE = Features(memory=2.0 * BETTER, shape=0.4)


def measured(features, lopsided=2.0 * LOPSIDED, period=50.0):
    return Measured(features, SILENT, SILENT, period, True, {"lopsided_op": lopsided})


@pytest.mark.parametrize(
    ("form", "index"),
    [
        (lambda turns: np.sin(2.0 * np.pi * turns), 0.0),
        (lambda turns: np.sign(np.sin(2.0 * np.pi * turns)), 0.0),
        (lambda turns: np.abs(turns % 1.0 - 0.5), 0.0),
        (lambda turns: turns % 1.0, 0.5),
        (lambda turns: (turns % 1.0 - 0.5) ** 2, 0.25),  # a saw tooth behind an integrator
        (lambda turns: np.interp(turns % 1.0, [0.0, 1.0 / 3.0, 1.0], [0.0, 1.0, 0.0]), 0.25),
        (lambda turns: turns % 1.0 < 0.3, np.cos(0.3 * np.pi)),  # a pump that runs three tenths of the time
    ],
)
def test_the_index_of_known_forms(form, index):
    assert lopsided_index(form(TIME / 61.3).astype(float), 61.3) == pytest.approx(index, abs=0.02)


def test_neither_scale_nor_drift_nor_noise_nor_a_wandering_period_makes_a_swing_lopsided():
    rng = np.random.default_rng(1)
    turns = TIME / 60.0 + 0.3 * np.sin(2.0 * np.pi * TIME / 900.0)
    even, saw = np.abs(turns % 1.0 - 0.5), turns % 1.0
    rough = 0.1 * rng.normal(size=TIME.size) + 1e-3 * TIME
    assert lopsided_index(1e6 * (even + rough), 60.0) < 0.5 * LOPSIDED
    assert lopsided_index(1e-6 * (saw + rough), 60.0) > 1.5 * LOPSIDED


def test_the_index_needs_two_periods():
    with pytest.raises(DataError, match="two periods"):
        lopsided_index(np.sin(TIME[:90]), 50.0)


@pytest.mark.parametrize("verdict", ["stiction", "backlash"])
def test_form_alone_names_no_valve_behind_a_level_where_the_swing_is_lopsided(verdict):
    assert NO_BETTER in without_proof(verdict, measured(FORM), True, False)
    assert without_proof(verdict, measured(FORM, 0.9 * LOPSIDED), True, True) == ""
    assert without_proof(verdict, measured(FORM), False, True) == ""
    assert without_proof(verdict, measured(BETTER_A_LITTLE), True, False) == ""


@pytest.mark.parametrize("verdict", ["stiction", "backlash", "dead zone"])
def test_where_only_pv_moves_op_a_lopsided_swing_names_nothing_behind_a_level(verdict):
    assert ONLY_FED_BACK in without_proof(verdict, measured(BETTER_A_LITTLE), True, True)
    assert without_proof(verdict, measured(BETTER_A_LITTLE, 0.9 * LOPSIDED), True, True) == ""


def test_what_a_valve_that_sticks_foretells_clearly_is_named_however_lopsided():
    clearly = measured(Features(memory=1.1 * FORETOLD, shape=0.4))
    assert without_proof("stiction", clearly, True, True) == ""
    assert ONLY_FED_BACK in without_proof("dead zone", clearly, True, True)


@pytest.mark.parametrize("verdict", ["none", "other oscillation", "saturation", "cannot tell"])
def test_other_verdicts_do_not_rest_on_the_form(verdict):
    assert without_proof(verdict, measured(FORM, period=np.nan), True, True) == ""


@pytest.mark.parametrize("level", [False, True])
def test_where_nothing_swings_there_is_no_form(level):
    assert without_proof("stiction", measured(FORM, period=np.nan), level, False) == NOTHING_SWINGS
    assert without_proof("stiction", measured(BETTER_A_LITTLE, period=np.nan), level, False) == ""


def test_the_index_is_measured_where_op_swings():
    assert _indices(TIME % 60.0, TIME % 60.0, 60.0)["lopsided_op"] == pytest.approx(0.5, abs=0.02)


def level_loop(valve, load):
    """2000 rows of a level held by a PI controller at a set point that does not move."""
    rate, pace = 0.03, 6.0
    tank = LinearModel.from_continuous([rate], [1.0, 0.0], 1.0, 1.0)
    kp = (2.0 * pace + 1.0) / (rate * (pace + 1.0) ** 2)
    noise = 0.01 * np.random.default_rng(1).normal(size=TIME.size)
    loop = simulate_loop(
        Hammerstein(valve, tank), PI(kp, kp / (2.0 * pace + 1.0), -50.0, 50.0), np.zeros(TIME.size),
        disturbance=tank.simulate(load), noise=noise, allow_unstable=True,
    )  # fmt: skip
    return lm.LoopRecord(50.0 + loop.control, 50.0 + loop.measured, dt=1.0, op_span=(0.0, 100.0))


@pytest.mark.statistics
@pytest.mark.parametrize("period", [90.0, 130.0])
def test_a_saw_tooth_of_load_on_a_level_is_no_valve_that_sticks(period):
    """It was named stiction by the form of the wave, with 0.69."""
    found = lm.diagnose(level_loop(lm.Identity(), 4.0 * (TIME / period % 1.0 - 0.5)), loop_type="level")
    assert (found.verdict, found.kind) == ("cannot tell", "unknown")
    assert "saw tooth" in found.why
    assert found.probabilities["actuator"] > 0.5


@pytest.mark.statistics
def test_a_valve_that_sticks_behind_a_level_is_named_and_swings_evenly():
    found = lm.diagnose(level_loop(lm.Stiction(4.0, 2.0), 0.7 + 1e-3 * TIME), loop_type="level")
    assert found.verdict in ("stiction", "backlash")
    assert found.measured.indices["lopsided_op"] < LOPSIDED
