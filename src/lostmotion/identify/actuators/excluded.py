"""The largest size of every kind of lost motion that a record does not exclude.

A size is excluded where the best model with it, everything else refitted, is less likely than the linear one by what a
one-sided test of 5 % asks for (limits of this kind: Cowan, Cranmer, Gross and Vitells, Eur. Phys. J. C 71 (2011) 1554).
Sizes are tried from the range of OP downwards, and the first that is not excluded is the answer, even where smaller
ones are: the likelihood of a memory has many hills. Where OP is noisy the sizes of a memory are tried behind a lag as
well (:mod:`.actuator_lag`): a size is excluded only if it is so with every pole.
"""

from __future__ import annotations

import numpy as np

from lostmotion.identify.actuators.actuator_lag import behind_pole, op_noise
from lostmotion.identify.actuators.held_size import HeldSize
from lostmotion.identify.actuators.kind import Kind, faults
from lostmotion.identify.likelihood.criterion import cost_of_parameters
from lostmotion.identify.likelihood.fitted import Fitted

FALL = 0.5 * 1.645**2  # of log-likelihood
STEP = 0.8  # of one size to the next
# of log-likelihood behind: then the next one, two or three sizes are looked at only if the one after them is open. Of
# 342 ladders of 80 simulated loops all ended where they do with every size looked at, with limits of 20, 60 and 200 too
HOPELESS = (30.0, 100.0, 200.0)
SMALLEST = 1e-3  # of the range of OP
HALVINGS = 3  # of the last step
POLES = (0.3, 0.5, 0.7)  # of a lag in front of a valve with a memory, behind which sizes are tried as well
NOISE = 3.0  # deviations of OP's noise: a size that is smaller may be hidden by a lag that takes this noise away
REACH = 5.0  # of such deviations: what a lag adds to an open size, 1.8 times at most in simulated loops
REFINED = 2  # forms of a size: the best before the refinement

Fits = dict[str, Fitted]


def largest_sizes(linear: Fitted, fits: Fits, ahead: float = 0.0) -> dict[str, float]:
    """Largest size of every kind that has one, in scaled units of OP; inf where a valve that never moves is as likely.

    Parameters
    ----------
    linear : Fitted
        The linear model, with its loads.
    fits : dict of Fitted
        Of the kinds, where there are some: the process that belongs to a fault may have another structure.
    ahead : float
        Log-likelihood by which what was found is surely ahead of the linear model; sizes are excluded behind that.
    """
    kinds = [kind for kind in faults() if kind.size is not None]
    found = {kind.name: _Sizes(linear, kind, fits.get(kind.name), ahead=ahead).largest() for kind in kinds}
    noise = op_noise(linear.problem)
    noisy = [kind for kind in kinds if kind.sticks and NOISE * noise > found[kind.name]]
    for behind in (behind_pole(linear, pole) for pole in POLES if noisy):
        for kind in noisy:
            known = found[kind.name]
            found[kind.name] = _Sizes(linear, kind, None, behind, ahead).largest(known, known + REACH * noise)
    return found


def nothing_excluded() -> dict[str, float]:
    """Of a record that does not show that OP moves PV."""
    return {kind.name: float(np.inf) for kind in faults() if kind.size is not None}


class _Sizes:
    """Sizes of one kind."""

    def __init__(
        self, linear: Fitted, kind: Kind, found: Fitted | None, behind: Fitted | None = None, ahead: float = 0.0
    ) -> None:
        self.linear, self.kind, self.ahead = linear, kind, ahead
        self.bases = [behind or linear] if found is None else [behind or linear, found]
        self.span = float(np.ptp(linear.problem.u))

    def largest(self, known: float = 0.0, most: float = np.inf) -> float:
        """From the range of OP downwards, then between the last two.

        Not below a size that is known to be open, nor above one that is not thought of.
        """
        size, above, smallest = min(self.span, most), np.inf, max(SMALLEST * self.span, known)
        passed: list[float] = []  # sizes that were not looked at, largest first
        while size > smallest and (behind := self._behind(size)) > 0.0:
            above, size, passed = size, STEP * size, []
            while len(passed) < int(np.searchsorted(HOPELESS, behind)) and STEP * size > smallest:
                passed.append(size)
                size *= STEP
        for one in passed:
            if not self._excluded(one):
                size = one
                break
            above = one
        if above == np.inf:
            return size if size < self.span else above
        if size <= known:
            return known
        for _ in range(HALVINGS if size > smallest else 0):
            middle = float(np.sqrt(size * above))
            if self._excluded(middle):
                above = middle
            else:
                size = middle
        return size

    def _excluded(self, size: float) -> bool:
        """Whether no form of this size is as likely."""
        return self._behind(size) > 0.0

    def _behind(self, size: float) -> float:
        """Log-likelihood by which the best form of it is surely behind; 0 where one is as likely."""
        least = np.inf
        for base in self.bases:
            limit = self._limit(base)
            for form in self._forms(base, size):
                least = min(least, form.behind(limit))
                if least == 0.0:
                    return 0.0
        return least

    def _forms(self, base: Fitted, size: float) -> list[HeldSize]:
        """The best of it before their refinement, beside the process, noise and loads of one fit."""
        forms = [HeldSize.on(base, self.kind, family, own) for family, own in self.kind.of_size(base.problem, size)]
        return sorted(forms, key=lambda form: form.cost)[:REFINED]

    def _limit(self, base: Fitted) -> float:
        """Sum of squares beside a fit that is FALL behind the linear model; its own structure is paid for (BIC)."""
        linear, n = self.linear, base.problem.errors
        own = len(base.problem.family.own) * float(np.log(n))
        paid = cost_of_parameters(base, n) - own - cost_of_parameters(linear, n)
        return n * linear.fit.cost / linear.problem.errors * float(np.exp((2.0 * (FALL - self.ahead) - paid) / n))
