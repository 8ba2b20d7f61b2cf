"""An actuator as the kernels of loops see it: a number and five parameters."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np

from lostmotion.arrays import FloatArray

ROOM = 5  # parameters that ``kernels.actuator`` has room for


@runtime_checkable
class KernelActuator(Protocol):
    """A model that loops can simulate."""

    @property
    def kernel_code(self) -> int:
        """Number in ``kernels.actuator``."""

    def kernel_parameters(self) -> FloatArray:
        """Parameters in the order of ``kernels.actuator``, shape (5,)."""


def padded(*values: float) -> FloatArray:
    """Parameters, with zeros behind them."""
    parameters = np.zeros(ROOM)
    parameters[: len(values)] = values
    return parameters
