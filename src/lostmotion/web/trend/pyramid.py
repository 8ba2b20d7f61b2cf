"""A long signal with the extremes of its blocks: smallest and largest of any stretch in microseconds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray

Rows = npt.NDArray[np.int64]

BASE, STEP = 16, 4  # rows of the smallest block; blocks in the next larger one
FEWEST = 256  # blocks of the top: fewer save nothing
INSIDE = 4  # blocks in a pixel at least: its edges lie an eighth of it beside where they should, at most


@dataclass(frozen=True)
class Pyramid:
    """Values, and smallest and largest of their blocks.

    Attributes
    ----------
    values : ndarray, shape (n,)
        NaN where missing; may be mapped from a file.
    low, high : ndarray
        Of the blocks of all levels, the finest first; empty: none were made.
    """

    values: FloatArray
    low: FloatArray
    high: FloatArray

    @classmethod
    def of(cls, values: FloatArray, blocks: bool = True) -> Pyramid:
        """Pyramid of a signal; without `blocks` only the signal.

        Examples
        --------
        >>> made = Pyramid.of(np.arange(10_000.0))
        >>> made.extremes(np.array([5, 6144, 9_999]), 16).tolist()
        [[5.0, 6143.0], [6144.0, 9998.0]]
        """
        lows, highs = [np.empty(0)], [np.empty(0)]
        low = high = values
        for step in _steps(values.size) if blocks else ():
            low, high = np.fmin.reduce(_rows(low, step), axis=1), np.fmax.reduce(_rows(high, step), axis=1)
            lows.append(low)
            highs.append(high)
        return cls(values, np.concatenate(lows), np.concatenate(highs))

    def extremes(self, edges: Rows, block: int) -> FloatArray:
        """Smallest and largest value of each stretch, shape (w, 2); NaN where nothing is known.

        Parameters
        ----------
        edges : ndarray, shape (w + 1,)
            Rows that rise; all but the first and the last are multiples of `block`.
        block : int
            Of :func:`block_of`; 1: every row is looked at.
        """
        first, last = int(edges[0]), int(edges[-1])
        if block == 1:
            return _reduced(self.values[first:last], self.values[first:last], edges[:-1] - first)
        low, high = self._level(block)
        begin, end = -(-first // block), last // block
        places = np.concatenate([[0], edges[1:-1] // block - begin])
        found = _reduced(low[begin:end], high[begin:end], places)
        for place, rows in ((0, slice(first, begin * block)), (-1, slice(end * block, last))):
            ragged = self.values[rows]
            if ragged.size:
                found[place, 0] = np.fmin(found[place, 0], np.fmin.reduce(ragged))
                found[place, 1] = np.fmax(found[place, 1], np.fmax.reduce(ragged))
        return found

    def _level(self, block: int) -> tuple[FloatArray, FloatArray]:
        start = 0
        for size, count in levels(self.values.size):
            if size == block:
                return self.low[start : start + count], self.high[start : start + count]
            start += count
        raise AssertionError(f"no level of {block} rows")

    def block_of(self, pixel: float) -> int:
        """Largest block of which several lie in a pixel of so many rows; 1: none."""
        fitting = [size for size, _ in levels(self.values.size) if INSIDE * size <= pixel]
        return fitting[-1] if fitting and self.low.size else 1


def levels(rows: int) -> Iterator[tuple[int, int]]:
    """Rows of a block and number of blocks of each level, the finest first.

    Examples
    --------
    >>> list(levels(20_001))
    [(16, 1251), (64, 313)]
    """
    size, count = 1, rows
    for step in _steps(rows):
        size, count = size * step, -(-count // step)
        yield size, count


def _steps(rows: int) -> list[int]:
    found, count, step = [], rows, BASE
    while -(-count // step) >= FEWEST:
        found.append(step)
        count, step = -(-count // step), STEP
    return found


def _rows(values: FloatArray, step: int) -> FloatArray:
    """Blocks as rows; the last one is filled up with NaN."""
    spare = -values.size % step
    return np.concatenate([values, np.full(spare, np.nan)]).reshape(-1, step)


def _reduced(low: FloatArray, high: FloatArray, places: Rows) -> FloatArray:
    return np.column_stack([np.fmin.reduceat(low, places), np.fmax.reduceat(high, places)])
