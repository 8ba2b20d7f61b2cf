"""Actuators one behind the other, such as a backlash followed by a dead zone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Self

import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.models.backlash import Backlash
from lostmotion.models.dead_zone import DeadZone
from lostmotion.models.hammerstein import Nonlinearity
from lostmotion.models.identity import Identity
from lostmotion.models.saturation import Saturation
from lostmotion.models.stiction import Stiction

Answer = float | FloatArray


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
    >>> valve = Series((Backlash(1.0), DeadZone(-1.0, 1.0)))
    >>> valve([0.0, 3.0, 2.5, 0.0]).tolist()
    [0.0, 1.5, 1.5, 0.0]
    >>> valve(valve.inverse()([0.0, 1.5, 0.5])).tolist()
    [0.0, 1.5, 0.5]
    """

    actuators: tuple[Nonlinearity, ...]

    kind = "series"

    def __post_init__(self) -> None:
        try:
            actuators = tuple(self.actuators)
        except TypeError:
            actuators = ()
        if not actuators or not all(isinstance(actuator, Nonlinearity) for actuator in actuators):
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
        return {"kind": self.kind, "actuators": [actuator.to_dict() for actuator in self.actuators]}

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
        for actuator in self.series.actuators:
            if not hasattr(actuator, "inverse"):
                raise ParameterError.expected(
                    "actuators with an inverse", actuator.kind, "leave it out, or compensate it in another way"
                )

    def __call__(self, v: npt.ArrayLike) -> Answer:
        """Command u that makes the series give v."""
        backwards: list[Any] = list(self.series.actuators[::-1])
        return _through([actuator.inverse() for actuator in backwards], v)

    def inverse(self) -> Series:
        """The series itself."""
        return self.series


KINDS: dict[str, Any] = {each.kind: each for each in (Backlash, DeadZone, Identity, Saturation, Series, Stiction)}


def actuator_from_dict(data: dict[str, Any]) -> Nonlinearity:
    """Actuator of any kind from its ``to_dict()``.

    Raises
    ------
    ParameterError
        An unknown kind, or missing numbers.

    Examples
    --------
    >>> actuator_from_dict({"kind": "backlash", "width": 2.0})
    Backlash(width=2.0)
    """
    if data.get("kind") not in KINDS:
        raise ParameterError.expected(f"kind out of {sorted(KINDS)}", repr(data.get("kind")), "use to_dict()")
    actuator: Nonlinearity = KINDS[data["kind"]].from_dict(data)
    return actuator


def _through(stages: list[Callable[[npt.ArrayLike], Answer]], u: npt.ArrayLike) -> Answer:
    """`u` through all stages."""
    first, *others = stages
    answer = first(u)
    for stage in others:
        answer = stage(answer)
    return answer
