"""Cells that are alike but for their digits, as most dates of one export are -> their numbers, many at once."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import polars as pl

from lostmotion.arrays import FloatArray

Ints = npt.NDArray[np.signedinteger[Any]]
_ZERO, _NINE = ord("0"), ord("9")


@dataclass(frozen=True, eq=False)
class FixedCells:
    """Digits by their places.

    Attributes
    ----------
    found : re.Match
        Groups of the first cell, which stand at the same places in all.
    digits : ndarray of uint8, shape (n, letters)
        What stands at each place; of use where the first cell has a digit.
    """

    found: re.Match[str]
    digits: npt.NDArray[np.uint8]

    def __len__(self) -> int:
        return len(self.digits)

    def text(self, group: str) -> str:
        """Text of a group in the first cell; empty where it has none."""
        return self.found[group] or ""

    def numbers(self, group: str, default: int = -1, first: int = 0, stop: int | None = None) -> Ints:
        """Digits of a group, or the first to the last of them, as whole numbers; a default where there are none."""
        start, end = self.found.span(group)
        places = [place for place in range(start, end) if self.found.string[place].isdigit()][first:stop]
        if not places:
            return np.full(len(self), default, dtype=np.int32)
        found = np.zeros(len(self), dtype=np.int32)
        for place in places:
            found = found * np.int32(10) + self.digits[:, place]
        return found

    def fraction(self, group: str) -> FloatArray:
        """Digits of a group as those behind a decimal point; 0 where there are none."""
        return np.asarray(self.numbers(group, default=0) / 10.0 ** len(self.text(group)))


def fixed_cells(cells: pl.Series, pattern: str) -> FixedCells | None:
    """Cells that fit a pattern and differ in their digits only; None where they do not.

    Parameters
    ----------
    cells : polars.Series of str
        Stripped.
    pattern : str
        A regular expression that takes all digits alike, of ASCII letters only.

    Examples
    --------
    >>> found = fixed_cells(pl.Series(["21-Jan 15:20", "22-Jan 15:21"]), r"(?P<day>[0-9]{2})-Jan [0-9:]+")
    >>> found.numbers("day"), fixed_cells(pl.Series(["21-Jan", "22-Feb"]), "(?P<day>[0-9]{2})-[A-Za-z]+")
    (array([21, 22], dtype=int32), None)
    """
    if not len(cells) or cells.null_count():
        return None
    lengths, found = cells.str.len_bytes(), re.match(pattern, str(cells[0]))
    if found is None or lengths.min() != lengths.max():
        return None
    codes = np.frombuffer(str(cells.str.join("")[0]).encode(), dtype=np.uint8).reshape(len(cells), -1)
    digit = (codes[0] >= _ZERO) & (codes[0] <= _NINE)
    digits = codes - np.uint8(_ZERO)  # what is below 0 comes out above 9
    if (codes[:, ~digit] != codes[0, ~digit]).any() or (digits[:, digit] > 9).any():
        return None
    return FixedCells(found, digits)
