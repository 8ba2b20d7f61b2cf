"""Order of the AR noise model from the output residual."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels.lanes import WIDTH
from lostmotion.kernels.likelihood import add_lagged
from lostmotion.kernels.nested import nested
from lostmotion.kernels.pole_filters import GONE
from lostmotion.kernels.products import add_products
from lostmotion.kernels.smoothed import smooth
from lostmotion.kernels.zeros import add_products_behind

MOST_NOISE_LAGS = 20  # AIC may choose up to this (docs/method.md, "noise order")
ROUNDING = 1e-18  # variance of scaled residuals that are nothing but rounding: there is no noise to model
# c of (1 - c q^-1): slow drift behind fast noise has one, which an AR of any order that a record carries cuts off
# (those beside 0 are looked through four at a time: their number is a multiple of it)
ZEROS = (0.0, 0.5, 0.7, 0.8, 0.87, 0.92, 0.95, 0.97, 0.985)
PENALTY = 2.0  # Akaike: an order too many costs nothing in open loop, one too few biases a closed one


@dataclass(frozen=True)
class Autoregressions:
    """AR models of order 0 to n on common rows.

    Attributes
    ----------
    gains : ndarray, shape (n, n)
        Coefficients of order i + 1 on the past in row i, then zeros.
    variances : ndarray, shape (n + 1,)
        Of what each leaves over.
    rows : int
    """

    gains: FloatArray
    variances: FloatArray
    rows: int

    @property
    def most(self) -> int:
        """Largest order."""
        return self.variances.size - 1

    def model(self, order: int) -> FloatArray:
        """Coefficients d of D(q) v = e, (order,)."""
        return -self.gains[order - 1, :order] if order else np.zeros(0)

    def best(self, penalty: float = PENALTY) -> tuple[float, FloatArray]:
        """Information criterion and coefficients of the best of them."""
        if self.variances[0] < ROUNDING:
            return -np.inf, self.model(0)
        score = self.rows * np.log(np.maximum(self.variances, 1e-300)) + penalty * np.arange(self.most + 1)
        order = int(np.argmin(score))
        return float(score[order]), self.model(order)


def autoregressions(v: list[FloatArray], most: int = MOST_NOISE_LAGS) -> Autoregressions:
    """AR(0) .. AR(most) of the segments v; where they are shorter than that takes, AR(0) alone."""
    usable = _usable(v, most)
    if not usable:
        plain = np.array([float(np.mean(np.concatenate(v) ** 2))])
        return Autoregressions(np.zeros((0, 0)), plain, sum(p.size for p in v))
    gram = np.zeros((most + 1, most + 1))
    for part in usable:
        add_products(part, 0, most + 1, part, 0, most + 1, most, part.size, gram)
    return _of_products(gram, sum(part.size - most for part in usable))


def _usable(v: list[FloatArray], most: int) -> list[FloatArray]:
    """Segments that are long enough for so many lags."""
    return [part for part in v if part.size > 2 * (most + 1)]


def _of_products(gram: FloatArray, rows: int) -> Autoregressions:
    """The same from the products of all lags, 0 included."""
    most = len(gram) - 1
    largest = float(gram[0, 0] if gram[0, 0] > 1e-12 * gram.max() else gram.max())  # 0 behind a single step
    ridge = max(1e-12 * largest, float(np.finfo(float).tiny))
    past = gram[1:, 1:].copy()
    past.flat[:: most + 1] += ridge
    gains, explained = _of_all_orders(past, gram[1:, 0])
    variances = np.empty(most + 1)
    variances[0], variances[1:] = gram[0, 0] / rows, np.maximum((gram[0, 0] - explained) / rows, 1e-300)
    return Autoregressions(gains, variances, rows)


def _of_all_orders(gram: FloatArray, right: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Coefficients of every order in the rows of (n, n), and what they explain (n,)."""
    gains, explained = np.zeros(gram.shape), np.zeros(right.size)
    if nested(gram, right, gains, explained):
        return gains, explained
    for order in range(1, right.size + 1):  # by rounding no factor, or singular: an exact sine
        gains[order - 1, :order] = np.linalg.lstsq(gram[:order, :order], right[:order], rcond=None)[0]
    return gains, gains @ right


