"""Random loops of known fault: they can be repeated, and are what they say."""

import numpy as np
import pytest

from lostmotion.evaluate.random_faults import CAUSES, FAULTS, PROCESSES, random_faulty_loop


@pytest.mark.parametrize("cause", CAUSES)
@pytest.mark.parametrize("process", PROCESSES)
def test_every_loop(cause, process):
    loop = random_faulty_loop(5, samples=300, cause=cause, process=process)
    again = random_faulty_loop(5, samples=300, cause=cause, process=process)
    for name in ("op", "pv", "sp"):
        signal = getattr(loop, name)
        assert signal.shape == (300,)
        assert np.isfinite(signal).all()
        assert np.array_equal(signal, getattr(again, name))
    assert loop.actuator.kind == (cause if cause in FAULTS else "none")
    assert (loop.width > 0) is (cause in ("dead zone", "backlash", "stiction"))
    assert 0.0 <= loop.op.min() <= loop.op.max() <= 100.0
    assert not (loop.visible and cause in ("none", "tuning", "disturbance"))


def test_causes_and_processes_are_drawn():
    loops = [random_faulty_loop(seed, samples=60) for seed in range(60)]
    assert {loop.cause for loop in loops} == set(CAUSES)
    assert {loop.process for loop in loops} == set(PROCESSES)
