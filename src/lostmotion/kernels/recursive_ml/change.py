"""Has something changed? A test on the ring, and the ring filtered again with other parameters."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.recursive_ml import state as ml
from lostmotion.kernels.recursive_ml.advance import advance, forget_zone, noise_at
from lostmotion.kernels.recursive_ml.equations import gather, influence

GAIN = 2  # direction that is tested after those of the break points, 0 and 1
CALIBRATED = 20.0  # blocks that the mean square 1 counts for at the start, which white errors give a statistic
LONGEST_MEAN = 500.0  # blocks that a mean square remembers
UNUSUAL = 9.0  # mean squares that a statistic adds to the mean at most: a change is not usual
NEWS = 1e-6  # share of a window's information that the total must leave: less is rounding


@njit(nogil=True)
def find_change(state: FloatArray, layout: IntArray) -> bool:
    """Efficient score test of a shift within the newest 1, 2, 4 .. blocks; keep the largest statistic.

    At the estimate from everything, the score s of a window is normal with covariance
    variance (H - H T^-1 H), H its information and T the total, if nothing has changed; a shift along c gives it
    the mean of that matrix times c. z = c's / sqrt(c' cov c) is the likelihood ratio against that shift. Where errors
    are not white, or the process is not of these orders, z varies more than it should without any change: it is
    divided by the root of its mean square, or of that of a shorter window, where that is above 1.
    """
    n, ring = layout[ml.N], layout[ml.RING]
    inverse, right_hand = ml.matrix(state, layout, ml.INVERSE), ml.vector(state, layout, ml.TOTAL_R)
    best = np.zeros(n)
    for i in range(n):
        for j in range(n):
            best[j] += inverse[i, j] * right_hand[i]
    h = ml.matrix(state, layout, ml.WORK)
    flat = h.reshape(n * n)  # one loop over all entries: it is vectorised
    flat[:] = 0.0
    r, c, along, score = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    deviation = np.sqrt(ml.variance(state))
    largest = 0.0
    wanted, window = 1, 0
    usual = np.ones(ml.DIRECTIONS)
    for back in range(min(ring, layout[ml.BLOCKS])):
        slot = (layout[ml.BLOCKS] - 1 - back) % ring
        at = ml.information_at(layout, slot)
        for i in range(n * n):
            flat[i] += state[at + i]
        at = ml.right_hand_at(layout, slot)
        for i in range(n):
            r[i] += state[at + i]
        if back + 1 != wanted:
            continue
        wanted *= 2
        for i in range(n):
            value = r[i]
            for j in range(n):
                value -= h[i, j] * best[j]
            score[i] = value
        for direction in range(ml.DIRECTIONS):
            point(c, direction, best, layout)
            statistic = shift_statistic(h, inverse, score, c, along, deviation)
            usual[direction] = max(usual[direction], mean_square(state, layout, window, direction, statistic))
            statistic /= np.sqrt(usual[direction])
            if abs(statistic) > abs(largest):
                largest = statistic
                layout[ml.WINDOW] = back + 1
        window += 1
    layout[ml.JUDGED] += 1
    state[ml.STATISTIC] = largest
    return bool(abs(largest) > state[ml.THRESHOLD])


@njit(nogil=True, forceinline=True)
def mean_square(state: FloatArray, layout: IntArray, window: int, direction: int, statistic: float) -> float:
    """Mean square of a statistic before this one, which then enters it."""
    at = layout[ml.USUAL] + window * ml.DIRECTIONS + direction
    blocks = min(float(layout[ml.JUDGED]), LONGEST_MEAN) + CALIBRATED
    before = 1.0 + state[at]
    state[at] += (min(statistic * statistic, UNUSUAL * before) - before) / (blocks + 1.0)
    return float(before)


@njit(nogil=True, forceinline=True)
def point(c: FloatArray, direction: int, theta: FloatArray, layout: IntArray) -> None:
    """Fill c with a shift of the left or right break point, or of the gain."""
    eta = ml.eta_at(layout)
    c[:] = 0.0
    if direction == GAIN:
        c[layout[ml.NA] : eta - 1] = theta[layout[ml.NA] : eta - 1]
    else:
        c[eta + direction] = 1.0


@njit(nogil=True, forceinline=True)
def shift_statistic(
    h: FloatArray, inverse: FloatArray, score: FloatArray, c: FloatArray, along: FloatArray, deviation: float
) -> float:
    """Normal statistic of a shift along c; 0 where the window tells nothing of it. `along` (n,) is room."""
    n = c.size
    spread, above = 0.0, 0.0
    for i in range(n):
        moved = 0.0
        for j in range(n):
            moved += h[i, j] * c[j]
        along[i] = moved
        spread += c[i] * moved
        above += c[i] * score[i]
    whole = spread
    for i in range(n):
        value = 0.0
        for j in range(n):
            value += inverse[i, j] * along[j]
        spread -= along[i] * value
    if spread > NEWS * whole and deviation > 0.0:
        return float(above / (deviation * np.sqrt(spread)))
    return 0.0


@njit(nogil=True)
def replay(
    old: FloatArray,
    theta: FloatArray,
    onset: int,
    blind: int,
    limit: float,
    state: FloatArray,
    layout: IntArray,
    blocks: int,
    h: FloatArray,
    r: FloatArray,
    errors: FloatArray,
    snapshots: FloatArray,
) -> float:
    """Filter the newest `blocks` whole blocks again, with `old` up to sample `onset`, then with `theta`.

    Fills h (blocks, n, n), r (blocks, n), errors (blocks * block; NaN where not used) and `snapshots` of the filters
    before each block and at the end (blocks + 1, filters);
    the information is that from `onset` on. Returns the cost, errors beyond `limit` counting as Huber has it. The
    first `blind` samples from `onset` on, in which the filters do not know how the change came about, add neither.
    """
    ring, block = layout[ml.RING], layout[ml.BLOCK]
    na, nb1, delay, p = layout[ml.NA], layout[ml.NB1], layout[ml.DELAY], layout[ml.P]
    oldest = (layout[ml.BLOCKS] - blocks) % ring
    filters = ml.filters_of(state, layout, oldest).copy()
    psi = np.zeros(layout[ml.N])
    cost = 0.0
    for i in range(blocks):
        slot = (oldest + i) % ring
        snapshots[i] = filters
        h[i] = 0.0
        r[i] = 0.0
        for j in range(block):
            k, at = slot * block + j, i * block + j
            if at == onset:
                forget_zone(filters, na, nb1, delay, p)
            now = theta if at >= onset else old
            error = advance(state[layout[ml.U] + k], state[layout[ml.Y] + k], now, filters, na, nb1, delay, p, psi)
            errors[at] = np.nan
            if state[layout[ml.USED] + k] > 0.0:
                errors[at] = error
                weight = influence(error, limit)
                if weight < 1.0 and p > 0:
                    filters[noise_at(na, nb1, delay)] -= (1.0 - weight) * error
                if onset <= at < onset + blind:
                    continue
                told = state[layout[ml.USED] + k]
                if at >= onset:
                    gather(psi, error, told * weight, h[i], r[i])
                cost += told * (error * error if weight == 1.0 else limit * (2.0 * abs(error) - limit))
        r[i] += np.dot(h[i], theta)
    snapshots[blocks] = filters
    return cost
