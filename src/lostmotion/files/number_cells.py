"""Cells -> floats: decimal mark, bad-value words of historians, and a clear error for anything else."""

from __future__ import annotations

import math
from typing import Any

import narwhals.stable.v2 as nw
import numpy as np
import polars as pl

from lostmotion.arrays import FloatArray
from lostmotion.errors import ColumnError
from lostmotion.files.table import Table
from lostmotion.records.record import LARGEST

# What historians and spreadsheets write in place of a number; compared in lower case.
BAD_WORDS = frozenset({
    "bad", "bad input", "bad data", "bad value", "bad quality", "nan", "-nan", "null", "none", "na",
    "n/a", "nil", "no data", "nodata", "no value", "missing", "i/o timeout", "io timeout", "i/o error",
    "timeout", "comm fail", "communication failure", "not connect", "not connected", "disconnected",
    "shutdown", "intf shut", "scan off", "scan timeout", "pt created", "configure", "calc failed",
    "under range", "over range", "invalid", "invalid data", "invalid float", "unknown", "uncertain",
    "questionable", "error", "#n/a", "#value!", "#div/0!", "#ref!", "#num!", "#name?", "#null!",
    "1.#qnan", "-1.#ind", "1.#ind", "-1.#qnan", "-", "--", "---", "?", "*",
})  # fmt: skip
# No process value is larger; historians fill missing cells with the largest float, 3.4e38.
DECIMAL_COMMA = r"^[+-]?\d*,\d+([eE][+-]?\d+)?$"
DECIMAL_DOT = r"^[+-]?(\d+\.\d*|\.\d+)([eE][+-]?\d+)?$"
_MAYBE_THOUSANDS = r"^[+-]?[1-9]\d{0,2},\d{3}$"
# Between thousands: a comma where the decimal mark is a dot, a dot where it is a comma; blanks and apostrophes.
_GROUPED = {".": r"^[+-]?[1-9]\d{0,2}(?:,\d{3})+(?:\.\d*)?$", ",": r"^[+-]?[1-9]\d{0,2}(?:\.\d{3})+(?:,\d*)?$"}
_BOTH = {".": r"^[+-]?[1-9]\d{0,2}(?:,\d{3})+\.\d*$", ",": r"^[+-]?[1-9]\d{0,2}(?:\.\d{3})+,\d*$"}
_BLANK_GROUPS = r"^[+-]?[1-9]\d{0,2}(?:[ \x{A0}\x{202F}'’]\d{3})+(?:[.,]\d*)?$"


def to_numbers(table: Table, name: str, decimal: str = ".") -> tuple[FloatArray, tuple[str, ...]]:
    """Numbers of one column, missing cells as NaN, and a note where words stood for missing values.

    Parameters
    ----------
    table : Table
        Where the column is.
    name : str
        Its exact name.
    decimal : "." or ","
        Decimal mark of text cells, see :func:`decimal_mark`.

    Raises
    ------
    ColumnError
        A cell is text, a date, infinite or beyond 1e30; the message names row, line and text.

    Examples
    --------
    >>> table = Table(nw.from_native(pl.DataFrame({"PV": ["1,5", "", "Bad"]}), eager_only=True), "a")
    >>> to_numbers(table, "PV", ",")
    (array([1.5, nan, nan]), ("1 cell of 'PV' ('Bad') was read as missing.",))
    """
    series = table.column(name)
    if is_text(series):
        values, notes = _from_text(table, name, decimal)
    elif series.dtype.is_numeric() or series.dtype == nw.Boolean:
        values = np.array(series.cast(nw.Float64).to_numpy(), dtype=np.float64)
        notes = ()
    else:
        raise ColumnError.expected(f"numbers in column {name!r}", f"{series.dtype}", "name another column")
    wild = np.abs(values) > LARGEST
    if wild.any():
        row = int(np.flatnonzero(wild)[0])
        raise ColumnError.expected(
            f"finite numbers below {LARGEST:g} in column {name!r}",
            f"{values[row]} in {table.where(row)}",
            "leave the cell empty where the value is missing",
        )
    return values, notes


def decimal_mark(table: Table, names: list[str]) -> str:
    """Decimal mark of the text cells in the given columns: "." or ",".

    Raises
    ------
    ColumnError
        Both marks occur, or "1,234" may as well be a thousand.

    Examples
    --------
    >>> table = Table(nw.from_native(pl.DataFrame({"PV": ["1,5", "3"]}), eager_only=True), "a", None, ";")
    >>> decimal_mark(table, ["PV"])
    ','
    """
    table.read_ahead(names)
    columns = {name: table.column(name) for name in names if is_text(table.column(name))}
    if not any(_has_comma(series) for series in columns.values()):
        return "."
    comma = dot = None
    proven = False
    texts = {name: text_cells(series) for name, series in columns.items()}
    grouped = _grouped_mark(list(texts.values()))
    if grouped:
        return grouped
    for name, whole in texts.items():
        cells = _without_blanks(whole)
        with_comma = cells.filter(cells.str.contains(DECIMAL_COMMA))
        with_dot = cells.filter(cells.str.contains(DECIMAL_DOT))
        comma = comma or (f"{with_comma[0]!r} in {name!r}" if len(with_comma) else None)
        dot = dot or (f"{with_dot[0]!r} in {name!r}" if len(with_dot) else None)
        proven = proven or not with_comma.str.contains(_MAYBE_THOUSANDS).all()
    if comma is None:
        return "."
    if dot is not None:
        raise ColumnError.expected("one decimal mark", f"{comma} and {dot}", "export without thousands separators")
    if not proven and table.delimiter not in (";", "\t", " "):
        raise ColumnError.expected(
            "numbers with one reading",
            f"{comma}, a decimal comma or a thousands separator",
            "export with a decimal point, or with ';' between columns",
        )
    return ","


