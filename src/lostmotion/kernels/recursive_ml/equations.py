"""Linear algebra of the information form: sums of a block, factor, solution, inverse, forgetting."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels.numba_cache import njit

RIDGE = 1e-11  # relative information put into every direction, about the present estimate
SMALLEST = 1e-200  # information below this is none: filters fade to denormal numbers


@njit(nogil=True)
def influence(error: float, limit: float) -> float:
    """Huber's weight: 1 up to `limit`, then falling so that an error counts as `limit`."""
    return 1.0 if abs(error) <= limit else limit / abs(error)


@njit(nogil=True)
def gather(psi: FloatArray, error: float, weight: float, h: FloatArray, g: FloatArray) -> None:
    """Add psi psi' and psi e to the sums of the block, with the weight of a bounded influence."""
    for i in range(psi.size):
        value = weight * psi[i]
        g[i] += value * error
        for j in range(psi.size):
            h[i, j] += value * psi[j]


@njit(nogil=True)
def factor(h: FloatArray, root: FloatArray) -> None:
    """Cholesky factor of h + ridge in `root` (lower); a direction without any information gets a unit.

    What is left of a pivot below the ridge is rounding, and so is the rest of its column: divided by the pivot it
    would grow from row to row, beyond all numbers where h spans more digits than they have.
    """
    n = h.shape[0]
    told = np.ones(n, dtype=np.bool_)
    for i in range(n):
        for j in range(i + 1):
            total = h[i, j]
            if i == j:
                total = total * (1.0 + RIDGE) if total > SMALLEST else 1.0
            for k in range(j):
                total -= root[i, k] * root[j, k]
            if i == j:
                floor = RIDGE * h[i, i] if h[i, i] > SMALLEST else 1.0
                told[i] = total >= floor
                root[i, i] = np.sqrt(max(total, floor))
            else:
                root[i, j] = total / root[j, j] if told[j] else 0.0


@njit(nogil=True)
def solve(root: FloatArray, b: FloatArray) -> None:
    """Solve root root' x = b in place."""
    n = b.size
    for i in range(n):
        total = b[i]
        for k in range(i):
            total -= root[i, k] * b[k]
        b[i] = total / root[i, i]
    for i in range(n - 1, -1, -1):
        total = b[i]
        for k in range(i + 1, n):
            total -= root[k, i] * b[k]
        b[i] = total / root[i, i]


@njit(nogil=True)
def invert(root: FloatArray, inverse: FloatArray) -> None:
    """Inverse of root root'."""
    n = root.shape[0]
    for i in range(n):  # inverse of the factor, in the lower triangle
        inverse[i, i] = 1.0 / root[i, i]
        for j in range(i):
            total = 0.0
            for k in range(j, i):
                total -= root[i, k] * inverse[k, j]
            inverse[i, j] = total / root[i, i]
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for k in range(i, n):
                total += inverse[k, i] * inverse[k, j]
            inverse[j, i] = total
    for i in range(n):
        for j in range(i):
            inverse[i, j] = inverse[j, i]


@njit(nogil=True)
def seen_from(root: FloatArray, h: FloatArray) -> FloatArray:
    """L^-1 h L^-T with the factor L: information h in the basis in which that of L is 1."""
    n = h.shape[0]
    left = h.copy()
    for column in range(n):
        for i in range(n):
            total = left[i, column]
            for k in range(i):
                total -= root[i, k] * left[k, column]
            left[i, column] = total / root[i, i]
    for row in range(n):
        for i in range(n):
            total = left[row, i]
            for k in range(i):
                total -= root[i, k] * left[row, k]
            left[row, i] = total / root[i, i]
    return left


@njit(nogil=True)
def fade(ref_h: FloatArray, ref_r: FloatArray, h: FloatArray, tail: float) -> None:
    """Let the reference lose a share `tail`, but in no direction more than h brings in.

    In the basis in which the reference is 1 the block is diagonal, mu; the reference loses min(tail, mu).
    """
    n = ref_r.size
    root = np.zeros((n, n))
    factor(ref_h, root)
    left = seen_from(root, h)
    mu, vectors = np.linalg.eigh(0.5 * (left + left.T))
    at = ref_r.copy()
    solve(root, at)
    for m in range(n):
        lost = min(max(mu[m], 0.0), tail)
        if lost <= 0.0:
            continue
        direction = np.zeros(n)
        for i in range(n):
            for k in range(i + 1):
                direction[i] += root[i, k] * vectors[k, m]
        along = 0.0
        for i in range(n):
            along += direction[i] * at[i]
        for i in range(n):
            ref_r[i] -= lost * direction[i] * along
            for j in range(n):
                ref_h[i, j] -= lost * direction[i] * direction[j]


@njit(nogil=True)
def merge(ref_h: FloatArray, ref_r: FloatArray, h: FloatArray, r: FloatArray, tail: float) -> None:
    """Let a block enter the reference, which forgets a share `tail`, but in no direction more than comes in."""
    n = r.size
    if tail > 0.0:
        fade(ref_h, ref_r, h, tail)
    for i in range(n):
        ref_r[i] += r[i]
        for j in range(n):
            ref_h[i, j] += h[i, j]


@njit(nogil=True)
def informed_sides(h: FloatArray, variance: float, eta: int, reach: float, root: FloatArray) -> tuple[bool, bool]:
    """Whether one block alone could place each break point inside the range of u, everything else unknown."""
    least = variance / (reach * reach)
    if not (h[eta, eta] > least or h[eta + 1, eta + 1] > least):
        return False, False
    n = h.shape[0]
    others = n - 2
    for i in range(n):  # the break points last
        row = i if i < eta else (i + 2 if i < others else i - others + eta)
        for j in range(i + 1):
            total = h[row, j if j < eta else (j + 2 if j < others else j - others + eta)]
            whole = total
            for k in range(min(j, others)):
                total -= root[i, k] * root[j, k]
            if i >= others and j >= others:
                root[i, j] = total
            elif i == j:
                root[i, i] = np.sqrt(max(total, RIDGE * whole)) if whole > SMALLEST else 1.0
            else:
                root[i, j] = total / root[j, j]
    left, right, cross = root[n - 2, n - 2], root[n - 1, n - 1], root[n - 1, n - 2]
    shared = cross * cross
    return (
        bool(right > 0.0 and left - shared / right > least) or bool(right <= 0.0 and left > least),
        bool(left > 0.0 and right - shared / left > least) or bool(left <= 0.0 and right > least),
    )
