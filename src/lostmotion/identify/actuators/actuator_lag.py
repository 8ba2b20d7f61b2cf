"""A lag in front of the lost motion: pneumatic actuators lag first, and what they drive sticks afterwards.

A model that sends OP into a memory as it is has all lag behind it. The noise of OP, which the lag takes away before it
reaches the play, then turns the modelled valve round at places where the real one has not been, and the size comes out
too large. So the size is also fitted behind one pole,

    v(k) = pole v(k - 1) + (1 - pole) u(k),

and the likelihood says what that counts: the pole is a parameter more, for which PRICE is paid.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.signal import lfilter

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.distributions import chi2_quantile
from lostmotion.identify.likelihood.criterion import FLOOR
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.likelihood.refinement import refine, settled

LEVEL = 0.95  # of the intervals
FALL = 0.5 * chi2_quantile(LEVEL, 1)  # of log-likelihood, from the maximum to the ends of an interval
PRICE = FALL  # of log-likelihood, for the pole: in half of the loops without a lag the interval is then not wider
# gain from which on a lag is said: log(n) / 2 of 2,000 rows (BIC), and 20 to 1 as for a fault. One of 37 loops
# without a lag gains 3.9 by one, eleven of 14 with one gain 7 or more
SEEN = PRICE + FALL + 3.0
DEVIATION = 1.4826  # of Gaussian noise over its median
SLOWEST = 0.95  # pole: with 20 rows of lag it is the process that is slow

Ends = dict[str, tuple[float, float]]


@dataclass(frozen=True)
class Lag:
    """What a lag in front of an actuator leaves of its parameters, all scaled.

    Attributes
    ----------
    pole : float
        Of the likeliest lag, where an actuator without one is rejected, else 0.
    own : ndarray
        The actuator's own parameters with it.
    ends : dict of (float, float)
        Their intervals with all poles that the record does not reject, but 0.
    """

    pole: float = 0.0
    own: FloatArray = field(default_factory=lambda: np.zeros(0))
    ends: Ends = field(default_factory=dict)

    @property
    def rows(self) -> float:
        """Time constant in rows."""
        return -1.0 / float(np.log(self.pole)) if self.pole > 0.0 else 0.0

    def joined(self, plain: Ends, unit: float) -> Ends:
        """Intervals with all poles in units of OP, `unit` of them a scaled one, from those without lag."""
        ends = dict(plain)
        for name, (low, high) in self.ends.items():
            mine = unit * low, unit * high
            without = mine if self.pole > 0.0 else plain.get(name, mine)
            ends[name] = min(mine[0], without[0]), max(mine[1], without[1])
        return ends

    def shown(self, fitted: Fitted) -> Fitted:
        """The model without a lag that comes nearest to the one with it: the same size, all else refined beside it."""
        if self.pole == 0.0:
            return fitted
        problem, theta = fitted.problem, fitted.fit.theta.copy()
        theta[problem.eta_at : problem.own.stop] = self.own
        fit = refine(problem, theta, problem.free_but(problem.own, fitted.basis), tied=True)
        return replace(fitted, fit=replace(fit, converged=fitted.fit.converged))


NO_LAG = Lag()


def lagged(u: FloatArray, segments: IntArray, pole: float) -> FloatArray:
    """OP behind a pole, at rest at the first row of each segment.

    Parameters
    ----------
    u : ndarray, shape (n,)
    segments : ndarray, shape (s, 2)
        Start and stop rows.
    pole : float
        In [0, 1).
    """
    found = u.copy()
    for start, stop in segments.tolist():
        found[start:stop] = u[start] + lfilter([1.0 - pole], [1.0, -pole], u[start:stop] - u[start])
    return found


def behind_pole(fitted: Fitted, pole: float) -> Fitted:
    """The same kind of model with OP behind a pole, refined with the likelier delay."""
    found = []
    for problem in (fitted.problem, earlier(fitted.problem)):
        behind = replace(problem, u=lagged(problem.u, problem.segments, pole))
        theta = settled(behind, fitted.fit.theta, fitted.basis)
        found.append(replace(fitted, problem=behind, fit=refine(behind, theta, fitted.basis)))
    return min(found, key=lambda one: one.fit.cost)


def earlier(problem: Problem) -> Problem:
    """With a delay that is shorter by a row, where it can be: without a lag a part of it was taken for delay."""
    s = problem.structure
    return replace(problem, structure=replace(s, delay=s.delay - 1)) if s.delay > 1 else problem


def op_noise(problem: Problem) -> float:
    """Deviation of what a lag of half a row or more takes away from OP, scaled; moves of set points count little."""
    fast = problem.u - lagged(problem.u, problem.segments, 0.5)
    return DEVIATION * float(np.median(np.abs(fast - np.median(fast))))


def gain_by_lag(without: Fitted, behind: Fitted) -> float:
    """Gain in log-likelihood by a pole, before it is paid for; -inf where what is left without it is rounding."""
    n = without.problem.errors
    if without.fit.cost <= n * FLOOR or behind.fit.cost <= 0.0:
        return float(-np.inf)
    return 0.5 * n * float(np.log(without.fit.cost / behind.fit.cost))


def rise_behind(behind: Fitted, gain: float) -> float:
    """Rise of the sum of squares behind a pole up to the ends of an interval, where it gains so much; below 0: none."""
    return 2.0 * (FALL + min(gain - PRICE, 0.0)) * behind.variance
