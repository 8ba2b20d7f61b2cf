"""Quality beside values: words and codes of historians and of OPC -> good, uncertain or bad."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lostmotion.errors import ColumnError
from lostmotion.files.names import BAD_QUALITY, GOOD_QUALITY, LONG, UNCERTAIN_QUALITY
from lostmotion.files.number_cells import BAD_WORDS, text_cells
from lostmotion.files.table import Table
from lostmotion.files.tags import folded, key

GOOD, UNCERTAIN, BAD = 0, 1, 2
Marks = npt.NDArray[np.int8]
# The two highest bits of a code. OPC DA, 8 bits: bad, uncertain, not used, good. OPC UA, 32 bits: good, uncertain, bad.
OF_DA = (BAD, UNCERTAIN, BAD, GOOD)
OF_UA = (GOOD, UNCERTAIN, BAD, BAD)
BESIDE = (*LONG["quality"], "st", "q", "qlty", "statuscode", "status code", "quality code")
VALUE_ENDS = (" cv", " value", " val")  # PV.CV has its status in PV.ST
_CODE = re.compile(r"[+-]?\d+(\.0*)?|0x[0-9a-f]+")
LONGEST_CODE = 20  # characters of a quality that is a number
SHOWN = 3  # words in a note


@dataclass(frozen=True)
class Trust:
    """What is believed of the qualities in a source.

    Parameters
    ----------
    read : bool
        They are read at all.
    uncertain : bool
        Values of uncertain quality are kept.
    """

    read: bool = True
    uncertain: bool = True


ALL = Trust()


def distrusted(table: Table, column: str, of: str, trust: Trust = ALL) -> tuple[npt.NDArray[np.bool_], tuple[str, ...]]:
    """Rows whose value is no measurement by its quality, and what to say of it.

    Parameters
    ----------
    table : Table
        Where the column of qualities is.
    column : str
        Its name.
    of : str
        What the values are called, for the notes.
    trust : Trust
        What is believed.

    Raises
    ------
    ColumnError
        Numbers that are no code of OPC, of which 0 may be good or bad.

    Examples
    --------
    >>> import narwhals.stable.v2 as nw
    >>> import polars as pl
    >>> frame = pl.DataFrame({"PV": [5, 6, 7], "PV.Status": [192, 64, 0]})
    >>> distrusted(Table(nw.from_native(frame, eager_only=True), "a"), "PV.Status", "PV", Trust(uncertain=False))[0]
    array([False,  True,  True])
    """
    cells = text_cells(table.column(column)).str.to_lowercase()
    nothing = np.zeros(len(cells), dtype=np.bool_)
    words = [str(word) for word in cells.drop_nulls().unique(maintain_order=True).to_list()]
    if not trust.read or not words:
        return nothing, ()
    marks = marks_of(words, column)
    if marks is None:
        said = ", ".join(repr(word) for word in words[:SHOWN])
        return nothing, (f"{column!r} was not read as the quality of {of!r}: no word of it is known ({said}).",)
    known = dict(zip(words, marks.tolist(), strict=True))
    of_rows = np.array([known.get(cell, GOOD) for cell in cells.to_list()], dtype=np.int8)
    notes = tuple(
        _note(of, mark, int(np.sum(of_rows == mark)), [word for word in words if known[word] == mark], trust)
        for mark in (BAD, UNCERTAIN)
        if (of_rows == mark).any()
    )
    return (of_rows == BAD) | ((of_rows == UNCERTAIN) & (not trust.uncertain)), notes


def _note(of: str, mark: int, count: int, words: Sequence[str], trust: Trust) -> str:
    said = ", ".join(repr(word) for word in words[:SHOWN])
    kind = "bad" if mark == BAD else "uncertain"
    counted = f"{count} value{'' if count == 1 else 's'} of {of!r} with {kind} quality ({said})"
    if mark == UNCERTAIN and trust.uncertain:
        return f"{counted} kept; uncertain='bad' leaves out such values."
    return f"{counted} left out, as missing."


def marks_of(words: Sequence[str], column: str) -> Marks | None:
    """Good, uncertain or bad for each word or code; None where none is known.

    Parameters
    ----------
    words : sequence of str
        What the column holds, each once, in lower case.
    column : str
        Its name, for messages.

    Notes
    -----
    OPC DA has 0 for bad and 192 for good, OPC UA has 0 for good: which of them it is, the other codes tell. A column of
    0 alone is good: in OPC DA it would hold no measurement at all.

    Examples
    --------
    >>> marks_of(["good", "i/o timeout", "questionable", "substituted by x"], "Status").tolist()
    [0, 2, 1, 1]
    >>> marks_of(["0", "192", "68"], "Q").tolist(), marks_of(["0", "2147483648", "0x40000000"], "Q").tolist()
    ([2, 0, 1], [0, 2, 1])
    >>> marks_of(["auto", "man"], "Status")
    """
    codes = [_code(word) for word in words]
    if all(code is not None for code in codes):
        return _of_codes([code for code in codes if code is not None], column)
    marks = [_of_word(word) if code is None else _of_da(code) for word, code in zip(words, codes, strict=True)]
    if all(mark is None for mark in marks):
        return None
    return np.array([UNCERTAIN if mark is None else mark for mark in marks], dtype=np.int8)


def _code(word: str) -> int | None:
    if len(word) > LONGEST_CODE or not _CODE.fullmatch(word):
        return None
    return int(word, 16) if word.startswith("0x") else int(float(word))


def _of_word(word: str) -> int | None:
    """By the word itself, or by what a longer one begins with: BadNoCommunication, Uncertain, sub-normal."""
    plain = folded(word)
    for mark, known, begin in (
        (GOOD, GOOD_QUALITY, "good"),
        (UNCERTAIN, UNCERTAIN_QUALITY, "uncertain"),
        (BAD, BAD_QUALITY | BAD_WORDS, "bad"),
    ):
        if plain in known or plain.startswith(begin):
            return mark
    return None


def _of_da(code: int) -> int:
    return OF_DA[(code & 0xFF) >> 6]


def _of_codes(codes: Sequence[int], column: str) -> Marks | None:
    """By the two highest bits, of 8 in OPC DA and of 32 in OPC UA."""
    if any(code < 0 or code > 0xFFFF for code in codes):
        return np.array([OF_UA[(code & 0xFFFFFFFF) >> 30] for code in codes], dtype=np.int8)
    if any(code & 0xC0 for code in codes):
        return np.array([_of_da(code) for code in codes], dtype=np.int8)
    if list(codes) == [0]:
        return np.zeros(1, dtype=np.int8)
    if len(codes) == 1:
        return None
    said = ", ".join(map(str, sorted(codes)[:SHOWN]))
    raise ColumnError.expected(
        f"a quality with one reading in column {column!r}",
        f"{said}: no codes of OPC, and 0 may be good or bad",
        "take all values with quality=False, or mark bad ones as Bad",
    ).leads_on({"quality": False})


def quality_column(table: Table, column: str) -> str | None:
    """Column with the quality of another: by its name, by its place behind it, or the only one; None: there is none.

    Examples
    --------
    >>> import narwhals.stable.v2 as nw
    >>> import polars as pl
    >>> def named(*names):
    ...     return Table(nw.from_native(pl.DataFrame({name: ["Good"] for name in names}), eager_only=True), "a")
    >>> quality_column(named("t", "F1.PV", "F1.OP", "F1.PV.Status"), "F1.PV")
    'F1.PV.Status'
    >>> quality_column(named("t", "F1.PV", "Quality (1)", "F1.OP", "Quality (2)"), "F1.OP")
    'Quality (2)'
    """
    wanted = names_of_quality(column)
    by_name = [name for name in table.names if name != column and key(name) in wanted]
    if by_name:
        return by_name[0] if len(by_name) == 1 else None
    plain = without_name(table.names)
    if len(plain) > 1:
        place = table.names.index(column) + 1
        return table.names[place] if place < len(table.names) and table.names[place] in plain else None
    if len(plain) == 1 and (key(plain[0]) != "status" or _has_words(table, plain[0])):
        return plain[0]
    return None


def names_of_quality(column: str) -> set[str]:
    """Keys of the columns that hold the quality of another by their names."""
    bare = key(column)
    bases = {bare, *(bare.removesuffix(end) for end in VALUE_ENDS)}
    wanted = {f"{base} {word}" for base in bases for word in BESIDE}
    return wanted | {f"{word} {base}" for base in bases for word in LONG["quality"]}


def without_name(names: Sequence[str]) -> list[str]:
    """Columns of quality that name no other: Quality, Quality (1)."""
    return [name for name in names if key(name) in LONG["quality"]]


def _has_words(table: Table, name: str) -> bool:
    """Whether a column called status alone holds words of quality: numbers may be anything's."""
    words = text_cells(table.column(name)).str.to_lowercase().drop_nulls().unique().to_list()
    return any(_code(word) is None and _of_word(word) is not None for word in words)
