"""What a sampled process under a PI controller can be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels import linear as kernel

LEAST_DAMPING = 0.1  # of a complex pair; valves and processes have 0.3 and more
LATE = np.array([100, 300])  # samples; a slow ramp must not make up for what is lost soon
LEAST_LASTING = 0.5  # of the peak of the step response that is there on average in the later half of this time
LARGEST_INVERSE = 0.3  # of that peak: how far the response goes the other way at first
TRIES = 30  # candidates that are looked at for one that is allowed
SLOWEST_RINGING = 0.5  # largest negative real pole; a sampled continuous process has none


@dataclass(frozen=True)
class Held:
    """What is known of a process because a controller with integral action holds it.

    Without moves of the set point the inverse of the controller, -(1 - q^-1) / (kp + ki - kp q^-1), explains PV as well
    as the process does (Ljung, 2nd ed., section 13.4), and with a memory in front of it, better: it then is a filter of
    PV that keeps steps and drops noise. But hardly anything is left of its response to a step, and it is negative
    where the process must be positive.

    Attributes
    ----------
    closed : bool
        Whether a controller is at work. If not, anything is allowed.
    direction : int
        Sign of its answer to PV; 0 where that is not sure.
    """

    closed: bool = False
    direction: int = 0

    @property
    def rules(self) -> tuple[IntArray, float, float, int]:
        """What a response to a step must do where a controller is at work, as the kernels take it."""
        return LATE, LEAST_LASTING, LARGEST_INVERSE, self.direction

    def allows(self, a: FloatArray, b: FloatArray) -> bool:
        """Whether such a process can be B / A."""
        if not self.closed:
            return True
        return bool(kernel.step_lasts(np.ascontiguousarray(a), np.ascontiguousarray(b), *self.rules))

    def best_allowed(self, rss: FloatArray, chosen: IntArray, polynomials: FloatArray, b: FloatArray) -> IntArray:
        """For every column of `rss` (m, columns) the best of the rows `chosen` that is allowed; -1 where none is.

        `polynomials` is (m, na), `b` (m, columns, nb + 1).
        """
        if not self.closed:
            return np.asarray(chosen[np.argmin(rss[chosen], axis=0)])
        best = np.empty(rss.shape[1], np.int64)
        kernel.best_lasting(rss.copy(), chosen, polynomials, np.ascontiguousarray(b), *self.rules, TRIES, best)
        return best


FREE = Held()


def plausible(a: FloatArray) -> bool:
    """Whether a sampled process can have these poles: no ringing at half the sampling rate, some damping.

    Where a record says little, the likelihood likes poles on the unit circle that copy the loop's oscillation.
    """
    if a.size <= kernel.FEW:
        return not bool(kernel.rings(np.ascontiguousarray(a), LEAST_DAMPING, SLOWEST_RINGING))
    return not any(kernel.pole_rings(pole, LEAST_DAMPING, SLOWEST_RINGING) for pole in np.roots(np.append(1.0, a)))


def slowest(a: FloatArray) -> float:
    """Largest radius of the poles; 0 where there are none."""
    poles = kernel.few_poles(np.ascontiguousarray(a)) if a.size <= kernel.FEW else np.roots(np.append(1.0, a))
    return float(np.abs(poles).max(initial=0.0))
