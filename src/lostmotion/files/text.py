"""Delimited text -> Table of strings: encoding, line ends, comments and delimiter are found out."""

from __future__ import annotations

import codecs
import csv
import re

import narwhals.stable.v2 as nw
import polars as pl

from lostmotion.errors import DataError
from lostmotion.files.head import DELIMITERS, find_head
from lostmotion.files.table import Table, unique_names

BLANKS = " "  # any number of blanks and tabs, where nothing else cuts the lines
SAMPLE_LINES = 20
_UTF16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
_COMMENT = re.compile(r"\s*(#(?!N/A|VALUE|DIV/0|REF|NAME|NUM|NULL)|//)")
_NUMBER = re.compile(r"\s*[+-]?[\d.,]+([eE][+-]?\d+)?\s*")


def parse_text(raw: bytes, source: str) -> Table:
    r"""Turn the bytes of a delimited text file into a table of strings.

    Parameters
    ----------
    raw : bytes
        Content: UTF-8, UTF-16 with a byte order mark, or Latin-1; line ends LF, CR LF or CR.
    source : str
        Name of the file, for messages.

    Raises
    ------
    DataError
        Empty, binary, without a header, or a row has more fields than the header.

    Examples
    --------
    >>> table = parse_text(b"OP;PV\r1,5;2\r", "a.csv")
    >>> table.delimiter, table.column("OP").to_list()
    (';', ['1,5'])
    """
    text = decode(raw, source).replace("\r\n", "\n").replace("\r", "\n")
    lines = text.split("\n")
    header, rows, notes = find_rows(lines, source)
    body = [lines[row] for row in rows]
    delimiter = find_delimiter(header, body[:SAMPLE_LINES], source)
    names = split_line(header, delimiter)
    numbers = [row + 1 for row in rows]
    frame = _parse(body, names, delimiter, numbers, source)
    aligned = numbers if len(frame) == len(numbers) else None  # a quoted cell may hold a line end
    return Table(nw.from_native(frame, eager_only=True), source, aligned, delimiter, notes)


def decode(raw: bytes, source: str) -> str:
    r"""Decode UTF-8 (with or without mark), UTF-16 with a mark, else Latin-1.

    Raises
    ------
    DataError
        Nothing in it, or NUL bytes: not text.

    Examples
    --------
    >>> decode(b"\xef\xbb\xbfOP", "a.csv"), decode(b"\xb0C", "a.csv")
    ('OP', '°C')
    """
    if not raw.strip():
        raise DataError.expected(
            "a header line and rows", f"an empty file {source!r}", "check that the export finished"
        )
    if raw.startswith(_UTF16):
        return raw.decode("utf-16", errors="replace")
    if b"\0" in raw or raw.startswith((b"PK\x03\x04", b"\x1f\x8b", b"%PDF")):
        raise DataError.expected(
            "delimited text or Parquet",
            f"a binary file {source!r}",
            "save it as CSV (in Excel: Save As, CSV) or unpack it first",
        )
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def find_delimiter(header: str, body: list[str], source: str = "") -> str:
    r"""Find the delimiter that cuts the header and the rows into the same number of fields.

    Blanks are one where nothing else is, and every row has as many words as the header.

    Raises
    ------
    DataError
        Neither ; tab , nor blanks cut the header.

    Examples
    --------
    >>> find_delimiter("Flow, m3/h;OP", ["1,5;2,5", "1,6;2,4"])
    ';'
    """
    best, delimiter = (0.0, 0), ""
    for candidate in DELIMITERS:
        fields = len(split_line(header, candidate))
        if fields < 2:
            continue
        alike = sum(0 <= len(split_line(line, candidate)) - fields <= 1 for line in body)
        score = (alike / max(len(body), 1), fields)
        if not delimiter or score > best:
            best, delimiter = score, candidate
    words = len(header.split())
    if words > 1 and best[0] < 1.0 and all(len(line.split()) == words for line in body):
        return BLANKS
    if not delimiter:
        raise DataError.expected(
            "a header with columns separated by ',' ';' tab or blanks",
            f"{header[:80]!r} in {source!r}",
            "export as CSV with one header line",
        )
    return delimiter


