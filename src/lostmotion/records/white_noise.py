"""Noise in a signal that moves slowly or in steps."""

from __future__ import annotations

import math

import numpy as np

from lostmotion.arrays import FloatArray


def noise_of(values: FloatArray) -> float:
    """Standard deviation of white noise in a record, from its second differences (robust); 0 where it is held.

    Parameters
    ----------
    values : ndarray, shape (n,)
        OP or PV without missing samples; the answer is in its units.

    Examples
    --------
    >>> noise_of(np.repeat([1.0, 2.0], 50))
    0.0
    """
    second = np.abs(np.diff(values, 2))
    return float(1.4826 * np.median(second) / math.sqrt(6.0)) if second.size else 0.0
