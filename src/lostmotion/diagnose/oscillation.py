"""Does a signal oscillate? Period, regularity and share of the variance, from the autocorrelation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.fft

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.filters import crossings, high_pass, low_pass, standard_signal, without_line

LEAST = 32  # samples
LEAST_CYCLES = 3.0  # in the record: of a slower line the spectrum does not tell drift
SETTLED = 0.01  # of the period
MOST_ROUNDS = 4  # of 120 signals 8 still move by over 1 % after them; whether one is regular changes in none
CANDIDATES = 4  # spectral peaks that are tried
MOST_CROSSINGS = 11  # of the autocorrelation, as published: later ones are noise where the period wanders
SLOWEST = 3.0  # periods: what is slower counts as drift
FASTEST = 3.5  # harmonics kept before the autocorrelation
HARMONICS = 5  # counted: 99.9 % of the power of a triangle, 93 % of that of a square wave
BAND = 0.25  # of the frequency, on both sides of every harmonic
WINDOW = 1.5  # cycles a record: so far the Hann window smears a line; matters below six periods a record
LEAST_SHARE = 0.5  # of the variance: an oscillation below it is not what matters about the loop
FEWEST_CYCLES = 4.0  # in the record: fewer may be chance
MOST_REGULAR = 1000.0  # half periods without noise have no spread to divide by


@dataclass(frozen=True)
class Oscillation:
    """The strongest oscillation of a signal.

    Parameters
    ----------
    period : float
        In samples.
    regularity : float
        Mean over three standard deviations of the intervals between zero crossings of the autocorrelation; above 1
        the oscillation counts as regular. At most 1000; 0: too few crossings to tell.
    share : float
        Part of the variance within 25 % of the frequency around it and its harmonics up to the fifth, of all that is
        not slower than 3 periods; 0 to 1.
    cycles : float
        Periods in the record.
    """

    period: float
    regularity: float
    share: float
    cycles: float

    @property
    def regular(self) -> bool:
        """True where the regularity is above 1, the published limit."""
        return self.regularity > 1.0


def find_oscillation(x: FloatArray) -> Oscillation:
    """Find the strongest oscillation of a signal that may drift.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Finite, uniformly sampled; OP or PV.

    Returns
    -------
    Oscillation
        Always one; look at its `regularity` and `share` before believing it.

    Raises
    ------
    DataError
        Fewer than 32 samples, or a constant.

    Notes
    -----
    After Thornhill, Huang and Zhang (2003), "Detection of multiple oscillations in control loops", J. Process
    Control 13. Their filter band is chosen by eye; here the four largest peaks of the power per octave (a drift has
    most of its power below three cycles a record and little per octave above) are tried. Around each, what is slower
    than 3 periods and faster than 3.5 harmonics is taken out, and the period is twice the mean interval between
    zero crossings of the autocorrelation; again around the period so found until it
    stays. The peak whose regularity (up to 1) times share is largest wins.

    Examples
    --------
    >>> found = find_oscillation(np.sin(2 * np.pi * np.arange(1000) / 40) + 0.01 * np.arange(1000))
    >>> round(found.period, 1), found.regular, round(found.share, 2), round(found.cycles)
    (40.0, True, 1.0, 25)
    """
    signal = without_line(standard_signal("x", x, LEAST))
    found = [_settled(signal, period) for period in _candidates(signal)]
    return max(found, key=lambda one: min(one.regularity, 1.0) * one.share)


def oscillation_near(x: FloatArray, period: float) -> Oscillation:
    """Measure the oscillation whose period is known about; faster than looking for the strongest.

    Raises
    ------
    DataError
        Fewer than 32 samples, or a constant.
    """
    return _settled(without_line(standard_signal("x", x, LEAST)), period)


def _candidates(x: FloatArray) -> list[float]:
    """Periods of the largest peaks of the power per octave, largest first, of at least three cycles each."""
    power = _power(x)
    cycles = np.arange(power.size)
    per_octave = power * cycles
    inner = per_octave[1:-1]
    peaks = np.flatnonzero((inner > per_octave[:-2]) & (inner >= per_octave[2:])) + 1
    peaks = peaks[peaks >= LEAST_CYCLES]
    if not peaks.size:
        peaks = np.array([int(LEAST_CYCLES) + int(np.argmax(per_octave[int(LEAST_CYCLES) :]))])
    largest = peaks[np.argsort(-per_octave[peaks], kind="stable")][:CANDIDATES]
    return [float(period) for period in x.size / cycles[largest]]


def _settled(x: FloatArray, period: float) -> Oscillation:
    """Measure around a spectral peak, then around what was found there, until that stays."""
    found = _measure(x, period)
    for _ in range(MOST_ROUNDS):
        if abs(found.period - period) <= SETTLED * period:
            break
        period = found.period
        found = _measure(x, period)
    return found


def _measure(x: FloatArray, period: float) -> Oscillation:
    """Period and regularity from the autocorrelation around a spectral peak."""
    slow = high_pass(x, SLOWEST * period)
    at = crossings(_autocorrelation(low_pass(slow, period / FASTEST)))[:MOST_CROSSINGS]
    regularity = 0.0
    if at.size >= 3:
        gaps = np.diff(at)
        mean = float(gaps.mean())
        period = max(2.0 * mean, 2.0)
        regularity = mean / max(3.0 * float(gaps.std(ddof=1)), mean / MOST_REGULAR)
    return Oscillation(period, regularity, _share(x, period), x.size / period)


def _autocorrelation(x: FloatArray) -> FloatArray:
    """At lags 0 to n - 1, scaled to 1 at lag 0."""
    size = scipy.fft.next_fast_len(2 * x.size, real=True)
    products = scipy.fft.irfft(np.abs(scipy.fft.rfft(x, size)) ** 2, size)[: x.size]
    return np.asarray(products / max(products[0], 1e-300))


def _share(x: FloatArray, period: float) -> float:
    """Part of the variance around the frequency and its harmonics."""
    power = _power(high_pass(x, SLOWEST * period))
    order = np.arange(power.size) * (period / x.size)
    nearest = np.clip(np.round(order), 1, HARMONICS)
    band = max(BAND, WINDOW / x.size * period)
    return float(power[np.abs(order - nearest) <= band].sum() / max(power.sum(), 1e-300))


def _power(x: FloatArray) -> FloatArray:
    """Power at 0, 1, 2, .. cycles a record, through a Hann window."""
    return np.asarray(np.abs(scipy.fft.rfft(x * np.hanning(x.size))) ** 2)
