"""What a historian does to a signal, from the description of its compression, sample by sample."""

import numpy as np


def swinging_door(values, deviation):
    """Straight lines between the stored points."""
    stored = by_swinging_door(values, deviation)
    return np.interp(np.arange(len(values)), stored, values[stored])


def by_swinging_door(values, deviation):
    """Rows that are stored such that straight lines between them miss no sample by more than `deviation`."""
    stored, start = [0], 0
    low, high = -np.inf, np.inf
    for k in range(1, len(values)):
        lower = max(low, (values[k] - deviation - values[start]) / (k - start))
        upper = min(high, (values[k] + deviation - values[start]) / (k - start))
        if lower > upper and k - 1 > start:
            stored.append(k - 1)
            start = k - 1
            lower, upper = values[k] - deviation - values[start], values[k] + deviation - values[start]
        low, high = lower, upper
    stored.append(len(values) - 1)
    return np.array(stored)


def exceptions(values, deadband):
    """The last stored value until one differs by more than `deadband`."""
    stored = by_exception(values, deadband)
    return np.repeat(values[stored], np.diff([*stored, len(values)]))


def by_exception(values, deadband):
    """Rows that are stored: those that differ from the last one by more than `deadband`."""
    stored = [0]
    for k, value in enumerate(values):
        if abs(value - values[stored[-1]]) > deadband:
            stored.append(k)
    return np.array(stored)
