"""Gram matrices of high-order ARX models: the past of the output and lagged inputs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.likelihood.remembered import remembered
from lostmotion.identify.scaled import Signals
from lostmotion.kernels.products import add_lagged_table, add_products

# an ARX this long needs neither orders nor a noise model: at the true cell in 10 of 10 drifting closed loops
OUTPUT_LAGS = 15
INPUT_LAGS = 12
RIDGE = 1e-10  # relative; keeps noise-free Gram matrices invertible


@dataclass(frozen=True)
class Lags:
    """Past outputs and inputs of the ARX, and the delay before its first input."""

    outputs: int
    inputs: int
    delay: int

    @classmethod
    def for_record(cls, shortest: int, delay: int, outputs: int = OUTPUT_LAGS, inputs: int = INPUT_LAGS) -> Lags:
        """As many as a record of `shortest` samples carries."""
        room = max((shortest - delay) // 10, 2)
        return cls(min(outputs, room), min(inputs, room), delay)

    @property
    def head(self) -> int:
        """Rows without a complete past."""
        return max(self.outputs, self.inputs - 1) + self.delay

    def rows(self, segments: IntArray) -> list[tuple[int, int]]:
        """First and last row with a complete past, of every segment that has one."""
        bounds = [(start + self.head, stop) for start, stop in segments.tolist()]
        return [(start, stop) for start, stop in bounds if stop > start]


def arx_products(x: FloatArray, signals: Signals, lags: Lags) -> tuple[FloatArray, FloatArray, float, int]:
    """Gram matrix of 1, past outputs and lags of x; their products with y; sum of squares of y; and the rows used."""
    own, known, total = past_products(signals, lags)
    table = np.zeros((lags.outputs + lags.inputs + 2, lags.inputs))
    for start, stop in lags.rows(signals.segments):
        add_lagged_table(signals.y, lags.outputs, x, lags.delay, lags.inputs, start, stop, table)
    mixed = table[: lags.outputs + 1]
    gram = np.block([[own, mixed], [mixed.T, table[lags.outputs + 1 : -1]]])
    return gram, np.concatenate([known, table[-1]]), total, int(own[0, 0])


@remembered
def past_products(signals: Signals, lags: Lags) -> tuple[FloatArray, FloatArray, float]:
    """Gram matrix of 1 and past outputs (first element: rows), their products with y, and sum of squares of y."""
    y, most = signals.y, lags.outputs + 1
    table, level = np.zeros((most, most)), np.zeros(most)
    samples = 0
    for start, stop in lags.rows(signals.segments):
        samples += stop - start
        add_products(y, 0, most, y, 0, most, start, stop, table)
        level += [y[start - lag : stop - lag].sum() for lag in range(most)]
    known, total = np.append(level[0], table[0, 1:]), float(table[0, 0])
    table[0], table[:, 0], table[0, 0] = level, level, samples
    return table, known, total
