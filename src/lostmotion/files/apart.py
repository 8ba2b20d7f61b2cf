"""A reader in a process of its own, with limits: bytes in, plain values out, and a reason where it dies."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from typing import Any

import numpy as np

from lostmotion.files.child import MARK, NUMBERS
from lostmotion.files.limits import most_bytes, most_seconds
from lostmotion.files.reader_process import KEPT, TOO_MUCH, ReaderDiedError

_LEAST, _TIMES = 2 << 30, 100  # bytes of memory: the packages alone reserve 1 GiB; and for each byte of the file
_SIZES = {name: int(name[1]) for name in NUMBERS} | {"bool": 1, "bytes": 1}
_START = len(MARK) + 8  # of the text of an answer


def leaves_apart(kind: str, raw: bytes, size: int = 0) -> list[tuple[str, Any]]:
    """Path and value of all that a file holds, by a reader of :mod:`lostmotion.files.child`.

    Parameters
    ----------
    kind : str
        One of that module. Parquet and Feather are on trial only, without leaves: where they end this way they can be
        read in this process, too.
    raw : bytes
        What that module wants: mostly the content of the file.
    size : int
        Of the files in bytes, where `raw` is not their content.

    Returns
    -------
    list of (str, value)
        Values: vectors of numbers or texts, a text, bytes; None for what is none of these.

    Raises
    ------
    ReaderDiedError
        Killed by a signal, too slow, not started, or it says that the file is damaged.
    """
    return leaves_of(_answer(kind, raw, size))


def _answer(kind: str, raw: bytes, size: int) -> bytes:
    memory = min(_LEAST + _TIMES * max(size, len(raw)), most_bytes())
    return KEPT.answer(kind, raw, memory, most_seconds())


def leaves_of(answer: bytes) -> list[tuple[str, Any]]:
    """Path and value of each leaf of an answer.

    Raises
    ------
    ReaderDiedError
        It is none: a reader gone wrong may say anything; or it is an error.
    """
    if not answer.startswith(MARK) or len(answer) < _START:
        raise ReaderDiedError("no answer of its reader")
    (length,) = struct.unpack_from("<Q", answer, len(MARK))
    try:
        told = json.loads(answer[_START : _START + length])
        if "error" in told:
            raise ReaderDiedError(TOO_MUCH if told["error"] == "memory" else str(told["error"]))
        return list(_values(told["leaves"], answer, _START + length))
    except (TypeError, KeyError, ValueError, RecursionError) as error:
        raise ReaderDiedError("half an answer of its reader") from error


def _values(leaves: list[list[Any]], answer: bytes, place: int) -> Iterator[tuple[str, Any]]:
    for path, kind, detail in leaves:
        if kind in _SIZES:
            if not isinstance(detail, int) or not 0 <= _SIZES[kind] * detail <= len(answer) - place:
                raise ValueError("more than there is")
            stop = place + _SIZES[kind] * detail
            yield str(path), _value(kind, answer[place:stop])
            place = stop
        elif kind == "texts":
            yield str(path), np.array([str(cell) for cell in detail], dtype=object)
        else:
            yield str(path), str(detail) if kind == "text" else None


def _value(kind: str, data: bytes) -> Any:
    if kind == "bytes":
        return data
    return np.frombuffer(data, "u1") != 0 if kind == "bool" else np.frombuffer(data, f"<{kind}")
