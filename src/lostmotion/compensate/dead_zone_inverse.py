"""Compensator of a dead zone: the paper's inverse with a stated centre."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import elementwise, finite
from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.kernels import dead_zone as kernel
from lostmotion.models import DeadZone


@dataclass(frozen=True)
class DeadZoneCompensator:
    """Inverse of a dead zone, between controller and actuator (paper, eqs 8-11).

    Parameters
    ----------
    dead_zone : DeadZone
        What is to be undone.
    centre : float
        Controller output at which the actuator shall rest, in units of u. 0 is the paper's case, in which the
        controller works in deviations; for absolute OP it is a point of the dead zone, so that the block passes
        OP through with a step of half the width to either side.

    Raises
    ------
    ParameterError
        A centre that is not finite.

    Notes
    -----
    At exactly the centre the command is the point of [left, right] nearest to the centre.

    Examples
    --------
    >>> block = DeadZoneCompensator(DeadZone(-1, 1, 3, 3))
    >>> block([-3.0, 0.0, 3.0]).tolist()
    [-2.0, 0.0, 2.0]
    >>> absolute = DeadZoneCompensator(DeadZone(44, 46), centre=45)
    >>> absolute([40.0, 45.0, 50.0]).tolist()
    [39.0, 45.0, 51.0]
    """

    dead_zone: DeadZone
    centre: float = 0.0
    kind: str = field(default="dead zone", init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", finite("centre", self.centre))
        if not isinstance(self.dead_zone, DeadZone):
            raise ParameterError.expected("a DeadZone", type(self.dead_zone).__name__, "pass fit.nonlinearity")

    @classmethod
    def from_dead_zone(cls, dead_zone: DeadZone, centre: float | None = None) -> DeadZoneCompensator:
        """Compensator whose centre is 0 where the dead zone holds it (the paper's case), else its middle."""
        if centre is None:
            inside = dead_zone.left <= 0.0 <= dead_zone.right
            centre = 0.0 if inside else 0.5 * (dead_zone.left + dead_zone.right)
        return cls(dead_zone, centre)

    @property
    def at_zero(self) -> float:
        """Command at exactly the centre."""
        return min(max(self.centre, self.dead_zone.left), self.dead_zone.right)

    def kernel_parameters(self) -> FloatArray:
        """Left, right, slopes and the answer to zero for an input that counts from the centre."""
        if self.centre != 0.0:
            raise ParameterError.expected("centre 0 in a simulated loop", self.centre, "simulate in deviations")
        zone = self.dead_zone
        return np.array([zone.left, zone.right, zone.left_slope, zone.right_slope, self.at_zero])

    def __call__(self, uc: npt.ArrayLike) -> float | FloatArray:
        """Command for the controller output uc, scalar or any shape."""
        zone = self.dead_zone
        return elementwise(
            lambda array: kernel.inverse_run(
                array - self.centre, zone.left, zone.right, zone.left_slope, zone.right_slope, self.at_zero
            ),
            uc,
        )

    def step(self, uc: float) -> float:
        """Command for one sample."""
        zone = self.dead_zone
        return float(
            kernel.inverse(uc - self.centre, zone.left, zone.right, zone.left_slope, zone.right_slope, self.at_zero)
        )

    def reset(self) -> None:
        """Forget the past; the static inverse has none."""

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        return {"kind": self.kind, "centre": self.centre, **asdict(self.dead_zone)}
