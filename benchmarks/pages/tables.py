"""Reading figures off a page: its tables by row and column, its sentences by a pattern."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from .footer import Footer, footer_of, unsigned

NUMBER = r"[-+]?\d+(?:,\d{3})*(?:\.\d+)?"


class QuoteError(Exception):
    """A page does not hold, or no longer says, what a text quotes."""


def numbers(text: str) -> list[float]:
    """All numbers in a text, commas of thousands left out."""
    return [float(found.replace(",", "")) for found in re.findall(NUMBER, text)]


@dataclass(frozen=True)
class PageText:
    """A page as it is on disk."""

    name: str
    text: str

    @classmethod
    def read(cls, path: Path) -> PageText:
        """A page; one that is not there is an error only where it is quoted."""
        return cls(path.stem, path.read_text(encoding="utf-8") if path.exists() else "")

    @property
    def footer(self) -> Footer | None:
        """Who made it."""
        return footer_of(self.text)

    @cached_property
    def tables(self) -> list[list[list[str]]]:
        """Cells of every table, header first, the line under it left out."""
        blocks = re.findall(r"(?:^\|.*\|$\n?)+", unsigned(self.text), flags=re.MULTILINE)
        return [[_cells(line) for line in block.splitlines() if set(line) - set("|- :")] for block in blocks]

    def cell(self, row: str, column: str) -> str:
        """Cell of the first row that begins so and has this column."""
        return self._found(row, column)[0]

    def numbers(self, row: str, column: str) -> list[float]:
        """Numbers in the cells of all rows that begin so, in this column."""
        return [number for cell in self._found(row, column) for number in numbers(cell)]

    def number(self, row: str, column: str) -> float:
        """First number of a cell."""
        return numbers(self.cell(row, column))[0]

    def rows(self, column: str, **where: str) -> list[list[str]]:
        """Rows of the first table that has a column; `where`: only those with these cells in further columns."""
        header, *lines = self._table(column)
        return [line for line in lines if all(line[header.index(name)] == cell for name, cell in where.items())]

    def column(self, name: str) -> int:
        """Place of a column in the first table that has it."""
        return self._table(name)[0].index(name)

    def said(self, pattern: str) -> list[float]:
        """Numbers that `#` stands for in a sentence of the page; line breaks do not matter."""
        words = r"\s+".join(re.escape(word).replace(r"\#", f"({NUMBER})") for word in pattern.split())
        found = re.search(words, self.text)
        if found is None:
            raise QuoteError(f"docs/{self.name}.md no longer says {pattern!r}")
        return [float(number.replace(",", "")) for number in found.groups()]

    def _table(self, column: str) -> list[list[str]]:
        for table in self.tables:
            if column in table[0]:
                return table
        raise QuoteError(f"docs/{self.name}.md has no table with a column {column!r}")

    def _found(self, row: str, column: str) -> list[str]:
        """Cells of the rows of this name; where there are none, of those that begin so."""
        named = [
            (line[0], line[header.index(column)])
            for header, *lines in self.tables
            if column in header
            for line in lines
        ]
        exact = [cell for name, cell in named if name == row]
        found = exact or [cell for name, cell in named if name.startswith(row)]
        if not found:
            raise QuoteError(f"docs/{self.name}.md has no row {row!r} with a column {column!r}")
        return found


def _cells(line: str) -> list[str]:
    return [cell.strip().replace("**", "") for cell in line.strip().strip("|").split("|")]
