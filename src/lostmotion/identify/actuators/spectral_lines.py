"""Lines in the periodogram of a signal: periods that stand out from what is about them."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import median_filter

from lostmotion.arrays import FloatArray

PADDING = 16  # of the periodogram
SHORTEST_PERIOD, FEWEST_PERIODS = 4.0, 6.0
NEIGHBOURS = 41  # lines of the periodogram whose median is the level about a line
MOST_LINES = 4  # the loudest; what they leave is asked again in the next round of loads
MAIN_SHARE = 0.4  # of the variance, of the swing of the loop itself
STANDS_OUT = 12.0  # times the level about a line: an exponential variable does so once in 10^5


def lines(x: FloatArray) -> list[tuple[float, float]]:
    """Periods of the lines of a signal that stand out from their neighbours, and how far, largest first."""
    n = x.size
    if n < 2 * NEIGHBOURS:
        return []
    power = np.abs(np.fft.rfft((x - x.mean()) * np.hanning(n))) ** 2
    level = median_filter(power, NEIGHBOURS, mode="nearest") / np.log(2.0)
    first = int(FEWEST_PERIODS)
    ratio = power[first : int(n / SHORTEST_PERIOD)] / np.maximum(level[first : int(n / SHORTEST_PERIOD)], 1e-300)
    found: list[tuple[int, float]] = []
    for index in np.argsort(-ratio).tolist():
        if not ratio[index] > STANDS_OUT:
            break
        if all(abs(index + first - line) > 2 for line, _ in found):
            found.append((index + first, float(ratio[index])))
    return [(1.0 / _finest(x, line), size) for line, size in found[:MOST_LINES]]


def dominant(x: FloatArray) -> float | None:
    """Period of the line that is most of a signal; None where it does not swing so."""
    shares = {period: share_of(x, period) for period, _ in lines(x)}
    period = max(shares, key=lambda one: shares[one], default=None)
    return period if period is not None and shares[period] > MAIN_SHARE else None


def share_of(x: FloatArray, period: float) -> float:
    """Share of the variance of a signal that is a sine of this period."""
    wave = np.exp(-2j * np.pi / period * np.arange(x.size))
    return float(2.0 * np.abs(wave @ (x - x.mean())) ** 2 / (x.size**2 * max(float(x.var()), 1e-300)))


def _finest(x: FloatArray, line: int) -> float:
    """Frequency (1/samples) of the largest line within one of the grid of the periodogram."""
    n = x.size
    trials = (line + np.linspace(-1.0, 1.0, 2 * PADDING + 1)) / n
    waves = np.exp(-2j * np.pi * np.outer(trials, np.arange(n)))
    return float(trials[int(np.argmax(np.abs(waves @ (x - x.mean()))))])
