"""The filters brought to parameters that have moved: what they hold is of those before."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.recursive_ml import state as ml
from lostmotion.kernels.recursive_ml.advance import noise_at, settling
from lostmotion.kernels.recursive_ml.equations import influence

FELT = 0.5  # deviations of the noise by which predictions would be wrong: what is less stays as it is
RESTS = 0.9  # share of samples in which OP stays: a few moves then tell all, and the parameters go in leaps


@njit(nogil=True, forceinline=True)
def push(past: FloatArray, value: float) -> None:
    """Put a value in front of those before it, newest first."""
    for j in range(past.size - 1, 0, -1):
        past[j] = past[j - 1]
    past[0] = value


@njit(nogil=True)
def believed(v: float, d: FloatArray, past_v: FloatArray, limit: float) -> float:
    """The v that goes on: what 1/D foretells where it is missing, without that of an outlier beyond `limit`."""
    likely = 0.0
    for j in range(d.size):
        likely -= d[j] * past_v[j]
    if np.isnan(v):
        return likely
    return v - (1.0 - influence(v - likely, limit)) * (v - likely)


@njit(nogil=True)
def felt(held: FloatArray, right: FloatArray, theta: FloatArray, na: int, nb1: int, samples: int) -> float:
    """Largest error of the predictions of the next samples with `held` in place of the `right` X (nx,)."""
    wrong = right - held
    largest = 0.0
    for _ in range(samples):
        z = 0.0
        for j in range(nb1):
            z += theta[na + j] * wrong[j]
        largest = max(largest, abs(z))
        x = 0.0
        for j in range(na):
            x -= theta[j] * wrong[j]
        push(wrong, x)
    return largest


@njit(nogil=True)
def zone_is_clear(state: FloatArray, layout: IntArray) -> bool:
    """Whether BIC prefers a dead zone: the place of one that is none wanders, and what is filtered with it too."""
    left = ml.eta_at(layout)
    theta, inverse = ml.vector(state, layout, ml.THETA), ml.matrix(state, layout, ml.INVERSE)
    width = theta[left + 1] - theta[left]
    spread = inverse[left, left] + inverse[left + 1, left + 1] - 2.0 * inverse[left, left + 1]
    return bool(width * width > np.log(max(state[ml.WEIGHT], 2.0)) * ml.variance(state) * spread)


@njit(nogil=True)
def rests(state: FloatArray, layout: IntArray, oldest: int, blocks: int) -> bool:
    """Whether OP stays as it is in most samples of so many blocks from the `oldest` on."""
    block, ring = layout[ml.BLOCK], layout[ml.RING]
    before, moves = np.nan, 0
    for i in range(blocks):
        first = layout[ml.U] + ((oldest + i) % ring) * block
        for k in range(first, first + block):
            moves += state[k] != before
            before = state[k]
    return bool(moves <= (1.0 - RESTS) * blocks * block)


@njit(nogil=True)
def follow(state: FloatArray, layout: IntArray) -> None:
    """Filter X and v of the newest samples again, with theta as it is now, as far back as they remember.

    Where that is further than the samples are stored nothing is done: what they begin with would be of the old theta.
    Nor is it where OP moves all the time: the parameters then go in small steps, and the filters keep up.

    Taken on as they are they would predict with the old theta for as long as the process remembers, and the equations
    of these samples, which are about the new one, would be wrong by the whole step. The gradients stay: their error is
    of second order.
    """
    na, nb1, delay, p = layout[ml.NA], layout[ml.NB1], layout[ml.DELAY], layout[ml.P]
    block, ring = layout[ml.BLOCK], layout[ml.RING]
    theta, filters = ml.vector(state, layout, ml.THETA), ml.filters_now(state, layout)
    blocks = (settling(theta, na, nb1, delay) + p + block - 1) // block
    known = min(ring, layout[ml.BLOCKS] - layout[ml.FROM_BLOCK])
    if not 1 <= blocks <= known or not zone_is_clear(state, layout):
        return
    oldest = (layout[ml.BLOCKS] - blocks) % ring
    if not rests(state, layout, oldest, blocks):
        return
    before = ml.filters_of(state, layout, oldest)
    nx, eta = max(na, nb1), na + nb1 + 1
    at_x, at_v = delay + 1, noise_at(na, nb1, delay)
    at_p = at_v + p + nb1 + na  # X once more, for what goes through D
    past_u, past_v = before[: delay + 1].copy(), before[at_v : at_v + p].copy()
    past_x = before[at_p : at_p + p].copy() if p > nx else before[at_x : at_x + nx].copy()
    limit = state[ml.CLIP] * np.sqrt(ml.variance(state))
    ratio = np.exp(theta[eta + 2])
    for i in range(blocks):
        first = ((oldest + i) % ring) * block
        for k in range(first, first + block):
            push(past_u, state[layout[ml.U] + k])
            x = max(past_u[delay] - theta[eta + 1], 0.0) + ratio * min(past_u[delay] - theta[eta], 0.0)
            for j in range(na):
                x -= theta[j] * past_x[j]
            push(past_x, x)
            if p > 0:
                v = state[layout[ml.Y] + k] - theta[na + nb1]
                for j in range(nb1):
                    v -= theta[na + j] * past_x[j]
                push(
                    past_v, believed(v, theta[eta + 3 :], past_v, limit if state[layout[ml.USED] + k] > 0.0 else np.inf)
                )
    if felt(filters[at_x : at_x + nx], past_x[:nx], theta, na, nb1, block) < FELT * np.sqrt(ml.variance(state)):
        return
    filters[at_x : at_x + nx] = past_x[:nx]
    filters[at_p : at_p + p] = past_x[:p]
    filters[at_v : at_v + p] = past_v