def has_cells(line: str) -> bool:
    """Tell a header or a row from a blank line or a comment.

    Examples
    --------
    >>> has_cells("#N/A;1"), has_cells("# made by x"), has_cells(" ")
    (True, False, False)
    """
    bare = line.strip(" ")
    return bool(bare) and (bare[0] not in "#/\t" or not _COMMENT.match(line))


def find_rows(lines: list[str], source: str) -> tuple[str, list[int], tuple[str, ...]]:
    """Header line, the places of the rows, and what was passed over besides blank lines and comments.

    Raises
    ------
    DataError
        No header, or nothing below it.
    """
    rows = [place for place, line in enumerate(lines) if has_cells(line)]
    while rows and not lines[rows[-1]].strip(' ,;\t"'):
        rows.pop()
    if not rows:
        raise DataError.expected("a header line and rows", f"none in {source!r}", "check the export")
    first = rows[0]
    head = find_head(lines, rows)
    notes: tuple[str, ...] = ()
    if head is not None:
        header, notes, rows = lines[head.header], head.notes, [place for place in rows if place >= head.first]
    elif not _is_numeric(lines[first]):
        header, rows = lines[first], rows[1:]
    elif first and _COMMENT.match(lines[first - 1]):
        header = lines[first - 1].lstrip(" #/")
    else:
        raise DataError.expected(
            "column names in the first line",
            f"numbers in line {first + 1} of {source!r}: {lines[first][:60]!r}",
            "add a header line such as time,OP,PV,SP",
        )
    if not rows:
        raise DataError.expected("rows below the header", f"none in {source!r}", "check the export")
    again = sum(lines[place] == header for place in rows)
    if again:
        rows = [place for place in rows if lines[place] != header]
        notes = (*notes, f"The header stands again in {again} line{'s' if again > 1 else ''}, passed over.")
    return header, rows, notes


def _is_numeric(line: str) -> bool:
    fields = [field.strip('" ') for field in re.split(r"[;\t ]|,(?!\d)|(?<=\d),", line)]
    filled = [field for field in fields if field]
    return bool(filled) and all(_NUMBER.fullmatch(field) for field in filled)


def split_line(line: str, delimiter: str) -> list[str]:
    """Fields of one line."""
    if delimiter == BLANKS:
        return line.split()
    return next(csv.reader([line], delimiter=delimiter), [])


def with_tabs(lines: list[str]) -> list[str]:
    """Rows that blanks separate, with tabs instead."""
    return ["\t".join(line.split()) for line in lines]


def _parse(body: list[str], names: list[str], delimiter: str, numbers: list[int], source: str) -> pl.DataFrame:
    while len(names) > 1 and not names[-1].strip():
        names = names[:-1]
    if delimiter == BLANKS:
        body, delimiter = with_tabs(body), "\t"
    spare = f"c{len(names)}"  # one field more than the header: lines that end with a delimiter
    places = delimiter.join(f"c{place}" for place in range(len(names) + 1))
    try:
        whole = "\n".join([places, *body, ""]).encode()  # as text a stream of it would take four bytes a letter
        frame = pl.read_csv(whole, separator=delimiter, infer_schema=False)
    except pl.exceptions.PolarsError as error:
        raise _ragged(body, len(names), delimiter, numbers, source) from error
    if (frame[spare].fill_null("").str.strip_chars() != "").any():
        raise _ragged(body, len(names), delimiter, numbers, source)
    return frame.drop(spare).rename(dict(zip(frame.columns[:-1], unique_names(names), strict=True)))


def _ragged(body: list[str], fields: int, delimiter: str, numbers: list[int], source: str) -> DataError:
    for number, line in zip(numbers, body, strict=True):
        found = split_line(line, delimiter)
        if any(field.strip() for field in found[fields:]):
            return DataError.expected(
                f"{fields} fields as in the header",
                f"{len(found)} in line {number} of {source!r}: {line[:60]!r}",
                "repair the line; with decimal commas, separate columns by ';' or quote the numbers",
            )
    return DataError.expected(
        "delimited text", f"lines that cannot be split in {source!r}", "check the quotes and export it again"
    )
