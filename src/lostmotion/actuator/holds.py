"""Holds: stretches in which the position stands still while OP moves, and how far OP is away when each ends.

Each hold bounds the threshold of the actuator: OP minus position exceeded it at the row in which the position moves,
and not before. The likelihood of a normal threshold of mean `half` and standard deviation `scatter` is that of
interval-censored data (Turnbull 1976); the lag and the dead time of the positioner are searched on a grid, and their
uncertainty is part of the interval.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from lostmotion.actuator.play import DELAYS, LAGS, NORMAL_BAND
from lostmotion.actuator.samples import Samples
from lostmotion.actuator.simplex import minimised
from lostmotion.arrays import FloatArray
from lostmotion.kernels import positioner as kernel

WINDOW_NOISE = 5.5  # standard deviations of the position: range of some 200 normal numbers
WINDOW_STEPS = 2.01  # resolutions: a value between two steps flickers, and once more at a break-away
INFORMATIVE = 3.0  # windows that OP moves in a hold: less may be the motion that the window hides
OUTLIER = 0.03  # probability of a hold that ends for another reason: a load, a lost sample
MIN_EVENTS = 3
WINDOWS = (1.0, 2.5, 6.0)  # of the smallest window: samples between those recorded are interpolated, and creep
SAME_FIT = 0.05  # of log-likelihood a hold: what LEAST_SCATTER alone may cost one lag more than another
MIN_CONSISTENT = 5  # holds that must agree
MISFIT = 0.35  # mean loss of log-likelihood per hold, beside one outlier: one hold in ten ends elsewhere
MAX_SCATTER = 0.35  # of the half band: more is no threshold
LEAST_SCATTER = 0.02  # of the half band: friction and electronics repeat no better
COARSE = 0.7  # of the half band: OP must move in smaller steps before most holds end
STEADY_SHARE = 0.5  # of the rows: an OP that changes in more of them does not move in single steps
LONGEST_LAG = 5.0  # seconds; longer ones leave no clean holds
SAME_WAY_SHARE = 0.35  # of the half band: OP goes on at least so far in a hold that ends as it began, in a slip


@dataclass(frozen=True, eq=False)
class Holds:
    """Holds of a record.

    Attributes
    ----------
    first, behind : ndarray of int, shape (m,)
        Rows: first one, and the one behind the last.
    level : ndarray, shape (m,)
        Mean position.
    way : ndarray, shape (m,)
        Direction in which the hold ends: 1, -1, or 0 where the record ends or a sample is missing.
    window : float
        Widest range of the position in a hold.
    """

    first: np.ndarray
    behind: np.ndarray
    level: FloatArray
    way: FloatArray
    window: float


@dataclass(frozen=True)
class Threshold:
    """Distance of OP from the position at which holds end.

    Attributes
    ----------
    half, offset, scatter : float
        Mean threshold on both sides of the offset, and its standard deviation.
    lag, delay : float
        Of the positioner, in samples.
    events, up, down : int
        Holds that count; those that end upwards and downwards.
    log_likelihood : float
    interval : (float, float)
        95 % interval of `half`.
    bracket : float
        Median width of the bounds on one threshold.
    op_step : float
        Median of the largest step of OP shortly before a hold ends.
    """

    half: float
    offset: float
    scatter: float
    lag: float
    delay: float
    events: int
    up: int
    down: int
    log_likelihood: float
    bracket: float
    op_step: float
    interval: tuple[float, float] = (math.nan, math.nan)

    @property
    def consistent(self) -> bool:
        """Whether one threshold explains the holds: they scatter little, and few end elsewhere."""
        resolved = max(self.bracket, self.op_step) < COARSE * self.half and self.scatter < MAX_SCATTER * self.half
        return (
            self.events >= MIN_CONSISTENT
            and resolved
            and self.log_likelihood > math.log(OUTLIER) - MISFIT * self.events
        )


def smallest_window(samples: Samples) -> float:
    """Range of a position that holds, by its noise and its resolution."""
    return max(WINDOW_STEPS * samples.resolution, 1e-3 * samples.op_range) + WINDOW_NOISE * samples.rest_noise


def holds_of(samples: Samples, window: float) -> Holds:
    """Stretches in which the position stays within a window."""
    y = samples.position
    found = kernel.holds(y, window, samples.fresh)
    first, behind = found[:, 0].astype(int), found[:, 1].astype(int)
    after = np.minimum(behind, len(y) - 1)
    ends = (behind < len(y)) & np.isfinite(y[after]) & (samples.fresh[after] == 0.0)
    way = np.where(ends, np.sign(y[after] - found[:, 2]), 0.0)
    return Holds(first, behind, found[:, 2], way, window)


@dataclass(frozen=True, eq=False)
class _Bounds:
    """Of each informative hold: OP minus position at most, at least and when it ends, its direction, OP's net way."""

    highest: FloatArray
    lowest: FloatArray
    end: FloatArray
    way: FloatArray
    net: FloatArray
    before: FloatArray
    op_step: FloatArray


