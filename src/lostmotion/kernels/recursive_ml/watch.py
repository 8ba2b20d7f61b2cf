"""What the samples say about the assumptions: steps of OP, commands that are none, errors that are not white."""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.recursive_ml import state as ml

SMALLEST_MOVE = 1e-9  # deviations of u: less is rounding of floats
FAR, FARTHEST = (
    10.0,
    1000.0,
)  # times the range of u beyond it: believed where it lasts; never (0 to 100 % in steps of 0.1)
WATCHED = 1.0 - 1.0 / 5000  # memory for the colour of the errors
MOST_DEVIATIONS = 4.0  # an outlier counts as so many


@njit(cache=True, nogil=True, forceinline=True)
def believable(u: float, state: FloatArray, layout: IntArray) -> bool:
    """Whether a command can be one: not for a block of samples where it is far beyond all before, never farther."""
    low, high = state[ml.LOW], state[ml.HIGH]
    beyond = max(low - u, u - high)
    if beyond <= FAR * (high - low):
        layout[ml.FAR] = 0
        return True
    layout[ml.FAR] += 1
    return bool(layout[ml.FAR] > layout[ml.BLOCK] and beyond <= FARTHEST * (high - low))


@njit(cache=True, nogil=True, forceinline=True)
def watch_command(u: float, state: FloatArray, layout: IntArray) -> None:
    """Keep the step of which all moves of u are multiples (Euclid): where OP is rounded, the distance of its levels."""
    at = layout[ml.WATCH]
    move = abs(u - state[at + ml.LAST_U])
    if move > SMALLEST_MOVE:
        step = state[at + ml.GAP]
        rest = move if step == np.inf else abs(move - step * np.round(move / step))
        if rest > SMALLEST_MOVE:
            state[at + ml.GAP] = rest
    state[at + ml.LAST_U] = u


@njit(cache=True, nogil=True, forceinline=True)
def watch_error(error: float, deviation: float, used: bool, state: FloatArray, layout: IntArray) -> None:
    """Add an error to the sums of the correlations; one that is not used counts as 0."""
    past, k = layout[ml.ERRORS], layout[ml.COUNT]
    if not used:
        state[past + k % ml.LONGEST_LAG] = 0.0
        return
    e = min(max(error / deviation, -MOST_DEVIATIONS), MOST_DEVIATIONS) if deviation > 0.0 else 0.0
    at, sums = layout[ml.WATCH], layout[ml.PRODUCTS]
    for i in range(len(ml.LAGS)):
        earlier = state[past + (k + ml.LONGEST_LAG - ml.LAGS[i]) % ml.LONGEST_LAG]
        state[sums + i] = WATCHED * state[sums + i] + e * earlier
    state[past + k % ml.LONGEST_LAG] = e
    state[at + ml.WATCHED_SQUARES] = WATCHED * state[at + ml.WATCHED_SQUARES] + e * e
    state[at + ml.WATCHED] = WATCHED * state[at + ml.WATCHED] + 1.0


@njit(cache=True, nogil=True)
def begin_watch(state: FloatArray, layout: IntArray) -> None:
    """Forget the errors: those before a change, and those on the way, tell nothing of what comes."""
    at = layout[ml.WATCH]
    state[at + ml.WATCHED_SQUARES], state[at + ml.WATCHED] = 0.0, 0.0
    state[layout[ml.PRODUCTS] : layout[ml.PRODUCTS] + len(ml.LAGS)] = 0.0
    state[layout[ml.ERRORS] : layout[ml.ERRORS] + ml.LONGEST_LAG] = 0.0


@njit(cache=True, nogil=True)
def colour(state: FloatArray, layout: IntArray) -> tuple[float, float]:
    """Largest correlation of the errors at a lag, and the number of samples that it is from."""
    at = layout[ml.WATCH]
    squares = state[at + ml.WATCHED_SQUARES]
    products = state[layout[ml.PRODUCTS] : layout[ml.PRODUCTS] + len(ml.LAGS)]
    return (float(np.abs(products).max() / squares) if squares > 0.0 else 0.0), float(state[at + ml.WATCHED])
