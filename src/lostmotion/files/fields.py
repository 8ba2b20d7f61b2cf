"""Typed reading of a dictionary that came from JSON: every refusal names the place."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

from lostmotion.arguments import LARGEST
from lostmotion.errors import DataError, InputError

T = TypeVar("T")
_ABSENT = object()


class Fields:
    """A mapping whose values are checked as they are read.

    Parameters
    ----------
    data : mapping
        What JSON gave.
    what : str
        For messages: "a fit", "a block".
    remedy : str
        For messages: what to do where something is missing or of another type.
    place : str
        Where `data` stands in the whole, with a dot at its end.

    Raises
    ------
    DataError
        `data` is no mapping.

    Examples
    --------
    >>> fields = Fields({"data": {"dt": 0.5}}, "a fit", "save it again")
    >>> fields.part("data").number("dt")
    0.5
    >>> fields.part("data").text("tag")
    Traceback (most recent call last):
    ...
    lostmotion.errors.DataError: expected a text in data.tag of a fit, got nothing; save it again
    """

    def __init__(self, data: object, what: str, remedy: str, place: str = "") -> None:
        self._what, self._remedy, self._place = what, remedy, place
        if not isinstance(data, Mapping):
            expected = f"a group {place[:-1]} of {what}" if place else f"the dictionary of {what}"
            raise DataError.expected(expected, _shown(data), remedy)
        self._data = data

    def __contains__(self, name: str) -> bool:
        return self._data.get(name) is not None

    @property
    def names(self) -> tuple[str, ...]:
        """All keys."""
        return tuple(self._data)

    def require(self, *names: str) -> None:
        """Refuse where keys are missing."""
        missing = [name for name in names if name not in self._data]
        if missing:
            got = f"no {', '.join(missing)} in keys {sorted(map(str, self._data))}"
            raise DataError.expected(f"the dictionary of {self._what}", got, self._remedy)

    def part(self, name: str) -> Fields:
        """Mapping inside."""
        return Fields(self._data.get(name), self._what, self._remedy, f"{self._place}{name}.")

    def number(self, name: str) -> float:
        """Finite number."""
        return self._read(name, "a number", as_number)

    def number_or_none(self, name: str) -> float | None:
        """Finite number, or None where it is null or missing."""
        return self.number(name) if name in self else None

    def unbounded(self, name: str, unknown: float = math.inf) -> float:
        """Number, `unknown` where it is null; it must be there."""
        return self._read(name, "a number or null", lambda value: unknown if value is None else as_number(value))

    def count(self, name: str) -> int:
        """Whole number, not negative."""
        return self._read(name, "a whole number", _as_count)

    def flag(self, name: str) -> bool:
        """True or false."""
        return self._read(name, "true or false", _as_flag)

    def text(self, name: str) -> str:
        """Text."""
        return self._read(name, "a text", _as_text)

    def texts(self, name: str) -> tuple[str, ...]:
        """List of texts."""
        return self._read(name, "a list of texts", lambda value: tuple(map(_as_text, as_list(value))))

    def numbers(self, name: str) -> tuple[float, ...]:
        """List of finite numbers."""
        return self._read(name, "a list of numbers", lambda value: tuple(map(as_number, as_list(value))))

    def pair(self, name: str, low: float | None = None, high: float | None = None) -> tuple[float, float]:
        """Two numbers, the first not above the second; `low` and `high` stand for null."""
        return self._read(name, "a pair (low, high)", lambda value: _as_pair(value, low, high))

    def rows(self, name: str, unknown: float = math.inf) -> list[list[float]]:
        """List of lists of numbers; `unknown` stands for null."""

        def as_rows(value: object) -> list[list[float]]:
            return [[unknown if cell is None else as_number(cell) for cell in as_list(row)] for row in as_list(value)]

        return self._read(name, "a table of numbers", as_rows)

    def made(self, name: str, expected: str, make: Callable[[Any], T]) -> T:
        """What `make` builds of a value; its refusal is one of the place."""
        value = self._data.get(name)
        try:
            return make(value)
        except DataError:
            raise
        except (InputError, TypeError, ValueError, LookupError, AttributeError) as error:
            raise self._refusal(name, expected, f"{_shown(value)} ({error})") from error

    def _read(self, name: str, expected: str, check: Callable[[object], T]) -> T:
        value = self._data.get(name, _ABSENT)
        try:
            return check(value)
        except (TypeError, ValueError, OverflowError) as error:
            raise self._refusal(name, expected, "nothing" if value is _ABSENT else _shown(value)) from error

    def _refusal(self, name: str, expected: str, got: str) -> DataError:
        return DataError.expected(f"{expected} in {self._place}{name} of {self._what}", got, self._remedy)


def as_number(value: object) -> float:
    """Number that is no flag, and can be multiplied with another; else TypeError or ValueError."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError
    if not abs(value) <= LARGEST:
        raise ValueError
    return float(value)


def as_list(value: object) -> Sequence[object]:
    """List or tuple, else TypeError."""
    if not isinstance(value, list | tuple):
        raise TypeError
    return value


def _as_count(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise TypeError
    if value < 0:
        raise ValueError
    return value


def _as_flag(value: object) -> bool:
    if not isinstance(value, bool):
        raise TypeError
    return value


def _as_text(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError
    return value


def _as_pair(value: object, low: float | None, high: float | None) -> tuple[float, float]:
    first, second = as_list(value)
    lower = low if first is None and low is not None else as_number(first)
    upper = high if second is None and high is not None else as_number(second)
    if lower > upper:
        raise ValueError
    return lower, upper


def _shown(value: object) -> str:
    """Value for a message of one line."""
    said = repr(value)
    return said if len(said) <= 60 else f"{said[:57]}..."
