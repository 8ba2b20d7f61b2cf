"""Table: named columns of any data frame, and where in the file each row stands."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import narwhals.stable.v2 as nw

from lostmotion.arrays import IntArray


@dataclass(frozen=True, eq=False)
class Table:
    """Columns as they were handed in, not yet converted to numbers.

    Parameters
    ----------
    frame : narwhals.DataFrame
        One column per name; text files give columns of strings.
    source : str
        What the user called it, for messages.
    lines : sequence of int, optional
        Line in the file (from 1) of each row.
    delimiter : str
        Separator of a text file; empty for data frames and Parquet.
    notes : tuple of str
        What was assumed while opening it.
    own_times : bool
        Each column had times of its own: empty cells hold no new value rather than a missing one.
    """

    frame: nw.DataFrame[Any]
    source: str
    lines: Sequence[int] | None = None
    delimiter: str = ""
    notes: tuple[str, ...] = ()
    own_times: bool = False

    @property
    def names(self) -> list[str]:
        """Names of the columns in file order."""
        return list(self.frame.columns)

    def column(self, name: str) -> nw.Series[Any]:
        """One column by its exact name."""
        return self.frame[name]

    def taken(self, rows: IntArray) -> Table:
        """Rows (from 0) in another order, or some of them."""
        places = rows.tolist()
        lines = None if self.lines is None else [self.lines[row] for row in places]
        return replace(self, frame=self.frame[places], lines=lines)

    def where(self, row: int) -> str:
        """Say where a row (from 0) stands: "row 3 (line 4)", both counted from 1."""
        return f"row {row + 1}" if self.lines is None else f"row {row + 1} (line {self.lines[row]})"


def unique_names(names: Sequence[str]) -> list[str]:
    """Strip names, number the repeated ones and give the empty ones a name, so that each is its own.

    Examples
    --------
    >>> unique_names(["time", "PV", "PV ", ""])
    ['time', 'PV (1)', 'PV (2)', 'column 4']
    """
    filled = [name.strip() or f"column {place + 1}" for place, name in enumerate(names)]
    total = Counter(filled)
    seen: Counter[str] = Counter()
    unique = []
    for name in filled:
        seen[name] += 1
        unique.append(f"{name} ({seen[name]})" if total[name] > 1 else name)
    return unique
