"""A loop with a compensating block in it that can be stopped, changed and continued."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, Reals
from lostmotion.kernels import actuator
from lostmotion.kernels.blocks import core
from lostmotion.kernels.blocks.run import step
from lostmotion.kernels.loop import pi_step
from lostmotion.kernels.numba_cache import njit

CONTROL, COMMAND, CLEAN, MEASURED = range(4)  # rows of the signals of a loop


@njit()
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
    inputs, outputs = np.zeros(core.INPUTS), np.zeros(core.OUTPUTS)
    inputs[core.ENABLE] = 1.0 if enable else 0.0
    inputs[core.GOOD] = 1.0
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
        inputs[core.OP_IN] = out
        step(kind, p, s, inputs, outputs)
        if out > outputs[core.BACK]:
            carry[0] = min(carry[0], integral)
        elif out < outputs[core.BACK]:
            carry[0] = max(carry[0], integral)
        signals[COMMAND, k] = outputs[core.OP_OUT]
        x[before + k] = actuator.step(valve, parameters, valve_state, signals[COMMAND, k])
