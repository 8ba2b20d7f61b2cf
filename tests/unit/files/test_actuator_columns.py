"""Tables of an actuator alone: command and position."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import ColumnError

ROWS = np.arange(50.0)


@pytest.mark.parametrize(
    ("command", "position"),
    [
        ("setpoint", "position"),
        ("command", "feedback"),
        ("target pos (5)", "pos (5)"),
        ("damperCommand", "damperFeedback"),
        ("Valve_Command", "Valve_Position"),
    ],
)
def test_position_stands_for_pv(command, position):
    record = lm.read_loop({"t_s": ROWS, command: ROWS + 1.0, position: ROWS, "torque": ROWS}, dt=1.0)
    assert record.op[0] == 1.0
    assert record.pv is not record.op
    np.testing.assert_array_equal(record.pv, record.position)
    assert record.sp is None
    assert any("stands for it" in note for note in record.notes)


def test_named_columns():
    columns = {"setpoint": ROWS + 1.0, "position": ROWS}
    for names in ({"op": "setpoint", "pv": "position"}, {"op": "setpoint", "position": "position"}):
        record = lm.read_loop(columns, dt=1.0, **names)
        np.testing.assert_array_equal(record.pv, record.position)


def test_several_actuators_are_asked_for():
    columns = {f"{name} ({number})": ROWS for number in (1, 2) for name in ("target pos", "pos")}
    with pytest.raises(ColumnError, match=r"command and position of one actuator"):
        lm.read_loop(columns, dt=1.0)
    record = lm.read_loop(columns, dt=1.0, op="target pos (2)", pv="pos (2)")
    assert record.position is not None


def test_a_loop_stays_a_loop():
    record = lm.read_loop({"OP": ROWS, "PV": ROWS + 1.0, "setpoint": ROWS + 2.0, "position": ROWS + 3.0}, dt=1.0)
    assert [one[0] for one in (record.op, record.pv, record.sp, record.position)] == [0.0, 1.0, 2.0, 3.0]
