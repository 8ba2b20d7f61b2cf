"""The largest size of every kind of lost motion that a record does not exclude.

A size is excluded where the best model with it, everything else refitted, is less likely than the linear one by what a
one-sided test of 5 % asks for (limits of this kind: Cowan, Cranmer, Gross and Vitells, Eur. Phys. J. C 71 (2011) 1554).
Sizes are tried from the range of OP downwards, and the first that is not excluded is the answer, even where smaller
ones are: the likelihood of a memory has many hills.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.kind import Kind, faults
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.likelihood.refinement import refine, settled

FALL = 0.5 * 1.645**2  # of log-likelihood
STEP = 0.8  # of one size to the next
SMALLEST = 1e-3  # of the range of OP
HALVINGS = 3  # of the last step
STEPS = 12  # of the refinement at each size
REFINED = 2  # forms of a size: the best before the refinement


def largest_sizes(linear: Fitted) -> dict[str, float]:
    """Largest size of every kind that has one, in scaled units of OP; inf where a valve that never moves is as likely.

    Parameters
    ----------
    linear : Fitted
        The linear model, with its loads.
    """
    return {kind.name: _largest(linear, kind) for kind in faults() if kind.size is not None}


def _largest(linear: Fitted, kind: Kind) -> float:
    span = float(np.ptp(linear.problem.u))
    size, above = span, np.inf
    while size > SMALLEST * span and _excluded(linear, kind, size):
        size, above = STEP * size, size
    for _ in range(HALVINGS if SMALLEST * span < size < span else 0):
        middle = float(np.sqrt(size * above))
        if _excluded(linear, kind, middle):
            above = middle
        else:
            size = middle
    return size if size < span else float(np.inf)


def _excluded(linear: Fitted, kind: Kind, size: float) -> bool:
    """Whether no form of this size is as likely."""
    forms = sorted(
        (_Held.on(linear, family, own) for family, own in kind.of_size(linear.problem, size)),
        key=lambda form: form.cost,
    )
    limit = linear.fit.cost * float(np.exp(2.0 * FALL / linear.problem.errors))
    return all(form.refined() > limit for form in forms[:REFINED])


class _Held:
    """A model with the actuator held, begun at the linear one with the best gain and level."""

    def __init__(self, problem: Problem, theta: FloatArray, basis: FloatArray | None) -> None:
        self.problem, self.basis = problem, problem.free_but(problem.own, basis)
        self.theta = settled(problem, theta, self.basis)
        self.cost = problem.evaluate(self.theta)[0]

    @classmethod
    def on(cls, linear: Fitted, family: Family, own: FloatArray) -> _Held:
        """With this actuator in front of the linear model."""
        at, beside = linear.problem.eta_at, linear.problem.family
        problem = replace(linear.problem, family=replace(family, load=beside.load, loads=beside.loads))
        basis = None if linear.basis is None else np.insert(linear.basis, [at] * own.size, 0.0, axis=0)
        return cls(problem, np.insert(linear.fit.theta, at, own), basis)

    def refined(self) -> float:
        """Sum of squares with everything else refined."""
        return refine(self.problem, self.theta, self.basis, STEPS, tied=True).cost
