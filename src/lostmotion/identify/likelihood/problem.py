"""The likelihood of one record set as a function of one parameter vector."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.plausible import FREE, Held
from lostmotion.kernels import likelihood as kernel
from lostmotion.kernels.linear import is_stable

POLE_RADIUS = 1.0 - 1e-7  # an output-error predictor needs a stable A


@dataclass(frozen=True)
class Structure:
    """Orders of the linear part and of the noise, and the row at which every segment's errors begin."""

    na: int
    nb: int
    delay: int
    noise_order: int
    start: int  # rows skipped at the head of each segment, >= delay + noise_order; equal where fits are compared
    integrating: bool = False  # A has a root at 1: A(1) = 0; the level is an initial state, no offset

    @property
    def first(self) -> int:
        """Row of each segment at which the simulation begins."""
        return self.start - self.noise_order

    @property
    def initial(self) -> int:
        """Initial conditions of one segment."""
        return max(self.na, self.nb)


@dataclass(frozen=True)
class Problem:
    """Data and structure; slices of the parameter vector; evaluation.

    Parameters
    ----------
    u, y : ndarray, shape (n,)
        Scaled command and output, segments one after the other.
    segments : ndarray, shape (s, 2)
        Start and stop rows.
    held : Held
        What the linear part may be.
    """

    u: FloatArray
    y: FloatArray
    segments: npt.NDArray[np.int64]
    family: Family
    structure: Structure
    held: Held = FREE

    @cached_property
    def size(self) -> int:
        """Length of the parameter vector."""
        return self.initial_at + self.structure.initial * len(self.segments)

    @cached_property
    def eta_at(self) -> int:
        """Index of the first actuator parameter; the offset stands before it."""
        return self.structure.na + self.structure.nb + 2

    @cached_property
    def noise_at(self) -> int:
        """Index of d1."""
        return self.eta_at + len(self.family.names)

    @cached_property
    def initial_at(self) -> int:
        """Index of the first initial condition."""
        return self.noise_at + self.structure.noise_order

    @cached_property
    def errors(self) -> int:
        """Number of prediction errors."""
        return int((self.segments[:, 1] - self.segments[:, 0] - self.structure.start).sum())

    def pack(self, a: FloatArray, b: FloatArray, eta: FloatArray, d: FloatArray, offset: float) -> FloatArray:
        """Parameter vector with zero initial conditions."""
        c = np.zeros(self.structure.initial * len(self.segments))
        return np.concatenate([a, b, [offset], eta, d, c])

    def evaluate(self, theta: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        """Sum of squared errors, J'e and J'J."""
        s = self.structure
        x, dx = self.internal(theta)
        hessian, gradient = np.zeros((self.size, self.size)), np.zeros(self.size)
        cost = kernel.normal_equations(
            theta, s.na, s.nb, len(self.family.names), s.noise_order, s.delay, s.first,
            self.segments, x, dx, self.y, hessian, gradient,
        )  # fmt: skip
        return float(cost), gradient, hessian

    def internal(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Internal variable x (n,) and dx/deta (ne, n)."""
        x, dx = np.empty(self.u.size), np.empty((len(self.family.names), self.u.size))
        self.family.evaluate(theta[self.eta_at : self.noise_at], self.u, x, dx)
        return x, dx

    def predict(self, theta: FloatArray) -> tuple[list[FloatArray], list[FloatArray]]:
        """Simulated output (from row `first`) and prediction errors (from row `start`) of each segment."""
        s = self.structure
        x, _ = self.internal(theta)
        a, b = theta[: s.na], theta[s.na : s.na + s.nb + 1]
        d = theta[self.noise_at : self.initial_at]
        simulated, errors = [], []
        for index, (start, stop) in enumerate(self.segments):
            at = self.initial_at + index * s.initial
            z, e = kernel.prediction_errors(
                a, b, theta[at : at + s.initial], theta[self.eta_at - 1], d, s.delay, s.first,
                x[start:stop], self.y[start:stop],
            )  # fmt: skip
            simulated.append(z)
            errors.append(e)
        return simulated, errors

    @cached_property
    def basis(self) -> FloatArray | None:
        """Directions that are free (size, free); None: all.

        An integrating process keeps the sum of A, and its offset is an initial state.
        """
        if not self.structure.integrating:
            return None
        na = self.structure.na
        inside = np.eye(na, na - 1) - np.eye(na, na - 1, k=-1)
        rest = np.delete(np.eye(self.size - na), self.eta_at - 1 - na, axis=1)
        return np.block([[inside, np.zeros((na, rest.shape[1]))], [np.zeros((len(rest), na - 1)), rest]])

    def admissible(self, theta: FloatArray) -> bool:
        """Whether A is stable, but for the integrator, and the process an allowed one."""
        a, b = theta[: self.structure.na], theta[self.structure.na : self.eta_at - 1]
        rest = a
        if self.structure.integrating:
            rest = 1.0 + np.cumsum(a)[:-1]  # A / (1 - q^-1)
        return bool(is_stable(np.ascontiguousarray(rest), POLE_RADIUS)) and self.held.allows(a, b)

    def project(self, theta: FloatArray) -> FloatArray:
        """The same vector with valid actuator parameters."""
        result = theta.copy()
        result[self.eta_at : self.noise_at] = self.family.project(theta[self.eta_at : self.noise_at])
        return result
