"""Backlash of an actuator and its exact inverse."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any, ClassVar, Self

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import along_time, finite, not_negative, positive
from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.kernels import actuator as numbers
from lostmotion.kernels import backlash as kernel
from lostmotion.models.fundamentals import gliding_sine
from lostmotion.models.kernel_view import padded
from lostmotion.models.registry import actuator


@actuator
@dataclass(frozen=True)
class Backlash:
    """Backlash (play): x follows u where the gap of full width `width` is used up, and rests otherwise.

    ``x(k) = max(u(k) - width/2, min(u(k) + width/2, x(k-1)))``. Every call starts at rest, x = u at the first
    sample; :meth:`run` takes another start.

    Parameters
    ----------
    width : float
        Full width of the dead band in units of u, not negative.

    Raises
    ------
    ParameterError
        A width that is negative or not finite.

    Notes
    -----
    Rate-independent: holding a sample, or sampling a ramp more finely, changes nothing but the number of samples.

    Examples
    --------
    >>> gear = Backlash(width=1.0)
    >>> gear([0.0, 2.0, 1.25, 0.0]).tolist()
    [0.0, 1.5, 1.5, 0.5]
    >>> gear(gear.inverse()([0.0, 2.0, 1.25, 0.0])).tolist()
    [0.0, 2.0, 1.25, 0.0]
    """

    width: float

    kind: ClassVar[str] = "backlash"
    own: ClassVar[tuple[str, ...]] = ("width",)
    size_name: ClassVar[str | None] = "width"

    def __post_init__(self) -> None:
        object.__setattr__(self, "width", not_negative("width", self.width))

    def __call__(self, u: npt.ArrayLike) -> float | FloatArray:
        """Position x for u, a scalar or shape (n,), from rest at the first finite sample; NaN gives NaN."""
        return self.run(u)

    def run(self, u: npt.ArrayLike, start: float | None = None) -> float | FloatArray:
        """Position x for u, a scalar or shape (n,), from the position `start` (None: x = u at the first sample)."""
        before = math.nan if start is None else finite("start", start)
        return along_time(lambda array: kernel.run(array, self.width, before), u)

    def inverse(self) -> BacklashInverse:
        """The inverse: ``backlash(backlash.inverse()(v)) == v``, to rounding."""
        return BacklashInverse(self)

    def describing_function(self, amplitude: float) -> complex:
        """Gain of the fundamental for ``amplitude * sin(t)``, complex; 0 where the sine stays inside the gap.

        Gelb and Vander Velde, Multiple-Input Describing Functions and Nonlinear System Design (1968), appendix B.
        """
        return gliding_sine(self.width / positive("amplitude", amplitude), 0.0)

    @property
    def kernel_code(self) -> int:
        """Number in ``kernels.actuator``."""
        return numbers.BACKLASH

    def kernel_parameters(self) -> FloatArray:
        """Parameters in the order of ``kernels.actuator``, shape (5,)."""
        return padded(self.width)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        return {"kind": self.kind, **asdict(self)}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Inverse of :meth:`to_dict`."""
        if "width" not in data:
            raise ParameterError.expected("key 'width'", sorted(data), "use to_dict()")
        return cls(data["width"])


@dataclass(frozen=True)
class BacklashInverse:
    """Inverse of a backlash: ``u = v + side width / 2``, side = sign of the last move of v (0 before the first).

    The command jumps by the whole width where the wanted position v turns, so that the gap is crossed at once.
    """

    backlash: Backlash

    def __call__(self, v: npt.ArrayLike) -> float | FloatArray:
        """Command u that makes the backlash give v, a scalar or shape (n,), from rest at the first sample."""
        return self.run(v)

    def run(self, v: npt.ArrayLike, side: int = 0) -> float | FloatArray:
        """Command u for v, where `side` (-1, 0, 1) is the sign of the last move before the first sample."""
        if side not in (-1, 0, 1):
            raise ParameterError.expected("side -1, 0 or 1", side, "give the sign of the last move")
        return along_time(lambda array: kernel.inverse_run(array, self.backlash.width, float(np.sign(side))), v)

    def inverse(self) -> Backlash:
        """The backlash itself."""
        return self.backlash
