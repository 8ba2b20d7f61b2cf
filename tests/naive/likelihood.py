"""Prediction errors of a Hammerstein model with AR noise, and their Jacobian by the complex step."""

from dataclasses import dataclass

import numpy as np

from tests.naive.dead_zone import STEP, actuator
from tests.naive.linear import simulate


@dataclass
class Orders:
    na: int
    nb: int
    ne: int
    p: int
    delay: int
    first: int
    zero: float = 0.0
    early: float = 0.0

    @property
    def initial(self):
        return max(self.na, self.nb) + (self.zero > 0.0)

    def size(self, segments):
        return self.na + self.nb + 1 + 1 + self.ne + self.p + self.initial * segments


def unpack(theta, orders, segments):
    """A, B, offset, eta, D, and the initial conditions of each segment."""
    sizes = [orders.na, orders.nb + 1, 1, orders.ne, orders.p, *([orders.initial] * segments)]
    parts = np.split(np.asarray(theta), np.cumsum(sizes)[:-1])
    a, b, offset, eta, d = parts[:5]
    return a, b, offset[0], eta, d, parts[5:]


def segment_errors(a, b, c, offset, d, delay, first, x, y, zero=0.0, early=0.0):
    """Simulated output from row `first` on, and the errors e = D v from row first + p on, of one segment.

    Before `first` the delayed input and the output of the process count as zero, and the noise, where the rows before
    first + p count, by the root of the weight `early`.
    """
    acting = np.array([x[k - delay] for k in range(first, len(y))])
    forcing = c if zero == 0.0 else simulate([-zero], [1.0], 0, np.append(c, np.zeros(len(acting) - len(c))))
    z = simulate(a, b, 0, acting, forcing=forcing)
    v = [y[first + k] - offset - z[k] for k in range(len(z))]
    p = len(d)
    errors = [v[k] + sum(d[i - 1] * v[k - i] for i in range(1, min(p, k) + 1)) for k in range(len(v))]
    begun = [early**0.5 * e for e in errors[:p]] if early else []
    return z + offset, np.array(begun + errors[p:])


def all_errors(theta, orders, segments, u, y):
    """Errors of all segments, one after the other."""
    a, b, offset, eta, d, initial = unpack(theta, orders, len(segments))
    parts = []
    for c, (start, stop) in zip(initial, segments, strict=True):
        x = actuator(eta, u[start:stop])
        more = x, y[start:stop], orders.zero, orders.early
        parts.append(segment_errors(a, b, c, offset, d, orders.delay, orders.first, *more)[1])
    return np.concatenate(parts)


def jacobian(theta, orders, segments, u, y):
    """Derivatives of all errors with respect to theta."""
    columns = []
    for i in range(len(theta)):
        moved = np.array(theta, dtype=complex)
        moved[i] += 1j * STEP
        columns.append(all_errors(moved, orders, segments, u, y).imag / STEP)
    return np.array(columns).T
