"""The inputs by which dead zones are sought: hinges at either break point, and jumps where narrow ones would be."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.actuators.paired_inputs import InputSignals, Sums, Tables
from lostmotion.kernels.products import add_products


@dataclass(frozen=True)
class Hinges(InputSignals):
    """min(u - left, 0) and max(u - right, 0); paired where left <= right."""

    left: FloatArray
    right: FloatArray

    @cached_property
    def knots(self) -> FloatArray:
        """All break points."""
        return np.unique(np.concatenate([self.left, self.right]))

    @cached_property
    def places(self) -> IntArray:
        """Indices of left and right of every pair."""
        return np.argwhere(self.left[:, None] <= self.right)

    @cached_property
    def pairs(self) -> IntArray:
        """The same as indices of signals: first all of the left side."""
        return np.column_stack([self.places[:, 0], self.left.size + self.places[:, 1]])

    def values(self, u: FloatArray) -> FloatArray:
        """Of all hinges."""
        below = [np.minimum(u - left, 0.0) for left in self.left]
        return np.stack([*below, *(np.maximum(u - right, 0.0) for right in self.right)])

    def sums(self, tables: Tables) -> Sums:
        """From the sums over cells, in each of which a hinge is a straight line or nothing."""
        lines, table = self._lines(tables.origin), tables.pairs()
        ahead, behind = tables.with_output()
        first, second = self.pairs.T
        by_cell = lines @ table
        return Sums(
            own=(by_cell * lines).sum(axis=2).T,
            mixed=np.stack([(by_cell[:, i] * lines[j]).sum(axis=2).T for i, j in ((first, second), (second, first))]),
            ahead=lines @ ahead.T,
            behind=lines @ behind.T,
            level=lines @ table[0, :, ::2].sum(axis=1),
        )

    def _lines(self, origin: FloatArray) -> FloatArray:
        """Value at the origin and slope of every hinge in every cell, (hinges, 2 cells)."""
        ends = np.append(self.knots, np.inf)  # upper ends of the cells
        below = ends <= self.left[:, None]
        above = ends > self.right[:, None]
        slope = np.concatenate([below, above]).astype(np.float64)
        bends = np.concatenate([self.left, self.right])[:, None]
        return np.stack([slope * (origin - bends), slope], axis=2).reshape(len(slope), -1)


@dataclass(frozen=True)
class Jumps(InputSignals):
    """The signal u, paired with [u > place] of every place."""

    at: FloatArray

    @property
    def knots(self) -> FloatArray:
        """The places."""
        return self.at

    @cached_property
    def pairs(self) -> IntArray:
        """Signal 0 is u."""
        places = np.arange(1, self.knots.size + 1)
        return np.column_stack([np.zeros_like(places), places])

    def values(self, u: FloatArray) -> FloatArray:
        """Of u and all jumps."""
        return np.stack([u, *((u > place).astype(np.float64) for place in self.knots)])

    def sums(self, tables: Tables) -> Sums:
        """Both samples are beyond a place where the lower of their cells is."""
        u, y, lags = tables.signals.u, tables.signals.y, tables.lags
        own, with_output = np.zeros((1, lags.inputs)), np.zeros((lags.outputs + 1, lags.inputs))
        level = 0.0
        for start, stop in tables.rows:
            add_products(u, lags.delay, 1, u, lags.delay, lags.inputs, start, stop, own)
            add_products(y, 0, lags.outputs + 1, u, lags.delay, lags.inputs, start, stop, with_output)
            level += float(u[start - lags.delay : stop - lags.delay].sum())
        jumps = _beyond(tables.lower())
        ahead, behind = (_beyond(table[:, ::2]) for table in tables.with_output())
        return Sums(
            own=np.concatenate([own, jumps]),
            mixed=np.stack([_beyond(table[:, ::2]) for table in tables.with_command()]),
            ahead=np.concatenate([with_output[:1], ahead]),
            behind=np.concatenate([with_output[:, 0][None], behind]),
            level=np.append(level, jumps[:, 0]),
        )


def _beyond(by_cell: FloatArray) -> FloatArray:
    """Sums over the cells above each place, (places, lags), from those of each cell (lags, cells)."""
    return by_cell[:, :0:-1].cumsum(axis=1)[:, ::-1].T
