"""Filters without delay that do not bend a record at its ends; shared by the indices."""

from __future__ import annotations

import math

import numpy as np
import scipy.fft

from lostmotion.arguments import finite, finite_signal
from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError, ParameterError


def standard_signal(name: str, values: FloatArray, least: int) -> FloatArray:
    """`values` less their mean and over their standard deviation.

    Raises
    ------
    DataError
        Fewer than `least` samples, a constant, or a value that is not finite.
    """
    x = finite_signal(name, values)
    if x.size < least:
        raise DataError.expected(f"{name} with at least {least} samples", x.size, "give a longer record")
    scale = float(np.abs(x).max())
    x = x / (scale or 1.0)  # so that squares of very large and very small numbers stay finite
    x -= x.mean()
    spread = float(x.std())
    if spread <= 1e-12:
        raise DataError.expected(f"{name} that moves", "a constant", "choose a stretch in which the loop was at work")
    return np.asarray(x / spread)


def checked_period(period: float, n: int) -> float:
    """A period in samples of which the record of n samples holds two.

    Raises
    ------
    ParameterError
        A period below 4 samples.
    DataError
        A record shorter than two periods.
    """
    if not finite("period", period) >= 4.0:
        raise ParameterError.expected("a period of 4 samples or more", period, "give it in samples")
    if n < 2.0 * period:
        raise DataError.expected(f"two periods of {period:.4g} samples", f"{n} samples", "give a longer record")
    return float(period)


def low_pass(x: FloatArray, shortest: float) -> FloatArray:
    """The signal without what is faster than a period of `shortest` samples.

    The cosine transform mirrors the record at its ends, so that no step arises there.
    """
    spectrum = scipy.fft.dct(x, norm="ortho")
    spectrum[math.floor(2.0 * x.size / shortest) + 1 :] = 0.0
    return np.asarray(scipy.fft.idct(spectrum, norm="ortho"))


def without_trend(x: FloatArray, period: float) -> FloatArray:
    """The signal without what is slower than `period` samples; an oscillation of this period stays as it is.

    The trend is the mean over one period, taken twice (a mean over exactly one period is blind to it), and is
    continued as a straight line over the first and the last period, where the window is not full.
    """
    kernel = _mean_over(period)
    trend = np.convolve(x, kernel, "valid")
    if trend.size >= kernel.size:
        trend = np.convolve(trend, kernel, "valid")
    lost = (x.size - trend.size) // 2
    reach = min(max(int(period) // 2, 1), trend.size - 1)
    ahead = np.arange(1, lost + 1) / reach if reach else np.zeros(lost)
    first = trend[0] - (trend[reach] - trend[0]) * ahead[::-1]
    last = trend[-1] + (trend[-1] - trend[-1 - reach]) * ahead
    return np.asarray(x - np.concatenate([first, trend, last]))


def _mean_over(period: float) -> FloatArray:
    """Weights of the mean over a period that need not be a whole number: the ends count in part."""
    half = math.ceil((period - 1.0) / 2.0)
    kernel = np.ones(2 * half + 1)
    kernel[[0, -1]] = (period - (2 * half - 1)) / 2.0
    return np.asarray(kernel / period)


def crossings(x: FloatArray) -> FloatArray:
    """Times in samples at which x goes through zero, between the samples by a straight line."""
    sign = np.where(x >= 0.0, 1, -1)
    at = np.flatnonzero(np.diff(sign))
    return np.asarray(at + x[at] / (x[at] - x[at + 1]))


def high_pass(x: FloatArray, longest: float) -> FloatArray:
    """The signal without what is slower than a period of `longest` samples, by the cosine transform; ends mirrored."""
    spectrum = scipy.fft.dct(x, norm="ortho")
    spectrum[: math.ceil(2.0 * x.size / longest)] = 0.0
    return np.asarray(scipy.fft.idct(spectrum, norm="ortho"))


def without_line(x: FloatArray) -> FloatArray:
    """The signal without its straight line of least squares."""
    t = np.arange(x.size) - (x.size - 1) / 2.0
    return np.asarray(x - x.mean() - t * (t @ x / (t @ t)))
