"""A model in which the size of the actuator is held and everything else refitted."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from weakref import finalize

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.held_family import HeldFamily, SlidingFamily
from lostmotion.identify.actuators.kind import Kind
from lostmotion.identify.likelihood.beside import Beside
from lostmotion.identify.likelihood.family import Family, LinearFamily
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.likelihood.refinement import refine
from lostmotion.identify.likelihood.remembered import remembered

STEPS = 40  # of the refinement at each size
NEARLY = 0.02  # variances: twice the log-likelihood that it may be short of, of the 1.35 by which a size is excluded
KEPT = 2  # fits beside which sizes are tried by turns

_made: dict[int, Beside] = {}  # of the fits asked for last


class HeldSize:
    """A model with the size of its actuator held, begun at a fit with the best gain and level."""

    def __init__(self, base: Fitted, kind: Kind, family: Family, own: FloatArray) -> None:
        self.kind, self._base = kind, base
        self._held = HeldFamily(family, family.valid(own))
        self.theta, self.cost = _beside(base).settled(self._held, np.zeros(0))

    @classmethod
    def on(cls, base: Fitted, kind: Kind, family: Family, own: FloatArray) -> HeldSize:
        """With this actuator in the place of its own."""
        return cls(base, kind, family, own)

    @cached_property
    def problem(self) -> Problem:
        """With this actuator; few of many are refined."""
        return _with_actuator(self._base, self._held)

    @cached_property
    def basis(self) -> FloatArray | None:
        """Free directions."""
        return _basis_without_actuator(self._base)

    def behind(self, limit: float) -> float:
        """Log-likelihood that is missing to a sum of squares, refined as long as that may do; 0 where it is reached."""
        cost = self.cost if self.cost <= limit else self._refined(limit)
        return 0.0 if cost <= limit else 0.5 * self.problem.errors * float(np.log(cost / limit))

    def refined(self, limit: float) -> float:
        """Sum of squares with everything else refined; as begun, where that is not above a limit.

        Where it slides away from OP and is brought back, the end can be worse than the beginning, which then counts.
        """
        return self.cost if self.cost <= limit else min(self._refined(np.inf), self.cost)

    def _refined(self, bound: float) -> float:
        """The same, where the actuator lies as well, as long as OP meets it; above a bound it is not exact."""
        problem, theta, basis, held = self.problem, self.theta, self.basis, self._held
        asked = bound < np.inf  # only whether it is reached
        target, tolerance = (bound, NEARLY) if asked else (-np.inf, 0.0)
        beside = problem.family
        for slide in self.kind.slides:
            sliding = SlidingFamily(held.actuator, held.at, np.array(slide), load=beside.load, loads=beside.loads)
            fit = refine(
                replace(problem, family=sliding), np.insert(theta, problem.eta_at, 0.0), self._with_slide(), STEPS,
                tied=True, bound=bound, target=target, tolerance=tolerance,
            )  # fmt: skip
            place = sliding.slid(fit.theta[problem.eta_at :])
            met = self.kind.met_by(problem.u, place)
            if fit.cost > bound or np.array_equal(met, place):
                return fit.cost
            theta = np.delete(fit.theta, problem.eta_at)
            problem = replace(problem, family=replace(held, at=met, load=beside.load, loads=beside.loads))
        return refine(problem, theta, basis, STEPS, tied=True, bound=bound, target=target, tolerance=tolerance).cost

    def _with_slide(self) -> FloatArray | None:
        """Free directions with that in which the actuator slides."""
        if self.basis is None:
            return None
        more = np.insert(np.insert(self.basis, self.problem.eta_at, 0.0, axis=0), 0, 0.0, axis=1)
        more[self.problem.eta_at, 0] = 1.0
        return more


def _with_actuator(base: Fitted, family: Family) -> Problem:
    """The problem of a fit with another actuator beside its loads."""
    beside = base.problem.family
    return replace(base.problem, family=replace(family, load=beside.load, loads=beside.loads))


@remembered
def _basis_without_actuator(base: Fitted) -> FloatArray | None:
    """Free directions of a fit without its actuator; None: all."""
    mine = list(base.problem.own)
    if base.basis is None:
        return None
    return np.delete(base.basis[:, ~np.any(base.basis[mine] != 0.0, axis=0)], mine, axis=0)


def _beside(base: Fitted) -> Beside:
    """All but the actuator of a fit; of those made last it is kept while the fit is."""
    key = id(base)
    if key not in _made:
        for oldest in list(_made)[: 1 - KEPT]:
            _made.pop(oldest, None)
        theta = np.delete(base.fit.theta, list(base.problem.own))
        problem = _with_actuator(base, HeldFamily(LinearFamily(), np.zeros(0)))
        _made[key] = Beside(problem, theta, _basis_without_actuator(base))
        finalize(base, _made.pop, key, None)
    return _made[key]
