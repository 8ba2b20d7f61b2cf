"""The likelihood of a sticking valve about one of its maxima, slip by slip.

Which samples slip is a discrete question. All bands and jumps of one rectangle have the same slips, a pattern, and

    x = u at the last slip - direction of the last motion * (S - J) / 2,

so within a pattern the likelihood is a parabola in half of the difference of band and jump. Everything else, process,
noise, offset, loads, follows to first order: it is projected out of the residual with its gradients at the maximum
(one step of Gauss and Newton), which costs as much as the simulation of the valve. So thousands of patterns can be
met where a refinement of each would allow some dozens.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.slip_draws import FEWEST_TURNS, spaced_rests
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.kernels import likelihood as kernel
from lostmotion.kernels.pole_filters import all_pole
from lostmotion.kernels.slips import weigh_patterns

INSIDE = 0.01  # of the rectangle, from its sides
TINY = 1e-300  # keeps divisions finite
CANCELLED = 1e-8  # of a sum of squares: a smaller difference of two such is computed row by row
SMALLEST_DIRECTION = 1e-12  # of the Gram matrix of the gradients, relative: what is less says nothing


@dataclass(frozen=True)
class Pattern:
    """All bands and jumps with the same slips.

    Attributes
    ----------
    bands, jumps : (float, float)
        The rectangle.
    rests : tuple of float
        First positions, in shares of (S + J) / 2 off the first command.
    firsts : tuple of int
        Rows of the first slips.
    behind : float
        Half of the difference of band and jump that is likeliest in it.
    loss : float
        Of log-likelihood there, from the point of reference.
    free, spread : float
        The same half difference where the rectangle does not bound it, and its standard deviation.
    """

    bands: tuple[float, float]
    jumps: tuple[float, float]
    rests: tuple[float, ...]
    firsts: tuple[int, ...]
    behind: float
    loss: float
    free: float
    spread: float

    @property
    def eta(self) -> FloatArray:
        """Band and jump in the middle of the likeliest."""
        low, high = self.bands_at(self.behind, self.behind)
        band = 0.5 * (low + high)
        return np.array([band, max(band - 2.0 * self.behind, 0.0)])

    def bands_at(self, least: float, most: float) -> tuple[float, float]:
        """Bands of the rectangle with half differences in a range."""
        return max(self.bands[0], self.jumps[0] + 2.0 * least), min(self.bands[1], self.jumps[1] + 2.0 * most)

    def jumps_at(self, least: float, most: float) -> tuple[float, float]:
        """Jumps of the rectangle with half differences in a range."""
        return max(self.jumps[0], self.bands[0] - 2.0 * most), min(self.jumps[1], self.bands[1] - 2.0 * least)

    def reach(self, drop: float) -> tuple[float, float]:
        """Half differences at which the loss is `drop` or less; the rectangle may bound them further."""
        nearest = 0.5 * ((self.behind - self.free) / self.spread) ** 2
        reach = self.spread * np.sqrt(2.0 * max(drop - self.loss + nearest, 0.0))
        return self.free - reach, self.free + reach


@dataclass(frozen=True)
class Patterns:
    """Many of them, row by row; as in :class:`Pattern`.

    Attributes
    ----------
    bounds : ndarray, shape (n, 4)
        Lowest and highest band, lowest and highest jump.
    begun : ndarray, shape (n, s, 2)
        First positions and rows of the first slips.
    behind, losses, free, spreads : ndarray, shape (n,)
    """

    bounds: FloatArray
    begun: FloatArray
    behind: FloatArray
    losses: FloatArray
    free: FloatArray
    spreads: FloatArray

    def __getitem__(self, at: int) -> Pattern:
        """One of them."""
        low, high, least, most = self.bounds[at].tolist()
        rests, firsts = self.begun[at].T.tolist()
        behind, loss = float(self.behind[at]), float(self.losses[at])
        first_rows = tuple(int(row) for row in firsts)
        spread = float(self.spreads[at])
        return Pattern((low, high), (least, most), tuple(rests), first_rows, behind, loss, float(self.free[at]), spread)

    def __iter__(self) -> Iterator[Pattern]:
        """All of them."""
        return (self[at] for at in range(self.losses.size))

    @property
    def best(self) -> Pattern:
        """The one of least loss."""
        return self[int(np.argmin(self.losses))]


@dataclass(frozen=True)
class SlipLikelihood:
    """Log-likelihood of patterns about a fit, everything but the valve projected out.

    Attributes
    ----------
    fitted : Fitted
        Of stiction.
    model : int
        Of :mod:`lostmotion.kernels.stiction`.
    widest : float
        Largest band.
    largest : float
        Largest jump, in bands.
    """

    fitted: Fitted
    model: int
    widest: float
    largest: float

    def at(self, band: float, jump: float, rests: tuple[float, ...]) -> Pattern:
        """The pattern of a band, a jump and first positions."""
        return self.patterns(np.array([[band, jump]]), np.array([rests], float))[0]

    def patterns(self, etas: FloatArray, rests: FloatArray) -> Patterns:
        """The patterns of bands and jumps (n, 2) and first positions (n, s)."""
        problem, s, n = self.fitted.problem, self.fitted.problem.structure, len(etas)
        bounds, turns = np.tile([0.0, np.inf, 0.0, np.inf], (n, 1)), np.empty(n, np.int64)
        sums, seen = np.empty((n, 3)), np.zeros((n, 2, len(self._directions)))
        begun = np.zeros((n, len(problem.segments), 2))
        here = rests[:, : len(problem.segments)]  # of a fit that was shortened, see `shortened`, there are more
        begun[:, : here.shape[1], 0] = here
        left, turned = np.empty(problem.errors), np.empty(problem.errors)
        weigh_patterns(
            self.model, problem.u, problem.segments, etas, s.first - s.delay, s.start, s.noise_order, self._steps,
            self.fitted.parts.a, self._without, self._answers, begun, bounds, sums, seen, turns, left, turned,
        )  # fmt: skip
        bounds[:, 1] = np.minimum(bounds[:, 1], self.widest)
        bounds[:, 3] = np.minimum(bounds[:, 3], self.largest * bounds[:, 1])
        seen[:, 0] = self._seen - seen[:, 0]
        found, cancelled = self._weighed(sums, seen, bounds)
        if cancelled.any():
            if n > 1:
                return _joined([self.patterns(etas[[at]], rests[[at]]) for at in range(n)])
            rest = left + found[0] * turned
            rest = rest - (self._directions @ rest) @ self._directions
            found[1][:] = self._loss(np.array(rest @ rest))
        found[1][turns < FEWEST_TURNS] = np.inf
        return Patterns(bounds, begun[:, : rests.shape[1]], *found)

    def first_rests(self, band: float, jump: float, index: int, most: int) -> list[float]:
        """First positions from which a segment goes on in different ways, at most so many of them."""
        start, stop = self.fitted.problem.segments[index].tolist()
        return spaced_rests(self.fitted.problem.u[start:stop], band, jump, most)

    def _weighed(
        self, sums: FloatArray, seen: FloatArray, bounds: FloatArray
    ) -> tuple[tuple[FloatArray, FloatArray, FloatArray, FloatArray], npt.NDArray[np.bool_]]:
        """Of each pattern the likeliest half difference, its loss, that without bounds and its spread; from products.

        And where the loss is a difference of sums that are too large for it.
        """
        left, turned = seen[:, 0], seen[:, 1]
        squares = sums[:, 0] - np.einsum("ij,ij->i", left, left)
        cross = sums[:, 1] - np.einsum("ij,ij->i", left, turned)
        curvature = np.maximum(sums[:, 2] - np.einsum("ij,ij->i", turned, turned), TINY)
        lowest, highest = 0.5 * (bounds[:, 0] - bounds[:, 3]), 0.5 * (bounds[:, 1] - bounds[:, 2])
        inside = INSIDE * (highest - lowest)  # a corner belongs to several patterns
        free = -cross / curvature
        behind = np.maximum(np.minimum(free, highest - inside), lowest + inside)
        cost = squares + behind * (2.0 * cross + behind * curvature)
        spreads = np.sqrt(self.fitted.variance / curvature)
        return (behind, self._loss(cost), free, spreads), cost < CANCELLED * sums[:, 0]

    def _loss(self, cost: FloatArray) -> FloatArray:
        return 0.5 * self._without.size * np.log(np.maximum(cost, TINY) / max(self.fitted.fit.cost, TINY))

    @cached_property
    def _numerator(self) -> FloatArray:
        parts = self.fitted.parts
        return np.convolve(np.append(1.0, parts.d), parts.b)

    @cached_property
    def _steps(self) -> FloatArray:
        return np.cumsum(self._numerator)

    @cached_property
    def _seen(self) -> FloatArray:
        """Products of the directions with the errors without the valve."""
        return self._directions @ self._without

    @cached_property
    def _answers(self) -> FloatArray:
        """Products (rows, r) of the directions with the answer to a step of one at each row of the segments.

        The process backwards: what an input does to a product is that product's answer, last row first.
        """
        problem, s = self.fitted.problem, self.fitted.problem.structure
        found, done = [], 0
        for start, stop in problem.segments.tolist():
            rows = stop - start - s.start
            back = np.zeros((len(self._directions), rows + s.noise_order))
            back[:, :rows] = self._directions[:, done : done + rows][:, ::-1]
            pulses = [_answer(self.fitted.parts.a, _lagged(self._numerator, one)) for one in back]
            found.append(np.cumsum(pulses, axis=1)[:, ::-1].T)
            done += rows
        return np.ascontiguousarray(np.concatenate(found))

    @cached_property
    def _without(self) -> FloatArray:
        """Prediction errors of the fit with the valve at 0."""
        problem, s, parts = self.fitted.problem, self.fitted.problem.structure, self.fitted.parts
        _, other = self._inputs
        states = parts.initial.reshape(len(problem.segments), s.initial)
        return np.concatenate(
            [
                kernel.prediction_errors(
                    parts.a, parts.b, state, parts.offset, parts.d, s.delay, s.first, other[start:stop],
                    problem.y[start:stop], 0.0,
                )[1]
                for (start, stop), state in zip(problem.segments.tolist(), states, strict=True)
            ]
        )  # fmt: skip

    @cached_property
    def _inputs(self) -> tuple[FloatArray, FloatArray]:
        """Input of the process, and what of it does not pass the valve."""
        problem, theta = self.fitted.problem, self.fitted.fit.theta
        x, _ = problem.internal(theta)
        valve = np.empty(x.size)
        problem.family.path(self.fitted.actuator, problem.u, valve)
        return x, x - valve

    @cached_property
    def _directions(self) -> FloatArray:
        """Orthonormal rows: what the parameters beside the valve's can explain."""
        problem = self.fitted.problem
        gradients = error_gradients(problem, self.fitted.fit.theta)
        rows = problem.free_but(problem.own, self.fitted.basis).T @ gradients
        size = np.sqrt(np.einsum("ij,ij->i", rows, rows))
        rows = rows[size > 0.0] / size[size > 0.0, None]
        values, vectors = np.linalg.eigh(rows @ rows.T)
        kept = values > SMALLEST_DIRECTION * values[-1]
        return np.ascontiguousarray((vectors[:, kept] / np.sqrt(values[kept])).T @ rows)


