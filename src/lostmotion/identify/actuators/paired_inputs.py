"""High-order ARX on pairs of signals that are piecewise linear in OP, all pairs at once.

Of every signal and pair only the products at one lag against all others are summed up over the samples (from sums over
cells of OP, ``kernels.cells``); those at other pairs of lags follow from the rows at the ends, and the past of PV and
a constant are projected out of all of them together.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.likelihood.arx_gram import RIDGE, Lags, past_products
from lostmotion.identify.scaled import Signals
from lostmotion.kernels import cells as by_cell
from lostmotion.kernels import paired as kernel
from lostmotion.kernels.products import factorise, solve_ahead


@dataclass(frozen=True)
class Sums:
    """Products over the rows k with one of the two lags 0, in the order of the lags; inputs are advanced by the delay.

    Attributes
    ----------
    own : ndarray, shape (m, inputs)
        Of every signal with itself.
    mixed : ndarray, shape (2, pairs, inputs)
        Of the first of each pair with the second at the lag, and the other way round.
    ahead, behind : ndarray, shape (m, inputs) and (m, outputs + 1)
        Of PV with the signals at the lag, and of PV at the lag with the signals.
    level : ndarray, shape (m,)
        Of the signals with 1.
    """

    own: FloatArray
    mixed: FloatArray
    ahead: FloatArray
    behind: FloatArray
    level: FloatArray


class InputSignals(ABC):
    """Signals that are piecewise linear in OP, and the pairs of them that are inputs of one regression."""

    @property
    @abstractmethod
    def knots(self) -> FloatArray:
        """Where they bend or jump, ascending, 255 at most."""

    @property
    @abstractmethod
    def pairs(self) -> IntArray:
        """Indices of two signals each, shape (pairs, 2)."""

    @abstractmethod
    def values(self, u: FloatArray) -> FloatArray:
        """Of all signals, shape (m, *u.shape)."""

    @abstractmethod
    def sums(self, tables: Tables) -> Sums:
        """Products of lag 0 with all lags."""


@dataclass(frozen=True)
class Tables:
    """Rows of a record, the cells of OP that its samples are in, and the sums over them.

    A cell goes from a knot, itself not included, to the next one; `origin` is the knot below it, the first knot in the
    lowest cell.
    """

    signals: Signals
    lags: Lags
    knots: FloatArray

    @cached_property
    def rows(self) -> list[tuple[int, int]]:
        """First and last row with a complete past."""
        return self.lags.rows(self.signals.segments)

    @cached_property
    def samples(self) -> int:
        """Rows in all."""
        return sum(stop - start for start, stop in self.rows)

    @cached_property
    def cell(self) -> by_cell.Cells:
        """Cell of every sample."""
        return np.searchsorted(self.knots, self.signals.u).astype(np.uint8)

    @cached_property
    def origin(self) -> FloatArray:
        """Of the cells."""
        return np.concatenate([self.knots[:1], self.knots])

    def pairs(self) -> FloatArray:
        """(1, s)(k) (1, s)(k - lag) by the cells of both, s counted from the origin: (lags, 2 cells, 2 cells)."""
        n, size = self.lags.inputs, self.origin.size
        table = np.zeros((n, size, size, 4))
        for start, stop in self._advanced():
            by_cell.add_pairs(self.signals.u, self.cell, self.origin, start, stop, table)
        parted = table.reshape(n, size, size, 2, 2).transpose(0, 1, 3, 2, 4)
        return parted.reshape(n, 2 * size, 2 * size)

    def lower(self) -> FloatArray:
        """Samples whose lower cell of lag 0 and the lag is this: (lags, cells)."""
        table = np.zeros((self.lags.inputs, self.origin.size))
        for start, stop in self._advanced():
            by_cell.add_lower(self.cell, start, stop, table)
        return table

    def with_output(self) -> tuple[FloatArray, FloatArray]:
        """PV with (1, s) at the lag, and PV at the lag with (1, s): (inputs, 2 cells) and (outputs + 1, 2 cells)."""
        return self._with(self.signals.y, 0, self.lags.outputs + 1)

    def with_command(self) -> tuple[FloatArray, FloatArray]:
        """The same with OP instead of PV."""
        return self._with(self.signals.u, self.lags.delay, self.lags.inputs)

    def _with(self, signal: FloatArray, ahead: int, most: int) -> tuple[FloatArray, FloatArray]:
        size, delay = self.origin.size, self.lags.delay
        first, second = np.zeros((self.lags.inputs, size, 2)), np.zeros((most, size, 2))
        for start, stop in self.rows:
            rows = (self.signals.u, self.cell, self.origin, delay, start, stop)
            by_cell.add_behind(signal, ahead, *rows, first)
            by_cell.add_ahead(signal, ahead, *rows, second)
        return first.reshape(-1, 2 * size), second.reshape(-1, 2 * size)

    def _advanced(self) -> list[tuple[int, int]]:
        return [(start - self.lags.delay, stop - self.lags.delay) for start, stop in self.rows]


@dataclass(frozen=True)
class PairedRegressions:
    """Regressions of PV on its past, a constant, and the lags of both signals of a pair.

    Attributes
    ----------
    rss, rss_of_sum : ndarray, shape (pairs,)
        Residual sums of squares, with the signals apart and with their sum.
    gains : ndarray, shape (pairs, 2)
        Sums of the coefficients of either signal.
    samples : int
        Rows.
    """

    rss: FloatArray
    rss_of_sum: FloatArray
    gains: FloatArray
    samples: int


def regress_on_pairs(inputs: InputSignals, signals: Signals, lags: Lags, uniform: bool) -> PairedRegressions:
    """Regressions on every pair over all rows with a complete past.

    A share RIDGE keeps them solvable: of the largest variance of a regression where `uniform`, else of each.
    """
    tables = Tables(signals, lags, inputs.knots)
    sums = inputs.sums(tables)
    ends = _Ends.of(tables)
    drive = inputs.values(ends.u)
    past = _Past.of(tables, ends, sums, drive)
    own = np.empty((len(drive), lags.inputs, lags.inputs))
    for table, row, ahead, values in zip(own, sums.own, past.products, drive, strict=True):
        row = np.ascontiguousarray(row)  # noqa: PLW2901  of one layout: another is compiled anew
        kernel.shifted(row, row, values * ends.signs[:, None], values, table)
        kernel.without(table, ahead, ahead)
    pairs = len(inputs.pairs)
    squares, gains = np.empty((2, pairs)), np.empty((pairs, 2, lags.inputs))
    kernel.regressions(
        own,
        np.ascontiguousarray(sums.mixed),
        drive,
        ends.signs,
        past.products,
        past.cross,
        inputs.pairs,
        RIDGE,
        uniform,
        squares,
        gains,
    )
    rss = np.maximum(past.total - squares, 0.0)
    return PairedRegressions(rss[0], rss[1], gains.sum(axis=2), tables.samples)


@dataclass(frozen=True)
class _Ends:
    """Rows before the first one and at the last one, by lag: what a lag more lets in and out.

    Attributes
    ----------
    u, y : ndarray, shape (ends, lags)
    signs : ndarray, shape (ends,)
        1 in front, -1 behind.
    """

    u: FloatArray
    y: FloatArray
    signs: FloatArray

    @classmethod
    def of(cls, tables: Tables) -> _Ends:
        lags, signals = tables.lags, tables.signals
        rows = np.array(tables.rows)
        at = np.concatenate([rows[:, 0], rows[:, 1]])[:, None]
        signs = np.repeat([1.0, -1.0], len(rows))
        # lag 0 lets nothing in or out, and at the last row there is no sample of it
        inputs, outputs = (np.maximum(np.arange(size), 1) for size in (lags.inputs, lags.outputs + 1))
        return cls(signals.u[at - lags.delay - inputs], signals.y[at - outputs], signs)


@dataclass(frozen=True)
class _Past:
    """What a constant and past outputs explain.

    Attributes
    ----------
    products : ndarray, shape (m, k, inputs)
        Products of the lags of every signal with the past, made orthonormal.
    cross : ndarray, shape (m, inputs)
        Of PV with the lags, the past taken away.
    total : float
        Sum of squares of PV, the past taken away.
    """

    products: FloatArray
    cross: FloatArray
    total: float

    @classmethod
    def of(cls, tables: Tables, ends: _Ends, sums: Sums, drive: FloatArray) -> _Past:
        products, cross, total = past_products(tables.signals, tables.lags)
        block, target = products + RIDGE * np.diag(np.diag(products) + np.finfo(float).tiny), cross.copy()
        with_past, with_output = _past_inputs(ends, sums, drive)
        known = factorise(block, target)
        for table in with_past:
            solve_ahead(block, table)
        return cls(with_past, with_output - target @ with_past, total - float(known))


def _past_inputs(ends: _Ends, sums: Sums, drive: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Products of the lags of every signal with 1 and past outputs (m, k, inputs), and with PV (m, inputs)."""
    products = np.empty((len(drive), ends.y.shape[1], drive.shape[2]))
    signed = ends.y * ends.signs[:, None]
    for table, row, column, values in zip(products, sums.ahead, sums.behind, drive, strict=True):
        kernel.shifted(np.ascontiguousarray(row), np.ascontiguousarray(column), signed, values, table)
    with_output = products[:, 0].copy()
    level = (drive * ends.signs[:, None]).sum(axis=1)
    level[:, 0] = sums.level
    products[:, 0] = np.cumsum(level, axis=1)
    return products, with_output
