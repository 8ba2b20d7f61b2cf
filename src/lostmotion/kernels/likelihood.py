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

from lostmotion.arrays import FloatArray
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.pole_filters import all_pole


@njit(fastmath={"contract"})
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


@njit()
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
    for i in range(min(c.size, n)):
        drive[i] = c[i]
    if zero > 0.0:
        all_pole(np.array([-zero]), drive.copy(), drive)
    add_lagged(b, x[begin : begin + n], drive)
    z = np.empty(n)
    all_pole(a, drive, z)
    v = np.empty(n)
    for k in range(n):
        v[k] = y[first + k] - offset - z[k]
        z[k] += offset
    errors = v.copy()
    add_lagged(d, v[:-1], errors[1:])
    return z, errors[d.size :]
