"""What can go wrong, and what to do about it.

Exceptions are for the door, where a caller hands in something that cannot be used. Inside batch work a
failure is a value: a :class:`Status`, whose text says what was found, why, and what to do.

::

    LostMotionError
    ├── InputError (ValueError)       something handed in cannot be used
    │   ├── ParameterError            a model parameter or a setting outside its domain
    │   │   └── GateError             a result that must not go on towards the valve (a DataError too)
    │   └── DataError                 a record that cannot be used: too short, constant, NaN, gaps
    │       ├── ColumnError           a column is missing, unknown or not numeric
    │       └── TimeError             a time column that is unsorted, repeated or contradicts dt
    ├── FileAccessError (OSError)     a file that is absent, unreadable, or already there
    ├── EngineError                   an audit has no workers any more, or its scheduler has gone away
    ├── SetupError                    a worker cannot do this work at all: the same would be said of every batch
    └── SlowError                     one loop of an audit took longer than it may
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from enum import Enum
from typing import Self

from lostmotion.printable import printable

LONGEST = 1000  # characters of one part of a message: a file may hold a cell of a gigabyte


def one_line(text: str) -> str:
    r"""Text with line ends, colours and all else that a terminal would act on written out, as in ``\n``; cut if long.

    Examples
    --------
    >>> one_line("a\nb"), len(one_line("x" * 9999))
    ('a\\nb', 1003)
    """
    cut = text if len(text) <= LONGEST else f"{text[: LONGEST // 2]} .. {text[1 - LONGEST // 2 :]}"
    return printable(cut).replace("\n", "\\n")


class LostMotionError(Exception):
    """Base of every error that lostmotion raises on purpose."""


class InputError(LostMotionError, ValueError):
    """Something handed in cannot be used.

    Attributes
    ----------
    said : (str, str, str) or None
        What was expected, what was got and the remedy, where the message has these parts.
    ways : tuple of dict
        Settings of the function that was called, each of which leads on; empty where no value is known.
    """

    said: tuple[str, str, str] | None = None
    ways: tuple[Mapping[str, object], ...] = ()

    @classmethod
    def expected(cls, expected: str, got: object, remedy: str) -> Self:
        """Build the message "expected X, got Y; do Z".

        Examples
        --------
        >>> raise InputError.expected("dt > 0", -1.0, "give the sampling time in seconds")
        Traceback (most recent call last):
        ...
        lostmotion.errors.InputError: expected dt > 0, got -1.0; give the sampling time in seconds
        """
        shown = (one_line(expected), one_line(str(got)), one_line(remedy))
        error = cls(f"expected {shown[0]}, got {shown[1]}; {shown[2]}")
        error.said = shown
        return error

    def leads_on(self, *ways: Mapping[str, object]) -> Self:
        """Error with settings that lead on, for those who can put them into a command line."""
        self.ways = ways
        return self


class ParameterError(InputError):
    """A model parameter or a setting is outside its domain."""


class DataError(InputError):
    """A record cannot be used as it is."""


class ColumnError(DataError):
    """A column is missing, unknown or not numeric."""

    @classmethod
    def missing(cls, wanted: str, available: Iterable[str], remedy: str) -> Self:
        """Name the column that is missing, what is there, and the nearest name."""
        names = list(available)
        lower = {name.lower(): name for name in names}
        near = difflib.get_close_matches(wanted.lower(), list(lower), n=1, cutoff=0.6)
        hint = f" (did you mean {lower[near[0]]!r}?)" if near else ""
        return cls.expected(f"a column {wanted!r}", f"{names}{hint}", remedy)


class TimeError(DataError):
    """A time column is unsorted, repeats, has gaps, or contradicts the sampling time."""


class GateError(ParameterError, DataError):
    """A result that must not go on towards the valve, unless a reason is given."""


class FileAccessError(LostMotionError, OSError):
    """A file is absent, unreadable, or would be overwritten."""


class EngineError(LostMotionError):
    """Nothing can be done any more: no workers, or a scheduler that has gone away."""


class SetupError(LostMotionError):
    """A worker cannot do this work at all: the same would be said of every batch."""


class SlowError(LostMotionError):
    """One loop of an audit took longer than it may."""


class Status(Enum):
    """Outcome of an identification; the value is the sentence that a report prints."""

    OK = "Converged; the record shows the nonlinearity clearly."
    NOT_SEEN = (
        "No lost motion can be seen: a model without a dead zone explains the record as well. "
        "If you suspect less than the bound given here, record moves of OP that cross it many times."
    )
    ONE_SIDED = (
        "Only one side of the dead zone is visited by OP, so the other break point is unknown. "
        "Record a stretch, or make a test, in which OP moves through the whole dead zone."
    )
    WIDE = (
        "Lost motion is seen, but not how much: the interval of a break point is wider than half of the width. "
        "Record more moves of OP that cross it, or make a test, before anything is built on these numbers."
    )
    FEW_CROSSINGS = (
        "A dead zone fits, but nothing except the controller moved OP, and went through it fewer than four times: a "
        "valve that sticks and slips looks the same. Record longer, record set-point moves, or make a test."
    )
    MISFIT = (
        "Converged, but the residuals still depend on OP: the real actuator is not quite of this shape. "
        "Read the numbers as those of the nearest actuator of this kind; nonlinearity='auto' compares all kinds."
    )
    COLOURED = (
        "Converged, but the residuals are not white, so the intervals are too narrow. "
        "Leave noise='auto' or give a higher noise order."
    )
    CANNOT_TELL = (
        "The record does not tell: OP hardly moves the measurement, or the feedback is an exact function of it. "
        "Use a longer record with set-point moves, or a test."
    )
    OTHER_KIND = (
        "Converged, but another kind of actuator fits the record better than the one that was asked for. "
        "Use nonlinearity='auto'."
    )
    SAME_SIGNAL = (
        "PV is an exact function of OP in the same sample: both are one signal, and there is no process between them. "
        "Check which columns were read; PV is what is measured behind the process."
    )
    NEAR_RANGE = (
        "What was found is nearly as wide as the range in which OP moved: such a size is not excluded, but not shown. "
        "Record larger moves of OP, well beyond it on either side, or make a test."
    )
    NO_PROCESS = (
        "Converged to a process whose time constant is longer than the record, which cannot show it. "
        "Record longer, say integrating=True where the process is a level, try fewer orders, or make a test."
    )
    NOT_REPRODUCED = (
        "Converged, but simulated from OP alone the model is farther from PV than the mean of PV is, without slow "
        "drift as well: the numbers rest on the prediction from sample to sample only. "
        "Record set-point moves, or make a test."
    )
    WRONG_GAIN = (
        "The known gain has the other sign than the record: the slopes of the actuator would be negative. "
        "Turn the sign of the gain."
    )
    NOT_CONVERGED = (
        "The likelihood has no interior maximum that the search could reach; the numbers are the best point seen. "
        "Try fewer orders, a longer record, or nonlinearity='none' to see whether a linear model fits at all."
    )
    INTEGRATING = (
        "The process integrates, as a level does, and is not followed sample by sample. "
        "Give the differences of PV from sample to sample instead of PV, and na one less."
    )

    @property
    def ok(self) -> bool:
        """True where the numbers and their intervals can be used."""
        return self in (Status.OK, Status.MISFIT)
