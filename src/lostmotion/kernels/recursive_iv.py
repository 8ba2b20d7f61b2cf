"""Recursive estimation with key-term separation (paper, eqs 16-26, 31): one kernel, several instruments.

Regressor (eq 23, na + nb + 4 entries, then the past residuals of extended least squares):

    phi = [-y(k-1) .. -y(k-na), Xr u(k-d), -Xr, Xl u(k-d), -Xl, x(k-d-1) .. x(k-d-nb), e(k-1) .. e(k-ne)]
    theta = [a1 .. a_na, b0 mr, b0 mr br, b0 ml, b0 ml bl, b1 .. b_nb, c1 .. c_ne]

The instrument z is phi itself (least squares), phi with y replaced by the model's output, or the printed eq 20.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.kernels.linear import is_stable
from lostmotion.kernels.types import FloatArray, IntArray

LEAST_SQUARES = 0
MODEL_OUTPUT = 1
PRINTED = 2
LARGEST_RATIO = 10.0
MOST_COVARIANCE = 1e9

# layout of `memory`: [y (na) | model y (na) | u (delay + nb + older) | x (nb) | residuals (ne)], newest first
# layout of `zone`: left, right, left slope, right slope
# layout of `tuning`: gain (nan: right slope 1), lambda, lambda0, samples of constant lambda, start samples


@njit(cache=True)
def push(memory: FloatArray, start: int, size: int, value: float) -> None:
    """Shift a newest-first stretch of `memory` and put `value` in front."""
    for i in range(size - 1, 0, -1):
        memory[start + i] = memory[start + i - 1]
    if size > 0:
        memory[start] = value


@njit(cache=True)
def separate(theta: FloatArray, na: int, nb: int, gain: float, zone: FloatArray) -> None:
    """Update `zone` from theta as printed: b0 by the known gain (eqs 25-26), then division."""
    b0 = theta[na]
    if not np.isnan(gain):
        b0 = gain
        for i in range(na):
            b0 += gain * theta[i]
        for i in range(nb):
            b0 -= theta[na + 4 + i]
    if b0 != 0.0 and theta[na] != 0.0 and theta[na + 2] != 0.0:
        zone[1], zone[3] = theta[na + 1] / theta[na], theta[na] / b0
        zone[0], zone[2] = theta[na + 3] / theta[na + 2], theta[na + 2] / b0


@njit(cache=True)
def separate_safely(theta: FloatArray, na: int, nb: int, gain: float, zone: FloatArray, span: FloatArray) -> None:
    """Update `zone` by a fixed-point form of eq 26 that never divides by the small b0.

    The x(k-d-i) were rebuilt with the slope m in `zone`, so gain mr (1 + sum a) = b0 mr + m sum b. At the fixed
    point mr = m it is eq 26. Values outside br >= 0 >= bl, the range of u seen (`span`) or slope ratios up to
    LARGEST_RATIO are not taken over.
    """
    total = 1.0
    for i in range(na):
        total += theta[i]
    later = 0.0
    for i in range(nb):
        later += theta[na + 4 + i]
    if total <= 0.0 or theta[na] == 0.0 or theta[na + 2] == 0.0:
        return
    slope = 1.0 if np.isnan(gain) else (theta[na] + zone[3] * later) / (gain * total)
    ratio = theta[na + 2] / theta[na]
    if not (slope > 0.0 and 1.0 / LARGEST_RATIO < ratio < LARGEST_RATIO):
        return
    zone[3], zone[2] = slope, slope * ratio
    right, left = theta[na + 1] / theta[na], theta[na + 3] / theta[na + 2]
    if 0.0 <= right < span[1]:
        zone[1] = right
    if span[0] < left <= 0.0:
        zone[0] = left


@njit(cache=True)
def fill_regressor(
    phi: FloatArray, z: FloatArray, memory: FloatArray, zone: FloatArray, orders: IntArray, kind: int
) -> float:
    """Write regressor and instrument; return u(k-d). Memory already holds u(k)."""
    na, nb, delay, ne, past_u = orders[0], orders[1], orders[2], orders[3], orders[4]
    at_u = 2 * na
    at_x = at_u + past_u
    u = memory[at_u + delay]
    over = 1.0 if u > zone[1] else 0.0
    under = 1.0 if u < zone[0] else 0.0
    for i in range(na):
        phi[i] = -memory[i]
    phi[na] = over * u
    phi[na + 1] = -over
    phi[na + 2] = under * u
    phi[na + 3] = -under
    for i in range(nb):
        phi[na + 4 + i] = memory[at_x + i]
    for i in range(ne):
        phi[na + 4 + nb + i] = memory[at_x + nb + i]
    for i in range(phi.size):
        z[i] = phi[i]
    if kind == MODEL_OUTPUT:
        for i in range(na):
            z[i] = -memory[na + i]
    elif kind == PRINTED:
        for i in range(na):
            z[i] = memory[na + i]
        for i in range(phi.size - na):
            z[na + i] = memory[at_u + delay + i]
    return float(u)


@njit(cache=True)
def update_gain(p: FloatArray, phi: FloatArray, z: FloatArray, lam: float, gain: FloatArray, row: FloatArray) -> bool:
    """Gain vector (eq 16) and P (eq 17) in place; False where the step is not well defined and nothing changed."""
    n = phi.size
    below = lam
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += p[i, j] * z[j]
        gain[i] = total
        below += phi[i] * total
    if not abs(below) > 1e-6 * lam:
        return False
    for i in range(n):
        gain[i] /= below
        row[i] = 0.0
    for i in range(n):
        weight = phi[i]
        for j in range(n):
            row[j] += weight * p[i, j]
    largest = 0.0
    for i in range(n):
        largest = max(largest, abs(p[i, i]))
    scale = 1.0 / lam if largest < MOST_COVARIANCE else 1.0  # without excitation nothing is forgotten any more
    for i in range(n):
        weight = gain[i]
        for j in range(n):
            p[i, j] = (p[i, j] - weight * row[j]) * scale
    return True


@njit(cache=True)
def gather_information(
    z: FloatArray,
    theta: FloatArray,
    zone: FloatArray,
    lam: float,
    delayed: float,
    miss: float,
    orders: IntArray,
    info: FloatArray,
) -> None:
    """Add one sample to what the standard errors need; `info` is (2 n + na + nb + 1, n + 2).

    Rows: S = sum (A z)(A z)' (n), W = sum z (sum b_i dx(k-d-i)/dzone)' (n), past z (na), past dx/dzone (nb), and
    [weight, squared output error].
    """
    na, nb, n = orders[0], orders[1], theta.size
    past = 2 * n
    for i in range(n):
        value = z[i]
        for j in range(na):
            value += theta[j] * info[past + j, i]
        info[2 * n + na + nb, i + 2] = value
    at = 2 * n + na + nb
    for i in range(n):
        weight = info[at, i + 2]
        for j in range(n):
            info[i, j] = lam * lam * info[i, j] + weight * info[at, j + 2]
    for c in range(4):
        slope = 0.0
        for i in range(nb):
            slope += theta[na + 4 + i] * info[past + na + i, c]
        for i in range(n):
            info[n + i, c] = lam * info[n + i, c] + z[i] * slope
    for j in range(na - 1, 0, -1):
        for i in range(n):
            info[past + j, i] = info[past + j - 1, i]
    if na > 0:
        for i in range(n):
            info[past, i] = z[i]
    first = past + na
    for j in range(nb - 1, 0, -1):
        for c in range(4):
            info[first + j, c] = info[first + j - 1, c]
    if nb > 0:
        over, under = delayed > zone[1], delayed < zone[0]
        info[first, 0] = -zone[2] if under else 0.0
        info[first, 1] = -zone[3] if over else 0.0
        info[first, 2] = delayed - zone[0] if under else 0.0
        info[first, 3] = delayed - zone[1] if over else 0.0
    info[at, 0] = lam * info[at, 0] + 1.0
    info[at, 1] = lam * info[at, 1] + miss * miss


@njit(cache=True)
def step(
    u: float,
    y: float,
    theta: FloatArray,
    p: FloatArray,
    memory: FloatArray,
    zone: FloatArray,
    held: FloatArray,
    tuning: FloatArray,
    span: FloatArray,
    orders: IntArray,
    scratch: FloatArray,
    info: FloatArray,
) -> float:
    """One sample; return the prediction error. All state is in the arrays.

    `held` (n) are the last parameters with a stable A: the model output is simulated with them. `orders` holds
    na, nb, delay, ne, past inputs, instrument, constrained (0/1), count. `scratch` (4, n); `info` as in
    :func:`gather_information`.
    """
    na, nb, delay, ne, past_u = orders[0], orders[1], orders[2], orders[3], orders[4]
    count = orders[7]
    phi, z, gain, row = scratch[0], scratch[1], scratch[2], scratch[3]
    push(memory, 2 * na, past_u, u)
    span[0], span[1] = min(span[0], u), max(span[1], u)
    kind = orders[5] if count >= tuning[4] else LEAST_SQUARES
    delayed = fill_regressor(phi, z, memory, zone, orders, kind)
    error = y
    for i in range(theta.size):
        error -= phi[i] * theta[i]
    if count >= delay and update_gain(p, phi, z, tuning[1], gain, row):
        for i in range(theta.size):
            theta[i] += gain[i] * error
        if orders[6] == 1:
            separate_safely(theta, na, nb, tuning[0], zone, span)
        else:
            separate(theta, na, nb, tuning[0], zone)
        if is_stable(theta[:na], 1.0):
            held[:] = theta
    output = 0.0
    for i in range(na):
        output -= held[i] * memory[na + i]
    for i in range(na, na + 4 + nb):
        output += held[i] * phi[i]
    residual = y
    for i in range(theta.size):
        residual -= phi[i] * theta[i]
    if count >= tuning[4]:
        gather_information(z, theta, zone, tuning[1], delayed, y - output, orders, info)
    at_x = 2 * na + past_u
    x = 0.0
    if delayed > zone[1]:
        x = zone[3] * (delayed - zone[1])
    elif delayed < zone[0]:
        x = zone[2] * (delayed - zone[0])
    push(memory, 0, na, y)
    push(memory, na, na, output)
    push(memory, at_x, nb, x)
    push(memory, at_x + nb, ne, residual)
    if count + 1 >= tuning[3]:
        tuning[1] = tuning[2] * tuning[1] + 1.0 - tuning[2]
    orders[7] = count + 1
    return error


@njit(cache=True)
def run(
    u: FloatArray,
    y: FloatArray,
    theta: FloatArray,
    p: FloatArray,
    memory: FloatArray,
    zone: FloatArray,
    held: FloatArray,
    tuning: FloatArray,
    span: FloatArray,
    orders: IntArray,
    scratch: FloatArray,
    info: FloatArray,
    every: int,
    trace: FloatArray,
) -> FloatArray:
    """All samples; every `every`-th leaves [theta, zone] in a row of `trace`. Return the prediction errors."""
    errors = np.empty(u.size)
    n = theta.size
    rows = 0
    for k in range(u.size):
        errors[k] = step(u[k], y[k], theta, p, memory, zone, held, tuning, span, orders, scratch, info)
        if (k + 1) % every == 0 and rows < trace.shape[0]:
            trace[rows, :n] = theta
            trace[rows, n:] = zone
            rows += 1
    return errors
