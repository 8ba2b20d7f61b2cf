"""The same plant on a slower clock: the search needs few samples per hold, not all of them.

Where a hold lasts hundreds of samples, the information of every r-th sample (with the noise averaged over r) is nearly
that of all, at a fraction of the work. Only the search uses it; what is reported comes from the full clock.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.linalg import solve_toeplitz
from scipy.signal import lfilter

from lostmotion.arrays import FloatArray
from lostmotion.design.simulated_plant import Plant
from lostmotion.models import LinearModel, NoiseModel

TINY = 1e-9  # coefficients of B this small beside the largest are rounding


def coarser(plant: Plant, factor: int) -> Plant:
    """The plant sampled every `factor` samples, its input held as long."""
    if factor == 1:
        return plant
    model = replace(plant.model, linear=coarser_linear(plant.model.linear, factor))
    return replace(plant, model=model, noise=coarser_noise(plant.noise, factor), fine=(plant.noise, factor))


def coarser_linear(linear: LinearModel, factor: int) -> LinearModel:
    """Exact at the coarse instants for inputs that are held between them."""
    poles = linear.poles**factor
    a = np.real(np.poly(poles))
    extra = -(-len(linear.b) // factor)
    count = -(-linear.delay // factor) + len(linear.a) + extra + 2
    steps = linear.step_response(count * factor)[::factor]
    b = np.convolve(a, np.diff(steps, prepend=0.0))[:count]
    large = np.flatnonzero(np.abs(b) > TINY * np.abs(b).max())
    return LinearModel(tuple(a[1:]), tuple(b[large[0] : large[-1] + 1]), int(large[0]), linear.dt * factor)


def coarser_noise(noise: NoiseModel, factor: int) -> NoiseModel:
    """Autoregression of the same order with the autocovariances of the mean over `factor` samples."""
    p = noise.order
    if p == 0:
        return NoiseModel((), noise.variance / factor)
    covariance = autocovariance(noise, (p + 1) * factor)
    lags = np.arange(-factor + 1, factor)
    weights = (factor - np.abs(lags)) / factor**2
    means = np.array([weights @ covariance[np.abs(j * factor + lags)] for j in range(p + 1)])
    d = -solve_toeplitz(means[:p], means[1:])
    return NoiseModel(tuple(d), float(max(means[0] + d @ means[1:], 0.0)))


def autocovariance(noise: NoiseModel, lags: int) -> FloatArray:
    """Autocovariance at lags 0 .. lags of stationary autoregressive noise."""
    length = lags + min(int(20.0 / -np.log(min(noise.radius, 0.9999))) + 10, 200_000)
    impulse = np.zeros(length)
    impulse[0] = 1.0
    weights = np.asarray(lfilter([1.0], [1.0, *noise.d], impulse))
    padded = np.concatenate([weights, np.zeros(length)])
    spectrum = np.abs(np.fft.rfft(padded)) ** 2
    return np.asarray(noise.variance * np.fft.irfft(spectrum)[: lags + 1])
