"""Spreadsheets -> Table: the one sheet with rows, read by the rules of text files."""

from __future__ import annotations

from lostmotion.errors import DataError
from lostmotion.extras import need_extra
from lostmotion.files.apart import leaves_apart
from lostmotion.files.child import SHEETS
from lostmotion.files.table import Table
from lostmotion.files.text import parse_text
from lostmotion.files.undamaged import undamaged


def load_workbook(raw: bytes, source: str) -> Table:
    """Columns of the one sheet that holds rows.

    Raises
    ------
    DataError
        Damaged, several sheets hold rows, or the reader is not installed.

    Notes
    -----
    Its reader runs in a process of its own: an .xls whose sectors lead in a circle takes all memory there is.
    """
    need_extra("excel", "save the sheet as CSV")
    with undamaged("a whole workbook", source, "save it again"):
        sheets = leaves_apart(SHEETS, raw)
    if len(sheets) != 1:
        listed = ", ".join(repr(name) for name, _ in sheets) or "none"
        raise DataError.expected(f"one sheet with rows in {source!r}", listed, "save the one of the loop as CSV")
    return parse_text(sheets[0][1], source)
