"""Prediction errors of a Hammerstein model with AR noise, their exact gradients, and the normal equations.

Model on one segment, for k >= first (everything before is zero, its effect is carried by c):

    A(q) z(k) = B(q) x(k-d) + c(k-first),   v = y - offset - z,   e = D(q) v  for k >= first + p

c has max(na, nb) entries: the initial state of A and the inputs from before the segment. All gradients are then
shifts of a few filtered signals: dz/da_i = -q^-i (1/A) z, dz/db_i = q^-(d+i) (1/A) x, dz/dc_i = q^-i (1/A) delta,
dz/deta = q^-d (B/A) dx/deta (Ljung, System Identification, 2nd ed., section 10.3).

Order of the parameters: a (na), b (nb+1), offset (1), eta (ne), d (p), then c of each segment.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.products import add_gram

BLOCK = 1024  # samples whose gradients are held at once
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
def _filtered_signals(
    a: FloatArray, b: FloatArray, c: FloatArray, delay: int, first: int, x: FloatArray, dx: FloatArray, base: FloatArray
) -> FloatArray:
    """Fill the rows of `base` (3+ne, n) with (1/A)x, -(1/A)z, (1/A)delta, (B/A)dx/deta; return z."""
    n = base.shape[1]
    begin = first - delay  # the input that first acts
    all_pole(a, x[begin : begin + n], base[0])
    drive = np.zeros(n)
    drive[0] = 1.0
    all_pole(a, drive, base[2])
    z = np.zeros(n)
    add_lagged(b, base[0], z)
    add_lagged(c, base[2], z)
    all_pole(a, z, base[1])
    for k in range(n):
        base[1, k] = -base[1, k]
    for e in range(dx.shape[0]):
        all_pole(a, dx[e, begin : begin + n], drive)
        base[3 + e] = 0.0
        add_lagged(b, drive, base[3 + e])
    return z


@njit(cache=True)
def _fill_gradients(
    rows: FloatArray,
    k0: int,
    m: int,
    na: int,
    nb1: int,
    ne: int,
    p: int,
    nc: int,
    c_at: int,
    base: FloatArray,
    v: FloatArray,
    offset_gain: float,
) -> None:
    """Gradients of e(k0) .. e(k0+m-1) with respect to all parameters, into rows[:, :m]; c of others stays zero."""
    for i in range(na):
        _copy_shifted(base[1], k0, m, i + 1, rows[i])
    for i in range(nb1):
        _copy_shifted(base[0], k0, m, i, rows[na + i])
    at = na + nb1
    rows[at, :m] = -offset_gain
    for e in range(ne):
        _copy_shifted(base[3 + e], k0, m, 0, rows[at + 1 + e])
    at += 1 + ne
    for i in range(p):
        rows[at + i, :m] = v[k0 - 1 - i : k0 - 1 - i + m]
    for i in range(nc):
        _copy_shifted(base[2], k0, m, i, rows[c_at + i])


@njit(cache=True)
def _copy_shifted(signal: FloatArray, k0: int, m: int, lag: int, row: FloatArray) -> None:
    """row[j] = -signal[k0 + j - lag], zero before the first sample."""
    before = min(m, max(lag - k0, 0))
    row[:before] = 0.0
    later = row[before:m]
    source = signal[max(k0 - lag, 0) :]
    for j in range(later.size):
        later[j] = -source[j]


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
) -> tuple[FloatArray, FloatArray]:
    """Simulated output z + offset from row `first` on, and the prediction errors from `first + p` on."""
    n = y.size - first
    begin = first - delay
    drive = np.zeros(n)
    drive[: c.size] = c[:n]
    add_lagged(b, x[begin : begin + n], drive)
    z = np.empty(n)
    all_pole(a, drive, z)
    v = y[first:] - offset - z
    errors = v.copy()
    add_lagged(d, v[:-1], errors[1:])
    return z + offset, errors[d.size :]


@njit(cache=True)
def normal_equations(
    theta: FloatArray,
    na: int,
    nb: int,
    ne: int,
    p: int,
    delay: int,
    first: int,
    segments: IntArray,
    x: FloatArray,
    dx: FloatArray,
    y: FloatArray,
    hessian: FloatArray,
    gradient: FloatArray,
) -> float:
    """Add J'J and J'e of all segments to `hessian` (n, n) and `gradient` (n,); return the sum of e squared.

    `segments` (s, 2) holds start and stop rows; `first` counts from the start of each. `dx` is (ne, samples).
    """
    nb1 = nb + 1
    a = theta[:na]
    b = theta[na : na + nb1]
    offset = theta[na + nb1]
    shared = na + nb1 + 1 + ne
    d = theta[shared : shared + p]
    nc = max(na, nb)
    cost = 0.0
    rows = np.zeros((theta.size, BLOCK))
    for s in range(segments.shape[0]):
        start, stop = segments[s, 0], segments[s, 1]
        n = stop - start - first
        c_at = shared + p + s * nc
        base = np.empty((3 + ne, n))
        z = _filtered_signals(a, b, theta[c_at : c_at + nc], delay, first, x[start:stop], dx[:, start:stop], base)
        v = y[start + first : stop] - offset - z
        errors = v.copy()
        add_lagged(d, v[:-1], errors[1:])
        if p > 0:
            for row in range(3 + ne):
                z[:] = base[row]
                add_lagged(d, z[:-1], base[row, 1:])
        rows[shared + p :] = 0.0
        for k0 in range(p, n, BLOCK):
            m = min(BLOCK, n - k0)
            _fill_gradients(rows, k0, m, na, nb1, ne, p, nc, c_at, base, v, 1.0 + d.sum())
            block = rows if m == BLOCK else rows[:, :m].copy()
            part = errors[k0 : k0 + m]
            add_gram(block, hessian)
            gradient += np.dot(block, part)
            cost += np.dot(part, part)
    return cost
