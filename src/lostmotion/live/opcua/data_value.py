"""A value of OPC UA -> a value of a signal: time of the source, quality, mode."""

from __future__ import annotations

import math
from collections.abc import Sequence
from datetime import UTC, datetime
from functools import lru_cache
from typing import Any

from asyncua import ua

from lostmotion.live.value import Value
from lostmotion.records.modes import holds, words_of
from lostmotion.records.record import LARGEST

OVERFLOW = 0x480  # info type "data value" and the overflow bit: values before this one were lost in the server
_BITS = 0x480
_SEVERITY = 0xC0000000
_BAD, _UNCERTAIN = 0x80000000, 0x40000000
_1970 = datetime(1970, 1, 1, tzinfo=UTC)


def overflowed(data: ua.DataValue) -> bool:
    """Whether the server had to drop values before this one."""
    code = _code(data)
    return code & _BITS == OVERFLOW


def value_of(
    role: str, data: ua.DataValue, at: float, automatic: Sequence[str] = (), uncertain: str = "bad"
) -> Value | None:
    """Value for a row; None where it has no time at all.

    Parameters
    ----------
    role : str
    data : DataValue
    at : float
        When it came.
    automatic : sequence of str
        Words of a mode in automatic; empty: the usual ones.
    uncertain : "bad" or "keep"
        What a value of uncertain quality is.
    """
    stamp = data.SourceTimestamp or data.ServerTimestamp
    if stamp is None:
        return None
    code = _code(data)
    bad = code & _SEVERITY >= _BAD or (code & _SEVERITY == _UNCERTAIN and uncertain == "bad")
    content = None if data.Value is None else data.Value.Value
    number = math.nan
    if not bad:
        number = float(_is_automatic(content, tuple(automatic))) if role == "mode" else _number(content)
    elif role == "mode":
        number = 0.0  # nobody knows
    return Value(role, seconds_of(stamp), number, at, _name(code) if bad else "")


def seconds_of(stamp: datetime) -> float:
    """Seconds from 1970, exact to the microsecond."""
    passed = (stamp if stamp.tzinfo else stamp.replace(tzinfo=UTC)) - _1970
    return ((passed.days * 86400 + passed.seconds) * 1_000_000 + passed.microseconds) / 1e6


def _code(data: ua.DataValue) -> int:
    return 0 if data.StatusCode is None else int(data.StatusCode.value)


def _number(content: Any) -> float:
    """Number that can be worked with; NaN for all else."""
    if isinstance(content, bool | int | float) and abs(float(content)) <= LARGEST:
        return float(content)
    return math.nan


def _is_automatic(content: Any, automatic: tuple[str, ...]) -> bool:
    if isinstance(content, ua.LocalizedText):
        content = content.Text
    return content is not None and _holds(str(content), automatic or words_of("automatic"))


@lru_cache(maxsize=1024)
def _holds(content: str, words: tuple[str, ...]) -> bool:
    return holds(content, words)


@lru_cache(maxsize=256)
def _name(code: int) -> str:
    return ua.StatusCode(code & 0xFFFF0000).name  # type: ignore[arg-type]  # an int is one


def quality_of(data: ua.DataValue) -> str:
    """Good, Uncertain or Bad."""
    severity = _code(data) & _SEVERITY
    return "Good" if severity == 0 else "Uncertain" if severity == _UNCERTAIN else "Bad"
