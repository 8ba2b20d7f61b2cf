"""Stick and slip where single slips are near the noise: maximum likelihood by the filter of ``kernels.positioner``."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lostmotion.actuator.holds import Threshold
from lostmotion.actuator.play import LONGEST_LAG, NO_LAG, NORMAL_BAND, Play, long_run_ratio
from lostmotion.actuator.samples import Samples
from lostmotion.actuator.simplex import minimised
from lostmotion.arrays import FloatArray
from lostmotion.kernels import positioner as kernel

MAX_THRESHOLD_SCATTER = 0.25  # of the half band: more is no threshold
MAX_LANDING_SCATTER = 0.35  # of the half band: more is no landing
RESTS = (0.0, 0.15, 0.35, 0.6)  # of the half band, left behind after a slip: the first search
GAIN_IN_WIDTH = (1.0, 1.4, 2.0, 3.0)  # of the play that fits best: a slip looks like a narrower play


@dataclass(frozen=True)
class Slip:
    """Threshold, what a slip leaves behind, and the noise. Lengths in units of OP, times in samples."""

    half: float
    rest: float
    offset: float
    delay: float
    lag: float
    approach_lag: float
    rate: float
    line: bool
    noise: float
    threshold_scatter: float
    landing_scatter: float
    log_likelihood: float = -math.inf


_LOGARITHMIC = ("half", "lag", "approach_lag", "rate", "noise", "threshold_scatter", "landing_scatter")
_STEPS = {
    "half": 0.12, "rest": 0.2, "offset": 1.0, "delay": 0.3, "lag": 0.3, "approach_lag": 0.3, "rate": 0.15,
    "noise": 0.3, "threshold_scatter": 0.6, "landing_scatter": 0.6,
}  # fmt: skip


def rows_of(samples: Samples, slip: Slip) -> FloatArray:
    """Log-likelihood of each row, shape (n,)."""
    v, per_row, x = (np.empty(len(samples)) for _ in range(3))
    kernel.command(samples.op, slip.delay, slip.lag, slip.line, 1, v)
    approach = 1.0 if slip.approach_lag < NO_LAG else 1.0 - math.exp(-1.0 / slip.approach_lag)
    theta = np.array([
        slip.offset, slip.half, slip.rest, slip.delay, slip.lag, approach, slip.rate, slip.noise,
        slip.threshold_scatter, slip.landing_scatter,
    ])  # fmt: skip
    wide = 0.25 * float(np.nanmax(samples.position) - np.nanmin(samples.position))
    kernel.filtered(v, samples.position, samples.fresh, theta, max(wide, 1e-9), per_row, x, samples.settling)
    per_row[: samples.settling] = 0.0
    return per_row


def _rated(samples: Samples, slip: Slip) -> Slip:
    least = 0.5 * samples.finest
    scatter = min(max(slip.threshold_scatter, least), max(MAX_THRESHOLD_SCATTER * slip.half, 4.0 * least))
    landing = min(max(slip.landing_scatter, least), max(MAX_LANDING_SCATTER * slip.half, 4.0 * least))
    noise = max(slip.noise, samples.finest)
    slip = replace(slip, noise=noise, threshold_scatter=scatter, landing_scatter=landing)
    return replace(slip, log_likelihood=float(rows_of(samples, slip).sum()))


def refined(samples: Samples, start: Slip, held: tuple[str, ...] = (), evaluations: int = 300, rounds: int = 3) -> Slip:
    """Most likely slip from a start on; parameters in `held` stay as they are."""
    free = [name for name in _STEPS if name not in held and not (name == "rate" and math.isinf(start.rate))]
    free.remove("lag" if start.approach_lag > 0.0 else "approach_lag")
    unit = max(0.1 * start.half, samples.finest)

    def decoded(point: FloatArray) -> Slip:
        values: dict[str, Any] = {}
        for name, number in zip(free, point.tolist(), strict=True):
            value = math.exp(min(number, 50.0)) if name in _LOGARITHMIC else number
            if name == "offset":
                value *= unit
            elif name == "rest":
                value = min(max(value, 0.0), 1.0)
            elif name == "delay":
                value = min(max(value, 0.0), samples.longest_delay)
            elif name in ("lag", "approach_lag"):
                value = min(value, LONGEST_LAG / samples.dt)
            values[name] = value
        return replace(start, **values)

    def cost(point: FloatArray) -> float:
        return -_rated(samples, decoded(point)).log_likelihood

    point, steps = [], []
    for name in free:
        value = getattr(start, name)
        least = 0.05 if name in ("lag", "approach_lag") else 1e-9
        value = math.log(max(value, least)) if name in _LOGARITHMIC else value / unit if name == "offset" else value
        step = -_STEPS[name] if name == "rest" and value > 0.7 else _STEPS[name]
        point.append(value)
        steps.append(step)
    return _rated(samples, decoded(minimised(cost, np.array(point), np.array(steps), evaluations, rounds)))


def _base(samples: Samples, play: Play) -> Slip:
    noise = max(samples.finest, 0.29 * samples.resolution, samples.rest_noise)
    return Slip(
        half=max(play.half, 1e-6 * samples.op_range), rest=1.0, offset=play.offset, delay=play.delay,
        lag=play.lag_first, approach_lag=play.lag if play.lag_last else 0.0, rate=play.rate, line=play.line,
        noise=noise, threshold_scatter=noise, landing_scatter=noise,
    )  # fmt: skip


def as_slip(samples: Samples, play: Play) -> Slip:
    """The play in terms of the filter, to compare both by one likelihood."""
    base = _base(samples, play)
    starts = [base, replace(base, landing_scatter=3.0 * base.noise)]
    return max((refined(samples, one, ("rest",), 350, 2) for one in starts), key=lambda one: one.log_likelihood)


def fit_slip(samples: Samples, play: Play, threshold: Threshold | None) -> Slip:
    """Most likely stick and slip; begun at the play, at the threshold of the holds, and around."""
    base = replace(_base(samples, play), rest=0.0)
    starts = [replace(base, half=max(play.half, 2.0 * base.noise) * factor) for factor in GAIN_IN_WIDTH]
    if threshold is not None:
        there = replace(
            base, half=threshold.half, offset=threshold.offset, lag=threshold.lag, delay=threshold.delay,
            approach_lag=0.0, line=False,
        )  # fmt: skip
        starts += [there, replace(there, rate=math.inf)]
    coarse = sorted((_best_around(samples, one) for one in starts), key=lambda one: -one.log_likelihood)
    quick = sorted((refined(samples, one, (), 200, 1) for one in coarse[:4]), key=lambda one: -one.log_likelihood)
    return max((refined(samples, one) for one in quick[:2]), key=lambda one: one.log_likelihood)


def _best_around(samples: Samples, start: Slip) -> Slip:
    tried = (
        replace(start, rest=rest, landing_scatter=landing, threshold_scatter=scatter)
        for rest in RESTS
        for landing in (start.noise, 0.1 * start.half)
        for scatter in (start.noise, 0.05 * start.half)
    )
    return max((_rated(samples, one) for one in tried), key=lambda one: one.log_likelihood)


def band_interval(samples: Samples, slip: Slip) -> tuple[float, float]:
    """95 % interval of the full dead band by the profile likelihood, widened where the rows depend on each other."""
    step = 0.02
    above, below = (rows_of(samples, replace(slip, half=slip.half * factor)) for factor in (1.0 + step, 1.0 - step))
    drop = 0.5 * NORMAL_BAND * long_run_ratio(above - below)
    ends = []
    for side in (-1.0, 1.0):
        width, inside = 0.01, slip
        for _ in range(9):
            half = inside.half * math.exp(side * width)
            one = refined(samples, replace(inside, half=half), ("half",), 150, 1)
            if one.log_likelihood < slip.log_likelihood - drop:
                break
            inside, width = one, 1.7 * width
        ends.append(2.0 * inside.half * math.exp(0.5 * side * width))
    return ends[0], ends[1]
