"""All that is remembered, and the parameters that solve it."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.linear import is_stable
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.recursive_ml import state as ml
from lostmotion.kernels.recursive_ml.bounds import RADIUS, calm, constrain, step_to
from lostmotion.kernels.recursive_ml.equations import factor, invert, solve

SURE = 1e9  # times the information about an offset that is known to be zero


@njit(nogil=True)
def total_information(state: FloatArray, layout: IntArray) -> None:
    """Sum reference and ring into TOTAL; its factor into ROOT and its inverse into INVERSE."""
    n = layout[ml.N]
    h, r = ml.matrix(state, layout, ml.TOTAL_H), ml.vector(state, layout, ml.TOTAL_R)
    flat = h.reshape(n * n)  # one loop over all entries: it is vectorised
    flat[:] = state[layout[ml.REF_H] : layout[ml.REF_H] + n * n]
    r[:] = ml.vector(state, layout, ml.REF_R)
    for slot in range(layout[ml.RING]):
        at = ml.information_at(layout, slot)
        for i in range(n * n):
            flat[i] += state[at + i]
        at = ml.right_hand_at(layout, slot)
        for i in range(n):
            r[i] += state[at + i]
    offset = ml.eta_at(layout) - 1
    offset_information = h[offset, offset]
    if state[ml.ZERO] > 0.0:  # known to be zero: solved and linearised there
        h[offset, offset] += SURE * offset_information
    root = ml.matrix(state, layout, ml.ROOT)
    factor(h, root)
    h[offset, offset] = offset_information
    invert(root, ml.matrix(state, layout, ml.INVERSE))


@njit(nogil=True)
def newton_step(state: FloatArray, layout: IntArray) -> None:
    """Move theta to the solution of all that is remembered, and `shown` to the same without a needless offset."""
    n, eta = layout[ml.N], ml.eta_at(layout)
    total_information(state, layout)
    root, h = ml.matrix(state, layout, ml.ROOT), ml.matrix(state, layout, ml.TOTAL_H)
    theta = ml.vector(state, layout, ml.THETA)
    move = ml.vector(state, layout, ml.TOTAL_R).copy()
    for i in range(n):
        value = move[i]
        for j in range(n):
            value -= h[i, j] * theta[j]
        move[i] = value
    if state[ml.ZERO] > 0.0:
        move[eta - 1] -= SURE * h[eta - 1, eta - 1] * theta[eta - 1]
    solve(root, move)
    wanted = theta + move
    constrain(wanted, root, eta, state[ml.LOW], state[ml.HIGH], state[ml.RATIO_LIMIT])
    calm(wanted[n - layout[ml.P] :], RADIUS)
    step_to(theta, wanted, layout[ml.NA], RADIUS)
    show(state, layout)


@njit(nogil=True)
def show(state: FloatArray, layout: IntArray) -> None:
    """Fill `shown`: theta, with the offset pinned to zero where it explains nothing (BIC) or must not be there.

    ZERO: nan free, 0 decide, 1 always zero. Zero inside the dead zone is asked for, as in the batch.
    """
    eta = ml.eta_at(layout)
    offset = eta - 1
    theta, shown = ml.vector(state, layout, ml.THETA), ml.vector(state, layout, ml.SHOWN)
    shown[:] = theta
    if not pinned(state, layout):
        return
    column = ml.matrix(state, layout, ml.INVERSE)[offset]
    for i in range(shown.size):
        shown[i] -= column[i] * (theta[offset] / column[offset])
    shown[offset] = 0.0
    for i in range(eta, eta + 2):
        shown[i] = min(max(shown[i], state[ml.LOW]), state[ml.HIGH])
    if shown[eta] > shown[eta + 1]:
        shown[eta : eta + 2] = 0.5 * (shown[eta] + shown[eta + 1])
    shown[eta + 2] = min(max(shown[eta + 2], -state[ml.RATIO_LIMIT]), state[ml.RATIO_LIMIT])
    if not is_stable(shown[: layout[ml.NA]], RADIUS):
        shown[:] = theta


@njit(nogil=True, forceinline=True)
def pinned(state: FloatArray, layout: IntArray) -> bool:
    """Whether the offset counts as zero now."""
    if np.isnan(state[ml.ZERO]):
        return False
    if state[ml.ZERO] > 0.0:
        return True
    eta = ml.eta_at(layout)
    theta = ml.vector(state, layout, ml.THETA)
    if not theta[eta] <= 0.0 <= theta[eta + 1]:
        return False
    spread = ml.variance(state) * ml.matrix(state, layout, ml.INVERSE)[eta - 1, eta - 1]
    return bool(theta[eta - 1] * theta[eta - 1] < np.log(max(state[ml.WEIGHT], 2.0)) * spread)
