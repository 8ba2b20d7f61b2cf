"""What a historian does to a signal, from the description of its compression, sample by sample."""

import numpy as np


def swinging_door(values, deviation):
    """Stored points such that straight lines between them miss no sample by more than `deviation`; interpolated."""
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
    return np.interp(np.arange(len(values)), stored, values[stored])


def exceptions(values, deadband):
    """The last stored value until one differs by more than `deadband`."""
    out, last = np.empty(len(values)), values[0]
    for k, value in enumerate(values):
        if abs(value - last) > deadband:
            last = value
        out[k] = last
    return out
