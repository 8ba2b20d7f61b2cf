"""Are phases coupled? Bicoherence tells a nonlinear loop from a linear one that is disturbed."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.fft

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.filters import checked_period, standard_signal
from lostmotion.errors import DataError

SEGMENT = 64  # samples, as published; overlapping by half, Hann window
PERIODS = 4  # in a segment at least: of a slower oscillation a segment sees a ramp, whose phases are all coupled
AT_ONCE = 65_536  # bifrequencies
LEAST_SEGMENTS = 4  # in noise the squared bicoherence is about 1 / segments: of fewer, noise looks coupled
CONFIDENCE = 1.6449  # one-sided 95 % quantile of the normal distribution
WINDOW_COUPLING = 2.22  # how far the Hann window ties neighbouring bifrequencies together
OVERLAP_COUPLING = 1.0 + 2.0 / 6.0**3  # neighbouring segments share 1/6 of an amplitude, cubed in the triple product
TRIM = 0.1  # share of the smallest and of the largest values left out of the robust mean and spread
CONDITION = 1e-6  # of the mean denominator; keeps empty frequencies from dividing zero by zero


@dataclass(frozen=True)
class Bicoherence:
    """Indices of the squared bicoherence of a signal.

    Parameters
    ----------
    ngi : float
        Non-Gaussianity index: mean squared bicoherence less its 95 % bound for a Gaussian signal. At most 0: the
        signal counts as Gaussian, and so as linear. In practice 0.001 is taken as the limit.
    nli : float
        Nonlinearity index: largest squared bicoherence less mean and two standard deviations, both without the 10 %
        smallest and largest values. Read it where ngi is positive; above 0.01 the signal counts as nonlinear.
    f1, f2 : float
        Frequencies of the largest, in cycles per sample.
    segments : int
        Segments averaged.
    """

    ngi: float
    nli: float
    f1: float
    f2: float
    segments: int


def bicoherence_indices(x: FloatArray, period: float | None = None) -> Bicoherence:
    """Test a signal for Gaussianity and linearity.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Finite, uniformly sampled: the control error, or PV where the set point stands still.
    period : float, optional
        Period in samples of the oscillation of interest: segments get four of them where that is more than the
        published 64 samples. None: 64 samples.

    Raises
    ------
    DataError
        A constant, or fewer than 4 segments (160 samples, or 10 periods).

    Notes
    -----
    Choudhury, Shah and Thornhill (2004), "Diagnosis of poor control-loop performance using higher-order
    statistics", Automatica 40:1719. Squared bicoherence in the normalisation that lies between 0 and 1. For a
    Gaussian signal twice the number of segments times its sum over M bifrequencies is chi-squared with 2 M degrees
    of freedom. Deviation: M is divided by 2.22, the sum of squared correlations of the triple products of
    neighbouring frequencies through a Hann window, and the lowest frequency is left out, where the window ties f1 to
    f1 + f2; without both the bound is passed in a quarter of white Gaussian records instead of 5 %.

    Examples
    --------
    >>> noise = np.random.default_rng(0).normal(size=2000)
    >>> bicoherence_indices(noise).ngi < 0 < bicoherence_indices(noise**2).ngi
    True
    """
    signal = standard_signal("x", x, 5 * SEGMENT // 2)
    size = SEGMENT
    if period is not None:
        size = max(size, 2 * math.ceil(PERIODS * checked_period(period, signal.size) / 2.0))
    count = (signal.size - size // 2) // (size // 2)
    if count < LEAST_SEGMENTS:
        need = (LEAST_SEGMENTS + 1) * size // 2
        raise DataError.expected(f"{need} samples for {LEAST_SEGMENTS} segments", signal.size, "give a longer record")
    first, second = _principal_domain(size)
    squared = _squared_bicoherence(_spectra(signal, size, count), first, second)
    free = squared.size / WINDOW_COUPLING
    averaged = count / OVERLAP_COUPLING
    bound = (CONFIDENCE + math.sqrt(4.0 * free - 1.0)) ** 2 / (4.0 * averaged * free)
    cut = int(TRIM * squared.size)
    middle = np.sort(squared)[cut : squared.size - cut]
    at = int(np.argmax(squared))
    nli = squared[at] - (middle.mean() + 2.0 * middle.std())
    return Bicoherence(float(squared.mean() - bound), float(nli), first[at] / size, second[at] / size, count)


def _spectra(x: FloatArray, size: int, count: int) -> npt.NDArray[np.complex128]:
    """Transforms of the half overlapping segments, each less its mean and through a Hann window; (count, size/2+1)."""
    starts = np.arange(count) * (size // 2)
    segments = x[starts[:, None] + np.arange(size)]
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * (np.arange(size) + 0.5) / size)
    return np.asarray(scipy.fft.rfft((segments - segments.mean(axis=1, keepdims=True)) * window, axis=1))


def _principal_domain(size: int) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]:
    """Bifrequencies 1 < f2 <= f1 with f1 + f2 below the Nyquist frequency, as bin numbers, f1 by f1."""
    rows = np.arange(2, size // 2 - 2, dtype=np.int32)
    counts = np.maximum(np.minimum(rows, size // 2 - 1 - rows) - 1, 0)
    first = np.repeat(rows, counts)
    begins = np.repeat(np.cumsum(counts) - counts, counts)
    return first, (np.arange(first.size) - begins + 2).astype(np.int32)


def _squared_bicoherence(
    spectra: npt.NDArray[np.complex128], first: npt.NDArray[np.int32], second: npt.NDArray[np.int32]
) -> FloatArray:
    """|mean X1 X2 conj(X12)|^2 / (mean |X1 X2|^2 mean |X12|^2) over the segments, for each bifrequency."""
    above, below = np.empty(first.size), np.empty(first.size)
    power = (spectra.real**2 + spectra.imag**2).sum(axis=0)
    for begin in range(0, first.size, AT_ONCE):  # the products of all bifrequencies would be large
        part = slice(begin, begin + AT_ONCE)
        f1, f2 = first[part], second[part]
        both = f1 + f2
        triple, pairs = np.zeros(f1.size, dtype=np.complex128), np.zeros(f1.size)
        for one in spectra:
            product = one[f1] * one[f2]
            triple += product * one[both].conj()
            pairs += product.real**2 + product.imag**2
        above[part], below[part] = triple.real**2 + triple.imag**2, pairs * power[both]
    return np.asarray(above / (below + CONDITION * below.mean() + 1e-300))
