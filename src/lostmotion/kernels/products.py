"""Sums of products of lagged signals, and the damped step of a least-squares problem."""

from __future__ import annotations

import numpy as np
from numba import config

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.lanes import WIDEST, address, alive, load_widest, plus_product, spread_widest, store, widest
from lostmotion.kernels.no_literal import no_literal
from lostmotion.kernels.numba_cache import njit

TILE = 4 * WIDEST  # columns of a factor at a time
DEPENDENT = 1e-15  # share of a sum of squares that others leave: rounding


@njit(nogil=True, fastmath={"reassoc", "contract"})
def _add_lags(first: FloatArray, second: FloatArray, other: FloatArray, begin: int, lags: int, out: FloatArray) -> None:
    """Add to `out` (2, lags) the sums of first(k) other(begin + k - lag), and of second(k) with the same.

    Two by four at a time stay in registers.
    """
    widest()
    m = first.size
    for j in range(0, lags, 4):
        j1, j2, j3 = min(j + 1, lags - 1), min(j + 2, lags - 1), min(j + 3, lags - 1)
        r0, r1 = other[begin - j : begin - j + m], other[begin - j1 : begin - j1 + m]
        r2, r3 = other[begin - j2 : begin - j2 + m], other[begin - j3 : begin - j3 + m]
        s0 = s1 = s2 = s3 = t0 = t1 = t2 = t3 = 0.0
        for k in range(m):
            x, y = first[k], second[k]
            s0 += x * r0[k]
            s1 += x * r1[k]
            s2 += x * r2[k]
            s3 += x * r3[k]
            t0 += y * r0[k]
            t1 += y * r1[k]
            t2 += y * r2[k]
            t3 += y * r3[k]
        out[0, j] += s0
        out[1, j] += t0
        if j1 > j:
            out[0, j1] += s1
            out[1, j1] += t1
        if j2 > j1:
            out[0, j2] += s2
            out[1, j2] += t2
        if j3 > j2:
            out[0, j3] += s3
            out[1, j3] += t3


def _add_lags_plain(
    first: FloatArray, second: FloatArray, other: FloatArray, begin: int, lags: int, out: FloatArray
) -> None:
    heads = np.stack([first, second])
    for lag in range(lags):
        out[:, lag] += heads @ other[begin - lag : begin - lag + first.size]


add_lags = _add_lags_plain if config.DISABLE_JIT else _add_lags  # type: ignore[attr-defined]


@njit(nogil=True)
def add_products(
    first: FloatArray,
    ahead: int,
    rows: int,
    second: FloatArray,
    behind: int,
    columns: int,
    start: int,
    stop: int,
    out: FloatArray,
) -> None:
    """Add the sums over k in [start, stop) of first(k-ahead-i) second(k-behind-j) to `out` (rows, columns).

    Only the first row and column are summed up: moving both lags by one drops the last product and adds one in front.
    """
    gram = np.empty((rows, columns))
    across, along = np.zeros((2, columns)), np.zeros((2, rows))
    head = first[start - ahead : stop - ahead]
    add_lags(head, head, second, start - behind, columns, across)
    head = second[start - behind : stop - behind]
    add_lags(head, head, first, start - ahead, rows, along)
    for j in range(columns):
        gram[0, j] = across[0, j]
    for i in range(1, rows):
        gram[i, 0] = along[0, i]
        before, after = first[start - ahead - i], first[stop - ahead - i]
        for j in range(1, columns):
            gram[i, j] = gram[i - 1, j - 1] + before * second[start - behind - j] - after * second[stop - behind - j]
    for i in range(rows):
        for j in range(columns):
            out[i, j] += gram[i, j]


