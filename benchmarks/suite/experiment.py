"""The paper's experiment, and how an answer to it is scored."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import lostmotion as lm
from lostmotion.evaluate import cramer_rao

TANK = lm.platforms.level_tank()
GAIN = TANK.linear.gain
DT = TANK.linear.dt
ORDERS = (3, 2, 3)
VARIANCE = 0.03
TRUTH = np.array([-1.0, 1.0, 1.0])
NAMES = ("left", "right", "slope_ratio")
CONVERGED = 0.3  # largest error of either break point and of the slope ratio
ROUTINE_SAMPLES = 6000
FRESH_SAMPLES, FRESH_SEED = 5000, 999_999
Array = np.ndarray


def record(samples: int, seed: int) -> tuple[Array, Array]:
    """Command and noisy output: PRS -5 .. 5, hold 10, white noise."""
    u = lm.signals.prs(samples, -5.0, 5.0, hold=10, seed=seed)
    noise = np.random.default_rng(seed + 10_000).normal(scale=VARIANCE**0.5, size=samples)
    return u, TANK.simulate(u) + noise


def routine(seed: int) -> tuple[Array, Array]:
    """The same tank as it runs every day: PI loop, set-point moves, mild drift, no test signal."""
    loop = lm.routine_operation(ROUTINE_SAMPLES, "mild", seed)
    return loop.command, loop.measured


def fresh() -> tuple[Array, Array]:
    """Command of another seed and the output without noise."""
    u = lm.signals.prs(FRESH_SAMPLES, -5.0, 5.0, hold=10, seed=FRESH_SEED)
    return u, TANK.simulate(u)


def fit_percent(y: Array, simulated: Array) -> float:
    """100 (1 - |y - simulated| / |y - mean y|)."""
    return float(100.0 * (1.0 - np.linalg.norm(y - simulated) / np.linalg.norm(y - y.mean())))


def bound(commands: list[Array], offset: str) -> Array:
    """Root mean square over the records of the Cramer-Rao bounds of left, right and slope ratio."""
    each = [cramer_rao(TANK, u, VARIANCE, gain=GAIN, offset=offset) for u in commands]
    return np.sqrt(np.mean([[one[name] ** 2 for name in NAMES] for one in each], axis=0))


@dataclass(frozen=True)
class Answers:
    """What one method made of its seeds: zone (seeds, 3), simulated fresh output (seeds, m), seconds (seeds,)."""

    zone: Array
    simulated: Array
    seconds: Array

    @property
    def converged(self) -> Array:
        """Seeds with a usable answer."""
        return np.all(np.abs(self.zone - TRUTH) < CONVERGED, axis=1)

    @property
    def rmse(self) -> Array:
        """Of left, right and slope ratio over the converged seeds."""
        return np.sqrt(np.mean((self.zone[self.converged] - TRUTH) ** 2, axis=0))

    @property
    def typical(self) -> float:
        """Median error of the break points over all seeds; half the width of the dead zone is 1."""
        return float(np.median(np.abs(self.zone - TRUTH)[:, :2]))

    def fits(self) -> Array:
        """Fit in % on the fresh data, every seed."""
        truth = fresh()[1]
        return np.array([fit_percent(truth, one) for one in self.simulated])
