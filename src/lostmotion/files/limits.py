"""How large, how long: what a file from outside may take, and how to allow more."""

from __future__ import annotations

import math
import os
import sys
from pathlib import Path

from lostmotion.errors import DataError, ParameterError

MOST_GIB = "LOSTMOTION_MOST_GIB"
MOST_SECONDS = "LOSTMOTION_MOST_SECONDS"
MOST_COLUMNS = "LOSTMOTION_MOST_COLUMNS"
_GIB, _SECONDS = 8.0, 60.0  # more is no record of a loop: 2.6 million rows of 20 columns are 0.4 GiB, read in 15 s
_COLUMNS = 20_000.0  # a plant has some thousand tags
ROW_BYTES = 250  # memory for a row of text with two columns until it is checked: 200 measured, of 4 million
MOST_CELL = 10_000_000  # characters of a cell, or of a header: 20,000 names of 500


def most_bytes() -> int:
    """Size of a file, of what is unpacked from it, and the memory of a reader in a process of its own.

    Raises
    ------
    ParameterError
        The environment says something else than a number.
    """
    return int(_number(MOST_GIB, _GIB) * 2**30)


def most_seconds() -> float:
    """Patience with a reader in a process of its own.

    Raises
    ------
    ParameterError
        As for most_bytes.
    """
    return _number(MOST_SECONDS, _SECONDS)


def need_few_columns(count: int) -> None:
    """Raise the DataError of a table with more columns than one has."""
    most = int(_number(MOST_COLUMNS, _COLUMNS))
    if count > most:
        raise DataError.expected(f"at most {most} columns", count, f"export those of one loop, or set {MOST_COLUMNS}")


def need_memory(rows: int, source: str) -> None:
    """Raise the DataError of a table whose rows take more memory than one file may, or than there is."""
    size, free = rows * ROW_BYTES, _free_bytes()
    if size > min(most_bytes(), free):
        told = f"{rows:,} rows in {source!r}, which take {size / 2**30:.2g} GiB of memory; {free / 2**30:.2g} are free"
        remedy = "read it on a larger computer" if size > free else f"set {MOST_GIB}"
        raise DataError.expected("a record of a loop", told, f"cut the export, or {remedy}")


def _free_bytes() -> float:
    """Memory that this process may still take, where the system tells: of the computer, and of its own limit."""
    if sys.platform == "win32":
        return math.inf
    import resource  # noqa: PLC0415  not on Windows

    try:
        fields = dict(line.split(":", 1) for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines())
        free = float(fields["MemAvailable"].split()[0]) * 1024
        used = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        own = math.inf if limit == resource.RLIM_INFINITY else limit - used * resource.getpagesize()
    except (OSError, LookupError, ValueError):
        return math.inf
    return max(min(free, own), 0.0)


def too_large(what: str) -> DataError:
    """The error of what has more than most_bytes."""
    return DataError.expected(
        "a record of a loop",
        f"more than {_number(MOST_GIB, _GIB):g} GiB in {what}",
        f"cut the export, or set {MOST_GIB}",
    )


def _number(name: str, usual: float) -> float:
    given = os.environ.get(name, "")
    if not given:
        return usual
    try:
        number = float(given)
    except ValueError:
        number = 0.0
    if not 0 < number <= 1e6:
        raise ParameterError.expected(f"{name} > 0", repr(given), "set it to a number, or not at all")
    return number
