"""What the standard errors of the recursive instrumental-variable estimate need, gathered along the run.

With lambda-weighted sums over samples (squared weights where squares are summed), the model's miss m = y - output,
the instrument z, A the present polynomial, and dx/dzone of the rebuilt inputs at the present zone:

    S = sum m^2 (A z)(A z)'      W = sum z (sum b_i dx(k-d-i)/dzone)'

They are averages, so that once many samples count (DENSE) one in STRIDE serves, STRIDE times as heavy. Its place
follows the golden ratio, which meets every phase of a periodic input alike; a fixed stride would not.
"""

from __future__ import annotations

import math

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.lanes import load, plus_product, spread, store, times
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.recursive_iv import state as iv

STRIDE = 8
GOLDEN = 0.6180339887498949
SHARPER = 4.0  # how much shorter than the estimate's own the memory for the present noise is


@njit(nogil=True, error_model="numpy", forceinline=True)
def filter_instrument(state: FloatArray, layout: IntArray) -> None:
    """A z into the work place."""
    na, pad, work, slot = layout[iv.NA], layout[iv.PAD], layout[iv.WORK], layout[iv.NOW_Z]
    for j in range(0, pad, 4):
        at = layout[iv.Z] + j
        value = load(state, at + slot * pad)
        for i in range(na):
            then = slot - 1 - i
            if then < 0:
                then += na + 1
            value = plus_product(value, spread(state[layout[iv.THETA] + i]), load(state, at + then * pad))
        store(state, work + j, value)


@njit(nogil=True, error_model="numpy", forceinline=True)
def add_rebuilt(state: FloatArray, layout: IntArray, decay: float, weight: float) -> None:
    """One sample of W: what the rebuilt x(k-d-i) would change by with the present zone."""
    size, key = layout[iv.PAST_U], layout[iv.THETA] + layout[iv.NA] + 4
    left, right = state[iv.ZONE], state[iv.ZONE + 1]
    slopes = layout[iv.SLOPES]
    store(state, slopes, spread(0.0))
    for i in range(layout[iv.NB]):
        then = layout[iv.NOW_U] - layout[iv.DELAY] - 1 - i
        if then < 0:
            then += size
        u, b = state[layout[iv.U] + then], state[key + i]
        if u < left:
            state[slopes] -= b * state[iv.ZONE + 2]
            state[slopes + 2] += b * (u - left)
        if u > right:
            state[slopes + 1] -= b * state[iv.ZONE + 3]
            state[slopes + 3] += b * (u - right)
    z, at = layout[iv.Z] + layout[iv.NOW_Z] * layout[iv.PAD], layout[iv.W]
    decays, moved = spread(decay), times(spread(weight), load(state, slopes))
    for i in range(layout[iv.N]):
        store(state, at, plus_product(times(decays, load(state, at)), spread(state[z + i]), moved))
        at += 4


@njit(nogil=True, error_model="numpy", forceinline=True)
def add_outer(state: FloatArray, layout: IntArray, decay: float, weight: float) -> None:
    """S = decay S + weight (A z)(A z)'."""
    pad, work, at = layout[iv.PAD], layout[iv.WORK], layout[iv.S]
    decays = spread(decay)
    for i in range(layout[iv.N]):
        factor = spread(weight * state[work + i])
        for j in range(0, pad, 4):
            store(state, at + j, plus_product(times(decays, load(state, at + j)), factor, load(state, work + j)))
        at += pad


@njit(nogil=True, error_model="numpy", forceinline=True)
def gather(state: FloatArray, layout: IntArray, kept: float, miss: float, error: float) -> None:
    """One sample, whose past weighs `kept` times as much as before."""
    square = miss * miss
    seen = kept * state[iv.SEEN] + 1.0
    state[iv.SEEN] = seen
    state[iv.SEEN_SQUARED] = kept * kept * state[iv.SEEN_SQUARED] + 1.0
    state[iv.SQUARES] = kept * kept * state[iv.SQUARES] + square
    share = min(1.0, SHARPER / seen)
    state[iv.PRESENT] += share * (square - state[iv.PRESENT])
    state[iv.EQUATION] += share * (error * error - state[iv.EQUATION])
    decay = kept * state[iv.SINCE]
    weight = 1.0
    if seen >= state[iv.DENSE]:
        turn = GOLDEN * layout[iv.COUNT]
        if turn - math.floor(turn) >= 1.0 / STRIDE:
            state[iv.SINCE] = decay
            return
        weight = float(STRIDE)
    filter_instrument(state, layout)
    add_rebuilt(state, layout, decay, weight)
    add_outer(state, layout, decay * decay, weight * square)
    state[iv.SINCE] = 1.0
