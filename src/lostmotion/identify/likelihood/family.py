"""What the likelihood needs to know about a kind of actuator: eta -> x, dx/deta, and the valid set of eta."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.courses import Loads
from lostmotion.identify.scaled import Scaling

Grid = tuple[list[FloatArray], Callable[[FloatArray], list[FloatArray]]]


@dataclass(frozen=True)
class Family(ABC):
    """One kind of actuator, with right slope (or only slope) 1: the gain stays in the linear part.

    eta = its own parameters, then the sizes of what else acts on the process: with `load` a constant, what an
    integrating process must be given to stand still (outflow of a tank; a self-regulating one has its offset for
    that), and then `loads`.
    """

    load: bool = field(default=False, kw_only=True)
    loads: Loads | None = field(default=None, kw_only=True, compare=False, repr=False)
    kind: ClassVar[str]  # name of the kind, as in its model
    own: ClassVar[tuple[str, ...]]  # names of the actuator's parameters
    kinks: ClassVar[bool] = False  # x jumps where eta moves: gradients alone do not end at the maximum
    needles: ClassVar[bool] = False  # and jumps so often that a start keeps eta until the rest is refined
    places: ClassVar[bool] = False  # own parameters are places on the axis of OP, not sizes
    relative: ClassVar[bool] = False  # x is 0 inside the actuator, so that the offset is PV at rest there
    rests: tuple[float, ...] = field(default=(), kw_only=True)  # of a memory: where it begins each segment

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of eta."""
        others = () if self.loads is None else self.loads.names
        return (*self.own, *(("load",) if self.load else ()), *others)

    @property
    def sought(self) -> int:
        """Parameters that are not in eta: the times of the loads."""
        return 0 if self.loads is None else self.loads.sought

    def with_load(self, load: bool) -> Self:
        """The same family with or without a constant load."""
        return replace(self, load=load)

    def with_loads(self, loads: Loads | None) -> Self:
        """The same family with other loads."""
        return replace(self, loads=loads)

    def evaluate(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Fill x (n,) and dx/deta (len(names), n) for the command u (n,)."""
        self.respond(eta, u, x, dx)
        if self.loads is not None:
            dx[-len(self.loads.names) :] = self.loads.shapes

    def respond(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """The same without the derivatives with respect to the sizes of known courses, which are these courses."""
        at = len(self.own)
        self.act(eta[:at], u, x, dx[:at])
        if self.load:
            x += eta[at]
            dx[at] = 1.0
            at += 1
        if self.loads is not None:
            x += eta[at:] @ self.loads.shapes

    def placed(self, eta: FloatArray, u: FloatArray, x: FloatArray) -> None:
        """Fill x (n,) as ``respond`` does, without derivatives."""
        at = len(self.own)
        self.path(eta[:at], u, x)
        if self.load:
            x += eta[at]
        if self.loads is not None:
            x += eta[at + self.load :] @ self.loads.shapes

    def courses(self, rows: int) -> FloatArray:
        """Known courses (m, rows)."""
        return np.zeros((0, rows)) if self.loads is None else self.loads.shapes

    def path(self, eta: FloatArray, u: FloatArray, x: FloatArray) -> None:
        """Fill x (n,) for the actuator alone, without derivatives where that is cheaper."""
        self.act(eta, u, x, np.empty((len(self.own), u.size)))

    def project(self, eta: FloatArray) -> FloatArray:
        """Nearest valid eta."""
        at = len(self.own)
        return np.concatenate([self.valid(eta[:at]), eta[at:]])

    @property
    def resting(self) -> int:
        """Segments in which it must be known where the valve rests at first: those of an actuator with memory."""
        return 0

    def with_rests(self, rests: Sequence[float]) -> Self:
        """The same family, beginning its segments elsewhere."""
        return replace(self, rests=tuple(rests))

    def grid(self, u: FloatArray, span: float, rows: int) -> Grid:
        """Where the parameters are sought: a first grid over all, and a finer one about a point of it.

        Parameters
        ----------
        u : ndarray, shape (n,)
            Command.
        span : float
            Range of it without its tails.
        rows : int
            Predicted rows of the profile.
        """
        raise NotImplementedError(f"{type(self).__name__} has no grid: write one, or a search of its own")

    def edges(self, own: FloatArray) -> list[float]:  # noqa: ARG002  most have none
        """Values of OP at which the real actuator may jump where this kind does not."""
        return []

    def room(self, own: FloatArray, direction: FloatArray, largest: float, u: FloatArray) -> float:  # noqa: ARG002
        """How far the own parameters can move along a direction without information; inf where it has no end.

        `direction` is their part of it, `largest` the largest component of the whole.
        """
        return float(np.inf)

    @classmethod
    def named(
        cls,
        own: npt.NDArray[Any],
        scaling: Scaling,
        product: Any,  # noqa: ARG003  for kinds with slopes
        gain: float | None,  # noqa: ARG003
    ) -> tuple[tuple[str, ...], list[Any], Any]:
        """Names and values of the actuator's parameters in units of OP, and the slope that the linear part gives up.

        Parameters
        ----------
        own : ndarray
            Scaled parameters, real or complex (derivatives by the complex step).
        scaling : Scaling
        product : complex
            Slope times static gain of the process.
        gain : float or None
            Known static gain of the process.
        """
        return cls.own, list(scaling.u_scale * own + (scaling.u_centre if cls.places else 0.0)), 1.0

    @abstractmethod
    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Fill x (n,) and its derivatives for the actuator alone."""

    def valid(self, eta: FloatArray) -> FloatArray:
        """Nearest valid parameters of the actuator alone."""
        return eta


@dataclass(frozen=True)
class LinearFamily(Family):
    """No fault: x = u."""

    kind: ClassVar[str] = "none"
    own: ClassVar[tuple[str, ...]] = ()

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Copy u."""
        del eta, dx
        x[:] = u
