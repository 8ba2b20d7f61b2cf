"""Regressions on lagged signals through the lagged matrix itself."""

import numpy as np


def lagged_matrix(y, outputs, signals, delay, inputs, rows):
    """One row for each k of `rows`: 1, y(k-1) .. y(k-outputs), then s(k-delay) .. s(k-delay-inputs+1) of every s."""
    return np.array(
        [
            [
                1.0,
                *(y[k - i] for i in range(1, outputs + 1)),
                *(s[k - delay - j] for s in signals for j in range(inputs)),
            ]
            for k in rows
        ]
    )


def regression(y, outputs, signals, delay, inputs, segments):
    """Residual sum of squares, and the sum of the coefficients of every signal."""
    head = max(outputs, inputs - 1) + delay
    rows = [k for start, stop in segments for k in range(start + head, stop)]
    matrix = lagged_matrix(y, outputs, signals, delay, inputs, rows)
    gains = np.linalg.lstsq(matrix, y[rows], rcond=None)[0]
    left = y[rows] - matrix @ gains
    return float(left @ left), gains[outputs + 1 :].reshape(len(signals), inputs).sum(axis=1)
