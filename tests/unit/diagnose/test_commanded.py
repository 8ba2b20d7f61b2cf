"""A swing that SP commands: the form of the wave is the command's, and no evidence about this valve."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.diagnose.evidence_words import NOT_COUNTED, OF_THE_WAVE
from lostmotion.diagnose.features import measure
from lostmotion.models.identity import Identity

pytestmark = pytest.mark.statistics
PERIOD = 80
FLOW = lm.LinearModel([-0.8], [0.2], 1)


def triangle(n):
    """The output of a master whose own valve sticks."""
    return 4.0 * (2.0 * np.abs(2.0 * (np.arange(n) / PERIOD % 1.0) - 1.0) - 1.0)


def square(n):
    return np.where(np.arange(n) // (PERIOD // 2) % 2, 4.0, -4.0)


def inner_loop(valve, command, seed, n=1600):
    """Fast flow loop that follows a swinging set point."""
    sp = command(n)
    made = lm.simulate_loop(lm.Hammerstein(valve, FLOW), lm.PI(0.8, 0.3), sp, noise=0.05, seed=seed)
    return lm.LoopRecord(50 + made.control, 50 + made.measured, 50 + sp, dt=1.0, op_span=(0.0, 100.0))


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("command", [triangle, square])
def test_a_sound_valve_that_follows_is_not_accused_for_the_form_of_the_command(command, seed):
    found = lm.diagnose(inner_loop(Identity(), command, seed))
    assert found.measured.commanded
    assert found.verdict not in ("stiction", "backlash", "dead zone", "saturation")
    told = {item.name: item for item in found.evidence if item.name in OF_THE_WAVE}
    assert told
    assert all(item.weight == 0.0 and item.meaning == NOT_COUNTED for item in told.values())
    assert found.measured.indices["shape_pv"] > 0.0  # measured and shown all the same


@pytest.mark.parametrize("command", [triangle, square])
def test_a_valve_that_sticks_is_found_by_what_it_foretells(command):
    found = lm.diagnose(inner_loop(lm.Stiction(1.5, 1.0), command, seed=1))
    assert found.verdict in ("stiction", "backlash")


def test_the_wave_counts_where_sp_is_not_known():
    found = lm.diagnose(inner_loop(Identity(), triangle, seed=1))
    assert found.measured.features.shape == 0.0
    assert measure(found.fit).features.shape > 0.0
