"""Whether a loop rings or is driven, by the amplitude of its oscillation: for one loop as for all of a plant."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

from lostmotion.diagnose.control_error.amplitude import error_oscillation
from lostmotion.records import LoopRecord

if TYPE_CHECKING:
    from lostmotion.diagnose.diagnosis import Diagnosis

Found = TypeVar("Found", bound="Diagnosis")


@dataclass(frozen=True)
class Source:
    """Where an oscillation comes from, and what to do about it.

    Attributes
    ----------
    where : str
        A sentence.
    advice : tuple of str
        Most important first.
    """

    where: str
    advice: tuple[str, ...]


RINGING = Source(
    "It comes from the tuning: the loop rings, and noise builds the swing up and takes it away.",
    ("Retune: the loop hardly settles at this period. Lower the gain, or the integral action.",),
)
DRIVEN = Source(
    "It comes from outside: the swing keeps its amplitude, which that of a badly tuned loop does not.",
    ("Look upstream: the loop follows a swing that comes from elsewhere. Compare the periods of its neighbours.",),
)
AGAIN = "Then record it again: once the loop settles, moves of SP show what the valve does."


def rings_untold(verdict: str, kind: str) -> bool:
    """Whether a diagnosis leaves it open that the loop rings: it names no fault, no tuning, SP or sensor."""
    return verdict in ("cannot tell", "none") or kind in ("disturbance", "unknown")


def judged_by_amplitude(found: Found, record: LoopRecord) -> Found:
    """The diagnosis with what the amplitude of the oscillation says of where it comes from.

    The verdict is on the valve and stays; `kind`, and what to do first, are those of the oscillation. In a record
    without feedback from PV to OP no loop rings.
    """
    measured = error_oscillation(record)
    if measured is None:
        return found
    found = replace(found, error_oscillation=measured)
    if measured.rings and rings_untold(found.verdict, found.kind) and found.fit.evidence.closed_loop:
        again = (AGAIN,) if found.verdict == "cannot tell" else ()
        return replace(found, kind="tuning", source=RINGING.where, advice=(*RINGING.advice, *again))
    if measured.steady and found.kind == "tuning":
        return replace(found, kind="disturbance", source=DRIVEN.where, advice=DRIVEN.advice)
    return found
