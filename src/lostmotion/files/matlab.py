"""MATLAB files -> Table: the vectors of one struct, or of the file, become columns."""

from __future__ import annotations

import io
from collections import Counter, defaultdict
from collections.abc import Iterator
from typing import Any

import narwhals.stable.v2 as nw
import numpy as np
import polars as pl

from lostmotion.errors import DataError
from lostmotion.files.columns import SAMPLING_NAMES, key
from lostmotion.files.table import Table

MAT = b"MATLAB 5.0 MAT-file"  # written by save -v6 and -v7
MAT_HDF5 = b"MATLAB 7.3 MAT-file"
_SHOWN = 4


def load_mat(raw: bytes, source: str) -> Table:
    """Columns of a MAT file.

    Parameters
    ----------
    raw : bytes
        Content of a file of version 5 (``save -v7`` or ``-v6``).
    source : str
        Name of the file, for messages.

    Raises
    ------
    DataError
        A file of version 7.3, a damaged one, or one without vectors or with those of several loops.
    """
    if raw.startswith(MAT_HDF5):
        raise DataError.expected(
            "a MAT file of version 7", f"one of version 7.3, {source!r}", "save it with save(.., '-v7')"
        )
    from scipy.io import loadmat  # noqa: PLC0415  a quarter of a second that text files need not wait for

    try:
        content = loadmat(io.BytesIO(raw), squeeze_me=True)  # type: ignore[arg-type]
    except Exception as error:  # scipy raises whatever the damaged bytes lead to
        reason = f"{type(error).__name__}: {error}"
        raise DataError.expected(
            "a whole MAT file", f"a damaged one, {source!r} ({reason})", "save it again"
        ) from error
    groups: dict[str, dict[str, Any]] = defaultdict(dict)
    for path, value in _leaves({name: value for name, value in content.items() if not name.startswith("__")}):
        parent, _, name = path.rpartition(".")
        groups[parent][name] = value
    loops = {parent: group for parent, group in groups.items() if _length(group)}
    if len(loops) != 1:
        raise _no_loop(loops, source)
    return _table(next(iter(loops.values())), source)


def _leaves(variables: dict[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted path and value of every variable that is no struct."""
    for name, value in variables.items():
        array = np.asarray(value)
        if array.dtype.names and array.ndim == 0:
            yield from _leaves({field: array[field].item() for field in array.dtype.names}, f"{above}{name}.")
        elif array.dtype.names:
            for place, one in enumerate(array.ravel()):
                inside = {field: one[field] for field in array.dtype.names}
                yield from _leaves(inside, f"{above}{name}({place + 1}).")
        else:
            yield f"{above}{name}", value


def _is_column(value: Any) -> bool:
    array = np.asarray(value)
    return array.ndim == 1 and array.size > 1 and (array.dtype.kind in "fiubU" or _all_text(array))


def _all_text(array: np.ndarray[Any, Any]) -> bool:
    return array.dtype == object and all(isinstance(cell, str) for cell in array)


def _length(group: dict[str, Any]) -> int:
    """Commonest length of the vectors of a struct; 0 where there are not two of them."""
    lengths = Counter(np.asarray(value).size for value in group.values() if _is_column(value))
    size, count = lengths.most_common(1)[0] if lengths else (0, 0)
    return size if count > 1 else 0


def _table(group: dict[str, Any], source: str) -> Table:
    rows = _length(group)
    columns, other = {}, []
    for name, value in group.items():
        array = np.asarray(value)
        if _is_column(value) and array.size == rows:
            columns[name] = array.tolist() if array.dtype == object else array
        elif array.size == 1 and array.dtype.kind in "fiu" and key(name) in SAMPLING_NAMES:
            columns[name] = np.full(rows, float(array.item()))
        else:
            other.append(name)
    notes = (f"Not vectors of {rows} numbers, and left out: {', '.join(map(repr, other))}.",) if other else ()
    return Table(nw.from_native(pl.DataFrame(columns), eager_only=True), source, notes=notes)


def _no_loop(loops: dict[str, dict[str, Any]], source: str) -> DataError:
    if not loops:
        return DataError.expected(
            "vectors of one length, such as OP and PV", f"none in {source!r}", "save them as numeric columns"
        )
    names = sorted(parent or "the file itself" for parent in loops)
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return DataError.expected(
        f"the vectors of one loop in {source!r}",
        f"{len(names)} structs with vectors: {', '.join(names[:_SHOWN])}{more}",
        "save the fields of one struct to a file of its own: save(.., '-struct', ..)",
    )
