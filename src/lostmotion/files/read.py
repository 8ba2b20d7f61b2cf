"""read_loop: any table of a control loop -> LoopRecord, with nothing guessed in silence."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Literal

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError, ParameterError
from lostmotion.files.clock import find_clock
from lostmotion.files.columns import SAMPLING_NAMES, Columns, Wanted, key, resolve, time_unit
from lostmotion.files.dates import AmbiguousDatesError, looks_numeric
from lostmotion.files.frames import load
from lostmotion.files.moments import with_moments
from lostmotion.files.number_cells import decimal_mark, to_numbers
from lostmotion.files.table import Table
from lostmotion.files.times import Stamps, read_times
from lostmotion.records.record import LoopRecord, StringArray

Span = tuple[float, float]
_SHOWN = 5


def read_loop(
    source: Any,
    op: str = "OP",
    pv: str = "PV",
    sp: Wanted = "SP",
    position: Wanted = None,
    time: Wanted = None,
    dt: float | None = None,
    tag: str | None = None,
    op_span: Span | None = None,
    pv_span: Span | None = None,
    missing: Literal["keep", "error"] = "keep",
    mode: Wanted = None,
) -> LoopRecord:
    """Read the record of one control loop.

    Parameters
    ----------
    source : path or data frame
        CSV or text (``,`` ``;`` tab or blanks, decimal point or comma), Parquet, a MAT file (one struct of vectors,
        or vectors; ``save -v7``), or a pandas, Polars or PyArrow frame.
    op, pv : str
        Columns of controller output and measurement, exact or without regard to case. The defaults also
        accept the usual other names (CO, MV, OUT.. and y, measurement..).
    sp, position : str, None or False
        Columns of set point and actuator position. The defaults take them if they are there. ``sp=None`` or
        False: do not read.
    time : str, None or False
        Time column: seconds, the unit in its name (t_ms), seconds or milliseconds since 1970, or dates.
        None: by its usual names; a column of dates and one of times of day are taken together. False: ignore it;
        `dt` is then needed.
    dt : float, optional
        Sampling time in seconds. None: from the time column. Where both are there they must agree, except
        that `dt` wins over a column that counts samples.
    tag : str, optional
        Name of the loop; the name of the file without suffix if None.
    op_span, pv_span : (float, float), optional
        Engineering limits (low, high).
    missing : "keep" or "error"
        Keep empty cells and bad values (Bad, No Data, I/O Timeout..) as NaN, or refuse them.
    mode : str, None or False
        Column with the mode of the controller (AUTO, MAN, CAS..), taken as text. None: if there is one of its
        usual names.

    Returns
    -------
    LoopRecord
        Its ``notes`` say what was assumed, its ``gaps`` where rows are missing.

    Raises
    ------
    FileAccessError
        No such file, a folder, or not readable.
    ColumnError
        A column is missing, not unique or not numeric.
    TimeError
        Sampling time unknown, contradictory or not constant.
    DataError
        Empty or binary file, rows of the wrong length, or missing values with ``missing="error"``.
    ParameterError
        `dt`, a span or `missing` is outside its domain.

    Examples
    --------
    >>> import polars as pl
    >>> frame = pl.DataFrame({"t_s": [0.0, 0.5, 1.0], "CO": [50, 51, 52], "PV": [1.0, None, 1.2]})
    >>> record = read_loop(frame, tag="FIC-101")
    >>> record
    LoopRecord('FIC-101': 3 samples of OP, PV every 0.5 s, 1.5 s)
    >>> record.notes
    ("OP was read from column 'CO'.",)
    """
    _check_settings(dt, missing)
    table = with_moments(load(source)) if time is None else load(source)
    if len(table.frame) < 2:
        raise DataError.expected("at least 2 rows", f"1 in {table.source!r}", "check the export")
    sampling = sampling_column(table, (op, pv, sp, position, time, mode))
    names = [name for name in table.names if name != sampling]
    columns = resolve(names, op, pv, sp, position, time, mode)
    decimal = _decimal(table, columns, sampling)
    signals, notes = _signals(table, columns, decimal)
    stamps, doubt = _stamps(table, columns.time, decimal, dt)
    ts = None if sampling is None else sampling_time(table, sampling, decimal)
    clock = find_clock(stamps, dt, ts)
    if missing == "error":
        _refuse_missing(table, signals, stamps)
    comma = ("Numbers were read with a decimal comma.",) if decimal == "," else ()
    return LoopRecord(
        op=signals["op"],
        pv=signals["pv"],
        sp=signals.get("sp"),
        position=signals.get("position"),
        dt=clock.dt,
        mode=None if columns.mode is None else _words(table, columns.mode),
        op_span=op_span,
        pv_span=pv_span,
        tag=_tag(source) if tag is None else tag,
        source=table.source,
        gaps=clock.gaps,
        notes=(*table.notes, *columns.notes, *comma, *notes, *doubt, *clock.notes),
    )


def _check_settings(dt: float | None, missing: str) -> None:
    if dt is not None and not (np.isfinite(dt) and dt > 0):
        raise ParameterError.expected("dt > 0", dt, "give the sampling time in seconds")
    if missing not in ("keep", "error"):
        raise ParameterError.expected("missing='keep' or 'error'", repr(missing), "choose one of them")


def sampling_column(table: Table, wanted: tuple[Wanted, ...]) -> str | None:
    """Column such as `ts` that repeats one number: the sampling time. Asked for by name, it is a column."""
    asked = {name.strip().lower() for name in wanted if isinstance(name, str)}
    for name in table.names:
        if key(name) not in SAMPLING_NAMES or name.strip().lower() in asked:
            continue
        series = table.column(name)
        cells = {str(value).strip() for value in series.drop_nulls().unique().to_list()} - {"", "nan"}
        if len(cells) == 1 and looks_numeric(next(iter(cells))):
            return name
    return None


def sampling_time(table: Table, name: str, decimal: str) -> float | None:
    """Seconds that :func:`sampling_column` repeats; None where they are no sampling time."""
    values, _ = to_numbers(table, name, decimal)
    value = float(values[~np.isnan(values)][0]) * (time_unit(name) or 1.0)
    return value if value > 0 else None


def _decimal(table: Table, columns: Columns, sampling: str | None) -> str:
    used = (columns.op, columns.pv, columns.sp, columns.position, columns.time, sampling)
    return decimal_mark(table, [name for name in used if name is not None])


def _signals(table: Table, columns: Columns, decimal: str) -> tuple[dict[str, FloatArray], tuple[str, ...]]:
    signals: dict[str, FloatArray] = {}
    notes: tuple[str, ...] = ()
    for role in ("op", "pv", "sp", "position"):
        name = getattr(columns, role)
        if name is not None:
            signals[role], words = to_numbers(table, name, decimal)
            notes += words
    return signals, notes


def _words(table: Table, name: str) -> StringArray:
    """Cells of a column as text; empty where missing."""
    cells = table.column(name).to_list()
    return np.array(["" if cell is None else str(cell).strip() for cell in cells], dtype=np.str_)


def _stamps(table: Table, name: str | None, decimal: str, dt: float | None) -> tuple[Stamps | None, tuple[str, ...]]:
    """Read the time column; with dt given, one whose dates have two readings is left out."""
    if name is None:
        return None, ()
    try:
        return read_times(table, name, decimal), ()
    except AmbiguousDatesError:
        if dt is None:
            raise
        return None, (f"Day and month in {name!r} cannot be told apart; dt = {dt:g} s was not checked.",)


def _refuse_missing(table: Table, signals: dict[str, FloatArray], stamps: Stamps | None) -> None:
    for role, values in signals.items():
        rows = np.flatnonzero(np.isnan(values))
        if len(rows):
            where = table.where if stamps is None else stamps.at
            shown = ", ".join(where(int(row)) for row in rows[:_SHOWN])
            more = f" and {len(rows) - _SHOWN} more" if len(rows) > _SHOWN else ""
            raise DataError.expected(
                f"a value of {role.upper()} in every row",
                f"{len(rows)} missing: {shown}{more}",
                "repair the export, or read with missing='keep'",
            )


def _tag(source: Any) -> str:
    return Path(source).stem if isinstance(source, str | os.PathLike) else ""
