"""The likelihood of one record set as a function of one parameter vector."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.plausible import FREE, Held
from lostmotion.identify.likelihood.zeros import before, seen_through
from lostmotion.kernels import likelihood as kernel
from lostmotion.kernels.linear import is_allowed
from lostmotion.kernels.normal_equations import normal_equations
from lostmotion.kernels.squared_errors import squared_errors

Inner: TypeAlias = tuple[FloatArray, FloatArray]  # internal variable x (n,) and dx/deta (m, n)
Normal: TypeAlias = tuple[float, FloatArray, FloatArray]  # sum of squared errors, J'e and J'J

KEPT = 2  # vectors of which the normal equations are kept
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
    zero: float = 0.0  # c of the noise D(q) v = (1 - c q^-1) e; it is held
    c: tuple[float, ...] = ()  # coefficients of C(q) in the place of 1 - c q^-1, where it is of a higher order; held

    @property
    def zeros(self) -> int:
        """Number of zeros of the noise."""
        return len(self.c) or int(self.zero != 0.0)

    @property
    def first(self) -> int:
        """Row of each segment at which the simulation begins."""
        return self.start - self.noise_order

    @property
    def initial(self) -> int:
        """Initial conditions of one segment: of the process, and of a zero of the noise."""
        return max(self.na, self.nb) + (self.zero > 0.0)


@dataclass(frozen=True)
class Parts:
    """The parameter vector by what its stretches mean.

    Attributes
    ----------
    a, b : ndarray, shape (na,) and (nb + 1,)
        Of the linear part.
    offset : float
    eta : ndarray
        Of the actuator, then the sizes of what else acts on the process.
    d : ndarray, shape (noise order,)
        Of the AR noise.
    initial : ndarray, shape (segments * initial,)
        Initial conditions of all segments.
    """

    a: FloatArray
    b: FloatArray
    offset: float
    eta: FloatArray
    d: FloatArray
    initial: FloatArray


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
    early : float
        Weight of the squared errors of the first rows of a segment, as many as D has coefficients, in which the noise
        from before is not known and taken as zero. Without them noise with a zero leaves initial conditions open.

    Attributes
    ----------
    size : int
        Length of the parameter vector.
    offset_at, eta_at, noise_at, initial_at : int
        Index of the offset, of the first actuator parameter, of d1 and of the first initial condition.
    """

    u: FloatArray
    y: FloatArray
    segments: IntArray
    family: Family
    structure: Structure
    held: Held = FREE
    early: float = 0.0

    size: int = field(init=False, repr=False, compare=False)
    offset_at: int = field(init=False, repr=False, compare=False)
    eta_at: int = field(init=False, repr=False, compare=False)
    noise_at: int = field(init=False, repr=False, compare=False)
    initial_at: int = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Where the stretches of the parameter vector begin: of thousands of problems, asked for at every step."""
        s = self.structure
        offset = s.na + s.nb + 1
        noise = offset + 1 + len(self.family.names)
        initial = noise + s.noise_order
        places = {"offset_at": offset, "eta_at": offset + 1, "noise_at": noise, "initial_at": initial}
        for name, value in {**places, "size": initial + s.initial * len(self.segments)}.items():
            object.__setattr__(self, name, value)

    @cached_property
    def own(self) -> range:
        """Indices of the actuator's own parameters."""
        return range(self.eta_at, self.eta_at + len(self.family.own))

    @cached_property
    def others(self) -> npt.NDArray[np.bool_]:
        """Which parameters are not the actuator's own, (size,)."""
        found = np.ones(self.size, bool)
        found[self.own.start : self.own.stop] = False
        return found

    @cached_property
    def errors(self) -> int:
        """Number of prediction errors; the rows that `early` weighs tell so little that they are not counted."""
        return int((self.segments[:, 1] - self.segments[:, 0] - self.structure.start).sum())

    def parts(self, theta: FloatArray) -> Parts:
        """What the stretches of a parameter vector mean; copies, contiguous as the kernels want them."""
        s, offset, eta, noise, initial = self.structure, self.offset_at, self.eta_at, self.noise_at, self.initial_at
        return Parts(
            theta[: s.na].copy(), theta[s.na : offset].copy(), float(theta[offset]), theta[eta:noise].copy(),
            theta[noise:initial].copy(), theta[initial:].copy(),
        )  # fmt: skip

    def pack(self, a: FloatArray, b: FloatArray, eta: FloatArray, d: FloatArray, offset: float) -> FloatArray:
        """Parameter vector with zero initial conditions."""
        c = np.zeros(self.structure.initial * len(self.segments))
        return np.concatenate([a, b, [offset], eta, d, c])

    def evaluate(self, theta: FloatArray, inner: Inner | None = None) -> Normal:
        """Sum of squared errors, J'e and J'J; of the last vectors they are kept. `inner`: where it is known."""
        known = self._last.get(theta.tobytes())
        if known is None:
            known = self._normal(theta, inner or self.internal(theta))
            self.keep(theta, known)
        return known

    def evaluate_beside(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """J'e and J'J without the actuator's own parameters, which are held: fewer signals to filter."""
        known = self._last.get(theta.tobytes())
        if known is not None:
            return known[1][self.others], known[2][np.ix_(self.others, self.others)]
        both = np.empty((1 + self.family.load, self.u.size))
        self.family.placed(theta[self.eta_at : self.noise_at], self.u, both[0])
        both[1:] = 1.0
        both, moving = self.smoothed(both), len(self.family.names) - len(self.own)
        _, gradient, hessian = self._products(theta[self.others], (both[0], both[1:]), moving)
        return gradient, hessian

    def keep(self, theta: FloatArray, known: Normal) -> None:
        """What is known of a vector: a refinement often goes on where another one ended."""
        for oldest in list(self._last)[: 1 - KEPT]:
            del self._last[oldest]
        self._last[theta.tobytes()] = known

    def _normal(self, theta: FloatArray, inner: Inner) -> Normal:
        return self._products(theta, inner, len(self.family.names))

    def _products(self, theta: FloatArray, inner: Inner, moving: int) -> Normal:
        """The same of a vector with `moving` parameters of eta."""
        (x, dx), zero = inner, self.structure.zero
        hessian, gradient = np.zeros((theta.size, theta.size)), np.zeros(theta.size)
        cost = normal_equations(
            theta, *self._layout(moving), x, dx, self.courses, self.target, hessian, gradient, zero, self.early
        )
        if zero == 0.0:
            return float(cost), gradient, hessian
        return self.scale * float(cost), self.scale * gradient, self.scale * hessian

    def squares(self, theta: FloatArray, x: FloatArray) -> float:
        """Sum of squared errors alone, for the internal variable x (n,), smoothed as ``internal`` gives it."""
        zero = self.structure.zero
        cost = float(squared_errors(theta, *self.layout, x, self.target, zero, self.early))
        return self.scale * cost

    @cached_property
    def _last(self) -> dict[bytes, Normal]:
        """Vectors and what belongs to them."""
        return {}

    @cached_property
    def layout(self) -> tuple[int, int, int, int, int, int, IntArray]:
        """What the kernels take besides vectors and signals."""
        return self._layout(len(self.family.names))

    def _layout(self, moving: int) -> tuple[int, int, int, int, int, int, IntArray]:
        s = self.structure
        return s.na, s.nb, moving, s.noise_order, s.delay, s.first, self.segments

    @cached_property
    def target(self) -> FloatArray:
        """PV as the likelihood sees it, through the zero of the noise, (n,)."""
        return self.smoothed(self.y)

    @cached_property
    def courses(self) -> FloatArray:
        """Known courses seen the same way, (m, n)."""
        return self.smoothed(self.family.courses(self.u.size))

    @property
    def sharpness(self) -> float:
        """What a prediction error is more than that of the smoothed signals."""
        return 1.0 / (1.0 - self.structure.zero)

    @property
    def scale(self) -> float:
        """The same of squares."""
        return self.sharpness**2

    def smoothed(self, signals: FloatArray) -> FloatArray:
        """One signal (n,) or several (m, n) through the zeros of the noise; themselves where it has none."""
        return seen_through(signals, self.structure.zero, self.structure.c, self.segments)

    def internal(self, theta: FloatArray) -> Inner:
        """Internal variable x (n,) and dx/deta (m, n), not of sizes of known courses, as the likelihood sees them."""
        both = np.empty((1 + len(self.family.own) + self.family.load, self.u.size))
        self.family.respond(theta[self.eta_at : self.noise_at], self.u, both[0], both[1:])
        both = self.smoothed(both)
        return both[0], both[1:]

    def predict(self, theta: FloatArray) -> tuple[list[FloatArray], list[FloatArray]]:
        """Simulated output (from row `first`) and prediction errors (from row `start`) of each segment."""
        s = self.structure
        simulated, errors = self._predicted(theta)
        if not s.zeros:
            return simulated, errors
        rows = [slice(start + s.first, stop) for start, stop in self.segments.tolist()]
        smooth = [self.target[at] - z for at, z in zip(rows, simulated, strict=True)]
        left = [before(v, s.zero, s.c) for v in smooth]
        return [self.y[at] - v for at, v in zip(rows, left, strict=True)], [self.sharpness * e for e in errors]

    def _predicted(self, theta: FloatArray) -> tuple[list[FloatArray], list[FloatArray]]:
        """The same of the smoothed signals."""
        s = self.structure
        x, _ = self.internal(theta)
        parts = self.parts(theta)
        initial = parts.initial.reshape(len(self.segments), s.initial)
        simulated, errors = [], []
        for (start, stop), state in zip(self.segments, initial, strict=True):
            z, e = kernel.prediction_errors(
                parts.a, parts.b, state, parts.offset, parts.d, s.delay, s.first,
                x[start:stop], self.target[start:stop], s.zero,
            )  # fmt: skip
            simulated.append(z)
            errors.append(e)
        return simulated, errors

    def output_residual(self, theta: FloatArray) -> list[FloatArray]:
        """Measured minus simulated output, from row `first` of each segment."""
        simulated, _ = self.predict(theta)
        first = self.structure.first
        return [self.y[start + first : stop] - z for (start, stop), z in zip(self.segments, simulated, strict=True)]

    def coloured_residual(self, theta: FloatArray) -> list[FloatArray]:
        """The same of the smoothed signals: what D(q) makes white."""
        simulated, _ = self._predicted(theta)
        first = self.structure.first
        pairs = zip(self.segments, simulated, strict=True)
        return [self.target[start + first : stop] - z for (start, stop), z in pairs]

    @cached_property
    def basis(self) -> FloatArray | None:
        """Directions that are free (size, free); None: all.

        An integrating process keeps the sum of A, and its offset is an initial state.
        """
        if not self.structure.integrating:
            return None
        na = self.structure.na
        inside = np.eye(na, na - 1) - np.eye(na, na - 1, k=-1)
        rest = np.delete(np.eye(self.size - na), self.offset_at - na, axis=1)
        return np.block([[inside, np.zeros((na, rest.shape[1]))], [np.zeros((len(rest), na - 1)), rest]])

    def free_but(self, rows: Sequence[int], basis: FloatArray | None = None) -> FloatArray:
        """Free directions (size, free) that leave some parameters where they are.

        Parameters
        ----------
        rows : sequence of int
            Indices of these parameters.
        basis : ndarray, optional
            Directions that are free; None: the problem's own.
        """
        free = self.basis if basis is None else basis
        free = np.eye(self.size) if free is None else free
        return np.asarray(free[:, ~np.any(free[list(rows)] != 0.0, axis=0)])

    def admissible(self, theta: FloatArray) -> bool:
        """Whether A is stable, but for the integrator, and the process an allowed one."""
        na = self.structure.na
        return bool(is_allowed(theta[:na], theta[na : self.offset_at], *self.rules))

    @cached_property
    def rules(self) -> tuple[bool, float, bool, IntArray, float, float, int]:
        """What the kernel takes besides A and B."""
        return self.structure.integrating, POLE_RADIUS, self.held.closed, *self.held.rules

    def project(self, theta: FloatArray) -> FloatArray:
        """The same vector with valid actuator parameters."""
        result, own = theta.copy(), len(self.family.own)
        if own:
            begin = self.eta_at
            result[begin : begin + own] = self.family.valid(theta[begin : begin + own])
        return result
