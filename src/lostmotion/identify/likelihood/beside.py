"""Many actuators beside one fit, each with the best gain and level: A and the noise are held.

What :func:`~lostmotion.identify.likelihood.refinement.settled` does for one model, for many that differ in their
actuator alone: what does not depend on it is filtered and multiplied once.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.problem import Normal, Problem
from lostmotion.identify.likelihood.refinement import linear_columns, linear_step
from lostmotion.kernels.held import input_products, respond

EXACT = 1e-8  # of the sum of squares: less is told by the errors alone


class Beside:
    """The process, noise and loads of a fit.

    Parameters
    ----------
    problem : Problem
        With an actuator of the kind that is tried.
    theta : ndarray
        Parameter vector; what the own parameters of the actuator are does not matter.
    basis : ndarray, shape (size, free), or None
        Directions that are free, as for ``settled``.
    """

    def __init__(self, problem: Problem, theta: FloatArray, basis: FloatArray | None = None) -> None:
        self.problem, self.theta = problem, theta
        self.rows, self.columns = linear_columns(problem, problem.basis if basis is None else basis)
        self.parts = problem.parts(theta)

    @property
    def _early(self) -> float:
        """Root of the weight of the rows before those whose past noise is known."""
        return math.sqrt(self.problem.early)

    @cached_property
    def _directions(self) -> FloatArray:
        """Free directions of the parameters in which the errors are linear."""
        return np.ascontiguousarray(self.columns[self.rows])

    @cached_property
    def _moving(self) -> slice:
        """Of the parameter vector: sizes of what acts beside the actuator."""
        return slice(self.problem.own.stop, self.problem.noise_at)

    @cached_property
    def _courses(self) -> FloatArray:
        """Courses (m, n) of these."""
        problem = self.problem
        shapes = problem.courses
        return np.vstack([np.ones((1, problem.u.size)), shapes]) if problem.family.load else shapes

    @cached_property
    def _initial(self) -> FloatArray:
        """What initial states do to the errors, (nc, n): each segment is its own."""
        s, found = self.problem.structure, np.zeros((self.problem.structure.initial, self.problem.u.size))
        for start, stop in self.problem.segments.tolist():
            n = stop - start - s.first
            for lag in range(min(s.initial, n)):
                pulse = np.zeros(n)
                pulse[lag:] = s.zero ** np.arange(n - lag)
                respond(self.parts.a, self.parts.d, pulse, found[lag, start + s.first : stop])
                found[lag, start + s.first : start + s.start] *= self._early
        return found

    @cached_property
    def _shared(self) -> FloatArray:
        """What offset and courses do to the errors, (m, n)."""
        problem, s, parts = self.problem, self.problem.structure, self.parts
        found = np.zeros((1 + len(self._courses), problem.u.size))
        for start, stop in problem.segments.tolist():
            head, first = start + s.first, start + s.start
            found[0, head:first] = self._early * np.cumsum(np.append(1.0, parts.d))[: first - head]
            found[0, first:stop] = 1.0 + parts.d.sum()
            for row, course in zip(found[1:], self._courses, strict=True):
                white = np.empty(stop - head)
                respond(parts.a, parts.d, course[head - s.delay : stop - s.delay], white)
                for lag, gain in enumerate(parts.b):
                    row[head + lag : stop] += gain * white[: white.size - lag]
                row[head:first] *= self._early
        return found

    @cached_property
    def _without(self) -> FloatArray:
        """The errors without any input, (n,)."""
        problem, s, parts = self.problem, self.problem.structure, self.parts
        found = np.zeros(problem.u.size)
        states = parts.initial.reshape(len(problem.segments), s.initial)
        for (start, stop), state in zip(problem.segments.tolist(), states, strict=True):
            head = start + s.first
            respond(np.zeros(0), parts.d, problem.target[head:stop] - parts.offset, found[head:stop])
            found[head : start + s.start] *= self._early
            found[head:stop] -= state @ self._initial[:, head:stop]
        return found

    @cached_property
    def _products(self) -> FloatArray:
        """Products of all these with each other, initial states of every segment apart: (m + s nc, m + s nc)."""
        m, nc, segments = len(self._shared), len(self._initial), self.problem.segments.tolist()
        gram = np.zeros((m + nc * len(segments), m + nc * len(segments)))
        gram[:m, :m] = self._shared @ self._shared.T
        for index, (start, stop) in enumerate(segments):
            at, own = m + nc * index, self._initial[:, start:stop]
            gram[at : at + nc, at : at + nc] = own @ own.T
            gram[:m, at : at + nc] = self._shared[:, start:stop] @ own.T
            gram[at : at + nc, :m] = gram[:m, at : at + nc].T
        return gram

    def settled(self, family: Family, own: FloatArray) -> tuple[FloatArray, float]:
        """Parameter vector with the best gain and level beside an actuator, and its sum of squared errors.

        Parameters
        ----------
        family : Family
            Of this actuator, with as many parameters as that of the problem; its loads do not count.
        own : ndarray
            Its parameters.
        """
        problem, theta, moving = self.problem, self.theta.copy(), self._moving
        theta[problem.eta_at : moving.start] = family.valid(own)
        alone = np.empty(problem.u.size)
        family.path(theta[problem.eta_at : moving.start], problem.u, alone)
        alone = problem.smoothed(alone)
        squares, gradient, hessian = self._normal(self._with_courses(alone, theta))
        step = linear_step(hessian, gradient, self._directions)
        moved = theta.copy()
        moved[self.rows] += step
        if not problem.admissible(moved):
            return theta, problem.scale * squares
        # the errors are linear in these, but for courses, which B multiplies; where nothing is left of them their
        # products do not say how little
        left = squares + float(step @ (2.0 * gradient + hessian @ step))
        if len(self._courses) or left < EXACT * squares:
            return moved, problem.squares(moved, self._with_courses(alone, moved))
        return moved, problem.scale * left

    def _with_courses(self, x: FloatArray, theta: FloatArray) -> FloatArray:
        return x + theta[self._moving] @ self._courses if len(self._courses) else x

    def _normal(self, x: FloatArray) -> Normal:
        """Sum of squared errors, J'e and J'J of B, offset, courses and initial states."""
        s, parts, known = self.problem.structure, self.parts, self._products
        lags = parts.b.size
        gram, cross, target = np.zeros((lags, lags)), np.zeros((lags, len(known))), np.zeros(lags + len(known))
        squares = input_products(
            parts.a, parts.b, parts.d, s.delay, s.first, self.problem.segments, x, self._without, self._shared,
            self._initial, self._early, gram, cross, target,
        )  # fmt: skip
        whole = np.empty((target.size, target.size))
        whole[:lags, :lags], whole[:lags, lags:], whole[lags:, :lags], whole[lags:, lags:] = gram, cross, cross.T, known
        return squares, -target, whole
