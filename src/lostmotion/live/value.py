"""One value of a signal, as a server tells it."""

from __future__ import annotations

from typing import NamedTuple

ROLES = ("op", "pv", "sp", "mode")
HELD = ("op", "mode")  # what a row needs beside PV: the last value holds


class Value(NamedTuple):
    """A value of a signal.

    Attributes
    ----------
    role : str
        "op", "pv", "sp" or "mode".
    stamp : float
        Time of the source, seconds from 1970 in UTC.
    value : float
        NaN where the quality is bad; of a mode 1 in automatic, else 0.
    at : float
        When it came, on a clock that never steps.
    why : str
        Name of a status that is not good.
    """

    role: str
    stamp: float
    value: float
    at: float
    why: str = ""
