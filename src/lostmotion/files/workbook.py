"""Spreadsheets -> Table: the one sheet with rows, read by the rules of text files."""

from __future__ import annotations

import polars as pl

from lostmotion.errors import DataError
from lostmotion.files.table import Table
from lostmotion.files.text import parse_text

FEWEST_CELLS = (3, 2)  # rows and columns of a sheet with a record


def load_workbook(raw: bytes, source: str) -> Table:
    """Columns of the one sheet that holds rows.

    Raises
    ------
    DataError
        Damaged, several sheets hold rows, or the reader is not installed.
    """
    try:
        import fastexcel  # noqa: PLC0415  only spreadsheets need it
    except ImportError as error:
        raise DataError.expected(
            f"the reader of spreadsheets for {source!r}", "none", "install lostmotion[excel], or save the sheet as CSV"
        ) from error
    try:
        reader = fastexcel.read_excel(raw)
        sheets = {name: _cells(reader, name) for name in reader.sheet_names}
    except fastexcel.FastExcelError as error:
        raise DataError.expected("a whole workbook", f"a damaged one, {source!r} ({error})", "save it again") from error
    filled = {name: sheet for name, sheet in sheets.items() if sheet.height >= FEWEST_CELLS[0]}
    filled = {name: sheet for name, sheet in filled.items() if sheet.width >= FEWEST_CELLS[1]}
    if len(filled) != 1:
        listed = ", ".join(repr(name) for name in filled) or "none"
        raise DataError.expected(f"one sheet with rows in {source!r}", listed, "save the one of the loop as CSV")
    sheet = next(iter(filled.values()))
    text = sheet.write_csv(separator="\t", include_header=False)
    return parse_text(text.encode(), source)


def _cells(reader: object, name: str) -> pl.DataFrame:
    """Cells as text, without the rows and columns that are empty."""
    sheet: pl.DataFrame = reader.load_sheet(name, header_row=None, dtypes="string").to_polars()  # type: ignore[attr-defined]
    kept = [column for column in sheet.columns if sheet[column].is_not_null().any()]
    sheet = sheet.select(kept)
    return sheet.filter(pl.any_horizontal(pl.all().is_not_null())) if kept else sheet
