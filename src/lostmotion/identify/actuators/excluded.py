"""The largest size of every kind of lost motion that a record does not exclude.

A size is excluded where the best model with it, everything else refitted, is less likely than the linear one by what a
one-sided test of 5 % asks for (limits of this kind: Cowan, Cranmer, Gross and Vitells, Eur. Phys. J. C 71 (2011) 1554).
Sizes are tried from the range of OP downwards, and the first that is not excluded is the answer, even where smaller
ones are: the likelihood of a memory has many hills.
"""

from __future__ import annotations

from dataclasses import replace
from weakref import finalize

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.held_family import HeldFamily, SlidingFamily
from lostmotion.identify.actuators.kind import Kind, faults
from lostmotion.identify.likelihood.beside import Beside
from lostmotion.identify.likelihood.criterion import cost_of_parameters
from lostmotion.identify.likelihood.family import Family, LinearFamily
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.likelihood.refinement import refine

FALL = 0.5 * 1.645**2  # of log-likelihood
STEP = 0.8  # of one size to the next
SMALLEST = 1e-3  # of the range of OP
HALVINGS = 3  # of the last step
STEPS = 40  # of the refinement at each size
KEPT = 2  # fits beside which sizes are tried by turns
REFINED = 2  # forms of a size: the best before the refinement

Fits = dict[str, Fitted]
_made: dict[int, Beside] = {}  # of the fits asked for last


def largest_sizes(linear: Fitted, fits: Fits) -> dict[str, float]:
    """Largest size of every kind that has one, in scaled units of OP; inf where a valve that never moves is as likely.

    Parameters
    ----------
    linear : Fitted
        The linear model, with its loads.
    fits : dict of Fitted
        Of the kinds, where there are some: the process that belongs to a fault may have another structure.
    """
    kinds = [kind for kind in faults() if kind.size is not None]
    return {kind.name: _Sizes(linear, kind, fits.get(kind.name)).largest() for kind in kinds}


class _Sizes:
    """Sizes of one kind."""

    def __init__(self, linear: Fitted, kind: Kind, found: Fitted | None) -> None:
        self.linear, self.kind = linear, kind
        self.bases = [linear] if found is None else [linear, found]
        self.span = float(np.ptp(linear.problem.u))

    def largest(self) -> float:
        """From the range of OP downwards, then between the last two."""
        size, above, smallest = self.span, np.inf, SMALLEST * self.span
        while size > smallest and self._excluded(size):
            size, above = STEP * size, size
        if size == self.span:
            return float(np.inf)
        for _ in range(HALVINGS if size > smallest else 0):
            middle = float(np.sqrt(size * above))
            if self._excluded(middle):
                above = middle
            else:
                size = middle
        return size

    def _excluded(self, size: float) -> bool:
        """Whether no form of this size is as likely."""
        return all(self._behind(base, size) for base in self.bases)

    def _behind(self, base: Fitted, size: float) -> bool:
        """The same, beside the process, noise and loads of one fit."""
        forms = [_Held.on(base, self.kind, family, own) for family, own in self.kind.of_size(base.problem, size)]
        forms.sort(key=lambda form: form.cost)
        limit = self._limit(base)
        return not any(form.reaches(limit) for form in forms[:REFINED])

    def _limit(self, base: Fitted) -> float:
        """Sum of squares beside a fit that is FALL behind the linear model; its own structure is paid for (BIC)."""
        linear, n = self.linear, base.problem.errors
        own = len(base.problem.family.own) * float(np.log(n))
        paid = cost_of_parameters(base, n) - own - cost_of_parameters(linear, n)
        return n * linear.fit.cost / linear.problem.errors * float(np.exp((2.0 * FALL - paid) / n))


class _Held:
    """A model with the size of its actuator held, begun at a fit with the best gain and level."""

    def __init__(self, base: Fitted, kind: Kind, family: Family, own: FloatArray) -> None:
        self.kind, self.basis = kind, _basis_without_actuator(base)
        self.problem = _with_actuator(base, HeldFamily(family, family.valid(own)))
        self.theta, self.cost = _beside(base).settled(self.problem, np.zeros(0))

    @classmethod
    def on(cls, base: Fitted, kind: Kind, family: Family, own: FloatArray) -> _Held:
        """With this actuator in the place of its own."""
        return cls(base, kind, family, own)

    def reaches(self, limit: float) -> bool:
        """Whether it can be refined to a sum of squares that is not above a limit."""
        return self.cost <= limit or self._refined(limit) <= limit

    def refined(self, limit: float) -> float:
        """Sum of squares with everything else refined; as begun, where that is not above a limit."""
        return self.cost if self.cost <= limit else self._refined(np.inf)

    def _refined(self, bound: float) -> float:
        """The same, where the actuator lies as well, as long as OP meets it; above a bound it is not exact."""
        problem, theta, basis, held = self.problem, self.theta, self.basis, self.problem.family
        assert isinstance(held, HeldFamily)  # noqa: S101  as it was made
        for slide in self.kind.slides:
            sliding = SlidingFamily(held.actuator, held.at, np.array(slide), load=held.load, loads=held.loads)
            fit = refine(
                replace(problem, family=sliding), np.insert(theta, problem.eta_at, 0.0), self._with_slide(), STEPS,
                tied=True, bound=bound,
            )  # fmt: skip
            place = sliding.slid(fit.theta[problem.eta_at :])
            met = self.kind.met_by(problem.u, place)
            if fit.cost > bound or np.array_equal(met, place):
                return fit.cost
            theta = np.delete(fit.theta, problem.eta_at)
            problem = replace(problem, family=replace(held, at=met))
        return refine(problem, theta, basis, STEPS, tied=True, bound=bound).cost

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
