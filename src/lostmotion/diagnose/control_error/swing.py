"""The oscillation of a window at its natural time scale, and how far it is from what a linear loop makes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.control_error.spectrum import Spectrum
from lostmotion.diagnose.oscillation import FEWEST_CYCLES, LEAST, LEAST_SHARE, Oscillation, oscillation_near
from lostmotion.errors import DataError

ROWS = 2048  # after thinning, on which a period is measured: a hundred cycles
PER_PERIOD = 20.0  # rows in a period, where there are as many: five harmonics of it are seen
USUAL = 0.75  # quantile of the variance of the parts: moves of SP and upsets are in few, a swing is in many
KNOWN = 0.9  # of a part
SEGMENT, HOP = 4.0, 3.0  # periods of a segment, and from one to the next
LEAST_SEGMENTS, MOST_SEGMENTS = 8, 32
SHORT_SEGMENT, SHORT_HOP = 2.0, 1.0  # periods, of an amplitude
TIED = 5  # harmonics up to which phases are compared
SIGMAS = 3.0


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
    """How firmly the phases of the harmonics are tied to that of the swing, over what chance makes.

    Above 1: more than a Gaussian linear process makes, whose harmonics have phases of their own; up to 21 where they
    are tied all the time. None: too few cycles.

    Notes
    -----
    For what Thornhill (2005), "Finding the source of nonlinearity in a process with plant-wide oscillations", IEEE
    Trans. Control Systems Technology 13:434, takes a prediction and its surrogates, and with the same scale: distance
    from the mean of Gaussian signals over three of their deviations. That statistic takes fifty times as long, and of a
    strictly periodic wave the surrogates are as predictable as the wave. In segments of four periods, phases counted
    from the middle, the share c of harmonic k that keeps its phase to k times that of the swing has
    segments c^2 ~ Exp(1) by chance.
    """
    factor = max(int(period / dt / PER_PERIOD), 1)
    part = usual_part(thinned(x, factor), ROWS)
    rows = period / (factor * dt)
    size, hop = round(SEGMENT * rows), round(HOP * rows)
    if part is None or part.size < size + (LEAST_SEGMENTS - 1) * hop or rows < 2.0 * TIED:
        return None
    starts = np.arange(0, part.size - size + 1, hop)[:MOST_SEGMENTS]
    segments = part[starts[:, None] + np.arange(size)]
    segments = segments[np.isfinite(segments).all(axis=1)]
    if len(segments) < LEAST_SEGMENTS:
        return None
    times = np.arange(size) - 0.5 * (size - 1)
    lines = np.hanning(size)[:, None] * np.exp(-2j * np.pi / rows * times[:, None] * np.arange(1, TIED + 1))
    found = (segments - segments.mean(axis=1, keepdims=True)) @ lines
    turned = found * np.exp(-1j * np.angle(found[:, :1]) * np.arange(1, TIED + 1))
    power = (np.abs(found[:, 1:]) ** 2).sum(axis=0)
    tied = np.abs(turned[:, 1:].sum(axis=0)) ** 2 / np.maximum(power, 1e-300)
    chance = float(TIED - 1)
    return float((tied.sum() - chance) / (SIGMAS * np.sqrt(chance)))


def amplitude_spread(x: FloatArray, period: float, dt: float) -> float | None:
    """How much a swing comes and goes: deviation of its amplitude over the mean, in segments of two periods.

    A loop that rings because little damps it has an amplitude that noise builds up and takes away: of a Gaussian
    narrow band it is distributed after Rayleigh, whose deviation is 0.52 of its mean. What is kept up by a limit cycle
    or forced from outside keeps its amplitude. None: fewer than eight segments.

    Examples
    --------
    >>> times = np.arange(40000.0)
    >>> round(amplitude_spread(np.sin(2.0 * np.pi * times / 200.0), 200.0, 1.0), 2)
    0.0
    """
    factor = max(int(period / dt / PER_PERIOD), 1)
    slow, rows = thinned(x, factor), period / (factor * dt)
    size, hop = max(round(SHORT_SEGMENT * rows), 2), max(round(SHORT_HOP * rows), 1)
    starts = np.arange(0, slow.size - size + 1, hop)
    segments = slow[starts[:, None] + np.arange(size)]
    segments = segments[np.isfinite(segments).all(axis=1)]
    if len(segments) < LEAST_SEGMENTS:
        return None
    line = np.hanning(size) * np.exp(-2j * np.pi / rows * np.arange(size))
    sizes = np.abs((segments - segments.mean(axis=1, keepdims=True)) @ line)
    return float(sizes.std() / sizes.mean()) if sizes.any() else None


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
