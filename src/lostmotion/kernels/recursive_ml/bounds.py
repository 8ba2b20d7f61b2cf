"""Parameters within their bounds: break points in order and in range, slope ratio, stable A and D."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels.linear import is_stable
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.recursive_ml.equations import solve

HALVINGS = 20  # of a step: a millionth of it is none
RADIUS = 1.0 - 1e-7  # of the poles: the batch fit's bound
CALMER, CALM_STEPS = 0.9, 80  # roots of D are drawn in to 0.9^80, 2e-4, of what they were, then D is given up


@njit(nogil=True)
def pin(theta: FloatArray, root: FloatArray, c: FloatArray, value: float) -> None:
    """Move theta to c' theta = value, at the least cost in likelihood; `c` is overwritten."""
    miss = -value
    for i in range(theta.size):
        miss += c[i] * theta[i]
    direction = c.copy()
    solve(root, c)
    along = 0.0
    for i in range(theta.size):
        along += direction[i] * c[i]
    if along > 0.0:
        for i in range(theta.size):
            theta[i] -= c[i] * (miss / along)


@njit(nogil=True)
def constrain(theta: FloatArray, root: FloatArray, eta: int, low: float, high: float, ratio: float) -> None:
    """Break points in order and inside the range seen, slope ratio within bounds; the others follow."""
    c = np.zeros(theta.size)
    if theta[eta] > theta[eta + 1]:
        c[eta], c[eta + 1] = 1.0, -1.0
        pin(theta, root, c, 0.0)
    for i in range(2):
        if not low <= theta[eta + i] <= high:
            c[:] = 0.0
            c[eta + i] = 1.0
            pin(theta, root, c, min(max(theta[eta + i], low), high))
    if abs(theta[eta + 2]) > ratio:
        c[:] = 0.0
        c[eta + 2] = 1.0
        pin(theta, root, c, ratio if theta[eta + 2] > 0.0 else -ratio)
    theta[eta] = min(max(theta[eta], low), high)  # two bounds at once
    theta[eta + 1] = min(max(theta[eta + 1], theta[eta]), high)


@njit(nogil=True)
def step_to(theta: FloatArray, wanted: FloatArray, na: int, radius: float) -> None:
    """Go from theta to `wanted`, or halves of the way while A would be unstable."""
    trial = wanted.copy()
    for _ in range(HALVINGS):
        if is_stable(trial[:na], radius):
            theta[:] = trial
            return
        for i in range(theta.size):
            trial[i] = 0.5 * (trial[i] + theta[i])


@njit(nogil=True)
def calm(d: FloatArray, radius: float) -> None:
    """Draw in the roots of an unstable noise model: 1/D bridges missing samples and outliers."""
    for _ in range(CALM_STEPS):
        if is_stable(d, radius):
            return
        power = 1.0
        for i in range(d.size):
            power *= CALMER
            d[i] *= power
    d[:] = 0.0
