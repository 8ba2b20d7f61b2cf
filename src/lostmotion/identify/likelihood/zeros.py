"""Signals seen through the zeros of the noise, behind which it is autoregressive."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter, lfilter_zi

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.smoothed import roughen, smooth, smooth_rows


def seen_through(signals: FloatArray, zero: float, c: tuple[float, ...], segments: IntArray) -> FloatArray:
    """One signal (n,) or several (m, n) through 1 / C(q), or (1 - zero) / (1 - zero q^-1); themselves without zeros.

    Each segment begins as if its first value had always been there.
    """
    if not c and zero == 0.0:
        return signals
    found = np.zeros(signals.shape)
    if c:
        rest = lfilter_zi([1.0], [1.0, *c])
        for start, stop in segments.tolist():
            begun = signals[..., start, None] * rest
            found[..., start:stop] = lfilter([1.0], [1.0, *c], signals[..., start:stop], zi=begun)[0]
    elif signals.ndim == 1:
        smooth(signals, zero, segments, found)
    else:
        smooth_rows(signals, zero, segments, found)
    return found


def before(seen: FloatArray, zero: float, c: tuple[float, ...]) -> FloatArray:
    """The signal of one stretch (n,) before them; the first rows, behind which lies what was before, repeat."""
    if not c:
        return np.asarray(roughen(seen, zero))
    found = lfilter([1.0, *c], [1.0], seen)
    found[: len(c)] = found[len(c) : len(c) + 1]
    return np.asarray(found)
