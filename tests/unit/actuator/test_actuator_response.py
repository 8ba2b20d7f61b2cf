"""What a measured position shows: exact actuators first, then noise, laws, records that cannot tell, real ones."""

import json
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lostmotion as lm
from lostmotion.actuator import ActuatorStatus
from lostmotion.errors import ParameterError

N = 600
SINE = 50.0 + 10.0 * np.sin(np.arange(N) / 40.0)


def sticking(op, threshold, left=0.0):
    """Holds until OP is `threshold` away, then catches up to `left`."""
    x, found = op[0], []
    for u in op:
        if abs(u - x) > threshold:
            x = u - np.sign(u - x) * left
        found.append(x)
    return np.array(found)


def noisy(position, scale, seed=0):
    return position + np.random.default_rng(seed).normal(scale=scale, size=position.size)


@cache
def play():
    return lm.actuator_response(op=SINE, position=lm.Backlash(2.0)(SINE), dt=1.0)


@cache
def stick():
    return lm.actuator_response(op=SINE, position=sticking(SINE, 1.0), dt=1.0)


def test_a_play_is_found_exactly():
    found = play()
    assert found.kind == "backlash"
    assert found.dead_band == pytest.approx(2.0, abs=0.01)
    assert found.interval[0] < 2.0 < found.interval[1] < 2.2
    assert found.offset == pytest.approx(0.0, abs=0.01)
    assert found.status is ActuatorStatus.SEEN


def test_a_positioner_that_holds_and_catches_up():
    found = stick()
    assert found.kind == "stiction"
    assert found.dead_band == pytest.approx(2.0, rel=0.06)
    assert found.interval[0] < 2.0 < found.interval[1]
    assert found.up == pytest.approx(2.2, abs=0.3)  # OP goes by 0.25 a sample, so that it overshoots the threshold
    assert found.resolution == pytest.approx(1.1, abs=0.2)
    assert found.events > 10


def test_an_actuator_that_follows():
    found = lm.actuator_response(op=SINE, position=noisy(SINE, 0.05), dt=1.0)
    assert (found.kind, found.dead_band) in (("none", 0.0), ("cannot tell", np.nan))
    assert found.interval[0] == 0.0
    assert found.interval[1] < 1.5


def test_lag_and_play_with_noise():
    op = np.repeat(np.random.default_rng(1).uniform(40, 60, 60), 10)
    v = lm.LinearModel([-np.exp(-0.5)], [1 - np.exp(-0.5)]).simulate(op - op[0]) + op[0]
    found = lm.actuator_response(op=op, position=noisy(lm.Backlash(1.5)(v) - 0.4, 0.05), dt=1.0)
    assert found.kind == "backlash"
    assert found.interval[0] < 1.5 < found.interval[1]
    assert found.dead_band == pytest.approx(1.5, abs=0.05)
    assert found.offset == pytest.approx(0.4, abs=0.05)
    assert found.lag == pytest.approx(2.0, abs=0.4)


def test_rate_limit():
    op = np.repeat([20.0, 80.0, 30.0, 70.0, 20.0, 60.0], 100)
    position, x = [], op[0]
    for u in op:
        x += np.clip(u - x, -0.7, 0.7)
        position.append(x)
    found = lm.actuator_response(op=op, position=noisy(np.array(position), 0.02), dt=0.5)
    assert found.rate_limit == pytest.approx(1.4, rel=0.02)
    assert found.kind == "cannot tell"  # steps of 40 show no dead band of 1


def test_a_load_moves_the_position():
    op = np.repeat([0.0, 100.0, 0.0, -100.0, 0.0], 40)
    position = np.repeat([0.0, 100.0, 0.0, -100.0, 0.0], 40)
    position[90:100] += 8.0
    position[100:110] -= 8.0
    position[180:190] += 8.0
    position[185:190] += 1.0  # in ticks of 1
    position[110:118] += 1.0
    position[190:198] -= 8.0
    found = lm.actuator_response(op=op, position=np.round(position), dt=0.1)
    assert (found.kind, found.status) == ("backlash", ActuatorStatus.LOAD)
    assert found.dead_band == 17.0


@settings(max_examples=2, deadline=None)
@given(shift=st.floats(-30, 30), scale=st.sampled_from([0.01, 1.0, 40.0]))
def test_shift_and_scale_change_nothing(shift, scale):
    op = scale * (SINE + shift)
    position = scale * (lm.Backlash(2.0)(SINE) + shift)
    found = lm.actuator_response(op=op, position=position, dt=1.0, op_span=(scale * shift, scale * (100.0 + shift)))
    assert found.kind == play().kind
    assert found.dead_band == pytest.approx(scale * play().dead_band, rel=0.02)


@pytest.mark.parametrize(
    ("op", "position", "status"),
    [
        (np.full(100, 50.0), np.full(100, 50.0), ActuatorStatus.FLAT),
        (np.arange(20.0), np.arange(20.0), ActuatorStatus.SHORT),
        (SINE, np.full(N, np.nan), ActuatorStatus.SHORT),
    ],
)
def test_records_that_cannot_tell(op, position, status):
    found = lm.actuator_response(op=op, position=position, dt=1.0)
    assert found.kind == "cannot tell"
    assert found.status is status
    assert found.interval == (0.0, np.inf)
    assert found.message in found.summary().replace("\n  ", " ")


def test_forms_of_a_record():
    position = lm.Backlash(2.0)(SINE)
    columns = {"setpoint": SINE, "position": position}
    record = lm.LoopRecord(SINE, 3.0 * position, position=position, dt=1.0)
    assert lm.actuator_response(columns, dt=1.0).dead_band == play().dead_band
    assert lm.actuator_response(record).dead_band == play().dead_band
    with pytest.raises(ParameterError, match="op, position and dt"):
        lm.actuator_response(op=SINE)


def test_it_prints_and_writes_itself():
    found = stick()
    assert "STICTION: dead band" in found.summary()
    assert repr(found).startswith("ActuatorResponse(stiction ")
    written = json.loads(json.dumps(found.to_dict()))
    assert written["dead_band"] == found.dead_band
    assert written["rate_limit"] is None
    assert found.interval_percent == found.interval  # OP is in %
    assert len(found.plot().axes) == 2
