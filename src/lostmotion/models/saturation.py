"""Saturation of an actuator."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, ClassVar, Self

import numpy.typing as npt

from lostmotion.arguments import elementwise, finite, positive
from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.kernels import actuator as numbers
from lostmotion.kernels import saturation as kernel
from lostmotion.models.fundamentals import clipped_sine
from lostmotion.models.kernel_view import padded
from lostmotion.models.registry import actuator


@actuator
@dataclass(frozen=True)
class Saturation:
    """Limits of an actuator: x = u between `low` and `high`, the limit outside.

    Parameters
    ----------
    low, high : float
        Limits in units of u, low <= high.

    Raises
    ------
    ParameterError
        low > high, or a limit that is not finite.

    Examples
    --------
    >>> Saturation(0.0, 100.0)([-5.0, 40.0, 120.0]).tolist()
    [0.0, 40.0, 100.0]
    """

    low: float
    high: float

    kind: ClassVar[str] = "saturation"
    own: ClassVar[tuple[str, ...]] = ("low", "high")
    size_name: ClassVar[str | None] = None

    def __post_init__(self) -> None:
        for name in ("low", "high"):
            object.__setattr__(self, name, finite(name, getattr(self, name)))
        if self.low > self.high:
            raise ParameterError.expected("low <= high", f"low={self.low}, high={self.high}", "swap the limits")

    def __call__(self, u: npt.ArrayLike) -> float | FloatArray:
        """Internal variable x for u, scalar or any shape; NaN stays NaN."""
        return elementwise(lambda array: kernel.run(array, self.low, self.high), u)

    def inverse(self) -> Saturation:
        """Itself: the command nearest to what is wanted; what lies outside the limits cannot be had."""
        return self

    def describing_function(self, amplitude: float) -> complex:
        """Gain of the fundamental for ``amplitude * sin(t)``: real, each limit counts for half of the sine."""
        size = positive("amplitude", amplitude)
        if self.low > 0 or self.high < 0:
            raise ParameterError.expected(
                "low <= 0 <= high", f"low={self.low}, high={self.high}", "use describing_function() with a bias"
            )
        return complex(0.5 * (clipped_sine(self.high / size) + clipped_sine(-self.low / size)))

    @property
    def kernel_code(self) -> int:
        """Number in ``kernels.actuator``."""
        return numbers.SATURATION

    def kernel_parameters(self) -> FloatArray:
        """Parameters in the order of ``kernels.actuator``, shape (5,)."""
        return padded(self.low, self.high)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        return {"kind": self.kind, **asdict(self)}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Inverse of :meth:`to_dict`."""
        names = ("low", "high")
        if any(name not in data for name in names):
            raise ParameterError.expected(f"keys {list(names)}", sorted(data), "use to_dict()")
        return cls(*(data[name] for name in names))
