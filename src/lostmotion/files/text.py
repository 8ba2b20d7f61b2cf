"""Delimited text -> Table of strings: encoding, line ends, comments and delimiter are found out."""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import narwhals.stable.v2 as nw
import numpy as np
import polars as pl

from lostmotion.errors import DataError
from lostmotion.files.head import DELIMITERS, TOP, cells_of, find_head, no_table
from lostmotion.files.limits import need_few_columns, need_memory
from lostmotion.files.number_cells import BAD_WORDS
from lostmotion.files.quoted_names import joined
from lostmotion.files.table import Table, unique_names
from lostmotion.files.text_blocks import BLOCK, Block, Content, cuts, find_blocks, numbers_of
from lostmotion.files.text_frame import TextFrame
from lostmotion.files.watch import LONG, tell

BLANKS = " "  # any number of blanks and tabs, where nothing else cuts the lines
ONE_COLUMN = ";"  # between what is no other column: a comma in its numbers is a decimal one
NO_NAME, SAMPLE_LINES = "Value", 20  # of the one column of a file without a header; by which columns are counted
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
    content = known_text(joined(raw), source)
    need_memory(max(content.raw.count(b"\n"), content.raw.count(b"\r")), source)
    spans = list(cuts(content.raw)) or [(0, 0)]
    top = _lines(content, spans[0])
    if len(spans) > 1 and sum(map(has_cells, top)) <= TOP:  # the header is not in the first block: look at all
        spans = [(0, len(content.raw))]
        top = _lines(content, spans[0])
    header, begin, notes, units = _find_header(top, _places(top, whole=len(spans) == 1), source)
    blocks, again = find_blocks(content, spans, begin, header, has_cells)
    if not blocks:
        raise _no_rows(source)
    body = content.rows(blocks[0]).decode().split("\n")[:SAMPLE_LINES]
    rows = _Rows(content, blocks, header, find_delimiter(header, body, source), source)
    numbers = numbers_of(blocks)
    if len(rows.names) == 1 and not isinstance(numbers, range):
        raise _skipped(numbers, source) if any(map(_is_value, body)) else no_table(header, source)
    frame = rows.frame()
    aligned = numbers if len(frame) == len(numbers) else None  # a quoted cell may hold a line end
    found = Table(frame, source, aligned, rows.delimiter, (*notes, *_headers_again(again)))
    return replace(found, units=rows.beside(units)) if units else found


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
    content = known_text(raw, source)
    return content.raw.decode(content.encoding)


def known_text(raw: bytes, source: str) -> Content:
    """Bytes as UTF-8 without mark, or Latin-1; raises as :func:`decode` does."""
    if not raw[:BLOCK].strip() and not raw.strip():
        raise DataError.expected(
            "a header line and rows", f"an empty file {source!r}", "check that the export finished"
        )
    if raw.startswith(_UTF16):
        return Content(raw.decode("utf-16", errors="replace").encode())
    if b"\0" in raw or raw.startswith((b"PK\x03\x04", b"\x1f\x8b", b"%PDF")):
        raise DataError.expected(
            "delimited text or Parquet",
            f"a binary file {source!r}",
            "save it as CSV (in Excel: Save As, CSV) or unpack it first",
        )
    return Content(raw.removeprefix(codecs.BOM_UTF8)) if _is_utf8(raw) else Content(raw, "latin-1")


def _is_utf8(raw: bytes) -> bool:
    if raw.isascii():
        return True
    decoder = codecs.getincrementaldecoder("utf-8")()
    try:
        for start in range(0, len(raw), BLOCK):
            decoder.decode(raw[start : start + BLOCK], final=start + BLOCK >= len(raw))
    except UnicodeDecodeError:
        return False
    return True


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
    if not delimiter and any(map(_NUMBER.fullmatch, body)) and all(map(_is_value, body)):
        return ONE_COLUMN
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
    rows = _places(lines)
    header, begin, notes, _ = _find_header(lines, rows, source)
    rows = [place for place in rows if place >= begin]
    if not rows:
        raise _no_rows(source)
    again = sum(lines[place] == header for place in rows)
    if again:
        rows = [place for place in rows if lines[place] != header]
    return header, rows, (*notes, *_headers_again(again))


def _lines(content: Content, span: tuple[int, int]) -> list[str]:
    return content.text(*span).decode().split("\n")


def _places(lines: list[str], whole: bool = True) -> list[int]:
    """Lines that are neither blank nor comments; of a whole text without rows of empty cells at the end."""
    rows = [place for place, line in enumerate(lines) if has_cells(line)]
    while whole and rows and not lines[rows[-1]].strip(' ,;\t"'):
        rows.pop()
    return rows


def _find_header(lines: list[str], rows: list[int], source: str) -> tuple[str, int, tuple[str, ...], str]:
    """Header, the line of the first row, what was passed over, and the row of units."""
    if not rows:
        raise DataError.expected("a header line and rows", f"none in {source!r}", "check the export")
    first = rows[0]
    head = find_head(lines, rows)
    if head is not None:
        return lines[head.header], head.first, head.notes, "" if head.units is None else lines[head.units]
    if not _is_numeric(lines[first]):
        return lines[first], first + 1, (), ""
    if all("," not in lines[row] and _is_value(lines[row]) for row in rows[:SAMPLE_LINES]):
        return NO_NAME, first, ("It has no header and one number in a line: values of one tag.",), ""
    if first and _COMMENT.match(lines[first - 1]):
        return lines[first - 1].lstrip(" #/"), first, (), ""
    raise DataError.expected(
        "column names in the first line",
        f"numbers in line {first + 1} of {source!r}: {lines[first][:60]!r}",
        "add a header line such as time,OP,PV,SP",
    )


