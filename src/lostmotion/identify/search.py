"""From data and a family to the global maximum of the likelihood: starts, noise order, refinement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lostmotion.identify.batch import LocalFit, refine
from lostmotion.identify.families import Family
from lostmotion.identify.noise_order import choose_noise
from lostmotion.identify.problem import Problem, Structure
from lostmotion.identify.start import HighOrderArx, fit_arx
from lostmotion.identify.structure import Start, given_structure, likely_structures
from lostmotion.models._arguments import FloatArray

START_NOISE_LAGS = 15
ROUGH_STEPS = 15
AUTO_LAGS = 30  # past inputs where the delay is unknown


@dataclass(frozen=True)
class ScaledData:
    """u and y with mean 0 and deviation 1, and the segments."""

    u: FloatArray
    y: FloatArray
    segments: npt.NDArray[np.int64]

    @property
    def shortest(self) -> int:
        """Samples of the shortest segment."""
        return int((self.segments[:, 1] - self.segments[:, 0]).min())


@dataclass(frozen=True)
class Fitted:
    """A problem and the maximum of its likelihood."""

    problem: Problem
    fit: LocalFit

    @property
    def variance(self) -> float:
        """Residual variance, corrected for the parameters."""
        return self.fit.cost / max(self.problem.errors - self.fit.theta.size, 1)

    @property
    def parameters(self) -> int:
        """Parameters without initial conditions."""
        return self.problem.initial_at

    def output_residual(self) -> list[FloatArray]:
        """y minus simulated output, from row `first` of each segment."""
        simulated, _ = self.problem.predict(self.fit.theta)
        first = self.problem.structure.first
        return [
            self.problem.y[start + first : stop] - z
            for (start, stop), z in zip(self.problem.segments, simulated, strict=True)
        ]


def best_fit(
    data: ScaledData,
    family: Family,
    etas: list[FloatArray],
    orders: tuple[int, int, int] | None,
    noise: int | None,
) -> Fitted:
    """Refine from every start of the actuator and every likely structure; then settle the noise order.

    Parameters
    ----------
    data : ScaledData
    family : Family
    etas : list of ndarray
        Starts of the actuator parameters.
    orders : (na, nb, delay) or None
        None: chosen from the data.
    noise : int or None
        Order of the AR noise; None: chosen from the data.
    """
    rough = [
        (eta, start, arx)
        for eta in etas
        for start, arx in _linear_starts(data, family, eta, orders)
    ]
    p = _noise_lags(data, max(start.delay for _, start, _ in rough), noise)
    common = max(start.delay for _, start, _ in rough) + p
    fits = [_rough_fit(data, family, eta, start, arx, p, common) for eta, start, arx in rough]
    best = min(fits, key=_criterion)
    d = best.fit.theta[best.problem.noise_at : best.problem.initial_at]
    if noise is None:
        d = choose_noise(best.output_residual())
    return refined(data, family, best, d)


def refined(data: ScaledData, family: Family, best: Fitted, d: FloatArray) -> Fitted:
    """Converged fit with noise start d, on all rows that its structure allows."""
    s = best.problem.structure
    theta = best.fit.theta
    problem = Problem(
        data.u, data.y, data.segments, family, Structure(s.na, s.nb, s.delay, d.size, s.delay + d.size)
    )
    start = problem.pack(
        theta[: s.na],
        theta[s.na : s.na + s.nb + 1],
        theta[best.problem.eta_at : best.problem.noise_at],
        d,
        theta[best.problem.eta_at - 1],
    )
    return Fitted(problem, refine(problem, start))


def _criterion(fitted: Fitted) -> float:
    """Bayesian information criterion."""
    n = fitted.problem.errors
    return float(n * np.log(max(fitted.fit.cost, 1e-300)) + fitted.parameters * np.log(n))


def _linear_starts(
    data: ScaledData, family: Family, eta: FloatArray, orders: tuple[int, int, int] | None
) -> list[tuple[Start, HighOrderArx]]:
    x, dx = np.empty(data.u.size), np.empty((data.u.size, len(family.names)))
    family.evaluate(eta, data.u, x, dx)
    if orders is None:
        arx = fit_arx(x, data.y, data.segments, 1, AUTO_LAGS)
        return [(start, arx) for start in likely_structures(arx)]
    arx = fit_arx(x, data.y, data.segments, orders[2])
    return [(given_structure(arx, *orders), arx)]


def _noise_lags(data: ScaledData, delay: int, noise: int | None) -> int:
    if noise is not None:
        return noise
    return max(min(START_NOISE_LAGS, (data.shortest - delay) // 20), 0)


def _rough_fit(
    data: ScaledData, family: Family, eta: FloatArray, start: Start, arx: HighOrderArx, p: int, common: int
) -> Fitted:
    structure = Structure(start.na, start.nb, start.delay, p, common)
    problem = Problem(data.u, data.y, data.segments, family, structure)
    d = np.zeros(p)
    shared = min(p, arx.a.size)
    d[:shared] = arx.a[:shared]
    theta = problem.pack(start.a, start.b, eta, d, 0.0)
    return Fitted(problem, refine(problem, theta, most_steps=ROUGH_STEPS))
