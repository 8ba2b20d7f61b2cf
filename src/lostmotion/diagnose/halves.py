"""An oscillation cut into half periods, and how well a wave form fits each of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.filters import checked_period, crossings, low_pass, standard_signal, without_trend
from lostmotion.errors import DataError

HARMONICS = 7.0  # kept; noise above them is none of the wave form's
SHORTEST, LONGEST = 0.5, 2.0  # of half a period: zero crossings nearer or farther are noise or a missing crossing
LEAST_SAMPLES = 4  # between the two zero crossings
LEAST_HALVES = 2  # a single one has no other to agree with
FLOOR = 1e-9  # of the power of the half period: what counts as no misfit at all


@dataclass(frozen=True)
class Halves:
    """Samples between neighbouring zero crossings, one half period after the other.

    Parameters
    ----------
    values : ndarray, shape (m,)
        The samples, in standard deviations of the record.
    place : ndarray, shape (m,)
        Where each lies between its zero crossings, 0 to 1.
    owner : ndarray of int, shape (m,)
        Number of its half period.
    samples : ndarray, shape (count,)
        Samples of each.
    """

    values: FloatArray
    place: FloatArray
    owner: npt.NDArray[np.intp]
    samples: FloatArray

    @property
    def count(self) -> int:
        """Number of half periods."""
        return int(self.samples.size)

    def total(self, of: FloatArray) -> FloatArray:
        """Sum over each half period, shape (count,)."""
        return np.asarray(np.bincount(self.owner, of, minlength=self.count), dtype=np.float64)

    def misfit(self, form: FloatArray, parameters: int) -> FloatArray:
        """Mean square error of a wave form with the best amplitude, shape (count,), for one form of shape (m,).

        Divided by the independent samples less `parameters`, so that a form is not rewarded for what it adapts. What
        is left below the 7th harmonic has 7 independent samples a half period, of which the crossing takes one.
        """
        power, own = self.total(self.values**2), self.total(form**2)
        amplitude = self.total(form * self.values) / np.maximum(own, 1e-300)
        left = np.maximum(power - amplitude**2 * own, FLOOR * power)
        independent = np.minimum(self.samples, HARMONICS - 1.0)
        return np.asarray(left * independent / (self.samples * (independent - parameters)))


def cut_halves(name: str, x: FloatArray, period: float) -> Halves:
    """Take trend and noise out of a signal and cut it at its zero crossings.

    Raises
    ------
    ParameterError
        A period below 4 samples.
    DataError
        Fewer than two periods, or fewer than two half periods with 4 samples each.
    """
    signal = standard_signal(name, x, 16)
    period = checked_period(period, signal.size)
    signal = low_pass(without_trend(signal, period), period / HARMONICS)
    at = crossings(signal)
    gaps = np.diff(at)
    first, last = np.floor(at[:-1]).astype(int) + 1, np.ceil(at[1:]).astype(int) - 1
    samples = last - first + 1
    good = (gaps >= SHORTEST * period / 2.0) & (gaps <= LONGEST * period / 2.0) & (samples >= LEAST_SAMPLES)
    if good.sum() < LEAST_HALVES:
        remedy = "give more samples for each period or a longer record"
        raise DataError.expected(f"half periods of {name} with {LEAST_SAMPLES} samples", int(good.sum()), remedy)
    samples = samples[good]
    owner = np.repeat(np.arange(samples.size), samples)
    rows = np.arange(owner.size) - np.repeat(np.cumsum(samples) - samples, samples) + first[good][owner]
    place = (rows - at[:-1][good][owner]) / gaps[good][owner]
    return Halves(signal[rows], place, owner, samples.astype(np.float64))


def sine(place: FloatArray) -> FloatArray:
    """Half a sine."""
    return np.asarray(np.sin(np.pi * place))


def triangle(place: FloatArray, apex: float) -> FloatArray:
    """Straight up to 1 at `apex` and straight down to 0 at 1."""
    return np.minimum(place / apex, (1.0 - place) / (1.0 - apex))


def relay_answer(place: FloatArray, lag: float) -> FloatArray:
    """Answer of a first order process to a relay, between its zero crossings; `lag` in half periods.

    It rises towards 1 until the relay's turn arrives and falls towards -1 then, through zero at 1. A short lag gives
    a square wave, a long one a triangle.
    """
    turn = lag * (np.logaddexp(0.0, 1.0 / lag) - np.log(2.0))
    rise = -np.expm1(-np.minimum(place, turn) / lag)
    fall = (1.0 + rise) * np.exp(-np.maximum(place - turn, 0.0) / lag) - 1.0
    return np.asarray(fall)