def _has_comma(series: nw.Series[Any]) -> bool:
    native = series.to_native()
    cells = native if isinstance(native, pl.Series) and native.dtype == pl.String else text_cells(series)
    return bool(cells.str.contains(",", literal=True).any())


def _grouped_mark(texts: list[pl.Series]) -> str:
    """Decimal mark that a number with both marks proves, if every other number agrees; empty: none does."""
    for mark, both in _BOTH.items():
        other = {".": DECIMAL_COMMA, ",": DECIMAL_DOT}[mark]
        if any(cells.str.contains(both).any() for cells in texts):
            odd = [cells.filter(cells.str.contains(other) & ~cells.str.contains(_GROUPED[mark])) for cells in texts]
            return "" if any(len(cells) for cells in odd) else mark
    return ""


def _without_blanks(cells: pl.Series) -> pl.Series:
    """Cells without the blanks and apostrophes between thousands."""
    grouped = cells.str.contains(_BLANK_GROUPS).fill_null(value=False)
    return cells.zip_with(~grouped, cells.str.replace_all(r"[ \x{A0}\x{202F}'’]", "")) if grouped.any() else cells


def is_text(series: nw.Series[Any]) -> bool:
    """Tell columns of strings, categories or mixed Python objects from numeric ones."""
    return isinstance(series.dtype, nw.String | nw.Categorical | nw.Enum | nw.Object | nw.Unknown)


def native(series: nw.Series[Any]) -> pl.Series:
    """The same values in Polars; those of a Polars frame are not copied."""
    held: Any = nw.to_native(series)
    if isinstance(held, pl.Series):
        return held
    return pl.Series(series.name, [None if _of_pandas(value) else value for value in series.to_list()])


def text_cells(series: nw.Series[Any]) -> pl.Series:
    """Text of each cell without surrounding blanks; null where there is none."""
    native = series.to_native()
    if isinstance(native, pl.Series) and native.dtype == pl.String:
        cells = native
    else:
        listed = [None if _is_none(value) else str(value) for value in series.to_list()]
        cells = pl.Series(series.name, listed, dtype=pl.String)
    stripped = cells.str.strip_chars()
    return stripped.set(stripped == "", None)


def without_words(cells: pl.Series) -> pl.Series:
    """Cells, null where they hold a word for a missing value; no such word begins with a digit and is without #."""
    perhaps = cells.str.contains("^[^0-9]|#").fill_null(value=False)
    return cells.set(cells.str.to_lowercase().is_in(list(BAD_WORDS)), None) if perhaps.any() else cells


def _is_none(value: object) -> bool:
    return value is None or (isinstance(value, float) and math.isnan(value)) or _of_pandas(value)


def _of_pandas(value: object) -> bool:
    """Whether it is one of the two by which pandas says that there is none."""
    return type(value).__name__ in ("NAType", "NaTType")


def _from_text(table: Table, name: str, decimal: str) -> tuple[FloatArray, tuple[str, ...]]:
    cells = text_cells(table.column(name))
    parsed = _parsed(cells, decimal)
    odd = (parsed.is_null() & cells.is_not_null()).to_numpy()
    notes: tuple[str, ...] = ()
    if odd.any():
        words = cells.filter(pl.Series(odd))
        known = words.str.to_lowercase().is_in(list(BAD_WORDS)).to_numpy()
        if not known.all():
            raise _not_a_number(table, name, int(np.flatnonzero(odd)[np.flatnonzero(~known)[0]]), cells)
        notes = (_missing_note(name, words),)
    values = parsed.fill_null(np.nan).to_numpy()
    return np.array(values, dtype=np.float64), notes


def _parsed(cells: pl.Series, decimal: str) -> pl.Series:
    """Numbers, null where a cell is none: at once where cells are numbers as they stand, as nearly all are."""
    if decimal == ".":
        parsed = cells.cast(pl.Float64, strict=False)
        if parsed.null_count() == cells.null_count():
            return parsed
    return _plain(cells, decimal).cast(pl.Float64, strict=False)


def _plain(cells: pl.Series, decimal: str) -> pl.Series:
    """Cells with a decimal point and nothing between thousands."""
    cells = _without_blanks(cells)
    grouped = cells.str.contains(_GROUPED[decimal]).fill_null(value=False)
    if grouped.any():
        between = "," if decimal == "." else "."
        cells = cells.zip_with(~grouped, cells.str.replace_all(between, "", literal=True))
    return cells.str.replace(",", ".", literal=True) if decimal == "," else cells


def _not_a_number(table: Table, name: str, row: int, cells: pl.Series) -> ColumnError:
    hint = "; if this row holds units, delete it" if row == 0 else ""
    return ColumnError.expected(
        f"numbers in column {name!r}",
        f"{cells[row]!r} in {table.where(row)}",
        f"name another column, or leave the cell empty where the value is missing{hint}",
    )


def _missing_note(name: str, words: pl.Series) -> str:
    examples = ", ".join(repr(word) for word in words.unique(maintain_order=True)[:3])
    cells, verb = ("cell", "was") if len(words) == 1 else ("cells", "were")
    return f"{len(words)} {cells} of {name!r} ({examples}) {verb} read as missing."
