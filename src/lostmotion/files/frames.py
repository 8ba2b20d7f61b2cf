"""Any source -> Table: a path to text, Parquet, Feather, MAT or a spreadsheet, packed or not, or a data frame."""

from __future__ import annotations

import gzip
import zlib
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import narwhals.stable.v2 as nw
import polars as pl

from lostmotion.addresses import is_url
from lostmotion.errors import DataError, FileAccessError, InputError, ParameterError
from lostmotion.files.apart import leaves_apart
from lostmotion.files.columns import several_loops
from lostmotion.files.database import SQLITE, read_query
from lostmotion.files.dataset import pieces_of, read_dataset
from lostmotion.files.from_mapping import frame_of
from lostmotion.files.limits import most_bytes, need_few_columns, need_memory, too_large
from lostmotion.files.matlab import MAT, MAT_HDF5, load_mat
from lostmotion.files.packed import GZIP, ZIP, is_workbook, unpacked
from lostmotion.files.paths import is_file, is_other, is_path
from lostmotion.files.table import Table
from lostmotion.files.text import parse_text
from lostmotion.files.undamaged import undamaged
from lostmotion.files.workbook import load_workbook

SEVERAL = "the table of one loop"
_PARQUET = b"PAR1"
_ARROW = b"ARROW1"  # Feather
PEEKED = 1 << 16  # bytes of text that show its columns
FEWEST_LINES, WIDEST = 4, 1 << 26  # header, units and rows; bytes in which they must stand


def load(source: Any) -> Table:
    """The one table of a source.

    Raises
    ------
    ColumnError
        It holds several: the error names them.
    LostMotionError
        As in :func:`tables`.

    Examples
    --------
    >>> load(pl.DataFrame({"OP": [1, 2], "PV": [3, 4]})).names
    ['OP', 'PV']
    """
    found = tables(source)
    if len(found) > 1:
        raise several_loops(list(found), SEVERAL)
    return next(iter(found.values()))


def tables(source: Any, query: str | None = None) -> dict[str, Table]:
    """Open a path or take a data frame: a table under "", or of a file with several one for each loop by its name.

    Parameters
    ----------
    source : path, data frame or Table
        Path to delimited text, Parquet, Feather, a MAT file or a spreadsheet (told by its content; .gz, and .zip of one
        file, are unpacked), an eager frame that narwhals knows, or a mapping of columns.

    Raises
    ------
    FileAccessError
        Absent, a directory or not readable.
    DataError
        Empty, binary, or a damaged Parquet or MAT file.
    InputError
        Neither a path nor a data frame.

    Examples
    --------
    >>> list(tables(pl.DataFrame({"OP": [1, 2], "PV": [3, 4]})))
    ['']
    """
    if isinstance(source, Table):
        return {"": source}
    if is_path(source) and (is_url(source) or is_database(Path(source))):
        return {"": read_query(str(source), query)}
    if query is not None:
        raise ParameterError.expected("a query of a database only", "a file or a frame", "leave it out")
    if is_path(source):
        return _from_path(Path(source))
    if isinstance(source, Mapping):
        return {"": _checked(nw.from_native(frame_of(source), eager_only=True), "dict of columns")}
    try:
        frame: nw.DataFrame[Any] = nw.from_native(source, eager_only=True)
    except TypeError as error:
        raise InputError.expected(
            "a path, an eager data frame (pandas, Polars, PyArrow) or a dict of columns",
            type(source).__name__,
            "collect a lazy frame first; for arrays build LoopRecord(op=..., pv=..., dt=...)",
        ) from error
    except nw.exceptions.NarwhalsError as error:
        raise DataError.expected("a data frame whose columns have names of their own", error, "rename them") from error
    return {"": _checked(_with_index(frame), f"{type(source).__module__.split('.')[0]} frame")}


def is_database(path: Path) -> bool:
    """Whether a path is an SQLite file, by its content."""
    if not is_file(path):
        return False
    try:
        with path.open("rb") as stream:
            return stream.read(len(SQLITE)) == SQLITE
    except (OSError, ValueError):
        return False


def _from_path(path: Path) -> dict[str, Table]:
    pieces = pieces_of(path)
    if pieces:
        return read_dataset(path, pieces)
    return tables_of(read_bytes(path), path.name)


