"""Rows <-> values of columns: one mapping for every kind of row and every database. Knows no SQL."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from datetime import UTC, datetime
from enum import StrEnum
from types import UnionType
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

from lostmotion.errors import DataError

Row = TypeVar("Row")
Kind = Literal["text", "float", "int", "bool", "moment", "bytes", "json"]
NAMES = {
    "where": "place",
    "loop_type": "type",
    "number": "id",
}  # where the name of a column is another (or a word of SQL)


@dataclass(frozen=True)
class Coded:
    """How a field of a row is kept.

    Attributes
    ----------
    name, column : str
        Of the field, and of its column.
    kind : str
    optional : bool
        Whether it may be None.
    of : type, optional
        The enumeration of a text.
    """

    name: str
    column: str
    kind: Kind
    optional: bool
    of: type[StrEnum] | None = None


def coded(row: type[Any]) -> tuple[Coded, ...]:
    """Fields of a kind of row, in their order."""
    if row not in _KNOWN:
        hints = get_type_hints(row)
        _KNOWN[row] = tuple(_coded(one.name, hints[one.name]) for one in fields(row))
    return _KNOWN[row]


def _coded(name: str, hint: Any) -> Coded:
    parts = get_args(hint) if isinstance(hint, UnionType) else (hint,)
    kinds = [part for part in parts if part is not type(None)]
    column = NAMES.get(name, name)
    if len(kinds) != 1:
        raise TypeError(f"expected one type of {name}, got {hint}")
    optional = len(parts) > 1
    enum = kinds[0] if isinstance(kinds[0], type) and issubclass(kinds[0], StrEnum) else None
    return Coded(name, column, "text" if enum else _KINDS[get_origin(kinds[0]) or kinds[0]], optional, enum)


_KINDS: dict[Any, Kind] = {
    str: "text", float: "float", int: "int", bool: "bool", datetime: "moment", bytes: "bytes", tuple: "json",
    Mapping: "json",
}  # fmt: skip


_KNOWN: dict[type[Any], tuple[Coded, ...]] = {}


def encoded(row: Any, *apart: str) -> dict[str, Any]:
    """Values by column.

    Parameters
    ----------
    row : a row of the store
    *apart : str
        Fields that are left out.

    Raises
    ------
    DataError
        A value that no database can keep: a number that is none where one is needed, a time without a zone.
    """
    return {one.column: _into(one, getattr(row, one.name)) for one in coded(type(row)) if one.name not in apart}


def decoded(row: type[Row], values: Mapping[Any, Any], **given: Any) -> Row:
    """Row from values by column; `given` are fields that stand elsewhere.

    Raises
    ------
    ValueError
        A value of another type: SQLite keeps any, and a damaged file holds any.
    """
    read = dict(given)
    if row not in _DECODERS:
        _DECODERS[row] = tuple(
            (one.name, one.column, one.of or _OUT.get(one.kind), (*_TYPES[one.kind], *[type(None)][: one.optional]))
            for one in coded(row)
        )
    for name, column, convert, types in _DECODERS[row]:
        if name not in given:
            value = values[column]
            if not isinstance(value, types):
                raise ValueError(f"{type(value).__name__} as {column}")
            read[name] = value if value is None or convert is None else convert(value)
    return row(**read)


# name, column, conversion and types of each field; None: the driver has what is wanted
_DECODERS: dict[type[Any], tuple[tuple[str, str, Callable[[Any], Any] | None, tuple[type, ...]], ...]] = {}
_TYPES: dict[Kind, tuple[type, ...]] = {
    "text": (str,), "float": (float, int), "int": (int,), "bool": (int,), "moment": (datetime,), "bytes": (bytes,),
    "json": (str,),
}  # fmt: skip


def _into(one: Coded, value: Any) -> Any:
    if value is None and one.optional:
        return None
    try:
        stored = _INTO[one.kind](value)
    except (TypeError, ValueError, OverflowError):
        stored = None
    if stored is None and not one.optional:
        raise DataError.expected(f"a {one.kind} as {one.name}", repr(value)[:80], "a row of the store needs it")
    return stored


def clean(text: str) -> str:
    """Text that every database keeps: PostgreSQL takes no NUL, none takes half of a surrogate pair.

    Examples
    --------
    >>> clean("FIC-1"), clean("a" + chr(0) + "b")
    ('FIC-1', 'a\ufffdb')
    """
    if text.isascii() and "\0" not in text:
        return text
    return text.replace("\0", "\ufffd").encode("utf-8", "replace").decode("utf-8")


def _number(value: Any) -> float | None:
    """SQLite keeps NaN as NULL and -0.0 as 0, PostgreSQL both as they are: neither is kept."""
    number = float(value) + 0.0
    return None if math.isnan(number) else number


def utc(value: datetime) -> datetime:
    """Moment in UTC; one without a zone is refused, because nobody knows when it was.

    Raises
    ------
    DataError
    """
    if value.tzinfo is None or value.utcoffset() is None:
        raise DataError.expected("a time with its zone", value.isoformat(), "give it in UTC")
    return value.astimezone(UTC)


def as_json(value: Any) -> str:
    """Text of it, always the same; numbers that are none become null."""
    return json.dumps(_plain(value), ensure_ascii=False, sort_keys=True, separators=(",", ":"), allow_nan=False)


def _plain(value: Any) -> Any:
    if value is None or isinstance(value, bool | int):
        return value
    if isinstance(value, str):
        return clean(value)
    if isinstance(value, Mapping):
        return {clean(str(key)): _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    number = float(value) + 0.0
    return number if math.isfinite(number) else None


def _read_json(text: str) -> Any:
    return () if text == "[]" else _tupled(json.loads(text))


def _tupled(value: Any) -> Any:
    kind = type(value)
    if kind is list:
        return tuple([_tupled(one) if type(one) in _NESTED else one for one in value])
    if kind is dict:
        return {key: _tupled(one) if type(one) in _NESTED else one for key, one in value.items()}
    return value


_NESTED = (list, dict)


_INTO: dict[Kind, Callable[[Any], Any]] = {
    "text": lambda value: clean(str(value)), "float": _number, "int": int, "bool": bool, "moment": utc, "bytes": bytes,
    "json": as_json,
}  # fmt: skip
_OUT: dict[Kind, Callable[[Any], Any]] = {"bool": bool, "bytes": bytes, "json": _read_json}
