"""The likelihood of an integrating process with a drifting load disturbance and white measurement noise.

Where only a controller moves OP, and exactly, a linear process cannot be told from the inverse of that controller by
predictions with a rich model of the noise (Ljung, 2nd ed., section 13.4): its gain may be anything, and so may the
lost motion that "would have been seen". The noise model of a level tells them apart. A load disturbance l, a
first-order autoregression, acts where the valve acts, and the measurement adds white noise v:

    (1 - q^-1) y = b q^-d (x + l) + (1 - q^-1) v,    (1 - p q^-1) l = w.

In innovations form (1 - q^-1) (1 - p q^-1) y = b (1 - p q^-1) q^-d x + constant + C(q) e, with C of the second order
from the spectrum of both (Ljung, section 4.3; Harvey, *Forecasting, Structural Time Series Models and the Kalman
Filter*, chapter 4). The errors are linear in b, the constant and the initial states; p, the ratio of the variances and
the delay are all that is sought.

Of records with many rows in the time that this takes, means over blocks say the same: those of PV rise by b times what
the valve did, weighed by a triangle, and the errors of the means of white noise are white.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.signal import lfilter

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.criterion import FLOOR
from lostmotion.identify.scaled import ScaledData

FASTEST, SLOWEST = 0.1, 1e-6  # rates 1 - p
RATIOS = (-27.0, -20.0, -14.0, -9.0, -4.0)  # logarithms, where a search begins
SMALLEST_RATIO, LARGEST_RATIO = -32.0, 5.0
FIRST_MEMORY = 0.1  # of the record, in which a load forgets where a search begins
STEPS = 12  # of Gauss and Newton
STEP, LONGEST = 0.02, 2.0  # of the logarithms: for derivatives, and of one step
FIRST_DAMPING, LARGEST_DAMPING, SHRINK, GROW = 1e-3, 1e4, 5.0, 10.0
ENOUGH = 0.01  # of twice the log-likelihood, that a step gains
DELAYS = 2  # evaluated in a block
RIDGE = 1e-12  # of products of columns of norm 1


@dataclass(frozen=True)
class DriftingLoad:
    """Logarithms of the rate 1 - p with which the load forgets, and of the variance of b w over that of v."""

    log_rate: float
    log_ratio: float

    @property
    def pole(self) -> float:
        """Of the load, p."""
        return 1.0 - float(np.exp(np.clip(self.log_rate, np.log(SLOWEST), np.log(FASTEST))))

    def over(self, blocks: float) -> DriftingLoad:
        """The same seen in means over so many rows; one over a number leads back."""
        return DriftingLoad(self.log_rate + float(np.log(blocks)), self.log_ratio + 4.0 * float(np.log(blocks)))

    @property
    def memory(self) -> float:
        """Rows in which the slowest zero of the noise forgets."""
        slowest = max(abs(np.roots([1.0, *self.c])))
        return 1.0 / max(-float(np.log(slowest)), 1e-9)

    @property
    def d(self) -> FloatArray:
        """Coefficients of (1 - q^-1) (1 - p q^-1), without the first, (2,)."""
        return np.array([-(1.0 + self.pole), self.pole])

    @cached_property
    def c(self) -> tuple[float, float]:
        """Coefficients of C(q), without the first.

        Examples
        --------
        >>> DriftingLoad(-7.0, -32.0).c[1] > 0.99, abs(DriftingLoad(-7.0, 40.0).c[0]) < 0.2
        (True, True)
        """
        p, ratio = self.pole, float(np.exp(np.clip(self.log_ratio, SMALLEST_RATIO, LARGEST_RATIO)))
        middle, side, far = ratio + 1.0 + (1.0 + p) ** 2 + p**2, -((1.0 + p) ** 2), p
        # far (z^2 + z^-2) + side (z + z^-1) + middle = 0 is quadratic in z + z^-1
        sums = np.roots([far, side, middle - 2.0 * far]).astype(complex)
        inside = [min(np.roots([1.0, -one, 1.0]), key=abs) for one in sums]
        _, first, second = np.real(np.poly(inside))
        return float(first), float(second)


@dataclass(frozen=True)
class LevelFit:
    """A level behind one course of the valve.

    Attributes
    ----------
    noise : DriftingLoad
        Of the blocks in which it was found.
    delay : int
        In rows of the record, at least 1.
    gain : float
        b, the rise of PV in a row of the record.
    cost : float
        Sum of squared prediction errors.
    """

    noise: DriftingLoad
    delay: int
    gain: float
    cost: float


class LevelLikelihood:
    """Of one set of data.

    Parameters
    ----------
    data : ScaledData
    latest : int
        Largest delay in rows.
    every : int
        Rows in a block.
    """

    def __init__(self, data: ScaledData, latest: int, every: int = 1) -> None:
        self.data, self.latest, self.every = data, latest, every
        counts = (data.segments[:, 1] - data.segments[:, 0]) // every
        ends = np.cumsum(counts)
        self.blocks = np.column_stack([ends - counts, ends]).tolist()
        self.rows = int(ends[-1])
        parts = [data.y[a : a + n * every] for (a, _), n in zip(data.segments.tolist(), counts.tolist(), strict=True)]
        self.y = np.concatenate([part.reshape(-1, every).mean(axis=1) - part[:every].mean() for part in parts])
        self._seen: tuple[DriftingLoad, FloatArray, FloatArray] | None = None

    @property
    def _rounding(self) -> float:
        """Sum of squares that is rounding."""
        return self.rows * FLOOR

    def still(self) -> LevelFit:
        """Best fit of a valve that never moves."""
        return self.best(np.zeros(self.data.u.size), None)

    def best(self, x: FloatArray, near: LevelFit | None, steps: int = STEPS) -> LevelFit:
        """Best fit behind a valve at x (n,), begun near another fit, or anywhere; its delay stays where it was."""
        course = self._course(x)
        if near is None:
            rate = -float(np.log(FIRST_MEMORY * self.rows))
            found = [self._at(DriftingLoad(rate, ratio), course) for ratio in RATIOS]
            near = min(found, key=_cost)
        return self._refined(course, near, steps)

    def with_best_delay(self, x: FloatArray, near: LevelFit, steps: int = STEPS) -> LevelFit:
        """The same with the best delay."""
        course = self._course(x)
        return self._refined(course, self._at(near.noise, course), steps)

    def gain_of(self, better: LevelFit, worse: LevelFit) -> float:
        """Twice the gain in log-likelihood."""
        return self.rows * float(np.log(max(worse.cost, self._rounding) / max(better.cost, self._rounding)))

    def errors(self, x: FloatArray, fit: LevelFit) -> FloatArray:
        """Prediction errors of the blocks."""
        return self._errors(fit.noise, self._course(x), fit.delay)[0]

    def _refined(self, course: FloatArray, near: LevelFit, steps: int) -> LevelFit:
        """Gauss-Newton over both logarithms, everything linear solved at each point (Golub and Pereyra, 1973)."""
        errors, gain = self._errors(near.noise, course, near.delay)
        best, damping = replace(near, gain=gain, cost=float(errors @ errors)), FIRST_DAMPING
        slopes = None
        for _ in range(steps):
            if best.cost <= self._rounding:
                break  # an exact fit has no slopes
            if slopes is None:
                beside = [self._errors(one, course, near.delay)[0] for one in _beside(best.noise)]
                slopes = (np.array(beside) - errors) / STEP
            hessian, gradient = slopes @ slopes.T, slopes @ errors
            ridge = np.diag(np.diag(hessian) + RIDGE * best.cost)
            step = np.clip(-np.linalg.solve(hessian + damping * ridge, gradient), -LONGEST, LONGEST)
            noise = DriftingLoad(best.noise.log_rate + step[0], best.noise.log_ratio + step[1])
            trial, gain = self._errors(noise, course, near.delay)
            cost = float(trial @ trial)
            if not cost < best.cost:
                damping *= GROW
                if damping > LARGEST_DAMPING:
                    break
                continue
            gained = self.rows * float(np.log(best.cost / max(cost, self._rounding)))
            best, errors, slopes, damping = LevelFit(noise, near.delay, gain, cost), trial, None, damping / SHRINK
            if gained < ENOUGH:
                break
        return best

    def _errors(self, noise: DriftingLoad, course: FloatArray, delay: int) -> tuple[FloatArray, float]:
        """Prediction errors with all that is linear at its best, and the gain, which is not negative."""
        target, columns = self._columns(noise)
        moved = self._through(noise, self._late(course, delay), np.array([1.0, -noise.pole]))
        both = np.vstack([moved, columns])
        gains = _solved(both @ both.T, both @ target)
        if gains[0] < 0.0 or not moved.any():
            gains = np.append(0.0, _solved(columns @ columns.T, columns @ target))
        return target - gains @ both, float(gains[0])

    def _at(self, noise: DriftingLoad, course: FloatArray) -> LevelFit:
        """Best delay with this noise."""
        target, columns = self._columns(noise)
        inner, right, whole = columns @ columns.T, columns @ target, float(target @ target)
        found = [LevelFit(noise, 1, 0.0, whole - float(right @ _solved(inner, right)))]
        for delay in range(1, self.latest + 1, max(self.every // DELAYS, 1)):
            late = self._through(noise, self._late(course, delay), np.array([1.0, -noise.pole]))
            cross = columns @ late
            gram = np.block([[np.array([[late @ late]]), cross[None]], [cross[:, None], inner]])
            both = np.append(late @ target, right)
            gains = _solved(gram, both)
            if gains[0] > 0.0:
                found.append(LevelFit(noise, delay, float(gains[0]), whole - float(both @ gains)))
        return min(found, key=_cost)

    def _course(self, x: FloatArray) -> FloatArray:
        """Sums of sums of x in each segment, from a long rest at its first value, which counts as nothing."""
        return np.concatenate([np.cumsum(np.cumsum(x[a:b] - x[a])) for a, b in self.data.segments.tolist()])

    def _late(self, course: FloatArray, delay: int) -> FloatArray:
        """What lets the mean of each block rise above that of the one before, for a gain of 1."""
        k, found = self.every, np.empty(self.rows)
        for (start, stop), (begin, end) in zip(self.data.segments.tolist(), self.blocks, strict=True):
            sums = np.concatenate([np.zeros(2 * k + delay), course[start:stop]])
            last = k + np.arange(end - begin) * k + 2 * k - 1
            found[begin:end] = (sums[last] - 2.0 * sums[last - k] + sums[last - 2 * k]) / k
        return found

    def _columns(self, noise: DriftingLoad) -> tuple[FloatArray, FloatArray]:
        """PV (n,), and a constant and the initial states of C of every segment (m, n), as the errors see them."""
        if self._seen is not None and self._seen[0] == noise:
            return self._seen[1:]
        columns = np.zeros((1 + 2 * len(self.blocks), self.rows))
        columns[0] = self._through(noise, np.ones(self.rows), np.ones(1))
        for index, (start, stop) in enumerate(self.blocks):
            pulse = np.zeros(stop - start)
            pulse[0] = 1.0
            after = lfilter([1.0], [1.0, *noise.c], pulse)
            columns[1 + 2 * index, start:stop], columns[2 + 2 * index, start + 1 : stop] = after, after[:-1]
        self._seen = noise, self._through(noise, self.y, np.append(1.0, noise.d)), columns
        return self._seen[1:]

    def _through(self, noise: DriftingLoad, signal: FloatArray, over: FloatArray) -> FloatArray:
        """A signal of the blocks through over(q) / C(q), each segment from rest at 0."""
        found = np.empty(signal.size)
        for start, stop in self.blocks:
            found[start:stop] = lfilter(over, [1.0, *noise.c], signal[start:stop])
        return found


def _cost(fit: LevelFit) -> float:
    return fit.cost


def _beside(noise: DriftingLoad) -> tuple[DriftingLoad, DriftingLoad]:
    return (
        replace(noise, log_rate=noise.log_rate + STEP),
        replace(noise, log_ratio=noise.log_ratio + STEP),
    )


def _solved(gram: FloatArray, target: FloatArray) -> FloatArray:
    """Least squares from products of columns, of which some may be nothing."""
    scale = np.sqrt(np.diag(gram))
    scale[scale == 0.0] = 1.0
    scaled = gram / np.outer(scale, scale) + RIDGE * np.eye(len(gram))
    return np.asarray(np.linalg.solve(scaled, target / scale) / scale)
