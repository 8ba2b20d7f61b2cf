"""Identity: an actuator without fault, x = u."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import elementwise
from lostmotion.arrays import FloatArray
from lostmotion.kernels import actuator as numbers
from lostmotion.models.kernel_view import padded
from lostmotion.models.registry import actuator


@actuator
@dataclass(frozen=True)
class Identity:
    """Actuator that does what it is told: x = u.

    Examples
    --------
    >>> Identity()(2.5)
    2.5
    """

    kind: ClassVar[str] = "none"
    own: ClassVar[tuple[str, ...]] = ()
    size_name: ClassVar[str | None] = None

    def __call__(self, u: npt.ArrayLike) -> float | FloatArray:
        """Internal variable x = u, scalar or any shape."""
        return elementwise(np.copy, u)

    def inverse(self) -> Identity:
        """Itself."""
        return self

    @property
    def kernel_code(self) -> int:
        """Number in ``kernels.actuator``."""
        return numbers.NONE

    def kernel_parameters(self) -> FloatArray:
        """Parameters in the order of ``kernels.actuator``, shape (5,)."""
        return padded()

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        return {"kind": self.kind}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:  # noqa: ARG003  nothing to read
        """Inverse of :meth:`to_dict`."""
        return cls()