def _no_rows(source: str) -> DataError:
    return DataError.expected("rows below the header", f"none in {source!r}", "check the export")


def _skipped(numbers: Sequence[int], source: str) -> DataError:
    """Error for a line that would be passed over: the values behind it would be those of other times."""
    line = next(after - 1 for before, after in pairwise(numbers) if after > before + 1)
    return DataError.expected(
        "a value in every line of a file of one column", f"none in line {line} of {source!r}", "write NaN there"
    )


def _headers_again(again: int) -> tuple[str, ...]:
    lines = "1 line" if again == 1 else f"{again} lines"
    return (f"The header stands again in {lines}, passed over.",) if again else ()


def _is_numeric(line: str) -> bool:
    fields = [field.strip('" ') for field in re.split(r"[;\t ]|,(?!\d)|(?<=\d),", line)]
    filled = [field for field in fields if field]
    return bool(filled) and all(_NUMBER.fullmatch(field) for field in filled)


def _is_value(line: str) -> bool:
    """Whether a line is one number, or a word for a missing one."""
    return _NUMBER.fullmatch(line) is not None or line.strip().lower() in BAD_WORDS


def split_line(line: str, delimiter: str) -> list[str]:
    """Fields of one line."""
    if delimiter == BLANKS:
        return line.split()
    return cells_of(line, delimiter)


def with_tabs(lines: list[str]) -> list[str]:
    """Rows that blanks separate, with tabs instead."""
    return ["\t".join(line.split()) for line in lines]


class _Rows:
    """Rows of a text, in blocks, and how their cells are separated."""

    def __init__(self, content: Content, blocks: Sequence[Block], header: str, delimiter: str, source: str) -> None:
        names = split_line(header, delimiter)
        need_few_columns(len(names))
        while len(names) > 1 and not names[-1].strip():
            names.pop()
        self.delimiter, self.names = delimiter, unique_names(names)
        self._content, self._blocks, self._source = content, blocks, source

    def frame(self) -> nw.DataFrame[Any] | TextFrame:
        """All columns, or of a long text those that will be asked for; every row is checked here."""
        height = 0
        long = len(self._blocks) > 1
        for block in self._blocks:
            if long and self._none_is_longer(block):
                height += block.rows
            else:
                part = self._parse(block)
                height += part.height
            self._tell("looking at the rows of", block)
        if long:
            return TextFrame(self.names, height, self._read)
        return nw.from_native(part.rename(dict(zip(part.columns, self.names, strict=True))), eager_only=True)

    def beside(self, line: str) -> dict[str, str]:
        """Cells of a line above the rows, by the names of their columns."""
        cells = (cell.strip() for cell in split_line(line, self.delimiter))
        return {name: cell for name, cell in zip(self.names, cells, strict=False) if cell}

    def _read(self, places: Sequence[int]) -> Iterator[pl.DataFrame]:
        for block in self._blocks:
            yield self._csv(self._content.rows(block), places)
            self._tell("reading the columns of", block)

    def _tell(self, what: str, block: Block) -> None:
        if len(self._content.raw) > LONG:
            tell(f"{what} {self._source}", block.stop, len(self._content.raw))

    def _none_is_longer(self, block: Block) -> bool:
        """Whether it is sure, without a look at the cells, that no row of a block has more of them than the header."""
        text = self._content.rows(block)
        if self.delimiter == BLANKS or b'"' in text:
            return False
        codes = np.frombuffer(text, dtype=np.uint8)
        ends = np.append(np.flatnonzero(codes == ord("\n")), len(codes))
        before = np.searchsorted(np.flatnonzero(codes == ord(self.delimiter)), ends)
        return int(np.diff(before, prepend=0).max()) < len(self.names)

    def _parse(self, block: Block) -> pl.DataFrame:
        """Cells of one block, all of them, once it is sure that no row has more than the header."""
        text, spare = self._content.rows(block), f"c{len(self.names)}"
        try:
            frame = self._csv(text)
        except pl.exceptions.PolarsError as error:
            raise self._ragged(text, block) from error
        if (frame[spare].fill_null("").str.strip_chars() != "").any():
            raise self._ragged(text, block)
        return frame.drop(spare)

    def _csv(self, rows: bytes, places: Sequence[int] | None = None) -> pl.DataFrame:
        delimiter = self.delimiter
        if delimiter == BLANKS:
            rows, delimiter = "\n".join(with_tabs(rows.decode().split("\n"))).encode(), "\t"
        names = delimiter.join(f"c{place}" for place in range(len(self.names) + 1))  # lines may end with a delimiter
        whole = b"\n".join([names.encode(), rows, b""])  # as text a stream of it would take four bytes a letter
        return pl.read_csv(whole, separator=delimiter, infer_schema=False, columns=places)

    def _ragged(self, rows: bytes, block: Block) -> DataError:
        body = rows.decode().split("\n")
        if self.delimiter == BLANKS:
            return _ragged(with_tabs(body), len(self.names), "\t", block.numbers.tolist(), self._source)
        return _ragged(body, len(self.names), self.delimiter, block.numbers.tolist(), self._source)


def _ragged(body: list[str], fields: int, delimiter: str, numbers: list[int], source: str) -> DataError:
    for number, line in zip(numbers, body, strict=True):
        found = split_line(line, delimiter)
        if any(field.strip() for field in found[fields:]):
            got = f"{len(found)} in line {number} of {source!r}: {line[:60]!r}"
            remedy = "repair the line; with decimal commas, separate columns by ';' or quote the numbers"
            return DataError.expected(f"{fields} fields as in the header", got, remedy)
    return DataError.expected(
        "delimited text", f"lines that cannot be split in {source!r}", "check the quotes and export it again"
    )
