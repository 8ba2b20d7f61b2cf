"""What every valve model is: parameters that never change, and a stem that moves.

OP, commands and stems are in % of OP, times in seconds. S is how far the command turns between the last move of the
stem one way and its first move back; J, the slip jump, how far it slips then.
"""

from __future__ import annotations

from typing import Protocol

from published_loops.meters import Meter, Turns


class Stem(Protocol):
    """A stem in a loop."""

    @property
    def meter(self) -> Meter:
        """What has watched it."""

    def move(self, op: float) -> float:
        """OP is given at a scan and held for a row: mean place of the stem over that row."""


class Valve(Protocol):
    """A model with its parameters."""

    @property
    def label(self) -> str:
        """Model and parameters, as in the name of a loop."""

    @property
    def kind(self) -> str:
        """What a diagnosis should say: "none", "dead zone", "backlash" or "stiction"."""

    @property
    def size(self) -> float:
        """S by the parameters, or the width of a dead zone."""

    @property
    def jump(self) -> float:
        """J by the parameters."""

    def stem(self, place: float, seconds: float) -> Stem:
        """A stem at rest at this place, with so many seconds in a row."""


def label_of(model: str, *parameters: float) -> str:
    """As `kano-5-2`."""
    return "-".join([model, *(f"{one:g}" for one in parameters)])


def sticking_kind(jump: float) -> str:
    """Without a jump a valve that sticks is one with backlash."""
    return "stiction" if jump > 0 else "backlash"


class ScannedStem:
    """A stem whose model looks at the command once when it is given.

    Parameters
    ----------
    place : float
        Command and stem at first.
    meter : Meter, optional
        Otherwise one that measures S.
    """

    def __init__(self, place: float, meter: Meter | None = None) -> None:
        self.place = place
        self.before = place  # command at the last scan
        self.meter = meter or Turns(place)

    def follow(self, command: float) -> float:
        """Place of the stem by the rule of the model."""
        raise NotImplementedError

    def move(self, op: float) -> float:
        """Follow, be watched, remember."""
        self.place = self.follow(op)
        self.meter.see(op, self.place)
        self.before = op
        return self.place
