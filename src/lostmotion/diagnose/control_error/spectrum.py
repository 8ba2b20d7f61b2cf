"""Power of the error of control over frequency, in 96 bins; periods at which it has peaks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.fft

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.oscillation import BAND, HARMONICS, SLOWEST

BINS = 96
LEAST_ROWS = 64
LEAST_CYCLES = 3.0  # in the window: slower is drift
FASTEST = 4.0  # rows: of a faster swing no form is seen
PEAKS = 3
FLOOR_OCTAVE = 2.0  # the fastest octave tells the noise
CORNER = 0.9  # share of the power above the noise that is slower than the corner


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Power of a signal over frequency.

    Attributes
    ----------
    cumulative : ndarray, shape (m,)
        Power up to the upper edge of each line, from 0 to 1.
    step : float
        Hz between lines.
    low, high : float
        Hz; ends of the bins.
    """

    cumulative: FloatArray
    step: float
    low: float
    high: float

    def below(self, frequency: FloatArray) -> FloatArray:
        """Power slower than frequencies in Hz."""
        edges = (np.arange(self.cumulative.size) + 0.5) * self.step
        return np.asarray(np.interp(frequency, edges, self.cumulative))

    @property
    def edges(self) -> FloatArray:
        """Of the bins, Hz, shape (97,)."""
        return np.geomspace(self.low, self.high, BINS + 1)

    @property
    def bins(self) -> FloatArray:
        """Share of the power in each, shape (96,); all 0 where there is none."""
        power = np.diff(self.below(self.edges))
        total = float(power.sum())
        return np.asarray(power / total) if total > 0.0 else np.zeros(BINS)

    def share(self, period: float) -> float:
        """Share of the power about a period (s) and its harmonics, of all that is not slower than 3 periods."""
        orders = np.arange(1, HARMONICS + 1) / period
        ends = np.minimum(np.stack([orders - BAND / period, orders + BAND / period]), self.high)
        inside = np.diff(self.below(ends), axis=0).sum()
        whole = 1.0 - float(self.below(np.array([1.0 / (SLOWEST * period)]))[0])
        return float(np.clip(inside / whole, 0.0, 1.0)) if whole > 0.0 else 0.0

    def harmonics(self, period: float) -> float:
        """Power at twice to five times a frequency over that at it."""
        orders = np.arange(1, HARMONICS + 1) / period
        width = 0.1 / period
        power = np.diff(self.below(np.stack([orders - width, orders + width])), axis=0)[0]
        return float(power[1:].sum() / power[0]) if power[0] > 0.0 else 0.0

    def peaks(self) -> list[float]:
        """Periods (s) of the largest peaks of the power per octave, largest first."""
        power = np.convolve(np.pad(self.bins, 1, mode="edge"), (0.25, 0.5, 0.25), "valid")
        centres = np.sqrt(self.edges[1:] * self.edges[:-1])
        inner = np.r_[False, (power[1:-1] > power[:-2]) & (power[1:-1] >= power[2:]), False]
        inner &= (centres < self.high * 2.0 / FASTEST) & (power > 0.0)
        at = np.flatnonzero(inner)
        return [float(1.0 / centres[one]) for one in at[np.argsort(-power[at], kind="stable")][:PEAKS]]

    def corner(self) -> float:
        """Hz below which nine tenths of the power above the noise are; the noise is that of the fastest octave."""
        edges = self.edges
        noise = 1.0 - float(self.below(np.array([self.high / FLOOR_OCTAVE]))[0])
        density = noise / (self.high - self.high / FLOOR_OCTAVE)
        power = np.maximum(np.diff(self.below(edges)) - density * np.diff(edges), 0.0)
        total = float(power.sum())
        if total <= 0.0:
            return self.high
        return float(edges[1 + int(np.searchsorted(np.cumsum(power), CORNER * total))])


def spectrum_of(error: FloatArray, dt: float) -> Spectrum | None:
    """Spectrum of an error of control with NaN in rows that do not count; None where too little is known.

    Rows that do not count are 0, the mean: they add no power.
    """
    known = np.isfinite(error)
    if int(known.sum()) < LEAST_ROWS:
        return None
    values = np.where(known, error, 0.0)
    reach = float(np.abs(values).max())
    if reach == 0.0:
        return None
    size = scipy.fft.next_fast_len(values.size, real=True)
    lines = scipy.fft.rfft(values / reach * np.hanning(values.size), size)
    cumulative = np.cumsum(lines.real**2 + lines.imag**2)
    if not cumulative[-1] > 0.0:
        return None
    return Spectrum(
        cumulative / cumulative[-1], 1.0 / (size * dt), LEAST_CYCLES / (values.size * dt), 0.5 / dt
    )  # fmt: skip
