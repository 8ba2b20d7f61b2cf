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

from lostmotion.kernels.types import FloatArray, IntArray

BLOCK = 256


@njit(cache=True)
def _filtered_signals(
    a: FloatArray,
    b: FloatArray,
    c: FloatArray,
    delay: int,
    first: int,
    x: FloatArray,
    dx: FloatArray,
    base: FloatArray,
) -> FloatArray:
    """Fill the columns of `base` (n, 3+ne) with (1/A)x, -(1/A)z, (1/A)delta, (B/A)dx; return z."""
    n = base.shape[0]
    ne = dx.shape[1]
    na = a.size
    z = np.zeros(n)
    for k in range(n):
        j = k + first - delay  # input that first acts now
        base[k, 0] = x[j]
        total = c[k] if k < c.size else 0.0
        for i in range(b.size):
            if k - i >= 0:
                total += b[i] * x[j - i]
        base[k, 2] = 1.0 if k == 0 else 0.0
        for e in range(ne):
            value = 0.0
            for i in range(b.size):
                if k - i >= 0:
                    value += b[i] * dx[j - i, e]
            base[k, 3 + e] = value
        lags = na if k >= na else k
        for i in range(lags):
            total -= a[i] * z[k - 1 - i]
        z[k] = total
        base[k, 1] = -total
        for i in range(lags):
            weight = a[i]
            for s in range(3 + ne):
                base[k, s] -= weight * base[k - 1 - i, s]
    return z


@njit(cache=True)
def _noise_filtered(d: FloatArray, base: FloatArray) -> FloatArray:
    """D(q) applied to each column, with zeros before the first row."""
    n, m = base.shape
    out = base.copy()
    for k in range(n):
        for i in range(min(d.size, k)):
            weight = d[i]
            for s in range(m):
                out[k, s] += weight * base[k - 1 - i, s]
    return out


@njit(cache=True)
def _fill_row(
    row: FloatArray,
    k: int,
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
    """Gradient of e(k) with respect to all parameters, into `row` (zero elsewhere)."""
    for i in range(na):
        row[i] = -base[k - 1 - i, 1] if k - 1 - i >= 0 else 0.0
    for i in range(nb1):
        row[na + i] = -base[k - i, 0] if k - i >= 0 else 0.0
    at = na + nb1
    row[at] = -offset_gain
    for e in range(ne):
        row[at + 1 + e] = -base[k, 3 + e]
    at += 1 + ne
    for i in range(p):
        row[at + i] = v[k - 1 - i]
    for i in range(nc):
        row[c_at + i] = -base[k - i, 2] if k - i >= 0 else 0.0


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
    p = d.size
    z = np.zeros(n)
    for k in range(n):
        total = c[k] if k < c.size else 0.0
        j = k + first - delay
        for i in range(b.size):
            if k - i >= 0:
                total += b[i] * x[j - i]
        for i in range(a.size):
            if k - 1 - i >= 0:
                total -= a[i] * z[k - 1 - i]
        z[k] = total
    errors = np.empty(n - p)
    for k in range(p, n):
        value = y[first + k] - offset - z[k]
        for i in range(p):
            value += d[i] * (y[first + k - 1 - i] - offset - z[k - 1 - i])
        errors[k - p] = value
    return z + offset, errors


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

    `segments` (s, 2) holds start and stop rows; `first` counts from the start of each.
    """
    nb1 = nb + 1
    a = theta[:na]
    b = theta[na : na + nb1]
    offset = theta[na + nb1]
    shared = na + nb1 + 1 + ne
    d = theta[shared : shared + p]
    nc = max(na, nb)
    offset_gain = 1.0 + d.sum()
    cost = 0.0
    rows = np.zeros((BLOCK, theta.size))
    errors = np.zeros(BLOCK)
    for s in range(segments.shape[0]):
        start, stop = segments[s, 0], segments[s, 1]
        n = stop - start - first
        c_at = shared + p + s * nc
        base = np.empty((n, 3 + ne))
        z = _filtered_signals(a, b, theta[c_at : c_at + nc], delay, first, x[start:stop], dx[start:stop], base)
        v = y[start + first : stop] - offset - z
        base = _noise_filtered(d, base)
        rows[:, shared + p :] = 0.0
        used = 0
        for k in range(p, n):
            value = v[k]
            for i in range(p):
                value += d[i] * v[k - 1 - i]
            errors[used] = value
            cost += value * value
            _fill_row(rows[used], k, na, nb1, ne, p, nc, c_at, base, v, offset_gain)
            used += 1
            if used == BLOCK or k == n - 1:
                block = rows[:used]
                hessian += np.dot(block.T, block)
                gradient += np.dot(block.T, errors[:used])
                used = 0
    return cost
