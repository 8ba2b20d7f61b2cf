"""The waveform index: what it may not depend on, what it sees, and that it is what was trained."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lostmotion as lm
from lostmotion.diagnose import waveform_index
from lostmotion.evaluate import random_faulty_loop


def loop(seed, cause):
    made = random_faulty_loop(seed, 2000, cause=cause)
    return np.asarray(made.op), np.asarray(made.pv)


OP, PV = loop(3, "stiction")


@settings(max_examples=20, deadline=None)
@given(
    st.sampled_from([-1.0, 1.0]),
    st.sampled_from([-1.0, 1.0]),
    st.floats(-6.0, 6.0),
    st.floats(-6.0, 6.0),
    st.floats(-1e3, 1e3),
)
def test_units_action_and_level_do_not_matter(op_sign, pv_sign, op_scale, pv_scale, level):
    expected = waveform_index(OP, PV).log_odds
    changed = waveform_index(op_sign * 10.0**op_scale * (OP + level), pv_sign * 10.0**pv_scale * (PV + level))
    assert changed.log_odds == pytest.approx(expected, abs=0.02)


def test_a_line_in_a_window_does_not_matter_much():
    ramp = np.linspace(0.0, 1.0, OP.size)
    assert abs(waveform_index(OP + ramp, PV - ramp).log_odds - waveform_index(OP, PV).log_odds) < 0.5


@pytest.mark.statistics
def test_simulated_loops_are_told_apart():
    """Loops of another simulation than that of the training; area under the curve."""
    seeds = range(700, 725)
    odds = {
        cause: np.array([waveform_index(*loop(seed, cause)).log_odds for seed in seeds])
        for cause in ("stiction", "tuning", "disturbance")
    }
    sound = np.concatenate([odds["tuning"], odds["disturbance"]])
    assert (odds["stiction"][:, None] > sound).mean() > 0.85
    assert np.median(sound) < -1.5


def test_a_period_is_what_the_record_has():
    t = np.arange(3000)
    found = waveform_index(np.sin(2 * np.pi * t / 73), np.cos(2 * np.pi * t / 73))
    assert found.period == pytest.approx(73, rel=0.02)
    assert found.windows > 1


@pytest.mark.parametrize(
    ("op", "pv", "said"),
    [
        (np.ones(500), np.arange(500.0), "op that moves"),
        (np.arange(500.0), np.arange(400.0), "500 samples of pv"),
        (np.arange(30.0), np.arange(30.0), "at least 64 samples"),
        (np.append(np.arange(499.0), np.nan), np.arange(500.0), "finite"),
    ],
)
def test_what_cannot_be_judged_is_refused(op, pv, said):
    with pytest.raises(lm.DataError, match=said):
        waveform_index(op, pv)
