"""Lagged products of signals that are piecewise linear in OP, from sums over its cells.

Between the bends a dead zone is linear in u, a jump constant. So the samples need to be met once, whatever the number
of bends: a product of two such signals is a sum over the cells of u(k) and u(k - lag).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from numba import config

from lostmotion.arrays import FloatArray
from lostmotion.kernels.numba_cache import njit

Cells = npt.NDArray[np.uint8]


@njit(nogil=True)
def _add_pairs(u: FloatArray, cell: Cells, origin: FloatArray, start: int, stop: int, table: FloatArray) -> None:
    """Add (1, s)(k) (1, s)(k - lag), s = u - origin, over k in [start, stop) to `table` (lags, cells, cells, 4)."""
    for k in range(start, stop):
        now, first = cell[k], u[k] - origin[cell[k]]
        for lag in range(table.shape[0]):
            then = cell[k - lag]
            second = u[k - lag] - origin[then]
            sums = table[lag, now, then]
            sums[0] += 1.0
            sums[1] += second
            sums[2] += first
            sums[3] += first * second


@njit(nogil=True)
def _add_twice(values: FloatArray, weight: float, sums: FloatArray) -> None:
    """Add the first of the values, and `weight` times these, to the rows of `sums` (2, m)."""
    plain, weighted = sums[0], sums[1]
    for i in range(plain.size):
        plain[i] += values[i]
        weighted[i] += weight * values[i]


@njit(nogil=True)
def _add_lag(sums: FloatArray, lag: int, table: FloatArray) -> None:
    """Add the sums (cells, 2, lags) of one lag to `table` (cells, 2)."""
    for i in range(table.shape[0]):
        table[i, 0] += sums[i, 0, lag]
        table[i, 1] += sums[i, 1, lag]


@njit(nogil=True)
def _add_behind(
    y: FloatArray,
    ahead: int,
    u: FloatArray,
    cell: Cells,
    origin: FloatArray,
    behind: int,
    start: int,
    stop: int,
    table: FloatArray,
) -> None:
    """Add y(k - ahead) (1, s)(k - behind - lag) over k in [start, stop) to `table` (lags, cells, 2)."""
    lags = table.shape[0]
    sums = np.zeros((origin.size, 2, lags))
    for at in range(start - behind - lags + 1, stop - behind):  # of u: its lags of y are neighbours
        now, first, last = cell[at], start - behind - at, stop - behind - at
        value, ends = u[at] - origin[now], y[at + behind - ahead :]
        if first <= 0 and last >= lags:
            _add_twice(ends, value, sums[now])
            continue
        for lag in range(max(first, 0), min(last, lags)):
            sums[now, 0, lag] += ends[lag]
            sums[now, 1, lag] += ends[lag] * value
    for lag in range(lags):
        _add_lag(sums, lag, table[lag])


@njit(nogil=True)
def _add_ahead(
    y: FloatArray,
    ahead: int,
    u: FloatArray,
    cell: Cells,
    origin: FloatArray,
    behind: int,
    start: int,
    stop: int,
    table: FloatArray,
) -> None:
    """Add y(k - ahead - lag) (1, s)(k - behind) over k in [start, stop) to `table` (lags, cells, 2)."""
    lags = table.shape[0]
    sums = np.zeros((origin.size, 2, lags))
    for k in range(start, stop):
        now = cell[k - behind]
        _add_twice(y[k - ahead - lags + 1 :], u[k - behind] - origin[now], sums[now])
    for lag in range(lags):
        _add_lag(sums, lags - 1 - lag, table[lag])


@njit(nogil=True)
def _add_lower(cell: Cells, start: int, stop: int, table: FloatArray) -> None:
    """Count the lower of the cells of k and k - lag over k in [start, stop) in `table` (lags, cells)."""
    for k in range(start, stop):
        now = cell[k]
        for lag in range(table.shape[0]):
            table[lag, min(now, cell[k - lag])] += 1.0


def _counted(where: Any, weights: FloatArray | None, cells: int) -> FloatArray:
    return np.bincount(where, weights, minlength=cells).astype(np.float64)


def _add_pairs_plain(u: FloatArray, cell: Cells, origin: FloatArray, start: int, stop: int, table: FloatArray) -> None:
    cells, s = origin.size, u - origin[cell]
    now = s[start:stop]
    for lag in range(len(table)):
        then = s[start - lag : stop - lag]
        where = cell[start:stop].astype(int) * cells + cell[start - lag : stop - lag]
        for place, weights in enumerate((None, then, now, now * then)):
            table[lag, :, :, place] += _counted(where, weights, cells**2).reshape(cells, cells)


def _add_behind_plain(
    y: FloatArray,
    ahead: int,
    u: FloatArray,
    cell: Cells,
    origin: FloatArray,
    behind: int,
    start: int,
    stop: int,
    table: FloatArray,
) -> None:
    values = y[start - ahead : stop - ahead]
    for lag in range(len(table)):
        where = slice(start - behind - lag, stop - behind - lag)
        s = u[where] - origin[cell[where]]
        for place, weights in enumerate((values, values * s)):
            table[lag, :, place] += _counted(cell[where], weights, origin.size)


def _add_ahead_plain(
    y: FloatArray,
    ahead: int,
    u: FloatArray,
    cell: Cells,
    origin: FloatArray,
    behind: int,
    start: int,
    stop: int,
    table: FloatArray,
) -> None:
    where = slice(start - behind, stop - behind)
    s = u[where] - origin[cell[where]]
    for lag in range(len(table)):
        values = y[start - ahead - lag : stop - ahead - lag]
        for place, weights in enumerate((values, values * s)):
            table[lag, :, place] += _counted(cell[where], weights, origin.size)


def _add_lower_plain(cell: Cells, start: int, stop: int, table: FloatArray) -> None:
    for lag in range(len(table)):
        table[lag] += _counted(np.minimum(cell[start:stop], cell[start - lag : stop - lag]), None, table.shape[1])


# as plain Python the loops would take minutes
_JIT = not config.DISABLE_JIT  # type: ignore[attr-defined]
add_pairs = _add_pairs if _JIT else _add_pairs_plain
add_behind = _add_behind if _JIT else _add_behind_plain
add_ahead = _add_ahead if _JIT else _add_ahead_plain
add_lower = _add_lower if _JIT else _add_lower_plain
