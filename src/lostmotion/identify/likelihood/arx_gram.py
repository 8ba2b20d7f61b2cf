"""Gram matrices of high-order ARX models: the past of the output and lagged inputs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.scaled import Signals
from lostmotion.kernels.lagged import lagged_gram

# an ARX this long needs neither orders nor a noise model: at the true cell in 10 of 10 drifting closed loops
OUTPUT_LAGS = 15
INPUT_LAGS = 12
CHUNK = 8192  # rows of which the input signals exist at once
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


def arx_gram(inputs: Callable[[int, int], FloatArray], signals: Signals, lags: Lags) -> tuple[FloatArray, int]:
    """Gram matrix of [y, 1, inputs] at lags 0 .. max, inputs advanced by the delay; and the rows used.

    `inputs` makes the signals (stop - start, m) of a range of rows, so that they never exist all at once.
    """
    length = max(lags.outputs + 1, lags.inputs)
    total: FloatArray | None = None
    samples = 0
    for start, stop in signals.segments:
        for row in range(start + lags.delay + length - 1, stop, CHUNK):
            head, end = row - length + 1, min(row + CHUNK, stop)
            ones = np.ones((end - head, 1))
            columns = np.concatenate(
                [signals.y[head:end, None], ones, inputs(head - lags.delay, end - lags.delay)], axis=1
            )
            gram = lagged_gram(columns, length, length - 1, end - head)
            total = gram if total is None else total + gram
            samples += end - row
    assert total is not None  # noqa: S101  there is always a segment
    return total, samples


def eliminate_past(gram: FloatArray, lags: Lags, inputs: int) -> tuple[FloatArray, FloatArray, float]:
    """Gram of the input columns, their products with y, and y'y, with past outputs and constant projected out.

    Input columns are ordered lag by lag.
    """
    m = inputs + 2
    past = np.concatenate([[1], m * np.arange(1, lags.outputs + 1)])
    columns = (m * np.arange(lags.inputs)[:, None] + 2 + np.arange(inputs)).ravel()
    block = gram[np.ix_(past, past)]
    block = block + RIDGE * np.diag(np.diag(block) + np.finfo(float).tiny)
    wanted = np.concatenate([columns, [0]])
    rest = gram[np.ix_(wanted, wanted)] - gram[np.ix_(wanted, past)] @ np.linalg.solve(
        block, gram[np.ix_(past, wanted)]
    )
    return rest[:-1, :-1], rest[:-1, -1], float(rest[-1, -1])