@njit(nogil=True, fastmath={"contract"})
def complete(table: FloatArray, outer: FloatArray, inner: FloatArray) -> None:
    """Fill sums of products of lags (n, m) from the first row and column: a lag more of both drops and adds a product.

    `outer` (2, n) and `inner` (2, m) are the factors that each lag lets in, and those that it lets out.
    """
    for i in range(1, table.shape[0]):
        before, now, come, gone = table[i - 1], table[i], outer[0, i], outer[1, i]
        for j in range(1, now.size):
            now[j] = before[j - 1] + come * inner[0, j] - gone * inner[1, j]


@njit(nogil=True)
def add_lagged_table(
    y: FloatArray, outputs: int, x: FloatArray, delay: int, inputs: int, start: int, stop: int, table: FloatArray
) -> None:
    """Add to `table` (outputs + inputs + 2, inputs) the products with x(k-delay-j), summed over k in [start, stop).

    Of 1, y(k-1) .. y(k-outputs), x(k-delay) .. x(k-delay-inputs+1) and y(k), in this order.
    """
    head, sums = x[start - delay : stop - delay], 0.0
    across, along = np.zeros((2, inputs)), np.zeros((2, outputs + 1))
    add_lags(y[start:stop], head, x, start - delay, inputs, across)
    add_lags(head, head, y, start, outputs + 1, along)
    for value in head:
        sums += value
    past, gram = np.empty((outputs + 1, inputs)), np.empty((inputs, inputs))
    for j in range(inputs):
        past[0, j], gram[0, j], gram[j, 0] = across[0, j], across[1, j], across[1, j]
    for i in range(1, outputs + 1):
        past[i, 0] = along[0, i]
    outer, ends = np.zeros((2, outputs + 1)), np.zeros((2, inputs))  # at lag 0 nothing is let in or out
    for i in range(1, outputs + 1):
        outer[0, i], outer[1, i] = y[start - i], y[stop - i]
    for j in range(1, inputs):
        ends[0, j], ends[1, j] = x[start - delay - j], x[stop - delay - j]
    complete(past, outer, ends)
    complete(gram, ends, ends)
    table[0, 0] += sums
    for j in range(1, inputs):
        sums += x[start - delay - j] - x[stop - delay - j]
        table[0, j] += sums
    for j in range(inputs):
        for i in range(outputs):
            table[i + 1, j] += past[i + 1, j]
        for i in range(inputs):
            table[outputs + 1 + i, j] += gram[i, j]
        table[outputs + inputs + 1, j] += past[0, j]


