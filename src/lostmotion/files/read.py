"""read_loop: any table of a control loop -> LoopRecord, with nothing guessed in silence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal, TypedDict, Unpack

import numpy as np
import polars as pl

from lostmotion.errors import DataError, ParameterError
from lostmotion.files.columns import Wanted
from lostmotion.files.interpret import Meaning, check_dt, interpret
from lostmotion.files.number_cells import native, text_cells
from lostmotion.files.opened import opened
from lostmotion.files.quality import Trust
from lostmotion.files.table import Table
from lostmotion.files.tags import loop_type
from lostmotion.files.units import unit_of
from lostmotion.records.absent_rows import with_absent_rows
from lostmotion.records.modes import holds
from lostmotion.records.record import LoopRecord, StringArray

Span = tuple[float, float]
_SHOWN = 5


class Plant(TypedDict, total=False):
    """What the plant calls things, beside its columns."""

    loop: str | None
    query: str | None
    uncertain: Literal["keep", "bad"]
    quality: Literal[False] | None
    automatic: str | Sequence[str] | None
    manual: str | Sequence[str] | None


USUAL = ("OP", "PV", "SP")  # names of columns that were not asked for


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
    **plant: Unpack[Plant],
) -> LoopRecord:
    """Read the record of one control loop.

    Parameters
    ----------
    source : path, data frame, dict of columns or list of paths
        CSV or text (``,`` ``;`` tab or blanks, decimal point or comma), Parquet, a MAT file (one struct of vectors,
        or vectors; ``save -v7``), Feather, a spreadsheet (``lostmotion[excel]``), all of them also in .gz or in a .zip
        of one file; or a pandas, Polars or PyArrow frame, or ``{"OP": .., "PV": ..}``. A list of files, a folder or a
        pattern (``FIC101_*.csv``): files of one tag each, such as FIC101_OP.csv and FIC101_PV.csv, are joined to one
        record; Parquet in partitions
        (year=2024/month=1/..) or in numbered or dated pieces is one table.
    op, pv : str
        Columns of controller output and measurement, exact or without regard to case. The defaults also
        accept the usual other names (CO, MV, OUT.. and y, measurement..).
    sp, position : str, None or False
        Columns of set point and actuator position. The defaults take them if they are there. ``sp=None`` or
        False: do not read. Where a table holds the command and the position of an actuator but no PV (setpoint and
        position, command and feedback), OP is the command, and PV as well as the position are the position.
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
        Keep empty cells and bad values (Bad, No Data, I/O Timeout..) as NaN, or refuse them. Single rows that are
        absent from a regular clock are kept as NaN too.
    mode : str, None or False
        Column with the mode of the controller (AUTO, MAN, CAS..), taken as text. None: if there is one of its
        usual names.
    **plant
        ``loop="FIC102"``: tag of the loop to read where a file holds several: columns FIC102.PV, FIC102.OUT .. or
        FT_102 and FV_102. ``query="SELECT .."``: of a database, whose address (``sqlite:///plant.db``, or any of
        SQLAlchemy with ``lostmotion[sql]``) is the source. ``automatic="1"``, ``manual="0"``: what the mode column
        holds, a word or several. ``uncertain="bad"``: values of uncertain quality are missing, as bad ones are;
        ``quality=False``: columns of quality are not read.

    Returns
    -------
    LoopRecord
        Its ``notes`` say what was assumed, its ``gaps`` where many rows are absent and ``gap_seconds`` for how long;
        its ``start`` when it began, where the times are dates, and its units are those of the file.

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
    check_dt(dt)
    if missing not in ("keep", "error"):
        raise ParameterError.expected("missing='keep' or 'error'", repr(missing), "choose one of them")
    asked = [name for name in (op, pv, sp, position, mode) if isinstance(name, str)]
    trust = trust_of(plant)
    content = opened(source, asked, plant.get("query"), trust)
    named = [name for name in (*asked, time) if isinstance(name, str) and name not in USUAL]
    table, loop, part = content.table(plant.get("loop"), named)
    meaning = interpret(table, op, pv, sp, position, time, mode, dt, loop=loop, trust=trust)
    if missing == "error":
        _refuse_missing(meaning)
    word = meaning.columns.mode
    by_columns = meaning.columns.loop if content.by_tags or plant.get("loop") else ""
    name = (part or by_columns or content.name) if tag is None else tag
    kind = loop_type(name) or loop_type(meaning.columns.loop)
    record = LoopRecord(
        **meaning.signals,
        dt=meaning.clock.dt,
        mode=None if word is None else _modes(meaning.table, word, plant),
        op_span=op_span,
        pv_span=pv_span,
        tag=name,
        source=meaning.table.source,
        gaps=meaning.clock.gaps,
        notes=meaning.notes,
        loop_type=kind,
        made_up=meaning.made_up,
        start=meaning.start,
        gap_seconds=meaning.gap_seconds,
        op_unit=unit_of(meaning.table, meaning.columns.op),
        pv_unit=unit_of(meaning.table, meaning.columns.pv),
    )
    if meaning.columns.pv_is_position:
        record = replace(record, position=record.pv)
    return record if missing == "error" else with_absent_rows(record)


def trust_of(plant: Mapping[str, Any]) -> Trust:
    """What is believed of the qualities in a source, by the settings `uncertain` and `quality`."""
    uncertain, quality = plant.get("uncertain", "keep"), plant.get("quality")
    if uncertain not in ("keep", "bad"):
        raise ParameterError.expected("uncertain='keep' or 'bad'", repr(uncertain), "choose one of them")
    return Trust(read=quality is not False, uncertain=uncertain == "keep")


def _modes(table: Table, name: str, plant: Plant) -> StringArray:
    """Cells of a column as text, empty where missing, with AUTO and MAN for the words that were said to mean them."""
    cells = native(table.column(name))
    if cells.dtype.is_nested() or cells.dtype == pl.Object:  # no words
        cells = text_cells(table.column(name))
    known = cells.drop_nulls().unique(maintain_order=True)  # few words in many rows
    words = [_meant(str(cell).strip(), plant) for cell in known.to_list()]
    rows = cells.replace_strict(known, range(len(known)), default=len(known), return_dtype=pl.UInt32).to_numpy()
    modes: StringArray = np.array([*words, ""], dtype=np.str_)[rows]
    return modes


def _meant(cell: str, plant: Plant) -> str:
    """AUTO or MAN where a word was said to mean it, else the word."""
    meant = cell
    for word, given in (("AUTO", plant.get("automatic")), ("MAN", plant.get("manual"))):
        listed = [given] if isinstance(given, str) else list(given or ())
        if holds(cell, [str(one).strip().lower() for one in listed]):
            meant = word
    return meant


def _refuse_missing(meaning: Meaning) -> None:
    where = meaning.table.where if meaning.stamps is None else meaning.stamps.at
    for role, values in meaning.signals.items():
        rows = np.flatnonzero(np.isnan(values))
        if len(rows):
            shown = ", ".join(where(int(row)) for row in rows[:_SHOWN])
            more = f" and {len(rows) - _SHOWN} more" if len(rows) > _SHOWN else ""
            raise DataError.expected(
                f"a value of {role.upper()} in every row",
                f"{len(rows)} missing: {shown}{more}",
                "repair the export, or read with missing='keep'",
            )
