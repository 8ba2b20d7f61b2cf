"""Bounds of settings: what the schema refuses the exported code refuses as well, in every dialect."""

import numpy as np
import pytest

from lostmotion.errors import ParameterError
from lostmotion.export import TARGETS
from lostmotion.export.dialects import restore
from lostmotion.export.reader import Program
from tests.support.exports import KINDS, REALS, block, source

COLUMNS = ("op_in", "enable", "good", "track", "track_value")
SCANS = np.array([[50.0 + 0.5 * k, 1.0, 1.0, 0.0, 0.0] for k in range(5)])
WANTED = ("op_out", "offset", "error")


def outside(variable):
    """Values beyond the bounds of a setting, either sign where it has one."""
    if variable.kind == "int":
        return [2e9]
    most = 2.125 if variable.name == "FACTOR" else 2e9
    return [most, 2e-13, 1e-30, -2e9, -2e-13]


@pytest.mark.parametrize("to", [name for name in TARGETS if name != "c"])
@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_size_out_of_bounds_is_an_error_and_op_passes_through(kind, real, to):
    made = source(kind, real)
    program = Program(restore(TARGETS[to].files(made)))
    good = made.values
    for variable in made.specification.section("parameter"):
        name = variable.name.lower()
        for value in [] if variable.kind == "bool" else outside(variable):
            with pytest.raises(ParameterError):
                block(kind, **{name: value})
            program.reset()
            found = program.run({**good, name: value}, COLUMNS, SCANS, WANTED)
            error = found[0, 2]
            assert error in (1.0, 2.0, 3.0), (name, value)
            assert (found[:, 1] == 0.0).all()
            if error == 1.0:  # without clamps the safe output, where that is one
                safe = value if name == "safe" else good["safe"]
                assert found[:, 0] == pytest.approx(safe if abs(safe) <= 1e9 else 0.0)
            else:
                assert (found[:, 0] == SCANS[:, 0]).all()


@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize(
    ("kind", "name", "value"),
    [
        ("dead zone", "zone", 1e-12),
        ("dead zone", "right_slope", 1e9),
        ("dead zone", "left_slope", 1e-12),
        ("backlash", "lead_up", 1e9),
        ("stiction knocker", "amplitude", 1e-12),
        ("stiction two moves", "stand", -1e-12),
        ("backlash", "factor", 2.0),
        ("backlash", "high", 1e9),
        ("backlash", "low", -1e9),
        ("backlash", "count_limit", 1e9),
    ],
)
def test_the_bounds_themselves_are_usable(kind, real, name, value):
    assert block(kind, **{name: value}).settings[name] == value
    made = source(kind, real)
    program = Program(restore(TARGETS["st"].files(made)))
    found = program.run({**made.values, name: value}, COLUMNS, SCANS, WANTED)
    assert (found[:, 2] == 0.0).all()
