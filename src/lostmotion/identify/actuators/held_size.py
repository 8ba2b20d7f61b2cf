"""A model in which the size of the actuator is held and everything else refitted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.kind import Kind
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.likelihood.refinement import refine, settled

STEPS = 40  # of the refinement at each size


class HeldSize:
    """A model with the size of its actuator held, begun at a fit with the best gain and level."""

    def __init__(self, kind: Kind, problem: Problem, theta: FloatArray, basis: FloatArray | None) -> None:
        self.kind, self.problem, self.held = kind, problem, problem.free_but(problem.own, basis)
        self.theta = settled(problem, theta, self.held)
        self.cost = problem.evaluate(self.theta)[0]

    @classmethod
    def on(cls, base: Fitted, kind: Kind, family: Family, own: FloatArray) -> HeldSize:
        """With this actuator in the place of its own."""
        mine, beside = list(base.problem.own), base.problem.family
        problem = replace(base.problem, family=replace(family, load=beside.load, loads=beside.loads))
        basis, theta = base.basis, np.delete(base.fit.theta, mine)
        if basis is not None:
            rest = np.delete(basis[:, ~np.any(basis[mine] != 0.0, axis=0)], mine, axis=0)
            basis = np.insert(rest, [base.problem.eta_at] * own.size, 0.0, axis=0)
        return cls(kind, problem, np.insert(theta, base.problem.eta_at, own), basis)

    def refined(self, limit: float) -> float:
        """Sum of squares with everything else refined, where the actuator lies as well, as long as OP meets it.

        Where it slides away from OP and is brought back, the end can be worse than the beginning, which then counts.
        """
        if self.cost <= limit:
            return self.cost
        problem, own = self.problem, list(self.problem.own)
        along = np.zeros((self.theta.size, len(self.kind.slides)))
        for column, slide in enumerate(self.kind.slides):
            along[own, column] = slide
        fit = refine(problem, self.theta, np.hstack([self.held, along]), STEPS, tied=True)
        met = self.kind.met_by(problem.u, fit.theta[own])
        if np.array_equal(met, fit.theta[own]):
            return min(fit.cost, self.cost)
        theta = fit.theta.copy()
        theta[own] = met
        return min(refine(problem, theta, self.held, STEPS, tied=True).cost, self.cost)
