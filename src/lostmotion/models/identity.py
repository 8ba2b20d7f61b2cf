"""Identity: an actuator without fault, x = u."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import elementwise
from lostmotion.arrays import FloatArray


@dataclass(frozen=True)
class Identity:
    """Actuator that does what it is told: x = u.

    Examples
    --------
    >>> Identity()(2.5)
    2.5
    """

    kind = "none"
    size_name: ClassVar[str | None] = None
    own: ClassVar[tuple[str, ...]] = ()

    def __call__(self, u: npt.ArrayLike) -> float | FloatArray:
        """Internal variable x = u, scalar or any shape."""
        return elementwise(np.copy, u)

    def inverse(self) -> Identity:
        """Itself."""
        return self

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        return {"kind": self.kind}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:  # noqa: ARG003  nothing to read
        """Inverse of :meth:`to_dict`."""
        return cls()
