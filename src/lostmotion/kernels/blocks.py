"""Any compensating block by number, and a loop with one in it that can be stopped, changed and continued."""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.arrays import FloatArray
from lostmotion.kernels import actuator, block, block_backlash, block_dead_zone, block_knocker, block_two_moves
from lostmotion.kernels.block import Reals
from lostmotion.kernels.loop import pi_step

DEAD_ZONE, BACKLASH, KNOCKER, TWO_MOVES = 1, 2, 3, 4
CONTROL, COMMAND, CLEAN, MEASURED = range(4)  # rows of the signals of a loop


@njit(cache=True)
def step(kind: int, p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """One scan of a block."""
    if kind == DEAD_ZONE:
        block_dead_zone.step(p, s, i, o)
    elif kind == BACKLASH:
        block_backlash.step(p, s, i, o)
    elif kind == KNOCKER:
        block_knocker.step(p, s, i, o)
    else:
        block_two_moves.step(p, s, i, o)


@njit(cache=True)
def loop_with_block(
    a: FloatArray,
    b: FloatArray,
    delay: int,
    offset: float,
    valve: int,
    parameters: FloatArray,
    valve_state: FloatArray,
    kind: int,
    p: Reals,
    s: Reals,
    enable: bool,
    kp: float,
    ki_dt: float,
    low: float,
    high: float,
    carry: FloatArray,
    reference: FloatArray,
    disturbance: FloatArray,
    noise: FloatArray,
    x: FloatArray,
    z: FloatArray,
    signals: FloatArray,
    start: int,
    stop: int,
) -> None:
    """Samples `start` to `stop` of a closed loop with a compensating block.

    `carry` (1,) holds the integral of the controller. `x` and `z` hold
    internal variable and process output behind ``max(delay + b.size, a.size)`` zeros. `signals` (4, n) is filled:
    CONTROL, COMMAND, CLEAN, MEASURED. Where the block cuts the command, the integral stops as it does at the
    controller's own limits: BACK tells the direction.
    """
    before = max(delay + b.size, a.size)
    inputs, outputs = np.zeros(block.INPUTS), np.zeros(block.OUTPUTS)
    inputs[block.ENABLE] = 1.0 if enable else 0.0
    inputs[block.GOOD] = 1.0
    for k in range(start, stop):
        value = 0.0
        newest = before + k - delay
        for i in range(b.size):
            value += b[i] * x[newest - i]
        newest = before + k - 1
        for i in range(a.size):
            value -= a[i] * z[newest - i]
        z[before + k] = value
        signals[CLEAN, k] = value + offset + disturbance[k]
        signals[MEASURED, k] = signals[CLEAN, k] + noise[k]
        integral = carry[0]
        out, carry[0] = pi_step(reference[k] - signals[MEASURED, k], integral, kp, ki_dt, low, high)
        signals[CONTROL, k] = out
        inputs[block.OP_IN] = out
        step(kind, p, s, inputs, outputs)
        if out > outputs[block.BACK]:
            carry[0] = min(carry[0], integral)
        elif out < outputs[block.BACK]:
            carry[0] = max(carry[0], integral)
        signals[COMMAND, k] = outputs[block.OP_OUT]
        x[before + k] = actuator.step(valve, parameters, valve_state, signals[COMMAND, k])
