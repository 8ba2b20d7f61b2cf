"""Lines in the periodogram of a signal: periods that stand out from what is about them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import numpy.typing as npt
from scipy.fft import fft, next_fast_len
from scipy.ndimage import median_filter

from lostmotion.arrays import FloatArray

PADDING = 16  # of the periodogram
AT_ONCE = 32_768  # samples: more are transformed by parts, in a tenth of the memory and four times the time
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
    wave = abs(_transform(x - x.mean(), np.array([1.0 / period]))[0])
    return float(2.0 * wave**2 / (x.size**2 * max(float(x.var()), 1e-300)))


def strongest(x: FloatArray, made_inside: Callable[[FloatArray], npt.NDArray[np.bool_]]) -> tuple[float, float]:
    """Period of the sine that explains most of a signal, and its sum of squares; not of those that are made inside.

    On the grid of a transform of PADDING times the length. Of a long signal that is one transform for every fraction
    of a line by which it is moved, so that nothing of that length is ever in memory.
    """
    length = next_fast_len(x.size, real=True)  # lengths with a large prime take thirty times as long
    size = PADDING * length
    low, high = int(np.ceil(FEWEST_PERIODS * size / x.size)), int(size / SHORTEST_PERIOD)
    best = (0.0, low)
    for first, step, values in _spectra(x, length):
        skipped = max(-(-(low - first) // step), 0)
        found = np.arange(first + skipped * step, high, step)
        inside = values[skipped : skipped + found.size]
        power = (inside.real**2 + inside.imag**2) * (2.0 / x.size)
        power[made_inside(size / found)] = 0.0
        at = int(np.argmax(power))
        best = max(best, (float(power[at]), int(found[at])), key=lambda one: (one[0], -one[1]))
    return size / best[1], best[0]


def _spectra(x: FloatArray, length: int) -> Iterator[tuple[int, int, npt.NDArray[np.complex128]]]:
    """Lines first, first + step, .. of the grid of PADDING * length, up to signs and phases."""
    if x.size <= AT_ONCE:
        yield 0, 1, np.fft.rfft(x, PADDING * length)
        return
    for part in range(PADDING // 2 + 1):
        moved = np.zeros(length, complex)
        waves = moved[: x.size]
        np.multiply(np.arange(x.size), -2j * np.pi * part / (PADDING * length), out=waves)
        np.exp(waves, out=waves)
        waves *= x
        moved = fft(moved, overwrite_x=True)
        yield part, PADDING, moved
        if 0 < part < PADDING // 2:  # the same lines seen from the other side
            yield PADDING - part, PADDING, moved[::-1]


def _finest(x: FloatArray, line: int) -> float:
    """Frequency (1/samples) of the largest line within one of the grid of the periodogram."""
    trials = (line + np.linspace(-1.0, 1.0, 2 * PADDING + 1)) / x.size
    return float(trials[int(np.argmax(np.abs(_transform(x - x.mean(), trials))))])


def _transform(x: FloatArray, frequencies: FloatArray) -> npt.NDArray[np.complex128]:
    """Fourier transform at any frequencies (1/samples), by stretches: the waves never are of the length of x."""
    length = int(np.ceil(np.sqrt(x.size)))
    rows = -(-x.size // length)
    table = np.zeros(rows * length)
    table[: x.size] = x
    inner = np.exp(-2j * np.pi * np.outer(np.arange(length), frequencies))
    outer = np.exp(-2j * np.pi * length * np.outer(np.arange(rows), frequencies))
    return np.asarray((outer * (table.reshape(rows, length) @ inner)).sum(axis=0))
