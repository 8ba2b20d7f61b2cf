"""What a position adds to a fit: it is seen without being asked, and outweighs a PV that shows no fault."""

from functools import cache

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import Status

N = 3000


@cache
def record(valve, noise, position=True):
    """A process behind a valve whose position is measured, or not."""
    generator = np.random.default_rng(5)
    op = 50.0 + 8.0 * np.sin(np.arange(N) / 15.0) + 4.0 * np.sin(np.arange(N) / 61.0)
    x, pv = op if valve is None else np.asarray(valve(op)), np.full(N, 50.0)
    for k in range(1, N):
        pv[k] = 0.95 * pv[k - 1] + 0.05 * x[k - 1]
    measured = x + generator.normal(scale=0.02, size=N)
    pv += generator.normal(scale=noise, size=N)
    return lm.LoopRecord(op, pv, dt=1.0, position=measured if position else None)


@cache
def fit(valve, noise, position=True):
    return lm.identify(record(valve, noise, position))


def test_a_play_that_pv_hides_is_seen_in_the_position():
    found = fit(lm.Backlash(1.0), 10.0)
    assert fit(lm.Backlash(1.0), 10.0, position=False).preferred in ("none", "cannot tell")
    assert (found.status, found.preferred) == (Status.OTHER_KIND, "backlash")
    assert found.actuator.interval[0] <= 1.0 <= found.actuator.interval[1]
    said = " ".join(str(found.summary()).split())
    assert "the measured position shows backlash (`fit.actuator`)" in said
    assert said.count("Seen directly in the position: backlash, dead band 1") == 1
    assert found.to_dict()["actuator"]["kind"] == "backlash"


def test_what_pv_names_stays_and_the_position_is_said_beside_it():
    found, without = fit(lm.Backlash(4.0), 0.05), fit(lm.Backlash(4.0), 0.05, position=False)
    assert (found.status, found.preferred) == (without.status, without.preferred)
    assert found.parameters == without.parameters
    assert found.actuator.dead_band == pytest.approx(found.parameters["width"], abs=0.3)


def test_a_fault_behind_the_position_is_said_to_lie_there():
    loose = record(lm.Backlash(4.0), 0.05)
    found = lm.identify(lm.LoopRecord(loose.op, loose.pv, dt=1.0, position=loose.op.copy()))
    assert found.preferred == "backlash"
    assert found.actuator.kind == "none"
    assert any("lies behind the position transmitter" in one for one in found.remarks)


def test_a_sound_valve_is_sound():
    found = fit(None, 0.2)
    assert found.preferred == "none"
    assert found.actuator.kind == "none"


def test_without_a_position_nothing_is_said():
    found = fit(lm.Backlash(4.0), 0.05, position=False)
    assert found.actuator is None
    assert "actuator" not in found.to_dict()
