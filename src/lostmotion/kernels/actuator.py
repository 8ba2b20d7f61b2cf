"""Any actuator by number, one sample at a time: what a loop and a replay need.

`parameters` (4,): dead zone left, right, left slope, right slope; backlash width; stiction band, jump; saturation low,
high. `state` is that of the stiction kernels; NaN in it stands for rest at the first command.
"""

from __future__ import annotations

from lostmotion.arrays import FloatArray
from lostmotion.kernels import backlash, dead_zone, saturation, stiction
from lostmotion.kernels.numba_cache import njit

NONE, DEAD_ZONE, BACKLASH, SATURATION, STICTION = 0, 1, 2, 3, 4  # stiction: plus the number of its model


@njit()
def init(start: float) -> FloatArray:
    """State of an actuator that rests at `start`; NaN: at the first command."""
    return stiction.init(start)


@njit()
def step(kind: int, parameters: FloatArray, state: FloatArray, u: float) -> float:
    """Internal variable after the command u; `state` is updated."""
    if kind == DEAD_ZONE:
        return float(dead_zone.forward(u, parameters[0], parameters[1], parameters[2], parameters[3]))
    if kind == BACKLASH:
        state[stiction.X] = backlash.step(u, parameters[0], state[stiction.X])
        return float(state[stiction.X])
    if kind == SATURATION:
        return float(saturation.forward(u, parameters[0], parameters[1]))
    if kind >= STICTION:
        return float(stiction.step(kind - STICTION, u, parameters[0], parameters[1], state))
    return u
