"""The oscillation of a window at its natural time scale, and how far it is from what a linear loop makes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.fft

from lostmotion.arrays import FloatArray
from lostmotion.audit.screen_spectrum import Spectrum
from lostmotion.diagnose.features import FEWEST_CYCLES, LEAST_SHARE
from lostmotion.diagnose.oscillation import LEAST, Oscillation, oscillation_near
from lostmotion.errors import DataError
from lostmotion.kernels.prediction import prediction_error

ROWS = 2048  # after thinning, on which a period is measured: a hundred cycles
PER_PERIOD = 20.0  # rows in a period, where there are as many: five harmonics of it are seen
USUAL = 0.75  # quantile of the variance of the parts: moves of SP and upsets are in few, a swing is in many
KNOWN = 0.9  # of a part
PATTERN = 10.0  # rows in a period of the prediction, as published (7 to 25)
LONGEST = 256  # rows of it
SURROGATES = 12
NEIGHBOURS = 8  # as published
SIGMAS = 3.0
SEED = 2005


@dataclass(frozen=True)
class Swing:
    """The strongest oscillation.

    Attributes
    ----------
    period : float
        Seconds.
    regularity : float
    power : float
        Share of the variance of the window, of what is not slower than three periods.
    cycles : float
        In the part on which it was measured.
    """

    period: float
    regularity: float
    power: float
    cycles: float

    @property
    def steady(self) -> bool:
        """Regular, and most of what the loop does: as a diagnosis takes it."""
        return self.regularity > 1.0 and self.power > LEAST_SHARE and self.cycles > FEWEST_CYCLES

    @property
    def oscillation(self) -> Oscillation:
        """In rows of one second, for the classes of performance."""
        return Oscillation(self.period, self.regularity, self.power, self.cycles)


def swing_of(error: FloatArray, spectrum: Spectrum, dt: float) -> Swing | None:
    """Measure about the peaks of the spectrum; the most regular and strongest of them. None where there is none."""
    found = [one for one in (_near(error, spectrum, period, dt) for period in spectrum.peaks()) if one is not None]
    return max(found, key=lambda one: min(one.regularity, 1.0) * one.power) if found else None


def _near(error: FloatArray, spectrum: Spectrum, period: float, dt: float) -> Swing | None:
    factor = max(int(period / dt / PER_PERIOD), 1)
    part = usual_part(thinned(error, factor), ROWS)
    if part is None or part.size < LEAST:
        return None
    step = factor * dt
    try:
        one = oscillation_near(np.nan_to_num(part), period / step)
    except DataError:  # it does not move there
        return None
    seconds = one.period * step
    return Swing(seconds, one.regularity, spectrum.share(seconds), one.cycles)


def thinned(x: FloatArray, factor: int) -> FloatArray:
    """Means of blocks of `factor` rows, of those that are known; NaN where fewer than half are."""
    if factor <= 1:
        return x
    blocks = x[: x.size // factor * factor].reshape(-1, factor)
    known = np.isfinite(blocks)
    count = known.sum(axis=1)
    total = np.where(known, blocks, 0.0).sum(axis=1)
    return np.where(2 * count >= factor, total / np.maximum(count, 1), np.nan)


def usual_part(x: FloatArray, rows: int) -> FloatArray | None:
    """A part of some rows, nine tenths of them known, whose variance only a quarter of the parts exceeds."""
    place = usual_place(x, rows)
    return None if place is None else x[place : place + rows]


def usual_place(x: FloatArray, rows: int) -> int | None:
    """First row of that part; 0 where the signal is no longer; None where too little is known everywhere."""
    rows = min(rows, x.size)
    parts = x[: x.size // rows * rows].reshape(-1, rows)
    known = np.isfinite(parts)
    usable = np.flatnonzero(known.mean(axis=1) >= KNOWN)
    if not usable.size:
        return None if x.size > rows or not known.any() else 0
    values = np.where(known, parts, 0.0)[usable]
    count = known[usable].sum(axis=1)
    mean = values.sum(axis=1) / count
    variance = (values**2).sum(axis=1) / count - mean**2
    order = np.argsort(variance, kind="stable")
    return int(usable[order[int(USUAL * (usable.size - 1))]]) * rows


def nonlinearity(x: FloatArray, period: float, dt: float) -> float | None:
    """How much better the signal predicts itself than surrogates of its spectrum do, over three of their deviations.

    Above 1: more than a Gaussian linear process makes. None: too few cycles.

    Notes
    -----
    Thornhill (2005), "Finding the source of nonlinearity in a process with plant-wide oscillations", IEEE Trans.
    Control Systems Technology 13:434: embedding of one period, 8 neighbours, prediction one period ahead; 12 surrogates
    and up to 256 rows here, for time.
    """
    factor = max(int(period / dt / PATTERN), 1)
    part = usual_part(thinned(x, factor), LONGEST)
    lags = max(round(period / (factor * dt)), 2)
    if part is None or part.size < 12 * lags:
        return None
    part = _end_matched(np.nan_to_num(part - np.nanmean(part)), lags)
    spread = float(part.std())
    if part.size < 10 * lags or spread == 0.0:
        return None
    part = part / spread
    of_itself = prediction_error(part, lags, NEIGHBOURS, lags)
    errors = np.array([prediction_error(one, lags, NEIGHBOURS, lags) for one in _surrogates(part)])
    deviation = float(errors.std(ddof=1))
    return float((errors.mean() - of_itself) / (SIGMAS * deviation)) if deviation > 0.0 else None


def _end_matched(x: FloatArray, period: int) -> FloatArray:
    """Without up to a period at both ends, so that the end goes on as the beginning: a jump there is no power."""
    starts, stops = np.arange(period), x.size - 1 - np.arange(period)
    slope = np.gradient(x)
    off = (x[starts][:, None] - x[stops][None, :]) ** 2 + (slope[starts][:, None] - slope[stops][None, :]) ** 2
    first, last = np.unravel_index(int(np.argmin(off)), off.shape)
    return x[int(starts[first]) : int(stops[last])]


def _surrogates(x: FloatArray) -> list[FloatArray]:
    """Signals with the same spectrum and phases at random, the same ones every time."""
    random = np.random.default_rng(SEED)
    lines = scipy.fft.rfft(x)
    made = []
    for _ in range(SURROGATES):
        phases = np.exp(2j * np.pi * random.random(lines.size))
        phases[0] = 1.0
        made.append(np.asarray(scipy.fft.irfft(lines * phases, x.size)))
    return made


def phase_at(x: FloatArray, times: FloatArray, period: float, dt: float) -> float | None:
    """Radians of the line of this period; `times` are seconds from where they are counted. None: it has none."""
    factor = max(int(period / dt / PER_PERIOD), 1)
    x, times = thinned(x, factor), thinned(times, factor)
    known = np.isfinite(x)
    if not known.any():
        return None
    values = np.where(known, x - float(np.mean(x[known])), 0.0)
    turn = 2.0 * np.pi / period * times
    real, imaginary = float(values @ np.cos(turn)), float(-(values @ np.sin(turn)))
    return float(np.arctan2(imaginary, real)) if real or imaginary else None
