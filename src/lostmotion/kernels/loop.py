"""A control loop in one pass: PI controller, inverse, actuator, linear process."""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.kernels import dead_zone
from lostmotion.kernels.types import FloatArray


@njit(cache=True)
def pi_step(error: float, integral: float, kp: float, ki_dt: float, low: float, high: float) -> tuple[float, float]:
    """Output of a parallel PI and its new integral; the integral stops where it would wind up."""
    advanced = integral + ki_dt * error
    output = kp * error + advanced
    if output > high:
        return high, min(advanced, integral) if error > 0.0 or ki_dt < 0.0 else advanced
    if output < low:
        return low, max(advanced, integral) if error < 0.0 or ki_dt < 0.0 else advanced
    return output, advanced


@njit(cache=True)
def closed_loop(
    a: FloatArray,
    b: FloatArray,
    delay: int,
    offset: float,
    zone: FloatArray,
    inverse: FloatArray,
    has_zone: bool,
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

    `zone` and `inverse` hold left, right, left slope, right slope (and the answer to zero, for the inverse).
    """
    n = reference.size
    control, command, x, clean, measured = np.empty((5, n))
    z = np.empty(n)
    integral = bias
    for k in range(n):
        value = 0.0
        for i in range(b.size):
            j = k - delay - i
            if j >= 0:
                value += b[i] * x[j]
        for i in range(a.size):
            j = k - 1 - i
            if j >= 0:
                value -= a[i] * z[j]
        z[k] = value
        clean[k] = value + offset + output_disturbance[k]
        measured[k] = clean[k] + noise[k]
        control[k], integral = pi_step(reference[k] - measured[k], integral, kp, ki_dt, low, high)
        command[k] = control[k]
        if has_inverse:
            command[k] = dead_zone.inverse(control[k], inverse[0], inverse[1], inverse[2], inverse[3], inverse[4])
        x[k] = command[k]
        if has_zone:
            x[k] = dead_zone.forward(command[k], zone[0], zone[1], zone[2], zone[3])
    return control, command, x, clean, measured
