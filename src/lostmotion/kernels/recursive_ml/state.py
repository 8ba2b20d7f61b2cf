"""Where the recursive maximum-likelihood estimator keeps its state: one array of floats, one of whole numbers.

The order of the entries is that of the bytes that estimators were saved to: new entries go to the end.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.numba_cache import njit

# `layout`: sizes, offsets into `state`, counters
NA, NB1, DELAY, P, N, BLOCK, RING, FILTERS = range(8)
THETA, SHOWN, FILTER, REF_H, REF_R, SUM_H, SUM_G, RING_H, RING_R, RING_F, U, Y, USED = range(8, 21)
TOTAL_H, TOTAL_R, ROOT, PERIOD_H, PERIOD_R, WORK, SIZE = range(21, 28)
COUNT, FILLED, BLOCKS, SETTLE, WAIT, LOST, SINCE, LEFT_AT, RIGHT_AT, CLIPPED, MISSING, MASKED = range(28, 40)
PERIOD_FROM, WINDOW, REFIT_AT, TEST_AFTER, FROM_BLOCK, EXPLAIN_AT, RING_S, INVERSE, FIRST_SIZE = range(40, 49)
WATCH, EVIDENCE, BANK_H, BANK_R, GONE_H, GONE_R, ERRORS, PRODUCTS, USUAL = range(48, 57)
GROUPED, DRIFT, FAR, JUDGED, SECOND_SIZE = range(57, 62)
REPEATS, LAYOUT_SIZE = range(61, 63)

# head of `state`
TAIL, KEEP, CLIP, THRESHOLD, SQUARES, WEIGHT, LOW, HIGH, HELD, ZERO, RATIO_LIMIT, STATISTIC, HEAD = range(13)

# part `watch`
GAP, LAST_U, WATCHED, WATCHED_SQUARES, WAS, RATE, WATCH_SIZE = 0, 1, 2, 3, 4, 6, 8  # WAS, RATE: left and right

# part `repeats`
LAST_Y, REPEATED, SHARE, REPEATS_SIZE = range(4)  # last PV, how often it has come again, share of new ones that do

DRIFTS = 6  # hypotheses about how fast the break points move, see `drift`
LAGS = (1, 2, 3, 4, 6, 8, 12, 16)  # samples, at which the prediction errors are watched: any noise order shows in them
LONGEST_LAG = LAGS[-1]
WINDOWS, DIRECTIONS = 5, 3  # that are tested for changes: 1, 2, 4, 8, 16 blocks; left, right, gain

# sizes and offsets: those of the settings
NOT_MOVING = (*range(COUNT), RING_S, INVERSE, *range(WATCH, GROUPED), REPEATS)
NEVER = int(np.iinfo(np.int64).max)  # of REFIT_AT


class Places(NamedTuple):
    """All that the sizes depend on: orders, samples of a block, blocks of the ring."""

    na: int
    nb: int
    delay: int
    noise_order: int
    block: int
    ring: int


def lay_out(places: Places) -> tuple[FloatArray, IntArray]:
    """Zeroed state and its layout; looks back at nothing yet."""
    na, nb, delay, p, block, ring = places
    n, nx = na + nb + 5 + p, max(na, nb + 1)
    filters = delay + 1 + 4 * nx + na + p + nb + 1 + na + 5 * p
    layout = np.zeros(LAYOUT_SIZE, dtype=np.int64)
    layout[: FILTERS + 1] = na, nb + 1, delay, p, n, block, ring, filters
    at = int(HEAD)
    for _, entry, shape in parts(layout):
        layout[entry] = at
        at += int(np.prod(shape))
    layout[SIZE] = at
    layout[REFIT_AT] = NEVER
    state = np.zeros(at)
    state[layout[WATCH] + GAP], state[layout[WATCH] + LAST_U] = np.inf, np.nan
    state[layout[REPEATS] + LAST_Y], state[layout[REPEATS] + SHARE] = np.nan, 1.0  # not rare until they are counted
    return state, layout


def grown(state: FloatArray, layout: IntArray, places: Places) -> tuple[FloatArray, IntArray]:
    """State and layout of an earlier format with room for what has come since; ValueError where they are none."""
    new_state, new_layout = lay_out(places)
    first_new = {(FIRST_SIZE,): WATCH, (SECOND_SIZE,): REPEATS}.get(layout.shape)
    if first_new is None or state.shape != (new_layout[first_new],) or layout[SIZE] != state.size:
        raise ValueError("layout")
    new_state[: state.size] = state
    size = new_layout[SIZE]
    new_layout[: layout.size] = layout
    new_layout[SIZE] = size
    return new_state, new_layout


def parts(layout: IntArray) -> list[tuple[str, int, tuple[int, ...]]]:
    """Name, entry of `layout` and shape of every part, in the order in which they lie in `state`."""
    n, block, ring, filters = (int(layout[entry]) for entry in (N, BLOCK, RING, FILTERS))
    return [
        ("theta", THETA, (n,)),
        ("shown", SHOWN, (n,)),  # theta, with the offset pinned where it is zero
        ("filters", FILTER, (filters,)),
        ("ref_h", REF_H, (n, n)),
        ("ref_r", REF_R, (n,)),
        ("sum_h", SUM_H, (n, n)),  # open block; its right-hand side still a gradient
        ("sum_g", SUM_G, (n,)),
        ("ring_h", RING_H, (ring, n, n)),
        ("ring_r", RING_R, (ring, n)),
        ("ring_filters", RING_F, (ring, filters)),  # before each block
        ("ring_scale", RING_S, (ring, 2)),  # squares and weight before each block
        ("u", U, (ring, block)),
        ("y", Y, (ring, block)),
        ("used", USED, (ring, block)),
        ("total_h", TOTAL_H, (n, n)),
        ("total_r", TOTAL_R, (n,)),
        ("root", ROOT, (n, n)),
        ("inverse", INVERSE, (n, n)),
        ("period_h", PERIOD_H, (n, n)),
        ("period_r", PERIOD_R, (n,)),
        ("work", WORK, (n, n)),
        ("watch", WATCH, (WATCH_SIZE,)),
        ("evidence", EVIDENCE, (DRIFTS,)),  # log-likelihood of each hypothesis about drift
        ("bank_h", BANK_H, (DRIFTS, n, n)),  # reference under each
        ("bank_r", BANK_R, (DRIFTS, n)),
        ("gone_h", GONE_H, (n, n)),  # blocks that have left the ring since the hypotheses were compared
        ("gone_r", GONE_R, (n,)),
        ("errors", ERRORS, (LONGEST_LAG,)),  # last prediction errors over their deviation, newest first
        ("products", PRODUCTS, (len(LAGS),)),
        ("usual", USUAL, (WINDOWS, DIRECTIONS)),  # mean squares of the statistics of changes
        ("repeats", REPEATS, (REPEATS_SIZE,)),
    ]


def named(state: FloatArray, layout: IntArray) -> dict[str, FloatArray]:
    """Views of the parts by name."""
    found = {}
    for name, entry, shape in parts(layout):
        at = int(layout[entry])
        found[name] = state[at : at + int(np.prod(shape))].reshape(shape)
    return found


@njit(nogil=True, forceinline=True)
def vector(state: FloatArray, layout: IntArray, entry: int) -> FloatArray:
    """View of a part of shape (n,)."""
    return state[layout[entry] : layout[entry] + layout[N]]


@njit(nogil=True, forceinline=True)
def matrix(state: FloatArray, layout: IntArray, entry: int) -> FloatArray:
    """View of a part of shape (n, n)."""
    n = layout[N]
    return state[layout[entry] : layout[entry] + n * n].reshape(n, n)


@njit(nogil=True, forceinline=True)
def right_hand_at(layout: IntArray, slot: int) -> int:
    """Place in `state` of the right-hand side of a block of the ring, (n,); a view in a loop would cost more."""
    return int(layout[RING_R] + slot * layout[N])


@njit(nogil=True, forceinline=True)
def information_at(layout: IntArray, slot: int) -> int:
    """Place in `state` of the information of a block of the ring, (n, n)."""
    return int(layout[RING_H] + slot * layout[N] * layout[N])


@njit(nogil=True, forceinline=True)
def filters_of(state: FloatArray, layout: IntArray, slot: int) -> FloatArray:
    """View of the filters before a block of the ring, (filters,)."""
    at = layout[RING_F] + slot * layout[FILTERS]
    return state[at : at + layout[FILTERS]]


@njit(nogil=True, forceinline=True)
def filters_now(state: FloatArray, layout: IntArray) -> FloatArray:
    """View of the filters, (filters,)."""
    return state[layout[FILTER] : layout[FILTER] + layout[FILTERS]]


@njit(nogil=True, forceinline=True)
def eta_at(layout: IntArray) -> int:
    """Place of the left break point in theta; the offset stands before it, the right one and the ratio behind."""
    return int(layout[NA] + layout[NB1] + 1)


@njit(nogil=True, forceinline=True)
def variance(state: FloatArray) -> float:
    """Variance of the prediction errors."""
    return float(state[SQUARES] / state[WEIGHT])
