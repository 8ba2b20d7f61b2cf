"""Compensator of a backlash: the plain ideal inverse."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.kernels import backlash as kernel
from lostmotion.models import Backlash


@dataclass(frozen=True)
class BacklashCompensator:
    """Inverse of a backlash: the command leads by half the width in the direction of the last move.

    Ideal: it turns with every change of sign of the moves, noise included. What is fit for a PLC is ``fit.block()``.

    Parameters
    ----------
    backlash : Backlash
        What is to be undone.

    Examples
    --------
    >>> comp = BacklashCompensator(Backlash(1.0))
    >>> comp([0.0, 2.0, 1.0]).tolist(), [comp.step(v) for v in (0.0, 2.0, 1.0)]
    ([0.0, 2.5, 0.5], [0.0, 2.5, 0.5])
    """

    backlash: Backlash
    kind: str = field(default="backlash", init=False)
    _memory: list[float] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if not isinstance(self.backlash, Backlash):
            raise ParameterError.expected("a Backlash", type(self.backlash).__name__, "pass fit.nonlinearity")
        self.reset()

    def __call__(self, uc: npt.ArrayLike) -> float | FloatArray:
        """Commands for the wanted positions uc, a scalar or shape (n,), from rest at the first sample."""
        return self.backlash.inverse()(uc)

    def step(self, uc: float) -> float:
        """Command for one sample; it remembers the direction. NaN gives NaN and changes nothing."""
        command, *memory = kernel.inverse_step(float(np.float64(uc)), self.backlash.width, *self._memory)
        self._memory[:] = memory
        return float(command)

    def reset(self) -> None:
        """Forget the direction."""
        object.__setattr__(self, "_memory", [math.nan, 0.0])

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        return {"kind": self.kind, **asdict(self.backlash)}
