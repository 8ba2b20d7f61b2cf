"""Actuators one behind the other, such as a backlash followed by a dead zone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.models.hammerstein import Nonlinearity
from lostmotion.models.registry import actuator, actuator_from_dict

Answer = float | FloatArray


@actuator
@dataclass(frozen=True)
class Series:
    """Actuators in a row: the output of each is the command of the next.

    Parameters
    ----------
    actuators : tuple of Nonlinearity
        In the order in which the command passes them, at least one.

    Raises
    ------
    ParameterError
        No actuator, or something that is none.

    Examples
    --------
    >>> from lostmotion.models import Backlash, DeadZone
    >>> valve = Series((Backlash(1.0), DeadZone(-1.0, 1.0)))
    >>> valve([0.0, 3.0, 2.5, 0.0]).tolist()
    [0.0, 1.5, 1.5, 0.0]
    >>> valve(valve.inverse()([0.0, 1.5, 0.5])).tolist()
    [0.0, 1.5, 0.5]
    """

    actuators: tuple[Nonlinearity, ...]

    kind: ClassVar[str] = "series"
    own: ClassVar[tuple[str, ...]] = ("actuators",)
    size_name: ClassVar[str | None] = None

    def __post_init__(self) -> None:
        try:
            actuators = tuple(self.actuators)
        except TypeError:
            actuators = ()
        if not actuators or not all(isinstance(each, Nonlinearity) for each in actuators):
            raise ParameterError.expected(
                "at least one actuator",
                repr(self.actuators)[:60],
                "give a tuple such as (Backlash(1.0), DeadZone(-1, 1))",
            )
        object.__setattr__(self, "actuators", actuators)

    def __call__(self, u: npt.ArrayLike) -> Answer:
        """Internal variable x for u; where an actuator has memory, a scalar or shape (n,), from rest."""
        return _through([*self.actuators], u)

    def inverse(self) -> SeriesInverse:
        """The inverses in the opposite order.

        Raises
        ------
        ParameterError
            An actuator without inverse, e.g. stiction.
        """
        return SeriesInverse(self)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        return {"kind": self.kind, "actuators": [each.to_dict() for each in self.actuators]}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Inverse of :meth:`to_dict`."""
        if "actuators" not in data:
            raise ParameterError.expected("key 'actuators'", sorted(data), "use to_dict()")
        return cls(tuple(actuator_from_dict(each) for each in data["actuators"]))


@dataclass(frozen=True)
class SeriesInverse:
    """Inverse of a series: the inverse of the last actuator first."""

    series: Series

    def __post_init__(self) -> None:
        for each in self.series.actuators:
            if not hasattr(each, "inverse"):
                raise ParameterError.expected(
                    "actuators with an inverse", each.kind, "leave it out, or compensate it in another way"
                )

    def __call__(self, v: npt.ArrayLike) -> Answer:
        """Command u that makes the series give v."""
        backwards: list[Any] = list(self.series.actuators[::-1])
        return _through([each.inverse() for each in backwards], v)

    def inverse(self) -> Series:
        """The series itself."""
        return self.series


def _through(stages: list[Callable[[npt.ArrayLike], Answer]], u: npt.ArrayLike) -> Answer:
    """`u` through all stages."""
    first, *others = stages
    answer = first(u)
    for stage in others:
        answer = stage(answer)
    return answer
