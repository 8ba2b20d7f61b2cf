"""Dead zone of an actuator and its inverse."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, ClassVar, Self

import numpy.typing as npt

from lostmotion.arguments import elementwise, finite, positive
from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.kernels import actuator as numbers
from lostmotion.kernels import dead_zone as kernel
from lostmotion.models.fundamentals import clipped_sine
from lostmotion.models.kernel_view import padded
from lostmotion.models.registry import actuator


@actuator
@dataclass(frozen=True)
class DeadZone:
    """Static dead zone (paper, eq 4).

    ``x = right_slope (u - right)`` above `right`, 0 between, ``left_slope (u - left)`` below `left`.

    Parameters
    ----------
    left, right : float
        Break points in units of u, left <= right. They need not straddle zero: with a free output offset they
        are absolute positions of the actuator's command.
    left_slope, right_slope : float
        Slopes in units of x per unit of u, positive.

    Raises
    ------
    ParameterError
        left > right, a slope that is not positive, or a value that is not finite.

    Examples
    --------
    >>> valve = DeadZone(left=-1.0, right=1.0, left_slope=3.0, right_slope=3.0)
    >>> valve([-2.0, 0.5, 2.0]).tolist()
    [-3.0, 0.0, 3.0]
    >>> round(valve(valve.inverse()(0.6)), 12)
    0.6
    """

    left: float
    right: float
    left_slope: float = 1.0
    right_slope: float = 1.0

    kind: ClassVar[str] = "dead zone"
    own: ClassVar[tuple[str, ...]] = ("left", "right", "left_slope", "right_slope")
    size_name: ClassVar[str | None] = "width"

    def __post_init__(self) -> None:
        for name in ("left", "right"):
            object.__setattr__(self, name, finite(name, getattr(self, name)))
        for name in ("left_slope", "right_slope"):
            object.__setattr__(self, name, positive(name, getattr(self, name)))
        if self.left > self.right:
            raise ParameterError.expected(
                "left <= right", f"left={self.left}, right={self.right}", "swap the break points"
            )

    @property
    def width(self) -> float:
        """Full width right - left in units of u."""
        return self.right - self.left

    def __call__(self, u: npt.ArrayLike) -> float | FloatArray:
        """Internal variable x for u, scalar or any shape; NaN stays NaN."""
        return elementwise(
            lambda array: kernel.forward_run(array, self.left, self.right, self.left_slope, self.right_slope),
            u,
        )

    def inverse(self) -> DeadZoneInverse:
        """The inverse: ``dead_zone(dead_zone.inverse()(v)) == v`` for every v (Lemma 1)."""
        return DeadZoneInverse(self)

    def describing_function(self, amplitude: float) -> complex:
        """Gain of the fundamental for ``amplitude * sin(t)``: real, each side counts for half of the sine."""
        size = positive("amplitude", amplitude)
        if self.left > 0 or self.right < 0:
            raise ParameterError.expected(
                "left <= 0 <= right",
                f"left={self.left}, right={self.right}",
                "use describing_function() with a bias",
            )
        below = self.left_slope * (1.0 - clipped_sine(-self.left / size))
        above = self.right_slope * (1.0 - clipped_sine(self.right / size))
        return complex(0.5 * (below + above))

    @property
    def kernel_code(self) -> int:
        """Number in ``kernels.actuator``."""
        return numbers.DEAD_ZONE

    def kernel_parameters(self) -> FloatArray:
        """Parameters in the order of ``kernels.actuator``, shape (5,)."""
        return padded(self.left, self.right, self.left_slope, self.right_slope)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        return {"kind": self.kind, **asdict(self)}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Inverse of :meth:`to_dict`."""
        names = ("left", "right", "left_slope", "right_slope")
        if any(name not in data for name in names):
            raise ParameterError.expected(f"keys {list(names)}", sorted(data), "use to_dict()")
        return cls(*(data[name] for name in names))


@dataclass(frozen=True)
class DeadZoneInverse:
    """Inverse of a dead zone (paper, eqs 8-11).

    ``u = v / right_slope + right`` for v > 0 and ``v / left_slope + left`` for v < 0. At v = 0 every u in
    [left, right] gives x = 0; the point nearest to zero is returned (the paper's 0 where zero lies inside).
    """

    dead_zone: DeadZone

    @property
    def at_zero(self) -> float:
        """Answer to v = 0: the point of [left, right] nearest to zero."""
        return min(max(0.0, self.dead_zone.left), self.dead_zone.right)

    def __call__(self, v: npt.ArrayLike) -> float | FloatArray:
        """Command u that makes the dead zone give v, scalar or any shape."""
        zone = self.dead_zone
        return elementwise(
            lambda array: kernel.inverse_run(
                array, zone.left, zone.right, zone.left_slope, zone.right_slope, self.at_zero
            ),
            v,
        )

    def inverse(self) -> DeadZone:
        """The dead zone itself."""
        return self.dead_zone
