"""Play or none: simulate the position behind a lag, a play and a rate limit, and fit it to the measured one.

The error of the simulated position has the robust likelihood of Student's t with 4 degrees of freedom, so that single
late or lost samples do not matter. A play forgets its start as soon as the command has crossed it once: unlike a slip,
it never loses step, and its likelihood is smooth.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from lostmotion.actuator.samples import Samples
from lostmotion.actuator.simplex import minimised
from lostmotion.arrays import FloatArray
from lostmotion.kernels import positioner as kernel

LAGS = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0)  # samples: the first search
LONGEST_LAG = 30.0  # seconds: a positioner is faster
DELAYS = (0.0, 0.5, 1.0, 2.0, 4.0)  # samples: the first search
HALF_BANDS = (0.0, 0.001, 0.0025, 0.005, 0.01, 0.02, 0.04, 0.08, 0.15)  # of the range of OP: the first search
NO_LAG = 0.02  # samples: shorter ones are not distinguishable from none
JITTER = 0.3  # samples, 1 / sqrt(12): OP changes anywhere between two samples, where it is not recorded at each change
PARTS = 4  # steps in a sample: a play that takes up in the middle of one is simulated to a quarter
FREEDOM = 4.0  # degrees of freedom of Student's t: heavy tails, finite variance
NORMAL_BAND = 3.841  # 95 % quantile of chi-squared with one degree of freedom


@dataclass(frozen=True)
class Play:
    """A play behind or before a lag, with a rate limit.

    Attributes
    ----------
    half : float
        Half of the full dead band.
    offset : float
        OP minus position in the middle of the dead band.
    lag, delay, rate : float
        Time constant and dead time in samples, largest move in a sample.
    lag_last : bool
        Whether the lag lies behind the play.
    line : bool
        Whether OP goes in straight lines between its samples; otherwise it holds.
    jitter : float
        Uncertainty of the times of OP, in samples: the residuals are larger where the position moves.
    scale : float
        Scale of the residuals of a position at rest.
    log_likelihood : float
    """

    half: float
    offset: float
    lag: float
    delay: float
    rate: float = math.inf
    lag_last: bool = False
    line: bool = False
    jitter: float = 0.0
    scale: float = math.nan
    log_likelihood: float = -math.inf

    @property
    def lag_first(self) -> float:
        """Time constant before the play, in samples."""
        return 0.0 if self.lag_last else self.lag

    def approach(self, parts: int) -> float:
        """Share of the way to its target that the position goes in a part of a sample."""
        return 1.0 if not self.lag_last or self.lag < NO_LAG else 1.0 - math.exp(-1.0 / (self.lag * parts))


def simulated(samples: Samples, play: Play, parts: int = PARTS) -> FloatArray:
    """Position of a play, shape (n,)."""
    v, x = np.empty(parts * len(samples)), np.empty(len(samples))
    kernel.command(samples.op, play.delay, play.lag_first, play.line, parts, v)
    kernel.follow(
        v, samples.position, samples.fresh, play.half, play.offset, play.approach(parts), play.rate / parts, parts, x
    )
    return x


def rated(samples: Samples, play: Play, parts: int = PARTS) -> Play:
    """The same play with its likelihood, and the scale of the residuals that makes it largest."""
    x = simulated(samples, play, parts)
    error = (samples.position - x)[samples.settling :]
    there = np.isfinite(error)
    moves = (play.jitter * np.diff(x, prepend=x[:1])[samples.settling :][there]) ** 2
    square = error[there] ** 2
    scale = max(1.35 * math.sqrt(float(np.median(square))), samples.finest)
    for _ in range(3 if play.jitter == 0.0 else 6):  # a fixed point that is reached to some percent
        spread = scale**2 + moves
        weight = (FREEDOM + 1.0) / (FREEDOM + square / spread)
        scale *= math.sqrt(float(np.sum(weight * square / spread**2)) / float(np.sum(1.0 / spread)))
        scale = max(scale, samples.finest)
    spread = scale**2 + moves
    fit = 0.5 * (FREEDOM + 1.0) * float(np.sum(np.log1p(square / spread / FREEDOM)))
    return replace(play, scale=scale, log_likelihood=-fit - 0.5 * float(np.sum(np.log(spread))))


def refined(samples: Samples, start: Play, half: float | None = None, evaluations: int = 300, rounds: int = 3) -> Play:
    """Most likely play from a start on (Nelder and Mead 1965), its half band held at `half` where that is given."""
    limited, free = math.isfinite(start.rate), half is None
    unit = max(start.half, start.scale)

    def decoded(point: FloatArray) -> Play:
        return replace(
            start,
            offset=float(point[0]) * start.scale,
            delay=min(max(float(point[1]), 0.0), samples.longest_delay),
            lag=min(math.exp(min(float(point[2]), 7.0)), LONGEST_LAG / samples.dt),
            rate=math.exp(min(float(point[3]), 50.0)) if limited else math.inf,
            half=abs(float(point[-1])) * unit if half is None else half,
        )

    def cost(point: FloatArray) -> float:
        return -rated(samples, decoded(point), parts).log_likelihood

    parts = 1 if evaluations < 150 else PARTS
    point = [start.offset / start.scale, start.delay, math.log(max(start.lag, 0.05))]
    steps = [0.7, 0.3, 0.3]
    if limited:
        point, steps = [*point, math.log(start.rate)], [*steps, 0.15]
    if free:
        point, steps = [*point, start.half / unit], [*steps, 0.15]
    return rated(samples, decoded(minimised(cost, np.array(point), np.array(steps), evaluations, rounds)), PARTS)


def _first_search(samples: Samples, rates: Iterable[float]) -> list[Play]:
    """Plays on a coarse grid, most likely first."""
    found = []
    half_bands = [share * samples.op_range for share in HALF_BANDS]
    for lag in (lag for lag in LAGS if lag * samples.dt <= LONGEST_LAG and lag < len(samples) / 10):
        for delay in (delay for delay in DELAYS if delay <= samples.longest_delay):
            v = np.empty(len(samples))
            kernel.command(samples.op, delay, lag, False, 1, v)
            offset = float(np.nanmedian(v - samples.position))
            for lag_last in (False, True) if lag else (False,):
                for rate in rates:
                    base = Play(0.0, offset, lag, delay, rate, lag_last)
                    found += [rated(samples, replace(base, half=half), 1) for half in half_bands]
    return sorted(found, key=lambda play: -play.log_likelihood)


def _spread(plays: list[Play], count: int) -> list[Play]:
    """Best plays of each structure, `count` of different lags each."""
    chosen: dict[tuple[bool, bool], dict[float, Play]] = {}
    for play in plays:
        group = chosen.setdefault((play.lag_last, math.isfinite(play.rate)), {})
        if len(group) < count:
            group.setdefault(play.lag, play)
    return [play for group in chosen.values() for play in group.values()]


def _most_likely(samples: Samples, starts: list[Play], half: float | None) -> Play:
    """Most likely play from several starts, with OP in steps and in straight lines."""
    quick = sorted((refined(samples, one, half, 120, 1) for one in starts), key=lambda one: -one.log_likelihood)
    first = quick[0]
    others = [
        one
        for one in quick
        if one.lag_last is not first.lag_last or (one.rate < math.inf) is not (first.rate < math.inf)
    ]
    both = []
    for one in (first, *others[:1]):
        both.append(refined(samples, one, half, 160, 1))
        both.append(refined(samples, replace(one, line=True, delay=max(one.delay - 0.5, 0.0)), half, 160, 1))
    both += [refined(samples, replace(one, jitter=JITTER), half, 160, 1) for one in both]
    both.sort(key=lambda one: -one.log_likelihood)
    return max((refined(samples, one, half) for one in both[:2]), key=lambda one: one.log_likelihood)


def fit_play(samples: Samples, rates: tuple[float, ...]) -> tuple[Play, Play]:
    """Most likely actuator without a play, and with one; `rates`: rate limits to begin with, in units a sample."""
    grid = _first_search(samples, rates)
    none = _most_likely(samples, _spread([one for one in grid if one.half == 0.0], 2), 0.0)
    starts = _spread([one for one in grid if one.half > 0.0], 3)
    play = _most_likely(samples, [*starts, replace(none, half=none.scale)], None)
    without = refined(samples, replace(play, half=0.0), 0.0)
    none = max(none, without, key=lambda one: one.log_likelihood)
    if play.log_likelihood < none.log_likelihood:
        play = none
    return none, play


def colour(samples: Samples, play: Play) -> float:
    """Factor by which coloured residuals widen a log-likelihood: long-run over plain variance of its derivative.

    Derivative with respect to the half band, Bartlett weights (Newey and West 1987) over the lags of the actuator.
    """
    half = max(play.half, 0.5 * play.scale)
    step = 0.05 * half
    slope = simulated(samples, replace(play, half=half + step)) - simulated(samples, replace(play, half=half - step))
    x = simulated(samples, play)
    error = samples.position - x
    spread = play.scale**2 + (play.jitter * np.diff(x, prepend=x[:1])) ** 2
    score = (error / (FREEDOM * spread + error**2) * slope)[samples.settling :]
    return long_run_ratio(score[np.isfinite(score)])


def long_run_ratio(score: FloatArray) -> float:
    """Long-run variance over variance of a sequence, at least 1."""
    score = score - score.mean()
    own = float(score @ score)
    if own <= 0.0:
        return 1.0
    lags = min(max(int(4.0 * len(score) ** (1.0 / 3.0)), 4), len(score) // 4)
    total = own
    for lag in range(1, lags + 1):
        total += 2.0 * (1.0 - lag / (lags + 1.0)) * float(score[lag:] @ score[:-lag])
    return max(total / own, 1.0)


def band_interval(samples: Samples, play: Play, factor: float) -> tuple[float, float]:
    """95 % interval of the full dead band from the profile likelihood, widened by `factor` (in log-likelihood)."""
    drop = 0.5 * NORMAL_BAND * factor

    def loss(half: float) -> float:
        return play.log_likelihood - refined(samples, replace(play, half=half), half, 150, 1).log_likelihood

    unit = max(0.02 * play.half, 0.1 * play.scale, 0.1 * samples.finest)
    return 2.0 * _crossing(loss, play.half, -unit, drop, 0.0), 2.0 * _crossing(
        loss, play.half, unit, drop, 0.5 * samples.op_range
    )


def _crossing(loss: Callable[[float], float], start: float, step: float, drop: float, end: float) -> float:
    """Half band at which the loss passes `drop`, on the way from `start` to `end`."""
    inside = start
    for _ in range(14):
        outside = inside + step
        if (step < 0.0 and outside <= end) or (step > 0.0 and outside >= end):
            outside = end
        if loss(outside) > drop:
            break
        if outside == end:
            return end
        inside, step = outside, 1.8 * step
    else:
        return outside
    for _ in range(5):
        middle = 0.5 * (inside + outside)
        if loss(middle) > drop:
            outside = middle
        else:
            inside = middle
    return 0.5 * (inside + outside)
