"""Variables of a MATLAB workspace -> a table for each loop: the vectors of one struct are those of one loop."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from typing import Any

import narwhals.stable.v2 as nw
import numpy as np
import polars as pl

from lostmotion.errors import DataError
from lostmotion.files.columns import SAMPLING_NAMES, key, usual
from lostmotion.files.table import Table

TOP = "file"  # what the vectors outside of all structs are called beside those of structs
NAMING = ("tag", "tagname", "tag name", "name", "loop")  # fields whose text is the name of a loop
Leaves = Iterable[tuple[str, Any]]


def tables_of_structs(leaves: Leaves, source: str) -> dict[str, Table]:
    """Tables by the name of the loop; under "" where there is one.

    Parameters
    ----------
    leaves : iterable of (str, value)
        Dotted path and value of every variable that is no struct.
    source : str
        Name of the file, for messages.

    Raises
    ------
    DataError
        No vectors of one length.

    Examples
    --------
    >>> signals = {"OP": np.arange(3.0), "PV": np.arange(3.0)}
    >>> leaves = [(f"{loop}.{name}", values) for loop in ("FIC1", "FIC2") for name, values in signals.items()]
    >>> list(tables_of_structs(leaves, "a.mat")), list(tables_of_structs(leaves[:2], "a.mat"))
    (['FIC1', 'FIC2'], [''])
    """
    groups: dict[str, dict[str, Any]] = defaultdict(dict)
    for path, value in leaves:
        parent, _, name = path.rpartition(".")
        groups[parent][name] = value
    loops = {parent: group for parent, group in groups.items() if _length(group)}
    if not loops:
        raise DataError.expected(
            "vectors of one length, such as OP and PV", f"none in {source!r}", "save them as numeric columns"
        )
    tables = {parent: _table(group, source) for parent, group in loops.items()}
    telling = {parent: table for parent, table in tables.items() if _tells(table)}
    if len(telling) == 1 and len(tables) > 1:
        parent, table = next(iter(telling.items()))
        others = ", ".join(other or TOP for other in tables if other != parent)
        note = f"OP and PV are in {parent or TOP!r}; {others} was left out."
        return {"": Table(table.frame, source, notes=(note, *table.notes))}
    tables = telling or tables
    if len(tables) == 1:
        return {"": next(iter(tables.values()))}
    return dict(zip(_names({parent: loops[parent] for parent in tables}), tables.values(), strict=True))


def _tells(table: Table) -> bool:
    return all(usual(role, table.names) for role in ("op", "pv"))


def _names(loops: Mapping[str, dict[str, Any]]) -> list[str]:
    """What the structs say that they are called, where all do; else their places."""
    said = [
        next(
            (str(value).strip() for name, value in group.items() if key(name) in NAMING and isinstance(value, str)), ""
        )
        for group in loops.values()
    ]
    return said if all(said) and len(set(said)) == len(said) else [parent or TOP for parent in loops]


def is_column(value: Any) -> bool:
    """Whether a value is a vector of numbers or of words."""
    array = np.asarray(value)
    return array.ndim == 1 and array.size > 1 and (array.dtype.kind in "fiubU" or _all_text(array))


def _all_text(array: np.ndarray[Any, Any]) -> bool:
    return array.dtype == object and all(isinstance(cell, str) for cell in array)


def _length(group: Mapping[str, Any]) -> int:
    """Commonest length of the vectors of a struct; 0 where there are not two of them."""
    lengths = Counter(np.asarray(value).size for value in group.values() if is_column(value))
    size, count = lengths.most_common(1)[0] if lengths else (0, 0)
    return size if count > 1 else 0


def _table(group: Mapping[str, Any], source: str) -> Table:
    rows = _length(group)
    columns, other = {}, []
    for name, value in group.items():
        array = np.asarray(value)
        if is_column(value) and array.size == rows:
            columns[name] = array.tolist() if array.dtype == object else array
        elif array.size == 1 and array.dtype.kind in "fiu" and key(name) in SAMPLING_NAMES:
            columns[name] = np.full(rows, float(array.item()))
        else:
            other.append(name)
    notes = (f"Not vectors of {rows} numbers, and left out: {', '.join(map(repr, other))}.",) if other else ()
    return Table(nw.from_native(pl.DataFrame(columns), eager_only=True), source, notes=notes)
