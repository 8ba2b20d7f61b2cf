"""MAT files of version 5: dotted path and value of each variable, in Python alone, which no changed byte can crash."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np

from lostmotion.files.limits import most_bytes, too_large
from lostmotion.files.table import unique_names

HEADER = 128  # bytes
DEEPEST = 40  # structs in structs
_SMALL = 4  # bytes that stand in the tag itself
_MATRIX, _COMPRESSED = 14, 15
_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_TEXTS = {1: "latin-1", 2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
_CELL, _STRUCT, _OBJECT, _CHAR, _FIRST_NUMERIC, _LAST_NUMERIC, _OPAQUE = 1, 2, 3, 4, 6, 15, 17  # classes
_COMPLEX = 0x0800
Leaf = tuple[str, Any]


class _NoSignal:
    """Value of a variable that is none of what a table holds: sparse, complex, a function, an object."""


@dataclass(frozen=True, eq=False)
class _Structs:
    """Fields of each struct of an array, and whether it is a single one."""

    each: list[dict[str, Any]]
    single: bool


def leaves_of_version_5(raw: bytes) -> list[Leaf]:
    """Dotted path and value of every variable that is no struct.

    Parameters
    ----------
    raw : bytes
        Content of the file (``save -v7`` or ``-v6``), of either byte order.

    Raises
    ------
    ValueError
        Damaged.

    Notes
    -----
    "MAT-File Format", The MathWorks. As ``scipy.io.loadmat(.., squeeze_me=True)`` reads it, which is compiled and can
    be crashed: a test compares both. Numbers keep the type that they are stored in. What is no signal is an object.
    """
    order = {b"IM": "<", b"MI": ">"}.get(raw[126:HEADER])
    if order is None:
        raise ValueError("no byte order in its header")
    room, found = most_bytes(), {}
    for kind, data in _elements(memoryview(raw)[HEADER:], order):
        plain, matrix = kind, data
        if kind == _COMPRESSED:
            unpacked = _unpacked(data, room)
            room -= len(unpacked)
            plain, matrix = next(_elements(unpacked, order), (0, data))
        if plain == _MATRIX:
            name, value = _Reader(order).variable(matrix)
            if name:  # without one: what MATLAB keeps of objects
                found[name] = value
    return list(_leaves(found))


def _unpacked(data: memoryview, room: int) -> memoryview:
    unpacker = zlib.decompressobj()
    try:
        whole = unpacker.decompress(data, max(room, 1))
    except zlib.error as error:
        raise ValueError(str(error)) from error
    if unpacker.unconsumed_tail:
        raise too_large("the MAT file")
    if not unpacker.eof or unpacker.unused_data:
        raise ValueError("packed bytes that end too early or too late")
    return memoryview(whole)


def _elements(data: memoryview, order: str) -> Iterator[tuple[int, memoryview]]:
    """Type and bytes of each data element."""
    place = 0
    while place + 8 <= len(data):
        kind, size = struct.unpack_from(order + "II", data, place)
        if kind >> 16:
            kind, size, start = kind & 0xFFFF, kind >> 16, place + 4
            place += 8
            if size > _SMALL:
                raise ValueError(f"{size} bytes in a tag of {_SMALL}")
        else:
            start = place + 8
            place = start + size + (-size % 8 if kind != _COMPRESSED else 0)
            if start + size > len(data):
                raise ValueError("it ends within a variable")
        yield kind, data[start : start + size]


class _Reader:
    """Variables of one byte order."""

    def __init__(self, order: str) -> None:
        self._order = order

    def variable(self, data: memoryview, depth: int = 0) -> tuple[str, Any]:
        """Name and value of a matrix."""
        if depth > DEEPEST:
            raise ValueError(f"structs deeper than {DEEPEST}")
        if not len(data):
            return "", np.zeros(0)
        parts = _elements(data, self._order)
        flags = self._numbers(*_next(parts))
        if not len(flags):
            raise ValueError("a variable without its class")
        kind, complex_ = int(flags[0]) & 0xFF, bool(int(flags[0]) & _COMPLEX)
        if kind == _OPAQUE:
            return _text(*_next(parts), self._order), _NoSignal()
        shape = [int(size) for size in self._numbers(*_next(parts))]
        if min(shape, default=-1) < 0:
            raise ValueError("a variable without its size")
        name = _text(*_next(parts), self._order)
        if kind == _CHAR:
            return name, self._chars(parts, shape)
        if kind == _CELL:
            return name, self._cells(parts, shape, depth)
        if kind in (_STRUCT, _OBJECT):
            return name, self._structs(parts, shape, depth, kind == _OBJECT)
        if not _FIRST_NUMERIC <= kind <= _LAST_NUMERIC or complex_:
            return name, _NoSignal()
        return name, _squeezed(self._numbers(*_next(parts)), shape)

    def _numbers(self, kind: int, data: memoryview) -> np.ndarray[Any, Any]:
        if kind not in _NUMBERS:
            raise ValueError(f"numbers of type {kind}")
        name = _NUMBERS[kind]
        if len(data) % int(name[1]):
            raise ValueError("half a number")
        return np.frombuffer(data, self._order + name).astype(name)

    def _chars(self, parts: Iterator[tuple[int, memoryview]], shape: list[int]) -> Any:
        """Text of a row; of several rows an array of texts."""
        text = _text(*_next(parts), self._order) if prod(shape) else ""
        rows = shape[0] if len(shape) == 2 else 1
        if rows <= 1 or not prod(shape):  # rows of nothing may be as many as a number can say
            return text
        if len(text) != prod(shape):
            raise ValueError("a text of another size")
        return np.array([text[row::rows].rstrip() for row in range(rows)], dtype=object)

    def _cells(self, parts: Iterator[tuple[int, memoryview]], shape: list[int], depth: int) -> Any:
        inside = [self._inside(parts, depth) for _ in range(prod(shape))]  # ends where the bytes do
        cells = np.empty(len(inside), dtype=object)
        for place, value in enumerate(inside):
            cells[place] = value
        return _squeezed(cells, shape)

    def _structs(self, parts: Iterator[tuple[int, memoryview]], shape: list[int], depth: int, is_object: bool) -> Any:
        if is_object:
            _next(parts)  # name of its class
        widths = self._numbers(*_next(parts))
        names = bytes(_next(parts)[1])
        width = int(widths[0]) if len(widths) else 0
        if width < 1 or len(names) % width:
            raise ValueError("a struct without names of its fields")
        fields = [names[at : at + width].split(b"\0")[0].decode("latin-1") for at in range(0, len(names), width)]
        if not fields:
            return _NoSignal()
        fields = unique_names(fields)
        each = [{field: self._inside(parts, depth) for field in fields} for _ in range(prod(shape))]
        order = np.arange(len(each)).reshape(shape, order="F").ravel()
        return _Structs([each[place] for place in order], len(each) == 1)

    def _inside(self, parts: Iterator[tuple[int, memoryview]], depth: int) -> Any:
        kind, data = _next(parts)
        if kind != _MATRIX:
            raise ValueError("a cell that is no variable")
        return self.variable(data, depth + 1)[1]


def _next(parts: Iterator[tuple[int, memoryview]]) -> tuple[int, memoryview]:
    found = next(parts, None)
    if found is None:
        raise ValueError("it ends within a variable")
    return found


def _text(kind: int, data: memoryview, order: str) -> str:
    if kind not in _TEXTS:
        raise ValueError(f"a text of type {kind}")
    encoding = _TEXTS[kind]
    if encoding in ("utf-16", "utf-32"):
        encoding += "-le" if order == "<" else "-be"
    return bytes(data).decode(encoding, "replace").rstrip("\0")


def _squeezed(values: np.ndarray[Any, Any], shape: list[int]) -> Any:
    if values.size != prod(shape):
        raise ValueError(f"{values.size} values of {prod(shape)}")
    squeezed = np.squeeze(values.reshape(shape, order="F"))
    if not squeezed.size:
        return squeezed.reshape(-1)
    return squeezed.item() if squeezed.dtype == object and not squeezed.shape else squeezed


def _leaves(variables: dict[str, Any], above: str = "") -> Iterator[Leaf]:
    for name, value in variables.items():
        if not isinstance(value, _Structs):
            yield f"{above}{name}", value
            continue
        for place, inside in enumerate(value.each):
            yield from _leaves(inside, f"{above}{name}." if value.single else f"{above}{name}({place + 1}).")
