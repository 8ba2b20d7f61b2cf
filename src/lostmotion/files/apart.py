"""A reader in a process of its own, with limits: bytes in, plain values out, and a reason where it dies."""

from __future__ import annotations

import json
import os
import signal
import struct
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from lostmotion.files.child import MARK, NUMBERS
from lostmotion.files.limits import MOST_GIB, MOST_SECONDS, most_bytes, most_seconds

_ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "POLARS_MAX_THREADS": "1",
}  # threads reserve memory that the limit counts
_CHILD = str(Path(__file__).with_name("child.py"))
_LEAST, _TIMES = 2 << 30, 100  # bytes of memory: the packages alone reserve 1 GiB; and for each byte of the file
_SIZES = {name: int(name[1]) for name in NUMBERS} | {"bool": 1, "bytes": 1}
_START = len(MARK) + 8  # of the text of an answer
_TOO_MUCH = f"more memory than a file of its size may take; {MOST_GIB} allows more"
_NO_PLUGINS = {"HDF5_PLUGIN_PRELOAD": "::"}  # a file names filters; none is loaded for it


class ReaderDiedError(Exception):
    """The process gave no answer; the text says why."""


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
    """Standard output of the script; no text from outside is part of its command."""
    seconds, memory = most_seconds(), min(_LEAST + _TIMES * max(size, len(raw)), most_bytes())
    command = [sys.executable, "-s", "-P", "-B", _CHILD, kind, str(memory), str(int(seconds) + 1)]
    try:
        done = subprocess.run(  # noqa: S603  this Python and a script of ours
            command, input=raw, capture_output=True, check=False, timeout=seconds, env=_environment()
        )
    except subprocess.TimeoutExpired as late:
        raise ReaderDiedError(f"not read within {seconds:g} s; {MOST_SECONDS} allows more") from late
    except (OSError, ValueError) as error:
        raise ReaderDiedError(f"no process for its reader: {error}") from error
    if done.returncode:
        raise ReaderDiedError(_reason(done.returncode))
    return done.stdout


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
            raise ReaderDiedError(_TOO_MUCH if told["error"] == "memory" else str(told["error"]))
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


def _environment() -> dict[str, str]:
    """Packages from where this process has them, but not from the working folder; no other setting of Python."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    paths = os.pathsep.join(path for path in sys.path if path and Path(path).is_absolute())
    return {**kept, **_ONE_THREAD, **_NO_PLUGINS, "PYTHONPATH": paths}


def _reason(code: int) -> str:
    if code > 0:
        return f"its reader ended with {code}"
    try:
        return f"it stops its reader by {signal.Signals(-code).name}"
    except ValueError:
        return f"it stops its reader by signal {-code}"
