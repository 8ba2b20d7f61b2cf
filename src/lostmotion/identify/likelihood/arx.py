"""Start values of A, B and D from a high-order ARX, without iterations on the data.

The ARX gives A_n(q) y = B_n(q) x + e with A_n near D and B_n near D B/A, so A B_n = B A_n is linear in A and B. It
is solved by weighted least squares with the covariance of the ARX coefficients (weighted null-space fitting:
Galrinho, Rojas, Hjalmarsson, IEEE Trans. Automatic Control 64, 2019, 2798-2813).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.arx_gram import RIDGE, Lags, arx_products
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels.linear import is_stable
from lostmotion.kernels.null_space import RANK, weighted

START_LAGS = 25  # past rows that an ARX of a start takes by default; the search gives its own
REWEIGHTINGS = 3  # each with the weights of the A and B before it; a start only, the likelihood goes on from there
TINY = 1e-300  # variance of what is exact
START_RADIUS = 0.998  # unstable or integrating starts are pulled inside this


@dataclass(frozen=True)
class HighOrderArx:
    """y(k) = -sum a_i y(k-i) + sum b_i x(k-delay-i) + constant, with the covariance of [a, b] up to sigma^2."""

    a: FloatArray
    b: FloatArray
    covariance: FloatArray
    variance: float
    samples: int
    delay: int


def fit_arx(data: ScaledData, x: FloatArray, delay: int, lags: int = START_LAGS) -> HighOrderArx:
    """High-order ARX from the internal variable x (n,) to y by least squares."""
    past = Lags.for_record(data.shortest, delay, lags, lags)
    gram, target, total, samples = arx_products(x, data, past)
    scale = np.sqrt(np.diag(gram)) + np.finfo(float).tiny
    scaled = gram / np.outer(scale, scale) + RIDGE * np.eye(scale.size)
    inverse = np.linalg.inv(scaled) / np.outer(scale, scale)
    solution = inverse @ target
    rss = max(total - float(solution @ target), 0.0)
    n = past.outputs
    sign = np.concatenate([-np.ones(n), np.ones(past.inputs)])
    covariance = inverse[1:, 1:] * np.outer(sign, sign)
    a, b = -solution[1 : n + 1], solution[n + 1 :]
    return HighOrderArx(a, b, covariance, rss / max(samples - scale.size, 1), samples, delay)


def linear_start(arx: HighOrderArx, na: int, nb: int, delay: int) -> tuple[FloatArray, FloatArray, float]:
    """A (na,), B (nb+1,) and the misfit in units of the ARX covariance (chi-squared where the orders suffice)."""
    n, m = arx.a.size, arx.b.size
    shift = delay - arx.delay
    length = min(n, m)
    a_high = np.concatenate([[1.0], arx.a])[: length + 1]
    b_high = arx.b[:length]
    regressors = np.zeros((length, na + nb + 1))
    for i in range(na):
        regressors[i + 1 :, i] = b_high[: length - i - 1]
    for j in range(nb + 1):
        lag = shift + j
        if lag < length:
            regressors[lag:, na + j] = -a_high[: length - lag]
    theta, misfit = np.asarray(np.linalg.lstsq(regressors, -b_high, rcond=RANK)[0], np.float64), 0.0
    for _ in range(REWEIGHTINGS):
        theta, misfit = weighted(_inside(theta[:na]), theta[na:], shift, arx.covariance, n, regressors, -b_high)
    return _inside(theta[:na]), theta[na:], misfit / max(arx.variance, TINY)


def _inside(a: FloatArray) -> FloatArray:
    """A with its unstable roots reflected and all roots pulled inside START_RADIUS."""
    if a.size == 0 or is_stable(np.ascontiguousarray(a), START_RADIUS):
        return a
    roots = np.roots(np.concatenate([[1.0], a]))
    size = np.abs(roots)
    roots = np.where(size > 1.0, roots / np.maximum(size, 1e-12) ** 2, roots)
    size = np.abs(roots)
    roots = np.where(size > START_RADIUS, roots * START_RADIUS / np.maximum(size, 1e-12), roots)
    return np.asarray(np.real(np.poly(roots))[1:])
