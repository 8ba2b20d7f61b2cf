"""Anything that holds a record -> LoopRecord: the one door of all functions that take records."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import Any, Literal, Protocol, TypeAlias

from lostmotion import _verbs
from lostmotion.errors import InputError, ParameterError
from lostmotion.records.prepared import Prepared
from lostmotion.records.record import LoopRecord


class Frame(Protocol):
    """A pandas, Polars or PyArrow table."""

    @property
    def columns(self) -> Any:
        """Columns, or their names."""


RecordLike: TypeAlias = LoopRecord | str | PathLike[str] | Frame | Mapping[str, Any]
Column: TypeAlias = str | Literal[False] | None


def is_source(value: Any) -> bool:
    """Whether a value is to be read: a path, a data frame or a mapping of columns.

    Examples
    --------
    >>> is_source("FIC-101.csv"), is_source({"OP": [1.0, 2.0]}), is_source([1.0, 2.0])
    (True, True, False)
    """
    return isinstance(value, str | PathLike | Mapping) or hasattr(type(value), "columns")


def as_record(source: Any, **columns: Any) -> LoopRecord:
    """Return a record as it is; read a path, a data frame or a mapping of columns.

    Parameters
    ----------
    source : LoopRecord, path, data frame, mapping of columns, or a list of one of these
        Mapping such as ``{"OP": .., "PV": ..}``, then with `dt` or a column of times. A list of files of one tag each
        is one record.
    **columns
        Settings of :func:`lostmotion.read_loop` (op, pv, sp, time, dt ..); those that are None are left out.

    Raises
    ------
    LostMotionError
        As in read_loop; several records, or columns beside a LoopRecord.

    Examples
    --------
    >>> as_record({"U": [1, 2, 3], "Y": [3, 2, 1]}, op="U", pv="Y", dt=1.0)
    LoopRecord('': 3 samples of OP, PV every 1 s, 3 s)
    """
    found = as_records(source, **columns)
    if isinstance(found, list | tuple) and len(found) == 1:
        found = found[0]
    if isinstance(found, LoopRecord):
        return found
    if isinstance(found, list | tuple) and found and all(isinstance(one, LoopRecord) for one in found):
        raise InputError.expected("one record", f"{len(found)} records", "give them one by one")
    got = type(found).__name__
    remedy = "arrays are lm.LoopRecord(op=.., pv=.., dt=..), what prepare() made is its .record"
    raise InputError.expected("a record: a LoopRecord, path, data frame or dict of columns", got, remedy)


def as_records(source: Any, **columns: Any) -> Any:
    """Return the same for one source or a list of them; anything else, such as an array, as it is.

    Examples
    --------
    >>> as_records([1.0, 2.0])
    [1.0, 2.0]
    """
    named = {name: value for name, value in columns.items() if value is not None}
    if is_source(source):
        return _verbs.read(source, **named)
    several = isinstance(source, list | tuple) and len(source) > 0
    if several and all(is_source(one) for one in source):
        return _verbs.read(source, **named)
    if several and all(isinstance(one, LoopRecord | Prepared) or is_source(one) for one in source):
        return [_verbs.read(one, **named) if is_source(one) else _as_is(one, named) for one in source]
    return _as_is(source, named)


def _as_is(value: Any, named: Mapping[str, Any]) -> Any:
    """What is not read, and so has no columns to name; a sampling time may be repeated."""
    columns = {name for name in named if name != "dt"}
    if columns:
        given = ", ".join(sorted(columns))
        expected = f"a path, a data frame or a dict beside {given}"
        raise ParameterError.expected(expected, type(value).__name__, f"leave {given} out, or use lm.read_loop()")
    dt = named.get("dt")
    if isinstance(value, LoopRecord) and dt is not None and abs(dt - value.dt) > 1e-9 * value.dt:
        raise ParameterError.expected(f"dt={value.dt} as in the record", dt, "leave dt out")
    return value