def choose_noise(v: list[FloatArray], most: int = MOST_NOISE_LAGS, penalty: float = PENALTY) -> FloatArray:
    """Coefficients d of the AR model that an information criterion prefers; empty for white noise."""
    return autoregressions(v, most).best(penalty)[1]


def share_of_errors(v: list[FloatArray], zero: float, d: FloatArray) -> float:
    """Variance of the errors e of D(q) v = (1 - c q^-1) e, with c = zero, over that of v / (1 - c q^-1)."""
    total = left = 0.0
    for part in v:
        seen = _through(part, zero)
        errors = seen.copy()
        add_lagged(d, seen[:-1], errors[1:])
        total, left = total + float(seen @ seen), left + float(errors[d.size :] @ errors[d.size :])
    return left / total if total > 0.0 else 0.0


@dataclass(frozen=True)
class Left:
    """What a model leaves of PV, by segments, and the noise that it may be.

    Attributes
    ----------
    parts : list of ndarray
    """

    parts: list[FloatArray]

    @cached_property
    def behind(self) -> dict[float, Autoregressions]:
        """Autoregressions of the parts seen through each of ZEROS."""
        return dict(zip(ZEROS, _behind_zeros(self.parts, MOST_NOISE_LAGS), strict=True))

    @property
    def likeliest_zero(self) -> float:
        """The c of ZEROS that an information criterion prefers; 0 where none pays."""
        cost = float(np.log(sum(part.size for part in self.parts)))  # near a pole it tells nothing
        scores = [found.best()[0] + cost * (zero != 0.0) for zero, found in self.behind.items()]
        return ZEROS[int(np.argmin(scores))]

    def noise(self, zero: float) -> FloatArray:
        """Coefficients d of D(q) v = (1 - c q^-1) e that an information criterion prefers, with c = zero, of ZEROS."""
        return self.behind[zero].best()[1]


def _behind_zeros(v: list[FloatArray], most: int) -> list[Autoregressions]:
    """Autoregressions of v seen through each of ZEROS."""
    usable = _usable(v, most)
    if not usable:
        return [autoregressions([_through(part, zero) for part in v], most) for zero in ZEROS]
    rows, found = sum(part.size - most for part in usable), [autoregressions(v, most)]
    for begin in range(1, len(ZEROS), WIDTH):
        zeros, grams = np.array(ZEROS[begin : begin + WIDTH]), np.zeros((most + 1, most + 1, WIDTH))
        for part in usable:
            add_products_behind(part, zeros, grams)
        found += [_of_products(grams[:, :, lane].copy(), rows) for lane in range(WIDTH)]
    return found


def _through(v: FloatArray, zero: float) -> FloatArray:
    """One over the zero, 1 / (1 - c q^-1), as if the first value had always been there."""
    if zero == 0.0 or not v.size:
        return v
    seen = np.empty(v.size)
    smooth(np.ascontiguousarray(v), zero, np.array([[0, v.size]]), seen)
    return seen / (1.0 - zero)


def _until_gone(rows: int, decay: float) -> int:
    """Rows until a mode has decayed to what counts as nothing."""
    rate = -math.log(decay) if 0.0 < decay < 1.0 else 0.0
    return rows if rate * rows <= -math.log(GONE) else math.ceil(-math.log(GONE) / rate)


def without_mode(v: FloatArray, decay: float) -> FloatArray:
    """Residual without its mean and the decay of the slowest mode: an unknown initial state is no noise."""
    columns = np.zeros((2, v.size))
    columns[0] = 1.0
    mode = columns[1, : _until_gone(v.size, decay)]  # below it a product takes a hundred times as long
    mode[:], mode[:1] = decay, 1.0
    np.multiply.accumulate(mode, out=mode)
    return np.asarray(v - np.linalg.pinv(columns @ columns.T, 1e-14, hermitian=True) @ (columns @ v) @ columns)
