"""Lines above the rows: which is the header, and what stands around it (a preamble, units, descriptions)."""

from __future__ import annotations

import csv
from dataclasses import dataclass

from lostmotion.errors import DataError
from lostmotion.files.columns import usual
from lostmotion.files.dates import looks_like_a_time, looks_numeric
from lostmotion.files.limits import MOST_CELL, need_few_columns
from lostmotion.files.names import UNIT_ROW
from lostmotion.files.number_cells import BAD_WORDS
from lostmotion.files.tags import loops_of

csv.field_size_limit(max(csv.field_size_limit(), MOST_CELL))  # a wide header is one cell for a wrong delimiter
DELIMITERS = (";", "\t", ",")
TOP = 60  # lines in which the header is looked for
SEEN = 20  # lines by which the columns are counted
ROLES = ("time", "op", "pv", "sp", "mode")


@dataclass(frozen=True)
class Head:
    """Place of the header, of the first row, and what was passed over."""

    header: int
    first: int
    notes: tuple[str, ...] = ()
    units: int | None = None  # line with the units of the columns


def find_head(lines: list[str], places: list[int]) -> Head | None:
    """Header among the first lines, by the columns of the rows below; None: the first line is it.

    Parameters
    ----------
    lines : list of str
        Of the file.
    places : list of int
        Those that are neither blank nor comments.

    Examples
    --------
    >>> lines = ["Trend of 1.3.2024", "Time;FIC1.OP;FIC1.PV", "s;%;m3/h", *(f"{k};1,5;2,5" for k in range(30))]
    >>> find_head(lines, list(range(33)))
    Head(header=1, first=3, notes=('Line 1 was passed over.', 'Line 3 holds units and was passed over.'), units=2)
    """
    top = places[:TOP]
    delimiter, width = _columns([lines[place] for place in places[len(top) // 2 :][:SEEN]])
    if not delimiter:
        return None
    split = [_fields(lines[place], delimiter) for place in top]
    fit = [len(fields) == width and _is_row(fields) for fields in split]
    empty = [len(fields) == width and _is_missing(fields) for fields in split]
    rows = [number for number in range(len(fit)) if fit[number] and all(_either(fit, empty, number + 1))]
    if not rows or rows[0] < 2:
        return None
    begin = rows[0]
    while (
        begin > 0
        and abs(len(split[begin - 1]) - width) <= 1
        and _fits(split[begin - 1], width)
        and not empty[begin - 1]
    ):
        begin -= 1
    if begin == rows[0]:
        return None
    candidates = range(begin, rows[0])
    chosen = max(candidates, key=lambda number: (_recognised(split[number]), -number))
    notes = [_passed(top[:chosen])] if chosen else []
    for number in range(chosen + 1, rows[0]):
        what = "units" if _are_units(split[number]) else "descriptions"
        notes.append(f"Line {top[number] + 1} holds {what} and was passed over.")
    units = next((top[number] for number in range(chosen + 1, rows[0]) if _are_units(split[number])), None)
    return Head(top[chosen], top[rows[0]], tuple(notes), units)


def no_table(line: str, source: str) -> DataError:
    """Error for a text in whose lines stand neither columns nor numbers: a letter."""
    got = f"text such as {line.strip()[:60]!r} in {source!r}"
    return DataError.expected("a table with columns for OP and PV", got, "export the record of the loop as a table")


def _columns(lines: list[str]) -> tuple[str, int]:
    """Delimiter that cuts all rows into the same number of columns, and that number."""
    for delimiter in DELIMITERS:
        counts = {len(_fields(line, delimiter)) for line in lines}
        if len(counts) == 1 and min(counts) > 1:
            need_few_columns(min(counts))
            return delimiter, counts.pop()
    return "", 0


def _fields(line: str, delimiter: str) -> list[str]:
    return [field.strip() for field in cells_of(line, delimiter)]


def cells_of(line: str, delimiter: str) -> list[str]:
    """Cells of a line, quotes taken off.

    Raises
    ------
    DataError
        One is longer than a cell can be.
    """
    try:
        return next(csv.reader([line], delimiter=delimiter), [])
    except csv.Error as error:
        raise DataError.expected("cells of text", f"one that cannot be read ({error})", "export it again") from error


def _fits(fields: list[str], width: int) -> bool:
    """A header may lack the last, empty field; a line of a preamble has few cells."""
    filled = sum(bool(field) for field in fields)
    return filled > max(1, width // 2)


def _is_row(fields: list[str]) -> bool:
    """Begins with a number or a time, or is mostly of these and of words for missing values."""
    filled = [field for field in fields if field]
    numbers = [looks_numeric(field) or looks_like_a_time(field) for field in filled]
    bad = sum(field.lower() in BAD_WORDS for field in filled)
    return any(numbers) and (numbers[0] or 2 * (sum(numbers) + bad) >= len(filled))


def _is_missing(fields: list[str]) -> bool:
    """Nothing but empty cells and words for missing values."""
    return all(not field or field.lower() in BAD_WORDS for field in fields)


def _either(fit: list[bool], empty: list[bool], number: int) -> list[bool]:
    """Whether the line, if there is one, is a row or holds missing values only."""
    return [row or missing for row, missing in zip(fit[number : number + 1], empty[number : number + 1], strict=True)]


def _recognised(fields: list[str]) -> int:
    """How many roles the names of a line tell."""
    names = [field for field in fields if field]
    return sum(bool(usual(role, names)) for role in ROLES) + len(loops_of(names))


def _are_units(fields: list[str]) -> bool:
    filled = [field.strip("[]()").lower() for field in fields if field]
    return 2 * sum(field in UNIT_ROW for field in filled) >= len(filled)


def _passed(places: list[int]) -> str:
    first, last = places[0] + 1, places[-1] + 1
    return f"Line {first} was passed over." if first == last else f"Lines {first} to {last} were passed over."