@njit(nogil=True, forceinline=True)
def _add_rows(
    floats: FloatArray, width: int, row: int, column: int, weights: FloatArray, first: int, step: int, begin: int,
    end: int, sign: float,
) -> None:  # fmt: skip
    """Add to a row of rows `width` long, from a column on, rows from `begin` to `end`, each times its weight.

    The weights begin at `first`, `step` apart, and count `sign` times. A tile of columns stays in registers: what is
    before the column in the first of them is overwritten.
    """
    here, pairs = row * width, begin + (end - begin) // 2 * 2
    for at in range(column // TILE * TILE, width, TILE):
        s0, s1 = load_widest(floats, here + at), load_widest(floats, here + at + WIDEST)
        s2, s3 = load_widest(floats, here + at + 2 * WIDEST), load_widest(floats, here + at + 3 * WIDEST)
        t0 = t1 = t2 = t3 = spread_widest(0.0)  # of every other row: a sum waits for its last addition
        for k in range(begin, pairs, 2):
            weight, other = spread_widest(sign * weights[first + (k - begin) * step]), k * width + at
            s0 = plus_product(s0, weight, load_widest(floats, other))
            s1 = plus_product(s1, weight, load_widest(floats, other + WIDEST))
            s2 = plus_product(s2, weight, load_widest(floats, other + 2 * WIDEST))
            s3 = plus_product(s3, weight, load_widest(floats, other + 3 * WIDEST))
            weight, other = spread_widest(sign * weights[first + (k + 1 - begin) * step]), other + width
            t0 = plus_product(t0, weight, load_widest(floats, other))
            t1 = plus_product(t1, weight, load_widest(floats, other + WIDEST))
            t2 = plus_product(t2, weight, load_widest(floats, other + 2 * WIDEST))
            t3 = plus_product(t3, weight, load_widest(floats, other + 3 * WIDEST))
        if pairs < end:
            weight, other = spread_widest(sign * weights[first + (pairs - begin) * step]), pairs * width + at
            s0 = plus_product(s0, weight, load_widest(floats, other))
            s1 = plus_product(s1, weight, load_widest(floats, other + WIDEST))
            s2 = plus_product(s2, weight, load_widest(floats, other + 2 * WIDEST))
            s3 = plus_product(s3, weight, load_widest(floats, other + 3 * WIDEST))
        one = spread_widest(1.0)
        store(floats, here + at, plus_product(s0, one, t0))
        store(floats, here + at + WIDEST, plus_product(s1, one, t1))
        store(floats, here + at + 2 * WIDEST, plus_product(s2, one, t2))
        store(floats, here + at + 3 * WIDEST, plus_product(s3, one, t3))


@njit(nogil=True)
def _less_rows(floats: FloatArray, width: int, row: int, column: int, begin: int, end: int) -> None:
    """Take from a row, from a column on, others times what they have in that column."""
    _add_rows(floats, width, row, column, floats, begin * width + column, width, begin, end, -1.0)


@njit(nogil=True)
def _factorise(gram: FloatArray, target: FloatArray) -> float:
    """Put the Cholesky factor L of `gram` (n, n) in its lower half, its diagonal inverted; make `target` L^-1 `target`.

    Returns the sum of squares that the regression explains. Columns that rounding has made dependent are left out.
    """
    n, total = target.size, 0.0
    width = (n // TILE + 1) * TILE
    upper = np.zeros((n, width))  # L', and the target behind it
    floats, zero = address(upper.reshape(-1)), no_literal(0)
    for i in range(n):
        for j in range(i, n):
            upper[i, j] = gram[j, i]
        upper[i, n], least = target[i], DEPENDENT * gram[i, i]
        _less_rows(floats, width, i, i, zero, i)
        inverse = 1.0 / np.sqrt(upper[i, i]) if upper[i, i] > least else 0.0
        for j in range(i + 1, n):
            upper[i, j] *= inverse
            gram[j, i] = upper[i, j]
        upper[i, n] *= inverse
        gram[i, i], target[i] = inverse, upper[i, n]
        total += target[i] * target[i]
    alive(upper)
    return total


def _factorise_plain(gram: FloatArray, target: FloatArray) -> float:
    for i in range(target.size):
        least, column = DEPENDENT * gram[i, i], gram[i:, i] - gram[i:, :i] @ gram[i, :i]
        inverse = 1.0 / np.sqrt(column[0]) if column[0] > least else 0.0
        gram[i + 1 :, i], gram[i, i] = column[1:] * inverse, inverse
        target[i] = (target[i] - gram[i, :i] @ target[:i]) * inverse
    return float(target @ target)


factorise = _factorise_plain if config.DISABLE_JIT else _factorise  # type: ignore[attr-defined]


@njit(nogil=True)
def solve_ahead(root: FloatArray, table: FloatArray) -> None:
    """Make `table` (n, m) L^-1 `table`, L from ``factorise``."""
    for i in range(table.shape[0]):
        row = table[i]
        for k in range(i):
            weight, other = root[i, k], table[k]
            for j in range(row.size):
                row[j] -= weight * other[j]
        for j in range(row.size):
            row[j] *= root[i, i]


@njit(nogil=True)
def solve_behind(root: FloatArray, values: FloatArray) -> None:
    """Make `values` (n,) L'^-1 `values`, L from ``factorise``."""
    for i in range(values.size - 1, -1, -1):
        values[i] *= root[i, i]
        last, row = values[i], root[i]
        for k in range(i):
            values[k] -= last * row[k]


@njit(nogil=True)
def _explained(table: FloatArray, basis: FloatArray, known: FloatArray, floor: float, ridge: float) -> float:
    """Sum of squares that m columns explain beyond k columns that are always there.

    `table` (k + m + 1, m) holds the products of those k, of the m and of the target with the m columns; `basis`
    (k, r) makes the k orthonormal and `known` (r,) are their products with the target.
    """
    (k, r), m, total = basis.shape, table.shape[1], 0.0
    width = (m // TILE + 1) * TILE
    rows = np.zeros((r + m + k, width))  # of the k made orthonormal, of the m, and the k as they are; the target behind
    floats, shares, zero = address(rows.reshape(-1)), address(basis.reshape(-1)), no_literal(0)
    for i in range(k):
        for j in range(m):
            rows[r + m + i, j] = table[i, j]
    for p in range(r):
        _add_rows(floats, width, p, zero, shares, p, r, r + m, r + m + k, 1.0)
        rows[p, m] = known[p]
    for i in range(m):
        row = rows[r + i]
        for j in range(i, m):
            row[j] = table[k + i, j]
        row[m] = table[k + m, i]
        _less_rows(floats, width, r + i, i, zero, r)
        row[i] += ridge * row[i] + floor
        least = DEPENDENT * row[i]
        _less_rows(floats, width, r + i, i, r, r + i)
        inverse = 1.0 / np.sqrt(row[i]) if row[i] > least else 0.0
        for j in range(i + 1, m + 1):
            row[j] *= inverse
        total += row[m] * row[m]
    alive(rows)
    return total


def _explained_plain(table: FloatArray, basis: FloatArray, known: FloatArray, floor: float, ridge: float) -> float:
    k, m = basis.shape[0], table.shape[1]
    past = basis.T @ table[:k]
    gram, cross = table[k : k + m] - past.T @ past, table[k + m] - known @ past
    return factorise(gram + np.diag(ridge * np.diag(gram) + floor), cross)


explained = _explained_plain if config.DISABLE_JIT else _explained  # type: ignore[attr-defined]


@njit(nogil=True)
def explained_by_lags(
    y: FloatArray,
    outputs: int,
    x: FloatArray,
    delay: int,
    inputs: int,
    blocks: IntArray,
    basis: FloatArray,
    known: FloatArray,
    floor: float,
    ridge: float,
) -> float:
    """Sum of squares of y that the lags of x explain beyond its past and a constant, over the rows of `blocks` (n, 2).

    `basis` and `known` as in ``explained``.
    """
    table = np.zeros((outputs + inputs + 2, inputs))
    for start, stop in blocks:
        add_lagged_table(y, outputs, x, delay, inputs, start, stop, table)
    return explained(table, basis, known, floor, ridge)


@njit()
def damped_step(hessian: FloatArray, gradient: FloatArray, damping: float) -> tuple[FloatArray, float]:
    """Marquardt step with columns scaled by their norm, and the decrease of the sum of squares that it promises."""
    n = gradient.size
    scale = np.ones(n)
    for i in range(n):
        if hessian[i, i] > 0.0:
            scale[i] = np.sqrt(hessian[i, i])
    scaled = np.empty((n, n))
    for i in range(n):
        for j in range(n):
            scaled[i, j] = hessian[i, j] / (scale[i] * scale[j])
        scaled[i, i] += damping
    slope = np.empty(n)
    for i in range(n):
        slope[i] = gradient[i] / scale[i]
    move: FloatArray = np.linalg.solve(scaled, slope)  # type: ignore[assignment]  # of float64, as both are
    for i in range(n):
        move[i] = -move[i]
    # with (H + damping) move = -slope: move' H move = -slope' move - damping move' move
    promised = -np.dot(slope, move) + damping * np.dot(move, move)
    for i in range(n):
        move[i] /= scale[i]
    return move, promised
