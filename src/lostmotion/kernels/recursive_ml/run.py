"""Samples, blocks and the ring: what is taken in, summed, stored, solved and tested."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.recursive_ml import state as ml
from lostmotion.kernels.recursive_ml.advance import advance, noise_at, settling
from lostmotion.kernels.recursive_ml.change import find_change
from lostmotion.kernels.recursive_ml.drift import leave
from lostmotion.kernels.recursive_ml.equations import gather, influence, informed_sides, merge
from lostmotion.kernels.recursive_ml.follow import follow
from lostmotion.kernels.recursive_ml.information import newton_step, total_information
from lostmotion.kernels.recursive_ml.watch import believable, news, stuck, watch_command, watch_error

NOTHING, ALARMED, REFIT = range(3)  # why `run` came back
UNKNOWN = -1  # in place of the samples to wait: the command is not known yet
ENOUGH = 4  # blocks of an alarm that are fitted again at least
HOLD = 2  # missing commands between two equal ones that count as these, without waiting for the process to settle


@njit(nogil=True)
def close_block(state: FloatArray, layout: IntArray) -> int:
    """Put the block into the ring, the oldest one into the reference; solve; look for a change."""
    store_block(state, layout)
    layout[ml.FILLED] = 0
    layout[ml.BLOCKS] += 1
    ring = layout[ml.RING]
    if layout[ml.EXPLAIN_AT] > 0:  # under suspicion: the estimate waits until there is enough to explain
        layout[ml.WINDOW] = min(layout[ml.WINDOW] + 1, ring)
        if layout[ml.BLOCKS] < layout[ml.EXPLAIN_AT]:
            return NOTHING
        layout[ml.EXPLAIN_AT] = 0
        total_information(state, layout)
        return ALARMED
    newton_step(state, layout)
    follow(state, layout)
    if layout[ml.COUNT] - layout[ml.SINCE] >= layout[ml.TEST_AFTER] and find_change(state, layout):
        layout[ml.EXPLAIN_AT] = layout[ml.BLOCKS] + max(min(ENOUGH, ring) - layout[ml.WINDOW], 0)
        if layout[ml.EXPLAIN_AT] == layout[ml.BLOCKS]:
            layout[ml.EXPLAIN_AT] = 0
            return ALARMED
        return NOTHING
    return REFIT if layout[ml.COUNT] >= layout[ml.REFIT_AT] else NOTHING


@njit(nogil=True)
def store_block(state: FloatArray, layout: IntArray) -> None:
    """Put the sums of the block into its slot and the period, what stood there into the reference; begin anew."""
    n, ring = layout[ml.N], layout[ml.RING]
    slot = layout[ml.BLOCKS] % ring
    at = ml.information_at(layout, slot)
    kept_h = state[at : at + n * n].reshape(n, n)
    at = ml.right_hand_at(layout, slot)
    kept_r = state[at : at + n]
    if layout[ml.BLOCKS] >= ring:
        ref_h, ref_r = ml.matrix(state, layout, ml.REF_H), ml.vector(state, layout, ml.REF_R)
        merge(ref_h, ref_r, kept_h, kept_r, state[ml.TAIL])
        leave(kept_h, kept_r, state, layout)
    h, g = ml.matrix(state, layout, ml.SUM_H), ml.vector(state, layout, ml.SUM_G)
    theta = ml.vector(state, layout, ml.THETA)
    for i in range(n):
        value = g[i]
        for j in range(n):
            value += h[i, j] * theta[j]
        g[i] = value
    kept_r[:] = g
    period_r = ml.vector(state, layout, ml.PERIOD_R)
    period_r += g
    flat, kept_flat = h.reshape(n * n), kept_h.reshape(n * n)  # one loop over all entries: it is vectorised
    period_h = ml.matrix(state, layout, ml.PERIOD_H).reshape(n * n)
    kept_flat[:] = flat
    period_h += flat
    reach = state[ml.HIGH] - state[ml.LOW]
    work = ml.matrix(state, layout, ml.WORK)
    left, right = informed_sides(h, ml.variance(state), ml.eta_at(layout), reach, work)
    if left:
        layout[ml.LEFT_AT] = layout[ml.COUNT]
    if right:
        layout[ml.RIGHT_AT] = layout[ml.COUNT]
    flat[:] = 0.0
    g[:] = 0.0


@njit(nogil=True)
def bridge(state: FloatArray, layout: IntArray) -> float:
    """Command in place of a missing one: that which held; after some in a row it is not known any more."""
    layout[ml.MISSING] += 1
    layout[ml.LOST] += 1
    if layout[ml.LOST] > HOLD:
        layout[ml.SETTLE] = UNKNOWN
    return float(state[ml.HELD])


@njit(nogil=True)
def settle(u: float, used: bool, state: FloatArray, layout: IntArray, theta: FloatArray) -> float:
    """Command that goes through the filters after a gap, where masked, or while what came before is not settled."""
    if layout[ml.LOST] > 0 and u != state[ml.HELD]:  # it has moved in the gap, at an unknown sample
        layout[ml.SETTLE] = UNKNOWN
    layout[ml.LOST] = 0
    if not used:
        layout[ml.SETTLE] = UNKNOWN
        layout[ml.MASKED] += 1
        layout[ml.WAIT] = layout[ml.P] + 1
        # whatever it is, the filters forget it in the time to settle
        return float(min(max(u, state[ml.LOW]), state[ml.HIGH]))
    if layout[ml.SETTLE] == UNKNOWN:
        layout[ml.SETTLE] = settling(theta, layout[ml.NA], layout[ml.NB1], layout[ml.DELAY])
    elif layout[ml.SETTLE] > 0:
        layout[ml.SETTLE] -= 1
    return u


@njit(nogil=True)
def take(
    u: float,
    y: float,
    used: bool,
    state: FloatArray,
    layout: IntArray,
    theta: FloatArray,
    filters: FloatArray,
    h: FloatArray,
    g: FloatArray,
    psi: FloatArray,
) -> float:
    """One sample: bridge or mask what is missing or stuck, filter, add to the block. Its error, NaN without y."""
    na, nb1, delay, p = layout[ml.NA], layout[ml.NB1], layout[ml.DELAY], layout[ml.P]
    if stuck(y, state, layout[ml.REPEATS]):
        y = np.nan
    if np.isnan(u) or (used and not believable(u, state, layout)):
        used = False
        u = bridge(state, layout)
    else:
        watch_command(u, state, layout)
        if not used or layout[ml.LOST] > 0 or layout[ml.SETTLE] != 0:
            u = settle(u, used, state, layout, theta)
        state[ml.HELD] = u
    slot = layout[ml.BLOCKS] % layout[ml.RING]
    if layout[ml.FILLED] == 0:
        ml.filters_of(state, layout, slot)[:] = filters
        state[layout[ml.RING_S] + 2 * slot] = state[ml.SQUARES]
        state[layout[ml.RING_S] + 2 * slot + 1] = state[ml.WEIGHT]
    error = advance(u, y, theta, filters, na, nb1, delay, p, psi)
    if np.isnan(y):
        layout[ml.MISSING] += 1
        layout[ml.WAIT] = p
        used = False
    elif layout[ml.WAIT] > 0:
        layout[ml.WAIT] -= 1
        used = False
    used = used and layout[ml.SETTLE] == 0
    told = news(state, layout[ml.REPEATS]) if used else 0.0
    if used:
        state[ml.LOW], state[ml.HIGH] = min(state[ml.LOW], u), max(state[ml.HIGH], u)
        deviation = np.sqrt(ml.variance(state))
        limit = state[ml.CLIP] * deviation
        weight = influence(error, limit)
        watch_error(error, deviation, True, state, layout)
        gather(psi, error, told * weight, h, g)
        state[ml.SQUARES] = state[ml.KEEP] * state[ml.SQUARES] + told * min(error * error, limit * limit)
        state[ml.WEIGHT] = state[ml.KEEP] * state[ml.WEIGHT] + told
        if weight < 1.0:
            layout[ml.CLIPPED] += 1
            if p > 0:
                filters[noise_at(na, nb1, delay)] -= (1.0 - weight) * error
    else:
        watch_error(0.0, 1.0, False, state, layout)
    at = slot * layout[ml.BLOCK] + layout[ml.FILLED]
    state[layout[ml.U] + at] = u
    state[layout[ml.Y] + at] = y
    state[layout[ml.USED] + at] = told
    layout[ml.FILLED] += 1
    layout[ml.COUNT] += 1
    return error


@njit(nogil=True)
def run(
    u: FloatArray,
    y: FloatArray,
    used: npt.NDArray[np.bool_],
    begin: int,
    state: FloatArray,
    layout: IntArray,
    errors: FloatArray,
    every: int,
    trace: FloatArray,
) -> tuple[int, int]:
    """Samples from `begin` on, until the end or until a block closes with a reason to come back.

    Fills `errors` (n,) and, after every `every`-th sample counted from 0, a row of `trace` with `shown`. Returns
    the next sample and the reason.
    """
    psi = np.zeros(layout[ml.N])
    theta, shown = ml.vector(state, layout, ml.THETA), ml.vector(state, layout, ml.SHOWN)
    filters = ml.filters_now(state, layout)
    h, g = ml.matrix(state, layout, ml.SUM_H), ml.vector(state, layout, ml.SUM_G)
    for k in range(begin, u.size):
        errors[k] = take(u[k], y[k], used[k], state, layout, theta, filters, h, g, psi)
        reason = NOTHING
        if layout[ml.FILLED] == layout[ml.BLOCK]:
            reason = close_block(state, layout)
        if (k + 1) % every == 0:
            row = (k + 1) // every - 1
            if row < trace.shape[0]:
                trace[row] = shown
        if reason != NOTHING:
            return k + 1, reason
    return u.size, NOTHING


@njit(nogil=True)
def one(u: float, y: float, used: bool, state: FloatArray, layout: IntArray, psi: FloatArray) -> tuple[float, int]:
    """One sample from Python: error and reason to look closer."""
    theta, filters = ml.vector(state, layout, ml.THETA), ml.filters_now(state, layout)
    h, g = ml.matrix(state, layout, ml.SUM_H), ml.vector(state, layout, ml.SUM_G)
    error = take(u, y, used, state, layout, theta, filters, h, g, psi)
    return error, close_block(state, layout) if layout[ml.FILLED] == layout[ml.BLOCK] else NOTHING