def tables_of(content: bytes, name: str) -> dict[str, Table]:
    """Tables of the content of a file, packed or not, as :func:`tables` gives them; raises as that does."""
    raw, name = unpacked(content, name)
    del content
    if raw.startswith((MAT, MAT_HDF5)):
        return load_mat(raw, name)
    if is_workbook(raw):
        return {"": load_workbook(raw, name)}
    for kind, start, read in (("Parquet", _PARQUET, pl.read_parquet), ("Feather", _ARROW, pl.read_ipc)):
        if raw.startswith(start):
            return {"": _columns(raw, name, kind, read)}
    return {"": parse_text(raw, name)}


def peeked(path: Path, most: int = PEEKED) -> Table:
    """Table of the first rows of a text file, for its columns; of any other file the whole.

    Parameters
    ----------
    path : Path
    most : int
        Bytes that are looked at.

    Raises
    ------
    FileAccessError, DataError
        As in :func:`load`.
    """
    if not is_file(path):
        return load(path)  # says what is wrong
    try:
        with path.open("rb") as stream:
            start, whole = _beginning(stream, most)
    except OSError:
        return load(path)  # says what is wrong
    if start.startswith(GZIP):
        with suppress(OSError, EOFError, zlib.error), gzip.open(path) as stream:
            start, whole = _beginning(stream, most)
    binary = start.startswith((MAT, MAT_HDF5, _PARQUET, _ARROW, GZIP, ZIP)) or b"\0" in start
    if binary or whole:
        return load(path)
    return parse_text(start[: start.rfind(b"\n") + 1] or start, path.name)


def _beginning(stream: Any, most: int) -> tuple[bytes, bool]:
    """First bytes of a file, more where they hold few lines of a wide table; and whether that is all of it."""
    start: bytes = stream.read(most)
    while len(start) == most < WIDEST and b"\0" not in start and len(start.splitlines()) <= FEWEST_LINES:
        start += stream.read(3 * most)
        most *= 4
    return start, len(start) < most


def _columns(raw: bytes, name: str, kind: str, read: Callable[[bytes], pl.DataFrame]) -> Table:
    with undamaged(f"a whole {kind} file", name, "export it again"):
        leaves_apart(kind.lower(), raw)  # some damaged ones end the process
        frame = read(raw)
    need_memory(len(frame), name)
    return _checked(nw.from_native(frame, eager_only=True), name)


def read_bytes(path: Path) -> bytes:
    """Content of a file, or a FileAccessError that says what to do.

    Examples
    --------
    >>> read_bytes(Path("no-such-file.csv"))
    Traceback (most recent call last):
    ...
    lostmotion.errors.FileAccessError: expected a file, got no such file 'no-such-file.csv'; check the path
    """
    if is_other(path):
        raise FileAccessError(f"expected a file, got a pipe or a device {str(path)!r}; save it as a file first")
    try:
        if path.stat().st_size > most_bytes():
            raise too_large(repr(path.name))
        return path.read_bytes()
    except FileNotFoundError as error:
        raise FileAccessError(f"expected a file, got no such file {str(path)!r}; check the path") from error
    except IsADirectoryError as error:
        raise FileAccessError(f"expected a file, got the folder {str(path)!r}; name one file in it") from error
    except (OSError, ValueError) as error:  # a ValueError: a zero in the name
        if isinstance(error, DataError):
            raise
        reason = getattr(error, "strerror", None) or str(error)
        raise FileAccessError(
            f"expected a readable file, got {reason!r} for {str(path)!r}; check its permissions and its path"
        ) from error


def _with_index(frame: nw.DataFrame[Any]) -> nw.DataFrame[Any]:
    """Make a time column of a pandas index of dates or durations."""
    index = nw.maybe_get_index(frame)
    if index is None or getattr(index.dtype, "kind", "") not in ("M", "m"):
        return frame
    name = index.name if isinstance(index.name, str) else "time"
    if name in frame.columns:
        return frame
    reset: Any = nw.to_native(frame).reset_index(names=name)
    return nw.from_native(reset, eager_only=True)


def _checked(frame: nw.DataFrame[Any], source: str) -> Table:
    need_few_columns(len(frame.columns))
    if not all(isinstance(name, str) for name in frame.columns):
        raise DataError.expected("column names as text", f"{list(frame.columns)} in the {source}", "rename the columns")
    if frame.is_empty():
        raise DataError.expected("rows", f"none in the {source}", "check that the right data were handed in")
    return Table(frame, source)
