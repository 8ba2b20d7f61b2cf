"""What a file of ours may hold: type, length and range of every value, said once and checked before it is used."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple, TypeAlias

from lostmotion.errors import DataError

DEEPEST = 40  # groups and lists inside each other; ours have 6
LARGEST_WHOLE = 2**53  # every whole number up to here is a float
LARGEST = 1e150  # of numbers: their squares are numbers
LONGEST_TEXT = 1_000_000


class Wrong(NamedTuple):
    """What was expected, where, and what is there."""

    expected: str
    place: str
    got: Any


Check: TypeAlias = Callable[[Any], "Wrong | None"]


def checked(value: Any, check: Check, what: str, remedy: str) -> Any:
    """The value itself.

    Raises
    ------
    DataError
        It is something else than `check` expects; names the place.

    Examples
    --------
    >>> checked({"dt": -1.0}, group(dt=number(low=0.0)), "a state", "start anew")
    Traceback (most recent call last):
    ...
    lostmotion.errors.DataError: expected a number from 0.0 on in dt of a state, got -1.0; start anew
    """
    wrong = check(value)
    if wrong is not None:
        place = f" in {wrong.place.lstrip('.')}" if wrong.place else ""
        raise DataError.expected(f"{wrong.expected}{place} of {what}", shown(wrong.got), remedy)
    return value


def shown(value: Any) -> str:
    """Value for a message of one line, however deep and long it is."""
    if isinstance(value, dict | list | tuple):
        return f"{'a group' if isinstance(value, dict) else 'a list'} of {len(value)}"
    said = repr(value[:60] if isinstance(value, str) else value)
    return said if len(said) <= 60 else f"{said[:57]}..."


def kept(words: str, good: Callable[[Any], bool]) -> Check:
    """A single value that is `good`."""
    return lambda value: None if good(value) else Wrong(words, "", value)


def anything(value: Any) -> Wrong | None:  # noqa: ARG001
    """Whatever it is: somebody else looks at it."""
    return None


def number(low: float = -LARGEST, high: float = LARGEST) -> Check:
    """Finite number."""

    def good(value: Any) -> bool:
        return isinstance(value, float | int) and not isinstance(value, bool) and low <= value <= high

    return kept(f"a number{_range(low, high)}", good)


def whole(low: int = 0, high: int = LARGEST_WHOLE) -> Check:
    """Whole number, written as one."""
    return kept(f"a whole number{_range(low, high)}", lambda value: type(value) is int and low <= value <= high)


def text(longest: int = LONGEST_TEXT) -> Check:
    """Text that can be written to a file."""

    def good(value: Any) -> bool:
        return isinstance(value, str) and len(value) <= longest and value.encode("utf-8", "ignore").decode() == value

    return kept(f"a text up to {longest} signs", good)


def one_of(*values: Any) -> Check:
    """One of these, of the same type."""
    words = f"one of {list(values)}"
    return kept(words, lambda value: any(type(value) is type(each) and value == each for each in values))


def flag() -> Check:
    """True or false."""
    return kept("true or false", lambda value: isinstance(value, bool))


def or_null(check: Check) -> Check:
    """The same, or null."""
    return lambda value: None if value is None else check(value)


def either(*checks: Check) -> Check:
    """What one of them lets through."""

    def check_any(value: Any) -> Wrong | None:
        wrong = [check(value) for check in checks]
        return wrong[-1] if all(wrong) else None

    return check_any


def each(check: Check, most: int, fewest: int = 0) -> Check:
    """List of such values."""

    def check_all(value: Any) -> Wrong | None:
        if not isinstance(value, list | tuple) or not fewest <= len(value) <= most:
            return Wrong(f"a list of {fewest} to {most}", "", value)
        return _first((f"[{place}]", check(one)) for place, one in enumerate(value))

    return check_all


def row(*checks: Check) -> Check:
    """List of one length, each place with its own check."""

    def check_all(value: Any) -> Wrong | None:
        if not isinstance(value, list | tuple) or len(value) != len(checks):
            return Wrong(f"a list of {len(checks)}", "", value)
        return _first((f"[{place}]", check(one)) for place, (check, one) in enumerate(zip(checks, value, strict=True)))

    return check_all


def group(optional: Mapping[str, Check] | None = None, /, **checks: Check) -> Check:
    """Mapping with these keys, perhaps the optional ones, and no other."""
    maybe = optional or {}

    def check_all(value: Any) -> Wrong | None:
        if not isinstance(value, Mapping):
            return Wrong("a group", "", value)
        for name in checks:
            if name not in value:
                return Wrong("something", f".{name}", "nothing")
        for name in value:
            if name not in checks and name not in maybe:
                return Wrong(f"nothing but {', '.join((*checks, *maybe))}", "", name)
        return _first((f".{name}", {**maybe, **checks}[name](one)) for name, one in value.items())

    return check_all


def within(optional: Mapping[str, Check] | None = None, /, **checks: Check) -> Check:
    """Mapping with these keys, perhaps the optional ones, and any others."""
    exact, known = group(optional, **checks), {*(optional or {}), *checks}

    def check_known(value: Any) -> Wrong | None:
        return exact({k: v for k, v in value.items() if k in known} if isinstance(value, Mapping) else value)

    return check_known


def table(check: Check, most: int = 1000) -> Check:
    """Mapping of any names to such values."""

    def check_all(value: Any) -> Wrong | None:
        if not isinstance(value, Mapping) or len(value) > most:
            return Wrong(f"a group of up to {most}", "", value)
        return _first((f".{str(name)[:40]}", check(one)) for name, one in value.items())

    return check_all


def parsed(data: bytes | str, most: int = 1 << 28) -> Any:
    """JSON as it is written in files of ours: no NaN, no numbers beyond 64 bits, not deeper than they are.

    Raises
    ------
    ValueError
        It is no JSON, or none of this kind.
    """
    if len(data) > most:
        raise ValueError(f"more than {most} bytes")
    try:
        value = json.loads(data, parse_constant=_refuse_constant, parse_int=_as_int, parse_float=_as_float)
    except RecursionError:
        raise ValueError(f"deeper than {DEEPEST}") from None
    _refuse_deep(value)
    return value


def _refuse_deep(value: Any) -> None:
    level = [value]
    for _ in range(DEEPEST):
        level = [inner for outer in level if isinstance(outer, dict | list) for inner in _inside(outer)]
        if not level:
            return
    raise ValueError(f"deeper than {DEEPEST}")


def toml_of(text: str) -> dict[str, Any]:
    """TOML as it is written in files for us: not deeper than they are.

    Raises
    ------
    ValueError
        It is no TOML, or none of this kind.

    Examples
    --------
    >>> toml_of("gain = 1.5")
    {'gain': 1.5}
    """
    try:
        found = tomllib.loads(text)
    except RecursionError:
        raise ValueError(f"deeper than {DEEPEST}") from None
    _refuse_deep(found)
    return found


def _inside(outer: dict[str, Any] | list[Any]) -> Any:
    return outer.values() if isinstance(outer, dict) else outer


def _refuse_constant(name: str) -> float:
    raise ValueError(f"{name} is no JSON")


def _as_int(digits: str) -> int:
    if len(digits) > 20:
        raise ValueError(f"a whole number of {len(digits)} digits")
    return int(digits)


def _as_float(digits: str) -> float:
    value = float(digits)
    if not math.isfinite(value):
        raise ValueError("a number beyond 64 bits")
    return value


def _first(found: Iterable[tuple[str, Wrong | None]]) -> Wrong | None:
    """The first that is wrong, with the way to it."""
    for place, wrong in found:
        if wrong is not None:
            return wrong._replace(place=place + wrong.place)
    return None


def _range(low: float, high: float) -> str:
    ends = [f" from {low} on" if low > -LARGEST else "", f" up to {high}" if high < LARGEST else ""]
    return "".join(ends)