def _joined(parts: Sequence[Patterns]) -> Patterns:
    return Patterns(*(np.concatenate([getattr(one, each.name) for one in parts]) for each in fields(Patterns)))


def shortened(fitted: Fitted, most: int) -> Fitted:
    """The same fit on the first rows, about `most` of them, where there are more: gradients of all would not fit."""
    problem = fitted.problem
    if problem.errors <= most:
        return fitted
    segments, room = [], most
    for start, stop in problem.segments.tolist():
        segments.append((start, min(stop, start + max(room, 2 * problem.structure.start))))
        room -= segments[-1][1] - start
        if room <= 0:
            break
    few = replace(problem, segments=np.array(segments))
    theta = fitted.fit.theta[: few.size]
    basis = fitted.basis
    if basis is not None:
        basis = basis[: few.size]
        basis = basis[:, np.any(basis != 0.0, axis=0)]
    cost = float(sum(part @ part for part in few.predict(theta)[1]))
    return replace(fitted, problem=few, fit=replace(fitted.fit, theta=theta, cost=cost), basis=basis)


def error_gradients(problem: Problem, theta: FloatArray) -> FloatArray:
    """Gradients (parameters, errors) of all prediction errors; as in :mod:`lostmotion.kernels.likelihood`."""
    s, parts = problem.structure, problem.parts(theta)
    x, dx = problem.internal(theta)
    courses = problem.family.courses(x.size)
    states = parts.initial.reshape(len(problem.segments), s.initial)
    whiten = np.append(1.0, parts.d)
    found = np.zeros((problem.size, problem.errors))
    done = 0
    for index, ((start, stop), state) in enumerate(zip(problem.segments.tolist(), states, strict=True)):
        n, begin = stop - start - s.first, start + s.first - s.delay
        by_b, by_c = _answer(parts.a, x[begin : begin + n]), _answer(parts.a, _pulse(n))
        z = _lagged(parts.b, by_b) + _lagged(state, by_c)
        v = problem.y[start + s.first : stop] - parts.offset - z
        by_a = _answer(parts.a, z)
        rows = [_later(by_a, i + 1) for i in range(s.na)]
        rows += [-_later(by_b, i) for i in range(s.nb + 1)]
        rows += [-np.ones(n)]
        rows += [-_lagged(parts.b, _answer(parts.a, one[begin : begin + n])) for one in (*dx, *courses)]
        white = [_lagged(whiten, row) for row in rows] + [_later(v, i + 1) for i in range(s.noise_order)]
        part = slice(done, done + n - s.noise_order)
        found[: problem.initial_at, part] = [row[s.noise_order :] for row in white]
        for i in range(s.initial):
            found[problem.initial_at + index * s.initial + i, part] = _lagged(whiten, -_later(by_c, i))[s.noise_order :]
        done += n - s.noise_order
    return found


def _answer(a: FloatArray, x: FloatArray) -> FloatArray:
    """(1/A) x from rest."""
    out = np.empty(x.size)
    all_pole(a, np.ascontiguousarray(x), out)
    return out


def _lagged(coefficients: FloatArray, x: FloatArray) -> FloatArray:
    out = np.zeros(x.size)
    kernel.add_lagged(np.ascontiguousarray(coefficients), x, out)
    return out


def _later(x: FloatArray, lag: int) -> FloatArray:
    return np.concatenate([np.zeros(min(lag, x.size)), x[: max(x.size - lag, 0)]])


def _pulse(n: int) -> FloatArray:
    return np.append(1.0, np.zeros(n - 1))
