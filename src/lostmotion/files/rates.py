"""Steps between the rows -> rate: the mean step, the gaps, and how far to trust them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.records.sampling import Bools

JITTER = 0.01  # steps within 1 % of a multiple of the median are one clock
GIVEN_TOLERANCE = 0.05  # a given dt may differ this much from rounded or irregular stamps: plant clocks drift
GAP_SHARE = 0.1  # more gaps than this are not gaps but irregular sampling
NEAR_SHARE = 0.95  # with dt given, at least this share of steps within half a dt of it
SCATTER = 0.25  # of the mean step, at most: standard deviation of the steps of one scan that jitters
STEADY = 0.05  # the quarters of a record agree in their mean step to this share, or it has no one rate
ROW_SPREAD = (0.1, 1.5)  # rows by which stamps of one rate differ: one, and for jitter a share of them, at most so many
ROW_SHARE = 0.05  # or this share of them
MOST_STEPS = 2  # of a clock that is set, among the first rows of a growing record
STEADY_ROWS = 20  # of one clock, at least, beside such a step
FEWEST_STAMPS = 2  # whole ones that the rows of a stamp are counted from
RESOLUTIONS = (60.0, 1.0, 0.1, 0.01, 0.001)  # s: what stamps are rounded to


@dataclass(frozen=True, eq=False)
class Rate:
    """Mean step in seconds, steps that are gaps, relative tolerance against a given dt, and a remark."""

    step: float
    gaps: Bools
    tolerance: float
    note: str = ""

    @property
    def rows(self) -> tuple[int, ...]:
        """Rows (from 0) before which time is missing."""
        return tuple(int(row) + 1 for row in np.flatnonzero(self.gaps))


def tidy(step: float, error: float) -> float:
    """Shortest decimal within the error of a step.

    Examples
    --------
    >>> tidy(0.0100000001, 1e-6), tidy(12.46, 0.08)
    (0.01, 12.5)
    """
    for digits in range(1, 12):
        short = float(f"{step:.{digits}g}")
        if abs(short - step) <= error:
            return short
    return step


def uniform(steps: FloatArray) -> Rate | None:
    """Rate of one clock with little jitter; None where the steps are not of this kind.

    Examples
    --------
    >>> rate = uniform(np.array([2.0, 2.01, 1.99, 6.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0]))
    >>> rate.step, rate.rows
    (2.0, (4,))
    """
    middle = float(np.median(steps))
    low, high = float(steps.min()), float(steps.max())
    if low > 0.0 and high - low <= JITTER * low:  # what follows would find the same
        return Rate(tidy(middle, 1e-6 * middle), np.zeros(len(steps), dtype=bool), JITTER)
    multiple = np.maximum(np.round(steps / middle), 1.0)
    gaps = multiple > 1
    if gaps.mean() > GAP_SHARE or (np.abs(steps - multiple * middle) > JITTER * middle * multiple).any():
        return None
    return Rate(tidy(middle, 1e-6 * middle), gaps, JITTER)


def between_steps(seconds: FloatArray) -> Bools:
    """Rows of the longest stretch of a clock that was set once or twice; all rows where that is not what happened.

    Examples
    --------
    >>> seconds = np.arange(60.0)
    >>> seconds[35:] -= 3600.0
    >>> np.flatnonzero(between_steps(seconds))[[0, -1]]
    array([ 0, 34])
    """
    whole = np.ones(len(seconds), dtype=bool)
    if len(seconds) <= STEADY_ROWS:
        return whole
    steps = np.diff(seconds)
    middle = float(np.median(steps))
    multiple = np.round(steps / middle) if middle > 0.0 else np.zeros_like(steps)
    odd = (multiple < 1.0) | (np.abs(steps - multiple * middle) > JITTER * middle * multiple)
    if not 0 < odd.sum() <= MOST_STEPS:
        return whole
    ends = np.concatenate([[0], np.flatnonzero(odd) + 1, [len(seconds)]])
    longest = int(np.argmax(np.diff(ends)))
    first, stop = ends[longest : longest + 2]
    if stop - first < max(STEADY_ROWS, len(seconds) // 2):
        return whole
    rows = np.arange(len(seconds))
    return np.asarray((rows >= first) & (rows < stop))


def rounded(seconds: FloatArray, steps: FloatArray) -> Rate | None:
    """Rate of a uniform clock whose stamps were rounded to whole seconds, tenths..; None: another kind.

    Examples
    --------
    >>> seconds = np.round(np.arange(100) * 1.6)
    >>> round(rounded(seconds, np.diff(seconds)).step, 2)
    1.6
    """
    finest = grain(seconds)
    middle = float(np.median(steps))
    if not 0 < finest < middle:
        return None
    single = np.abs(steps - middle) <= finest * 1.001
    if not single.any():
        return None
    step = float(steps[single].mean())
    multiple = np.maximum(np.round(steps / step), 1.0)
    gaps = ~single
    aligned = np.abs(steps - multiple * step) <= finest * 1.001
    if gaps.mean() > GAP_SHARE or not aligned.all() or _wander(steps - multiple * step, gaps) > 2 * finest:
        return None
    error = finest / max(int(single.sum()), 1)
    note = f"stamps are rounded to {finest:g} s; their mean step of {tidy(step, error):g} s was used"
    return Rate(tidy(step, error), gaps, GIVEN_TOLERANCE, note)


def coarse(steps: FloatArray) -> tuple[Rate, float]:
    """Rate where several rows carry one stamp, and the error of its step in seconds.

    A stamp changes within one sampling time of its own time, so the rows between two changes tell the mean
    step better than the first and last stamps do, and than those beside a gap, which may be cut.

    Examples
    --------
    >>> seconds = np.floor(np.arange(50) * 12.0 / 60.0) * 60.0
    >>> rate, error = coarse(np.diff(seconds))
    >>> rate.step, rate.note
    (12.0, 'several rows carry one stamp, about 5.0 rows a minute, 12 s each')
    """
    changes = np.flatnonzero(steps > 0)
    stamp = float(steps[changes].min())
    gaps = steps > 1.5 * stamp
    whole, rows = _whole_stamps(changes, gaps)
    counted = int(rows[whole].sum())
    usual = steps[~gaps]
    step = float(steps[changes[1:]][whole].sum()) / counted if counted else float(usual.mean() or stamp)
    error = step / max(counted or len(usual), 1)
    what = {60.0: "a minute", 1.0: "a second"}.get(stamp, f"per {stamp:g} s stamp")
    note = f"several rows carry one stamp, about {stamp / step:.1f} rows {what}, {step:.3g} s each"
    return Rate(step, gaps, GIVEN_TOLERANCE + error / step, note), error


def evenly_spread(steps: FloatArray) -> bool:
    """Whether the stamps that several rows carry have nearly as many rows each, the first and the last aside.

    Examples
    --------
    >>> seconds = np.floor(np.arange(50) * 12.0 / 60.0) * 60.0
    >>> evenly_spread(np.diff(seconds)), evenly_spread(np.diff(np.delete(seconds, [20, 21, 22, 23])))
    (True, False)
    """
    changes = np.flatnonzero(steps > 0)
    whole, count = _whole_stamps(changes, steps > 1.5 * float(steps[changes].min()))
    rows = count[whole]
    if len(rows) < FEWEST_STAMPS:
        return False
    mean = float(rows.mean())
    spread = max(min(1.0 + ROW_SPREAD[0] * mean, ROW_SPREAD[1]), ROW_SHARE * mean)
    return float(np.mean(np.abs(rows - mean) <= spread)) >= NEAR_SHARE


def _whole_stamps(changes: IntArray, gaps: Bools) -> tuple[Bools, IntArray]:
    """Which of the stamps between the first and the last are not beside a gap, and the rows of each."""
    return ~(gaps[changes[:-1]] | gaps[changes[1:]]), np.diff(changes)


def scattered(steps: FloatArray) -> Rate | None:
    """Rate of a scan that jitters: nearly all steps within half of the median of it, at one mean all along.

    Examples
    --------
    >>> steps = np.random.default_rng(0).choice([10.0, 11.0, 12.0, 15.0], size=400, p=[0.1, 0.5, 0.3, 0.1])
    >>> scattered(steps).step
    11.7
    >>> scattered(np.random.default_rng(0).exponential(12.0, size=400))
    """
    middle = float(np.median(steps))
    close = np.abs(steps - middle) <= 0.5 * middle
    if not middle > 0 or close.mean() < NEAR_SHARE:
        return None
    mean, spread = float(steps[close].mean()), float(steps[close].std())
    quarters = [float(part.mean()) for part in np.array_split(steps[close], 4) if len(part)]
    if spread > SCATTER * mean or max(abs(quarter - mean) for quarter in quarters) > STEADY * mean:
        return None
    step = tidy(mean, spread / np.sqrt(close.sum()))
    note = (
        f"steps between rows scatter from {steps.min():g} to {steps.max():g} s; the rows were taken as samples "
        f"of one scan of {step:g} s, their mean"
    )
    return Rate(step, ~close & (steps > middle), max(GIVEN_TOLERANCE, spread / mean), note)


def near(seconds: FloatArray, steps: FloatArray, dt: float) -> tuple[Rate, float]:
    """Mean and share of the steps within half a given dt of it, or within the resolution of the stamps."""
    finest = grain(seconds)
    close = np.abs(steps - dt) <= max(0.5 * dt, finest if finest < dt else 0.0)
    mean = float(steps[close].mean()) if close.any() else float(steps.mean())
    words = f"steps between rows vary from {steps.min():g} to {steps.max():g} s (mean {steps.mean():.4g} s)"
    return Rate(mean, ~close & (steps > dt), GIVEN_TOLERANCE, words), float(close.mean())


def grain(seconds: FloatArray) -> float:
    """Coarsest usual resolution in seconds of which all times are multiples; 0: none.

    Examples
    --------
    >>> grain(np.array([0.0, 1.2, 2.3]))
    0.1
    """
    relative = seconds - seconds[0]
    for finest in RESOLUTIONS:
        if (np.abs(relative / finest - np.round(relative / finest)) < 1e-3).all():
            return finest
    return 0.0


def _wander(excess: FloatArray, gaps: Bools) -> float:
    """Largest spread, in seconds, of the stamps about a uniform clock between gaps."""
    pieces = np.split(np.where(gaps, 0.0, excess), np.flatnonzero(gaps))
    return max(float(np.ptp(np.cumsum(piece))) if len(piece) else 0.0 for piece in pieces)
