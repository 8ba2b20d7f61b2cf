"""What the samples say about the assumptions: steps of OP, what is no command or no PV, errors that are not white."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.recursive_ml import state as ml

SMALLEST_MOVE = 1e-9  # deviations of u: less is rounding of floats
FAR, FARTHEST = (
    10.0,
    1000.0,
)  # times the range of u beyond it: believed where it lasts; never (0 to 100 % in steps of 0.1)
WATCHED = 1.0 - 1.0 / 5000  # memory for the colour of the errors
MOST_DEVIATIONS = 4.0  # an outlier counts as so many
RARE = 0.1  # share of PV that come again by chance, up to which a stuck one can be told: steps of a third of the noise
CHANCE = 1e-4  # that a PV comes again so often by chance
ROUNDED = 2.0  # in place of the share: PV is rounded coarsely, and repeats where it rests, however rarely it does
EQUAL = 8.0  # samples of a rounded PV in a row that count fully; all of them together count as twice as many at most
SHARES = 1.0 / 1000  # of each new PV in the share of those that come again


@njit(nogil=True, forceinline=True)
def believable(u: float, state: FloatArray, layout: IntArray) -> bool:
    """Whether a command can be one: not for a block of samples where it is far beyond all before, never farther."""
    low, high = state[ml.LOW], state[ml.HIGH]
    beyond = max(low - u, u - high)
    if beyond <= FAR * (high - low):
        layout[ml.FAR] = 0
        return True
    layout[ml.FAR] += 1
    return bool(layout[ml.FAR] > layout[ml.BLOCK] and beyond <= FARTHEST * (high - low))


@njit(nogil=True, forceinline=True)
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


@njit(nogil=True, forceinline=True)
def stuck(y: float, state: FloatArray, at: int) -> bool:
    """Whether PV is to the last bit the one before, more often in a row than chance allows.

    A PV with noise comes again where it is rounded, with a share of new ones that is counted; each further time in a
    row is as rare. A frozen transmitter or a historian that fills in repeats what is no measurement. The part
    `repeats` lies in `state` from `at` on.
    """
    last, again, share = state[at + ml.LAST_Y], state[at + ml.REPEATED], state[at + ml.SHARE]
    if y != last:
        if again == 0.0 and share <= 1.0 and not np.isnan(y) and not np.isnan(last):
            state[at + ml.SHARE] = share * (1.0 - SHARES)
        state[at + ml.LAST_Y], state[at + ml.REPEATED] = y, 0.0
        return False
    if again == 0.0 and share <= 1.0:
        state[at + ml.SHARE] += SHARES * (1.0 - share)
    state[at + ml.REPEATED] = again + 1.0
    return bool(share < RARE and share ** (again + 1.0) < CHANCE)


@njit(nogil=True, forceinline=True)
def news(state: FloatArray, at: int) -> float:
    """Weight of a sample: 1, but where PV is rounded coarsely and comes again and again with one rounding error."""
    equal = state[at + ml.REPEATED] + 1.0
    if state[at + ml.SHARE] <= 1.0 or equal <= EQUAL:
        return 1.0
    return float((EQUAL / equal) ** 2)


@njit(nogil=True)
def mean_news(y: FloatArray, repeats: FloatArray) -> float:
    """Mean weight of the samples of a rounded PV (n,); leaves `repeats` as after the last one."""
    repeats[ml.LAST_Y], repeats[ml.REPEATED] = np.nan, 0.0
    total, known = 0.0, 0
    for value in y:
        stuck(value, repeats, 0)
        if not np.isnan(value):
            total += news(repeats, 0)
            known += 1
    return total / max(known, 1)


@njit(nogil=True)
def without_stuck(y: FloatArray, repeats: FloatArray) -> FloatArray:
    """The same PV (n,), NaN where it is stuck; counts the share first, leaves `repeats` (3,) as after the last one."""
    new = again = 0
    for k in range(1, y.size):
        if not (np.isnan(y[k]) or np.isnan(y[k - 1])) and (k == 1 or y[k - 1] != y[k - 2]):
            new += 1
            again += y[k] == y[k - 1]
    repeats[ml.LAST_Y], repeats[ml.REPEATED], repeats[ml.SHARE] = np.nan, 0.0, again / max(new, 1)
    kept = y.copy()
    for k in range(y.size):
        if stuck(y[k], repeats, 0):
            kept[k] = np.nan
    return kept


@njit(nogil=True, forceinline=True)
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


@njit(nogil=True)
def begin_watch(state: FloatArray, layout: IntArray) -> None:
    """Forget the errors: those before a change, and those on the way, tell nothing of what comes."""
    at = layout[ml.WATCH]
    state[at + ml.WATCHED_SQUARES], state[at + ml.WATCHED] = 0.0, 0.0
    state[layout[ml.PRODUCTS] : layout[ml.PRODUCTS] + len(ml.LAGS)] = 0.0
    state[layout[ml.ERRORS] : layout[ml.ERRORS] + ml.LONGEST_LAG] = 0.0


@njit(nogil=True)
def colour(state: FloatArray, layout: IntArray) -> tuple[float, float]:
    """Largest correlation of the errors at a lag, and the number of samples that it is from."""
    at = layout[ml.WATCH]
    squares = state[at + ml.WATCHED_SQUARES]
    products = state[layout[ml.PRODUCTS] : layout[ml.PRODUCTS] + len(ml.LAGS)]
    return (float(np.abs(products).max() / squares) if squares > 0.0 else 0.0), float(state[at + ml.WATCHED])
