"""A control loop in one pass: PI controller, inverse, actuator, linear process."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels import actuator, dead_zone
from lostmotion.kernels.numba_cache import njit


@njit()
def pi_step(error: float, integral: float, kp: float, ki_dt: float, low: float, high: float) -> tuple[float, float]:
    """Output of a parallel PI and its new integral; the integral stops where it would wind up."""
    advanced = integral + ki_dt * error
    output = kp * error + advanced
    if output > high:
        return high, min(advanced, integral) if error > 0.0 or ki_dt < 0.0 else advanced
    if output < low:
        return low, max(advanced, integral) if error < 0.0 or ki_dt < 0.0 else advanced
    return output, advanced


@njit()
def closed_loop(
    a: FloatArray,
    b: FloatArray,
    delay: int,
    offset: float,
    parameters: FloatArray,
    inverse: FloatArray,
    kind: int,
    has_inverse: bool,
    kp: float,
    ki_dt: float,
    low: float,
    high: float,
    bias: float,
    reference: FloatArray,
    output_disturbance: FloatArray,
    noise: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Simulate n samples; return controller output, command to the actuator, internal variable, y and measured y.

    `kind` and `parameters` are those of ``kernels.actuator``; an actuator with memory begins at rest at the bias.
    `inverse` holds left, right, left slope, right slope and the answer to zero of a dead-zone inverse.
    """
    n = reference.size
    control, command, clean, measured = np.empty((4, n))
    before = max(delay + b.size, a.size)  # zeros ahead of the first sample spare the recursion its conditions
    x, z = np.zeros((2, before + n))
    integral = bias
    state = actuator.init(bias)
    for k in range(n):
        value = 0.0
        newest = before + k - delay
        for i in range(b.size):
            value += b[i] * x[newest - i]
        newest = before + k - 1
        for i in range(a.size):
            value -= a[i] * z[newest - i]
        z[before + k] = value
        clean[k] = value + offset + output_disturbance[k]
        measured[k] = clean[k] + noise[k]
        control[k], integral = pi_step(reference[k] - measured[k], integral, kp, ki_dt, low, high)
        sent = control[k]
        if has_inverse:
            sent = dead_zone.inverse(sent, inverse[0], inverse[1], inverse[2], inverse[3], inverse[4])
        command[k] = sent
        x[before + k] = actuator.step(kind, parameters, state, sent)
    return control, command, x[before:].copy(), clean, measured
