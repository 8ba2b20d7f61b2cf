"""Whether a controller moves OP, where OP rests most of the time."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identify.data import collect
from lostmotion.identify.likelihood.feedback import feedback, held_by_hand

N = 2000


def controlled(seed, *, dead_band=0.0, step=0.0):
    """PI with integral action that rests inside a dead band about SP, or whose output goes by whole steps."""
    random = np.random.default_rng(seed)
    op, pv = np.zeros(N), np.zeros(N)
    wanted = load = state = 0.0
    for k in range(N):
        load += 0.05 * random.standard_normal()
        state += 0.2 * (0.5 * op[k - 1] + load - state) if k else 0.0
        pv[k] = state + 0.03 * random.standard_normal()
        if abs(pv[k]) > dead_band:
            wanted -= 0.3 * (pv[k] - pv[k - 1]) + 0.1 * pv[k]
        op[k] = step * np.round(wanted / step) if step else wanted
    return lm.LoopRecord(50 + op, 50 + pv, np.full(N, 50.0), dt=1.0)


def by_hand(seed, hold, course):
    random = np.random.default_rng(seed)
    op = {
        "two levels": lm.signals.prs(N, -5, 5, hold=hold, seed=seed),
        "levels": np.repeat(random.uniform(-5.0, 5.0, N // hold), hold),
        "walk": np.repeat(np.cumsum(random.standard_normal(N // hold)), hold),
    }[course]
    pv = np.zeros(N)
    for k in range(1, N):
        pv[k] = 0.8 * pv[k - 1] + 0.2 * op[k - 1]
    return lm.LoopRecord(op, pv + 0.05 * random.standard_normal(N), dt=1.0)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("options", [{"dead_band": 0.3}, {"dead_band": 0.5}, {"step": 0.25}, {"step": 0.5}])
def test_a_controller_that_rests_is_a_controller(options, seed):
    data = collect(controlled(seed, **options), None, None)
    assert feedback(data).closed
    assert not held_by_hand(data)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("hold", [10, 40])
@pytest.mark.parametrize("course", ["two levels", "levels", "walk"])
def test_moves_by_hand_are_none(course, hold, seed):
    assert not feedback(collect(by_hand(seed, hold, course), None, None)).closed


@pytest.mark.parametrize("options", [{"dead_band": 0.5}, {"step": 0.5}])
def test_a_controller_that_rests_most_of_the_time_does_rest(options):
    """What these tests are about."""
    assert np.mean(np.diff(controlled(0, **options).op) == 0.0) > 0.5
