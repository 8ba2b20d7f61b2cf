"""From data and a family to the global maximum of the likelihood: starts, noise order, refinement."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from lostmotion.identify.batch import LocalFit, refine
from lostmotion.identify.families import Family
from lostmotion.identify.noise_order import choose_noise
from lostmotion.identify.problem import Problem, Structure
from lostmotion.identify.start import HighOrderArx, fit_arx
from lostmotion.identify.structure import Start, given_structure, likely_structures, neighbours, plausible
from lostmotion.models._arguments import FloatArray

_Attempt = tuple[FloatArray, Start, HighOrderArx]

START_NOISE_LAGS = 15
MOST_ROUNDS = 4
IMPLAUSIBLE = 1e12
RIVAL = 20.0  # BIC of rough fits: less than this apart is told to the reader
APART = 0.3  # deviations of OP between the break points of two rivals
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
    basis: FloatArray | None = None  # directions that were free; None: all
    rivals: tuple[tuple[FloatArray, float], ...] = ()  # other actuators that fit about as well, and by how much less

    @property
    def variance(self) -> float:
        """Residual variance, corrected for the parameters."""
        return self.fit.cost / max(self.problem.errors - self.free, 1)

    @property
    def free(self) -> int:
        """Free parameters, initial conditions included."""
        return self.fit.theta.size if self.basis is None else self.basis.shape[1]

    @property
    def parameters(self) -> int:
        """Free parameters without initial conditions."""
        return self.free - (self.fit.theta.size - self.problem.initial_at)

    def output_residual(self) -> list[FloatArray]:
        """Measured minus simulated output, from row `first` of each segment."""
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
    search = _Search(data, family, orders, noise)
    best = search.over([pair for eta in etas for pair in search.likely(eta)])
    if orders is None:
        best = search.improve(best)
    d = best.fit.theta[best.problem.noise_at : best.problem.initial_at]
    if noise is None:
        d = choose_noise(best.output_residual())
    s = best.problem.structure
    if not (best.fit.converged and d.size == s.noise_order and s.start == s.delay + s.noise_order):
        best = refined(data, family, best, d)
    return replace(best, rivals=search.rivals())


def refined(data: ScaledData, family: Family, best: Fitted, d: FloatArray) -> Fitted:
    """Converged fit with noise start d, on all rows that its structure allows."""
    s = best.problem.structure
    theta = best.fit.theta
    problem = Problem(data.u, data.y, data.segments, family, Structure(s.na, s.nb, s.delay, d.size, s.delay + d.size))
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


@dataclass(frozen=True)
class _Search:
    """Rough fits of many structures on common rows, compared by their information criterion."""

    data: ScaledData
    family: Family
    orders: tuple[int, int, int] | None
    noise: int | None
    seen: list[tuple[FloatArray, float]] = field(default_factory=list)

    def likely(self, eta: FloatArray) -> list[_Attempt]:
        """The structures to try for one start of the actuator."""
        arx = self._arx(eta)
        if self.orders is not None:
            return [(eta, given_structure(arx, *self.orders), arx)]
        return [(eta, start, arx) for start in likely_structures(arx)]

    def over(self, attempts: list[_Attempt]) -> Fitted:
        """Best of the attempts; all are remembered."""
        fits = [self._rough(*attempt) for attempt in attempts]
        for fitted in fits:
            eta = fitted.fit.theta[fitted.problem.eta_at : fitted.problem.noise_at]
            self.seen.append((eta, self._score(fitted)))
        return min(fits, key=self._score)

    def rivals(self) -> tuple[tuple[FloatArray, float], ...]:
        """Actuators other than the best that came within RIVAL of it, best first, one for each place."""
        if not self.seen or not self.seen[0][0].size:
            return ()
        ordered = sorted(self.seen, key=lambda item: item[1])
        best = ordered[0][1]
        kept = [ordered[0][0]]
        found = []
        for eta, score in ordered[1:]:
            if score - best > RIVAL:
                break
            if all(np.abs(eta[:2] - other[:2]).max() > APART for other in kept):
                kept.append(eta)
                found.append((eta, score - best))
        return tuple(found)

    def improve(self, best: Fitted) -> Fitted:
        """Look again from the actuator found, then at neighbouring structures, while it helps."""
        for _ in range(MOST_ROUNDS):
            s = best.problem.structure
            eta = best.fit.theta[best.problem.eta_at : best.problem.noise_at]
            arx = self._arx(eta)
            tried = [(eta, start, arx) for start in neighbours(arx, s.na, s.nb, s.delay)]
            if eta.size:
                tried += self.likely(eta)
            challenger = self.over(tried)
            if self._score(challenger) > self._score(best) - 1.0:
                break
            best = challenger
        return best

    def _score(self, fitted: Fitted) -> float:
        """Information criterion; orders that were chosen here, not given, must also be plausible."""
        a = fitted.fit.theta[: fitted.problem.structure.na]
        return _criterion(fitted) + (0.0 if self.orders is not None or plausible(a) else IMPLAUSIBLE)

    def _arx(self, eta: FloatArray) -> HighOrderArx:
        data = self.data
        x, dx = np.empty(data.u.size), np.empty((len(self.family.names), data.u.size))
        self.family.evaluate(eta, data.u, x, dx)
        if self.orders is None:
            return fit_arx(x, data.y, data.segments, 1, AUTO_LAGS)
        return fit_arx(x, data.y, data.segments, self.orders[2])

    def _rough(self, eta: FloatArray, start: Start, arx: HighOrderArx) -> Fitted:
        latest = AUTO_LAGS if self.orders is None else start.delay
        latest = min(latest, max(self.data.shortest // 10, start.delay))
        p = self.noise
        if p is None:
            p = max(min(START_NOISE_LAGS, (self.data.shortest - latest) // 20), 0)
        structure = Structure(start.na, start.nb, start.delay, p, latest + p)
        problem = Problem(self.data.u, self.data.y, self.data.segments, self.family, structure)
        d = np.zeros(p)
        shared = min(p, arx.a.size)
        d[:shared] = arx.a[:shared]
        theta = problem.pack(start.a, start.b, eta, d, 0.0)
        return Fitted(problem, refine(problem, theta, most_steps=ROUGH_STEPS))
