"""What one sample does to the parameters of the recursive instrumental-variable estimator (eqs 16, 17 and 24-26)."""

from __future__ import annotations

import math

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.lanes import load, plus_product, spread, store, times, total
from lostmotion.kernels.linear import inside_circle, three_inside_circle
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.recursive_iv import state as iv

LARGEST_RATIO = 10.0  # of the two slopes: beyond it an estimate is on its way, not there
MOST_COVARIANCE = 1e9  # a million times P0: nothing has excited this direction for long, and P would overflow
VANISHING = 1e-6  # of lambda: an instrument that is at right angles to the regressor defines no gain


@njit(nogil=True, error_model="numpy", forceinline=True)
def weigh(state: FloatArray, layout: IntArray, z: int, lam: float) -> float:
    """P z and phi' P into their places; return lambda + phi' P z."""
    n, pad = layout[iv.N], layout[iv.PAD]
    p, phi, step, row = layout[iv.P], layout[iv.PHI], layout[iv.STEP], layout[iv.ROW]
    below = lam
    for j in range(0, pad, iv.PANEL):
        z0, z1, z2 = load(state, z + j), load(state, z + j + 4), load(state, z + j + 8)
        sum0, sum1, sum2 = spread(0.0), spread(0.0), spread(0.0)
        at = p + j
        for i in range(n):
            weight = spread(state[phi + i])
            p0, p1, p2 = load(state, at), load(state, at + 4), load(state, at + 8)
            sum0 = plus_product(sum0, weight, p0)
            sum1 = plus_product(sum1, weight, p1)
            sum2 = plus_product(sum2, weight, p2)
            value = total(plus_product(plus_product(times(p0, z0), p1, z1), p2, z2))
            state[step + i] = value if j == 0 else value + state[step + i]
            at += pad
        store(state, row + j, sum0)
        store(state, row + j + 4, sum1)
        store(state, row + j + 8, sum2)
        below += total(plus_product(plus_product(times(sum0, z0), sum1, z1), sum2, z2))
    return below


@njit(nogil=True, error_model="numpy", forceinline=True)
def update_covariance(state: FloatArray, layout: IntArray, scale: float, factor: float) -> None:
    """P = scale P + factor (P z)(phi' P)."""
    n, pad = layout[iv.N], layout[iv.PAD]
    p, step, row = layout[iv.P], layout[iv.STEP], layout[iv.ROW]
    scales, factors = spread(scale), spread(factor)
    for j in range(0, pad, iv.PANEL):
        row0 = times(factors, load(state, row + j))
        row1 = times(factors, load(state, row + j + 4))
        row2 = times(factors, load(state, row + j + 8))
        at = p + j
        for i in range(n):
            weight = spread(state[step + i])
            store(state, at, plus_product(times(scales, load(state, at)), weight, row0))
            store(state, at + 4, plus_product(times(scales, load(state, at + 4)), weight, row1))
            store(state, at + 8, plus_product(times(scales, load(state, at + 8)), weight, row2))
            at += pad


@njit(nogil=True, error_model="numpy", forceinline=True)
def correct(state: FloatArray, layout: IntArray, z: int, error: float) -> float:
    """Gain (eq 16), P (eq 17) and theta; return what the past was weighed with, 0 where nothing was well defined."""
    lam, n, pad = state[iv.FORGETTING], layout[iv.N], layout[iv.PAD]
    below = weigh(state, layout, z, lam)
    if not abs(below) > VANISHING * lam:
        return 0.0
    largest = 0.0
    for i in range(n):
        largest = max(largest, abs(state[layout[iv.P] + i * pad + i]))
    kept = lam if largest < MOST_COVARIANCE else 1.0  # without excitation nothing is forgotten any more
    inverse = 1.0 / (below * kept)
    update_covariance(state, layout, below * inverse, -inverse)
    factor, theta, step = error * kept * inverse, layout[iv.THETA], layout[iv.STEP]
    for i in range(n):
        state[theta + i] = state[theta + i] + factor * state[step + i]
    return kept


@njit(nogil=True, error_model="numpy", forceinline=True)
def separate(state: FloatArray, layout: IntArray) -> None:
    """Update the zone from theta as printed: b0 by the known gain (eqs 25-26), then division."""
    theta, na, gain = layout[iv.THETA], layout[iv.NA], state[iv.KNOWN_GAIN]
    key = theta + na
    right, left = state[key], state[key + 2]
    b0 = right
    if not math.isnan(gain):
        b0 = gain
        for i in range(na):
            b0 += gain * state[theta + i]
        for i in range(layout[iv.NB]):
            b0 -= state[key + 4 + i]
    if b0 != 0.0 and right != 0.0 and left != 0.0:
        state[iv.ZONE] = state[key + 3] / left
        state[iv.ZONE + 1] = state[key + 1] / right
        state[iv.ZONE + 2] = left / b0
        state[iv.ZONE + 3] = right / b0


@njit(nogil=True, error_model="numpy", forceinline=True)
def separate_safely(state: FloatArray, layout: IntArray) -> None:
    """Update the zone by a fixed-point form of eq 26 that never divides by the small b0.

    The x(k-d-i) were rebuilt with the present slope m, so gain mr (1 + sum a) = b0 mr + m sum b. At the fixed point
    mr = m it is eq 26. Values outside br >= 0 >= bl, the range of u seen or slope ratios up to LARGEST_RATIO are not
    taken over.
    """
    theta, na, gain = layout[iv.THETA], layout[iv.NA], state[iv.KNOWN_GAIN]
    key = theta + na
    bottom, later = 1.0, 0.0
    for i in range(na):
        bottom += state[theta + i]
    for i in range(layout[iv.NB]):
        later += state[key + 4 + i]
    at_right, at_left = state[key], state[key + 2]
    if bottom <= 0.0 or at_right == 0.0 or at_left == 0.0:
        return
    slope = 1.0 if math.isnan(gain) else (at_right + state[iv.ZONE + 3] * later) / (gain * bottom)
    inverse = 1.0 / at_right
    ratio = at_left * inverse
    if not (slope > 0.0 and 1.0 / LARGEST_RATIO < ratio < LARGEST_RATIO):
        return
    state[iv.ZONE + 2] = slope * ratio
    state[iv.ZONE + 3] = slope
    right, left = state[key + 1] * inverse, state[key + 3] / at_left
    if 0.0 <= right < state[iv.HIGH]:
        state[iv.ZONE + 1] = right
    if state[iv.LOW] < left <= 0.0:
        state[iv.ZONE] = left


@njit(nogil=True, error_model="numpy", forceinline=True)
def hold_if_stable(state: FloatArray, layout: IntArray) -> None:
    """Take the parameters over for the model's output if A is stable."""
    na, theta, work, held = layout[iv.NA], layout[iv.THETA], layout[iv.WORK], layout[iv.HELD]
    if na <= 3:
        a1 = state[theta] if na > 0 else 0.0
        a2 = state[theta + 1] if na > 1 else 0.0
        stable = three_inside_circle(a1, a2, state[theta + 2] if na > 2 else 0.0)
    else:
        for i in range(na):
            state[work + i] = state[theta + i]
        stable = inside_circle(state, work, na)
    if stable:
        for i in range(0, layout[iv.PAD], 4):
            store(state, held + i, load(state, theta + i))
