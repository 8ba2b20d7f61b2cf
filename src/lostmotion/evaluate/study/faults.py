"""What the study needs to know of a kind of actuator: one class each, and a refusal for kinds without one."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import singledispatch
from typing import Any, ClassVar

from lostmotion.compensate import CompensatorBlock
from lostmotion.errors import ParameterError
from lostmotion.models import Backlash, DeadZone, Identity, Nonlinearity, Stiction, actuator_from_dict

WANTED = "an actuator with a dead zone, backlash or stiction"
REMEDY = "other faults have no block: mend them"


@dataclass(frozen=True)
class Fault(ABC):
    """An actuator with memory, by default.

    Attributes
    ----------
    valve : Nonlinearity
    static : bool
        No memory, and x = 0 inside the lost motion.
    """

    valve: Any
    static: ClassVar[bool] = False

    @property
    @abstractmethod
    def lost_motion(self) -> float:
        """Width of what is lost, in units of x."""

    @abstractmethod
    def scaled(self, factor: float) -> list[tuple[str, Nonlinearity]]:
        """Actuators with one size or another so many times as large, and the name of the size."""

    @property
    def own(self) -> tuple[str, ...]:
        """Names of the parameters of the actuator."""
        names: tuple[str, ...] = self.valve.own
        return names

    @property
    def middle(self) -> float:
        """OP around which a sine is put."""
        return 0.0

    @property
    def slope(self) -> float:
        """Steepest slope outside the lost motion."""
        return 1.0

    @property
    def inside(self) -> float:
        """Distance from x = 0 that is surely crossed where a static actuator is left, in units of x."""
        return 0.0

    def command_at(self, x: float) -> float:
        """Command at rest for an internal variable."""
        return x

    def repaired(self, block: CompensatorBlock) -> Nonlinearity:  # noqa: ARG002  a dead zone asks the block
        """What a perfect inverse would make of it: no lost motion, the gain that the block gives the loop."""
        return Identity()

    def with_values(self, values: Mapping[str, float]) -> Nonlinearity | None:
        """The actuator with other parameters; None where there is none such."""
        data = {**self.valve.to_dict(), **{name: float(value) for name, value in values.items()}}
        return actuator_from_dict(data) if self._possible(data) else None

    def _possible(self, data: Mapping[str, Any]) -> bool:
        return all(data[name] >= 0.0 for name in self.own)


@singledispatch
def fault_of(valve: Nonlinearity) -> Fault:
    """What the study needs to know of an actuator.

    Raises
    ------
    ParameterError
        A kind without an answer.
    """
    raise ParameterError.expected(WANTED, getattr(valve, "kind", type(valve).__name__), REMEDY)


@dataclass(frozen=True)
class DeadZoneFault(Fault):
    """A dead zone."""

    valve: DeadZone
    static: ClassVar[bool] = True

    @property
    def lost_motion(self) -> float:
        """Width times the steeper slope."""
        return self.valve.width * self.slope

    @property
    def middle(self) -> float:
        """Middle of the dead zone."""
        return 0.5 * (self.valve.left + self.valve.right)

    @property
    def slope(self) -> float:
        """The steeper slope."""
        return max(self.valve.left_slope, self.valve.right_slope)

    @property
    def inside(self) -> float:
        """A quarter of the width."""
        return 0.25 * self.valve.width * min(self.valve.left_slope, self.valve.right_slope)

    def command_at(self, x: float) -> float:
        """By the inverse; the middle for x = 0."""
        return self.middle if x == 0.0 else float(self.valve.inverse()(x))

    def repaired(self, block: CompensatorBlock) -> Nonlinearity:
        """Without width, with the slopes that the block leaves."""
        middle, slopes = self.middle, (self.valve.left_slope, self.valve.right_slope)
        if block.kind == "dead zone":
            inverse = block.settings
            middle = inverse["centre"]
            slopes = (slopes[0] / inverse["left_slope"], slopes[1] / inverse["right_slope"])
        return DeadZone(middle, middle, *slopes)

    def scaled(self, factor: float) -> list[tuple[str, Nonlinearity]]:
        """Both halves, each half, one slope."""
        valve, half = self.valve, 0.5 * self.valve.width
        left, right = self.middle - factor * half, self.middle + factor * half
        return [
            ("width", replace(valve, left=left, right=right)),
            ("left half", replace(valve, left=left)),
            ("right half", replace(valve, right=right)),
            ("left slope", replace(valve, left_slope=valve.left_slope * factor)),
        ]

    def _possible(self, data: Mapping[str, Any]) -> bool:
        return bool(data["left"] <= data["right"] and min(data["left_slope"], data["right_slope"]) > 0.0)


@dataclass(frozen=True)
class BacklashFault(Fault):
    """A backlash."""

    valve: Backlash

    @property
    def lost_motion(self) -> float:
        """The width."""
        return self.valve.width

    def scaled(self, factor: float) -> list[tuple[str, Nonlinearity]]:
        """The width."""
        return [("width", Backlash(self.valve.width * factor))]


@dataclass(frozen=True)
class StictionFault(Fault):
    """A sticking valve."""

    valve: Stiction

    @property
    def lost_motion(self) -> float:
        """Band or jump."""
        return max(self.valve.band, self.valve.jump)

    def scaled(self, factor: float) -> list[tuple[str, Nonlinearity]]:
        """Band, jump, both."""
        valve = self.valve
        return [
            ("band", replace(valve, band=valve.band * factor)),
            ("jump", replace(valve, jump=valve.jump * factor)),
            ("band and jump", replace(valve, band=valve.band * factor, jump=valve.jump * factor)),
        ]


@dataclass(frozen=True)
class NoFault(Fault):
    """What is left where a fault with memory was repaired; looked at as that fault is."""

    valve: Identity

    @property
    def lost_motion(self) -> float:
        """None."""
        return 0.0

    def scaled(self, factor: float) -> list[tuple[str, Nonlinearity]]:  # noqa: ARG002
        """None."""
        return []


@fault_of.register
def _dead_zone(valve: DeadZone) -> Fault:
    return DeadZoneFault(valve)


@fault_of.register
def _backlash(valve: Backlash) -> Fault:
    return BacklashFault(valve)


@fault_of.register
def _stiction(valve: Stiction) -> Fault:
    return StictionFault(valve)


@fault_of.register
def _none(valve: Identity) -> Fault:
    return NoFault(valve)
