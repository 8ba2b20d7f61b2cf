"""Hammerstein model: an actuator in front of a linear process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite, signal
from lostmotion.arrays import FloatArray
from lostmotion.models.control_system import nonlinear_system
from lostmotion.models.linear import LinearModel


@runtime_checkable
class Nonlinearity(Protocol):
    """What every actuator model offers: a kind, a call, and a description."""

    kind: ClassVar[str]

    def __call__(self, u: npt.ArrayLike) -> float | FloatArray:
        """Internal variable x for the command u."""

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""


@dataclass(frozen=True)
class Hammerstein:
    """``y = q^-d B/A x + offset`` with ``x = nonlinearity(u)`` (paper, figure 1).

    Parameters
    ----------
    nonlinearity : Nonlinearity
        Actuator, e.g. :class:`DeadZone`.
    linear : LinearModel
        Process.
    offset : float
        Output where x is zero at rest, in units of y.

    Examples
    --------
    >>> from lostmotion.models import DeadZone
    >>> valve = DeadZone(-1, 1)
    >>> Hammerstein(valve, LinearModel(a=[-0.5], b=[0.5], delay=1)).simulate([3.0, 0.5, 0.5]).tolist()
    [0.0, 1.0, 0.5]
    """

    nonlinearity: Nonlinearity
    linear: LinearModel
    offset: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "offset", finite("offset", self.offset))

    def simulate(self, u: npt.ArrayLike) -> FloatArray:
        """Noise-free output for the command u, shape (n,), from rest (x = 0 before the first sample)."""
        x = np.asarray(self.nonlinearity(signal("u", u)))
        return self.linear.simulate(x) + self.offset

    def to_control(self, load: float = 0.0) -> Any:
        """As a discrete ``NonlinearIOSystem`` of python-control, from OP to PV (needs ``lostmotion[control]``).

        From the state zero it begins as :meth:`simulate` does: the actuator at rest at the first OP, x = 0 before it,
        PV at the offset. The linear part alone is ``model.linear.to_control()``.

        Parameters
        ----------
        load : float
            Constant, added to x: what an integrating process is held against.

        Raises
        ------
        ParameterError
            An actuator that no kernel simulates, such as a :class:`Series`.
        ImportError
            python-control is not installed.

        Examples
        --------
        >>> from lostmotion.models import Backlash
        >>> model = Hammerstein(Backlash(1.0), LinearModel(a=[-0.5], b=[0.5], delay=1), offset=20.0)
        >>> system = model.to_control()
        >>> system.ninputs, system.noutputs, system.state_labels
        (1, 1, ['started', 'position', 'linear 1'])
        """
        return nonlinear_system(self, load)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        return {
            "nonlinearity": self.nonlinearity.to_dict(),
            "linear": self.linear.to_dict(),
            "offset": self.offset,
        }
