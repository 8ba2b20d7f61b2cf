"""The likelihood of a sticking valve about one of its maxima, slip by slip.

Which samples slip is a discrete question. All bands and jumps of one rectangle have the same slips, a pattern, and

    x = u at the last slip - direction of the last motion * (S - J) / 2,

so within a pattern the likelihood is a parabola in half of the difference of band and jump. Everything else, process,
noise, offset, loads, follows to first order: it is projected out of the residual with its gradients at the maximum
(one step of Gauss and Newton), which costs as much as the simulation of the valve. So thousands of patterns can be
met where a refinement of each would allow some dozens.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.slip_draws import FEWEST_TURNS, spaced_rests
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.kernels import likelihood as kernel
from lostmotion.kernels.slips import pattern, through_process

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
        problem, s, parts = self.fitted.problem, self.fitted.problem.structure, self.fitted.parts
        bounds = np.array([0.0, np.inf, 0.0, np.inf])
        moved, sides = self._room
        found: list[tuple[int, float]] = []
        done = turned = 0
        for index, (start, stop) in enumerate(problem.segments.tolist()):
            last, side = np.empty(stop - start), np.empty(stop - start)
            rest = rests[index] if index < len(rests) else 0.0
            first = problem.u[start] + 0.5 * rest * (band + jump)
            row, first, turns = pattern(self.model, problem.u[start:stop], band, jump, first, last, side, bounds)
            found.append((row, float(first - problem.u[start]) / max(0.5 * (band + jump), TINY)))
            turned += turns
            begin, rows = s.first - s.delay, stop - start - s.start
            until = begin + rows + s.noise_order
            for signal, out in ((last, moved), (side, sides)):
                through_process(signal[begin:until], self._numerator, parts.a, s.noise_order, out[done : done + rows])
            done += rows
        bounds[1] = min(bounds[1], self.widest)
        bounds[3] = min(bounds[3], self.largest * bounds[1])
        one = self._weighed(self._without - moved, sides, bounds, found[: len(rests)])
        return one if turned >= FEWEST_TURNS else replace(one, loss=np.inf)

    def first_rests(self, band: float, jump: float, index: int, most: int) -> list[float]:
        """First positions from which a segment goes on in different ways, at most so many of them."""
        start, stop = self.fitted.problem.segments[index].tolist()
        return spaced_rests(self.fitted.problem.u[start:stop], band, jump, most)

    def _weighed(
        self, left: FloatArray, turned: FloatArray, bounds: FloatArray, begun: list[tuple[int, float]]
    ) -> Pattern:
        """The likeliest of a pattern, from what it leaves of PV and its directions, both whitened."""
        directions = self._directions
        seen, turns = directions @ left, directions @ turned
        squares = float(left @ left - seen @ seen)
        cross = float(left @ turned - seen @ turns)
        curvature = max(float(turned @ turned - turns @ turns), 1e-300)
        lowest, highest = 0.5 * (bounds[0] - bounds[3]), 0.5 * (bounds[1] - bounds[2])
        inside = INSIDE * (highest - lowest)  # a corner belongs to several patterns
        lowest, highest = lowest + inside, highest - inside
        free = -cross / curvature
        behind = float(min(max(free, lowest), highest))
        cost = squares + behind * (2.0 * cross + behind * curvature)
        if cost < CANCELLED * float(left @ left):
            rest = left + behind * turned
            rest = rest - (directions @ rest) @ directions
            cost = float(rest @ rest)
        loss = 0.5 * left.size * float(np.log(max(cost, TINY) / max(self.fitted.fit.cost, 1e-300)))
        bands, jumps = (float(bounds[0]), float(bounds[1])), (float(bounds[2]), float(bounds[3]))
        firsts, rests = tuple(row for row, _ in begun), tuple(rest for _, rest in begun)
        spread = float(np.sqrt(self.fitted.variance / curvature))
        return Pattern(bands, jumps, rests, firsts, behind, loss, free, spread)

    @cached_property
    def _room(self) -> tuple[FloatArray, FloatArray]:
        rows = self.fitted.problem.errors
        return np.empty(rows), np.empty(rows)

    @cached_property
    def _numerator(self) -> FloatArray:
        parts = self.fitted.parts
        return np.convolve(np.append(1.0, parts.d), parts.b)

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
                    problem.y[start:stop],
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
    kernel.all_pole(a, np.ascontiguousarray(x), out)
    return out


def _lagged(coefficients: FloatArray, x: FloatArray) -> FloatArray:
    out = np.zeros(x.size)
    kernel.add_lagged(np.ascontiguousarray(coefficients), x, out)
    return out


def _later(x: FloatArray, lag: int) -> FloatArray:
    return np.concatenate([np.zeros(min(lag, x.size)), x[: max(x.size - lag, 0)]])


def _pulse(n: int) -> FloatArray:
    return np.append(1.0, np.zeros(n - 1))
