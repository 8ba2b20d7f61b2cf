"""How much of a swing two loops share, and how often chance would make as much: from the lines of the store."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from lostmotion.arrays import ComplexArray, FloatArray
from lostmotion.audit.screen.lines import Lines, octave_of, taper

Windows = Sequence[tuple[datetime, dict[int, Lines]]]  # beginning and bands of each

HALF = 0.25  # of a frequency to both sides: periods of one swing are estimated up to 17 % apart
LAG, LAGS = 1.0, 17  # periods that one may be behind or ahead of the other, and how many of them are tried
WIDER = 1.22  # lines that the taper makes of one
TONE = 2.0  # lines within which two pure tones agree
LEAST_POWER = 0.5  # of tones the coherence falls with the square of their distance
SAME_TIME = 0.05  # periods by which begins or ends may differ, to be the same
LEAST_CYCLES = 3.0  # in common


@dataclass(frozen=True)
class Shared:
    """What two loops have in common about a period.

    Attributes
    ----------
    coherence : float
        Share of the power of one that follows from the other by a gain and a lag, 0 to 1.
    chance : float
        Probability of as much between loops that share nothing.
    """

    coherence: float
    chance: float


NOTHING = Shared(0.0, 1.0)


def shared(first: Windows, second: Windows, period: float) -> Shared:
    """Compare two loops about a period (s), in the time that they have in common.

    Notes
    -----
    Of two Gaussian signals with n lines each that share nothing, the coherence c is exceeded with a probability of
    (1 - c)^(n - 1). Lines are counted by how the powers of both lie on each other, 1 / sum(p q) with shares p and q: a
    pure tone is one line, and two tones at one place are always coherent. That they are at one place counts then: of
    m lines of the band 2 n / m are as near, and how near within a line c says (a power of a half, at least). The lags
    that are tried are 1 + 2 n / N chances, with N periods.

    It is what chance makes, or a little more: benchmarks/audit/groups.py compares loops of different plants.
    """
    pairs = list(_pairs(first, second, period))
    if not pairs:
        return NOTHING
    one, other, frequencies = (
        np.concatenate(parts) for parts in zip(*((x, y, f) for x, y, f, _ in pairs), strict=True)
    )
    powers = np.abs(one) ** 2, np.abs(other) ** 2
    total = float(powers[0].sum() * powers[1].sum())
    if not total > 0.0:
        return NOTHING
    turns = np.exp(2j * np.pi * np.outer(np.linspace(-LAG, LAG, LAGS) * period, frequencies))
    coherence = min(float(np.max(np.abs(turns @ (one * other.conj()))) ** 2) / total, 1.0)
    along = float(powers[0] @ powers[1])
    count = max(min(total / along if along > 0.0 else np.inf, one.size) / WIDER, 1.0)
    tries = 1.0 + 2.0 * LAG * count * period / sum(seconds for *_, seconds in pairs)
    near = min(TONE * count / one.size, 1.0)
    return Shared(coherence, min(tries * near * (1.0 - coherence) ** max(count - 1.0, LEAST_POWER), 1.0))


def _pairs(
    first: Windows, second: Windows, period: float
) -> Iterator[tuple[ComplexArray, ComplexArray, FloatArray, float]]:
    """Lines of both about the period, their frequencies, and seconds, of each two windows with time in common."""
    octave = octave_of((1.0 - HALF) / period)
    for start, bands in first:
        for begin, others in second:
            if octave in bands and octave in others:
                found = _pair(bands[octave], others[octave], (begin - start).total_seconds(), period)
                if found is not None:
                    yield found


def _pair(
    one: Lines, other: Lines, later: float, period: float
) -> tuple[ComplexArray, ComplexArray, FloatArray, float] | None:
    """Of one pair; `later` is by how many seconds the second begins after the first."""
    if max(abs(later), abs(one.seconds - other.seconds)) > SAME_TIME * period:
        begin, end = max(0.0, later), min(one.seconds, later + other.seconds)
        if end - begin < LEAST_CYCLES * period:
            return None
        one, other = _part(one, begin, end - begin, period), _part(other, begin - later, end - begin, period)
    first, last = (int(np.ceil((1.0 - HALF) / period * one.seconds)), int((1.0 + HALF) / period * one.seconds))
    if last <= first:
        return None
    frequencies = np.arange(first, last + 1) / one.seconds
    return _between(one, first, last), _between(other, first, last), frequencies, one.seconds


def _between(lines: Lines, first: int, last: int) -> ComplexArray:
    """Lines of these numbers, 0 where there are none."""
    found = np.zeros(last - first + 1, dtype=np.complex128)
    low, high = max(first, lines.first), min(last + 1, lines.first + lines.values.size)
    if high > low:
        found[low - first : high - first] = lines.values[low - lines.first : high - lines.first]
    return found


def _part(lines: Lines, begin: float, seconds: float, period: float) -> Lines:
    """Lines about a period of a part of the time."""
    size = int(np.ceil(4.0 * seconds / period))
    times = begin + np.arange(size) * seconds / size
    first, last = int((1.0 - 2.0 * HALF) / period * lines.seconds), int((1.0 + 2.0 * HALF) / period * lines.seconds) + 1
    numbers = np.arange(first, last + 1) / lines.seconds
    values = np.exp(2j * np.pi * np.outer(times, numbers)) @ _between(lines, first, last)
    return Lines(seconds, 0, np.fft.fft(values * taper(size)))
