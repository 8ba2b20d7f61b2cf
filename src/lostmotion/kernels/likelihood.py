"""Prediction errors of a Hammerstein model with AR noise, their exact gradients, and the normal equations.

Model on one segment, for k >= first (everything before is zero, its effect is carried by c):

    A(q) z(k) = B(q) x(k-d) + c(k-first),   v = y - offset - z,   e = D(q) v  for k >= first + p

c has max(na, nb) entries: the initial state of A and the inputs from before the segment. Where the noise has a zero,
signals go through it first (``kernels.smoothed``), whose state before the segment is unknown too: c has one entry more
and acts as c / (1 - zero q^-1). All gradients are then
shifts of a few filtered signals: dz/da_i = -q^-i (1/A) z, dz/db_i = q^-(d+i) (1/A) x, dz/dc_i = q^-i (1/A) delta,
dz/deta = q^-d (B/A) dx/deta (Ljung, System Identification, 2nd ed., section 10.3).

Order of the parameters: a (na), b (nb+1), offset (1), eta (ne), d (p), then c of each segment.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.arrays import FloatArray

GONE = 1e-100  # what has decayed to this is zero: below 1e-308 a product of two numbers takes a hundred times as long
REST = 256  # samples after which it is looked at


@njit(cache=True, fastmath={"contract"})
def all_pole(a: FloatArray, x: FloatArray, out: FloatArray) -> None:
    """Write (1/A) x into `out`, from rest; up to four poles run in registers."""
    if a.size > 4:
        _many_poles(a, x, out)
        return
    a1 = a[0] if a.size > 0 else 0.0
    a2 = a[1] if a.size > 1 else 0.0
    a3 = a[2] if a.size > 2 else 0.0
    a4 = a[3] if a.size > 3 else 0.0
    y1 = y2 = y3 = y4 = 0.0
    for begin in range(0, x.size, REST):
        if abs(y1) < GONE and abs(y2) < GONE and abs(y3) < GONE and abs(y4) < GONE:
            y1 = y2 = y3 = y4 = 0.0
        for k in range(begin, min(begin + REST, x.size)):
            value = (x[k] - a4 * y4 - a3 * y3 - a2 * y2) - a1 * y1  # the newest last: it is the critical path
            y4, y3, y2, y1 = y3, y2, y1, value
            out[k] = value


@njit(cache=True, fastmath={"contract"})
def two_all_pole(a: FloatArray, x: FloatArray, out: FloatArray, other_x: FloatArray, other: FloatArray) -> None:
    """The same for two signals of one length at once: neither waits for the other."""
    if a.size > 3:
        all_pole(a, x, out)
        all_pole(a, other_x, other)
        return
    a1 = a[0] if a.size > 0 else 0.0
    a2 = a[1] if a.size > 1 else 0.0
    a3 = a[2] if a.size > 2 else 0.0
    y1 = y2 = y3 = z1 = z2 = z3 = 0.0
    for begin in range(0, x.size, REST):
        if abs(y1) < GONE and abs(y2) < GONE and abs(y3) < GONE:
            y1 = y2 = y3 = 0.0
        if abs(z1) < GONE and abs(z2) < GONE and abs(z3) < GONE:
            z1 = z2 = z3 = 0.0
        for k in range(begin, min(begin + REST, x.size)):
            value = (x[k] - a3 * y3 - a2 * y2) - a1 * y1  # the newest last: it is the critical path
            second = (other_x[k] - a3 * z3 - a2 * z2) - a1 * z1
            y3, y2, y1, z3, z2, z1 = y2, y1, value, z2, z1, second
            out[k], other[k] = value, second


@njit(cache=True, fastmath={"contract"})
def _many_poles(a: FloatArray, x: FloatArray, out: FloatArray) -> None:
    for k in range(x.size):
        value = x[k]
        for i in range(min(a.size, k)):
            value -= a[i] * out[k - 1 - i]
        out[k] = value if abs(value) > GONE else 0.0


@njit(cache=True, fastmath={"contract"})
def add_lagged(coefficients: FloatArray, x: FloatArray, out: FloatArray) -> None:
    """Add sum c_i x(k-i), with zeros before the first sample, to `out`."""
    n = out.size
    done = 0
    while done + 4 <= coefficients.size and done + 4 <= n:  # four at a time: fewer passes over memory
        c0, c1, c2, c3 = coefficients[done], coefficients[done + 1], coefficients[done + 2], coefficients[done + 3]
        out[done] += c0 * x[0]
        out[done + 1] += c0 * x[1] + c1 * x[0]
        out[done + 2] += c0 * x[2] + c1 * x[1] + c2 * x[0]
        later, x0, x1, x2 = out[done + 3 :], x[3:], x[2:], x[1:]  # slices: the loop over them runs in lanes
        for k in range(later.size):
            later[k] += c0 * x0[k] + c1 * x1[k] + c2 * x2[k] + c3 * x[k]
        done += 4
    for i in range(done, coefficients.size):
        weight = coefficients[i]
        later = out[i:]
        for k in range(n - i):
            later[k] += weight * x[k]


@njit(cache=True)
def prediction_errors(
    a: FloatArray,
    b: FloatArray,
    c: FloatArray,
    offset: float,
    d: FloatArray,
    delay: int,
    first: int,
    x: FloatArray,
    y: FloatArray,
    zero: float = 0.0,
) -> tuple[FloatArray, FloatArray]:
    """Simulated output z + offset from row `first` on, and the prediction errors from `first + p` on."""
    n = y.size - first
    begin = first - delay
    drive = np.zeros(n)
    drive[: c.size] = c[:n]
    if zero > 0.0:
        all_pole(np.array([-zero]), drive.copy(), drive)
    add_lagged(b, x[begin : begin + n], drive)
    z = np.empty(n)
    all_pole(a, drive, z)
    v = y[first:] - offset - z
    errors = v.copy()
    add_lagged(d, v[:-1], errors[1:])
    return z + offset, errors[d.size :]
