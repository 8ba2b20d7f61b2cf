"""Another actuator in the place of that of a fit, with everything refined."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.criterion import cost_of_equal
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.likelihood.refinement import LocalFit, refine, settled


def in_place_of(base: Fitted, family: Family, own: FloatArray, score: float) -> Fitted:
    """A family with these own parameters in the place of the actuator of a fit, refined.

    Not to its end where it stays far above the criterion `score` for each row.
    """
    begun = placed(base, family, own)
    return refined(begun.problem, begun.fit.theta, begun.basis, score)


def placed(base: Fitted, family: Family, own: FloatArray) -> Fitted:
    """The same where it begins: all that is linear is settled."""
    problem, mine, at = base.problem, list(base.problem.own), base.problem.eta_at
    family = replace(family, load=problem.family.load, loads=problem.family.loads)
    theta = np.insert(np.delete(base.fit.theta, mine), [at] * own.size, own)
    basis = None
    if base.basis is not None:
        others = np.delete(base.basis[:, ~np.any(base.basis[mine] != 0.0, axis=0)], mine, axis=0)
        free = np.eye(theta.size)[:, at : at + own.size]
        basis = np.hstack([np.insert(others, [at] * own.size, 0.0, axis=0), free])
    problem = replace(problem, family=family)
    theta = settled(problem, theta, basis)
    cost = float(sum(errors @ errors for errors in problem.predict(theta)[1]))
    return Fitted(problem, LocalFit(theta, cost, np.zeros((0, 0)), 0, False), basis)


def refined(problem: Problem, theta: FloatArray, basis: FloatArray | None, score: float, tied: bool = False) -> Fitted:
    """Refined, but not to its end where it stays far above a criterion for each row."""
    begun = Fitted(problem, LocalFit(theta, np.inf, np.zeros((0, 0)), 0, False), basis)
    return replace(begun, fit=refine(problem, theta, basis, tied=tied, bound=cost_of_equal(begun, score)))