def _bounds(samples: Samples, holds: Holds, lag: float, delay: float) -> _Bounds:
    v = np.empty(len(samples))
    kernel.command(samples.op, delay, lag, False, 1, v)
    long = (holds.behind - holds.first >= 2) & (holds.first >= samples.settling // 2)
    first, behind, level, way = holds.first[long], holds.behind[long], holds.level[long], holds.way[long]
    if len(first) == 0:
        empty = np.empty(0)
        return _Bounds(empty, empty, empty, empty, empty, empty, empty)
    highest = np.array([v[a:b].max() for a, b in zip(first, behind, strict=True)]) - level
    lowest = np.array([v[a:b].min() for a, b in zip(first, behind, strict=True)]) - level
    at_end = v[np.minimum(behind, len(v) - 1)]
    before = np.concatenate([[0.0], holds.way[:-1]])[long]  # direction of the motion that led here
    steps = np.abs(np.diff(samples.op, prepend=samples.op[:1]))
    reach = int(samples.longest_delay) + 1
    if float(np.mean(steps > 0.0)) > STEADY_SHARE:  # holds end at many distances of OP, which tell the threshold
        steps[:] = 0.0
    op_step = np.array([steps[max(b - reach, a + 1, 0) : b + 1].max() for a, b in zip(first, behind, strict=True)])
    informative = highest - lowest > INFORMATIVE * holds.window
    bounds = (highest, lowest, at_end - level, way, way * (at_end - v[first]), before, op_step)
    return _Bounds(*(one[informative] for one in bounds))


def _log_likelihood(bounds: _Bounds, half: float, offset: float, scatter: float) -> float:
    up, down = bounds.highest - offset, offset - bounds.lowest
    total = 0.0
    for way, survived, other in ((1.0, up, down), (-1.0, down, up)):
        rows = bounds.way == way
        ended = way * (bounds.end[rows] - offset)
        inside = ndtr((ended - half) / scatter) - ndtr((survived[rows] - half) / scatter)
        total += float(np.log(OUTLIER + (1.0 - OUTLIER) * np.maximum(inside, 0.0)).sum())
        total += float(np.log(OUTLIER + (1.0 - OUTLIER) * ndtr((half - other[rows]) / scatter)).sum())
    open_ended = bounds.way == 0.0
    stays = ndtr((half - up[open_ended]) / scatter) * ndtr((half - down[open_ended]) / scatter)
    return total + float(np.log(OUTLIER + (1.0 - OUTLIER) * stays).sum())


def threshold_of(samples: Samples, holds: Holds) -> Threshold | None:
    """Most likely threshold of the holds, with its interval; None: fewer than MIN_EVENTS holds tell one."""
    fits = []
    for lag in (lag for lag in LAGS if lag * samples.dt <= LONGEST_LAG):
        for delay in (delay for delay in DELAYS if delay <= samples.longest_delay):
            bounds = _bounds(samples, holds, lag, delay)
            if int(np.count_nonzero(bounds.way)) >= MIN_EVENTS:
                fits.append((_at(samples, holds, bounds, lag, delay), bounds))
    if not fits:
        return None
    best = max((one for one, _ in fits), key=lambda one: one.log_likelihood)
    drop = 0.5 * NORMAL_BAND + SAME_FIT * best.events
    near = [(one, bounds) for one, bounds in fits if one.log_likelihood > best.log_likelihood - drop]
    ends = [_interval(one, bounds, one.log_likelihood) for one, bounds in near]
    interval = (min(low for low, _ in ends), max(high for _, high in ends))
    # between lags and delays that fit alike the likelihood is flat: its middle errs least
    return Threshold(**{**vars(best), "half": 0.5 * (interval[0] + interval[1]), "interval": interval})


def _at(samples: Samples, holds: Holds, bounds: _Bounds, lag: float, delay: float) -> Threshold:
    up, down = bounds.end[bounds.way > 0.0], -bounds.end[bounds.way < 0.0]
    both = [float(np.median(one)) for one in (up, down) if len(one)]
    half = max(float(np.mean(both)), holds.window)
    offset = 0.5 * (both[0] - both[1]) if len(both) == 2 else 0.0
    finest = 0.5 * samples.finest

    def scatter(point: FloatArray) -> float:
        return max(math.exp(point[2]), LEAST_SCATTER * math.exp(point[0]), finest)

    def cost(point: FloatArray) -> float:
        return -_log_likelihood(bounds, math.exp(point[0]), point[1] * half, scatter(point))

    start = np.array([math.log(half), offset / half, math.log(0.1 * half)])
    best = minimised(cost, start, np.array([0.1, 0.1, 0.7]), 200)
    ways = bounds.way != 0.0
    survived = np.where(bounds.way > 0.0, bounds.highest, -bounds.lowest)
    width = bounds.way * bounds.end - survived
    return Threshold(
        half=math.exp(best[0]), offset=float(best[1]) * half, scatter=scatter(best), lag=lag,
        delay=delay, events=int(np.count_nonzero(ways)), up=len(up), down=len(down), log_likelihood=-cost(best),
        bracket=float(np.median(np.abs(width[ways]))),
        op_step=float(np.median(bounds.op_step[ways])),
    )  # fmt: skip


def _interval(threshold: Threshold, bounds: _Bounds, best: float) -> tuple[float, float]:
    """Interval of the half band at one lag and delay, by the profile over the offset and the scatter."""

    def inside(half: float) -> bool:
        def cost(point: FloatArray) -> float:
            return -_log_likelihood(bounds, half, point[0], max(math.exp(point[1]), LEAST_SCATTER * half))

        start = np.array([threshold.offset, math.log(threshold.scatter)])
        nearest = minimised(cost, start, np.array([0.1 * threshold.half, 0.5]), 60)
        return cost(nearest) < 0.5 * NORMAL_BAND - best

    ends = []
    for side in (-1.0, 1.0):
        step, at = 0.01 * threshold.half, threshold.half
        for _ in range(12):
            if at + side * step <= 0.0 or not inside(at + side * step):
                break
            at, step = at + side * step, 1.7 * step
        low, high = at, max(at + side * step, 0.0)
        for _ in range(4):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if inside(middle) else (low, middle)
        ends.append(low)
    return ends[0], ends[1]


def slips(samples: Samples, holds: Holds, threshold: Threshold) -> tuple[int, float]:
    """Holds that end in the direction in which they began while OP goes on in it, and how far OP goes in them.

    A play holds after a reversal only: until it moves on in its old direction, OP has come back to where it was.
    """
    bounds = _bounds(samples, holds, threshold.lag, threshold.delay)
    same = (bounds.way == bounds.before) & (bounds.way != 0.0)
    ahead = same & (bounds.net > max(SAME_WAY_SHARE * threshold.half, 2.0 * holds.window))
    return int(np.count_nonzero(ahead)), float(np.median(bounds.net[same])) if same.any() else 0.0


def directions(samples: Samples, holds: Holds, threshold: Threshold) -> tuple[FloatArray, FloatArray]:
    """Full dead band by each hold that ends upwards, and downwards: twice the distance of OP at its end."""
    bounds = _bounds(samples, holds, threshold.lag, threshold.delay)
    up, down = bounds.way > 0.0, bounds.way < 0.0
    return 2.0 * (bounds.end[up] - threshold.offset), 2.0 * (threshold.offset - bounds.end[down])
