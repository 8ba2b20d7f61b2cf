"""Table: named columns of any data frame, and where in the file each row stands."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import narwhals.stable.v2 as nw
import numpy as np

from lostmotion.arrays import IntArray
from lostmotion.files.text_frame import TextFrame


@dataclass(frozen=True, eq=False)
class Table:
    """Columns as they were handed in, not yet converted to numbers.

    Parameters
    ----------
    frame : narwhals.DataFrame or TextFrame
        One column per name; text files give columns of strings, long ones when they are asked for.
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
    units : mapping of str to str
        What a row of units says of the columns, by their names.
    """

    frame: nw.DataFrame[Any] | TextFrame
    source: str
    lines: Sequence[int] | None = None
    delimiter: str = ""
    notes: tuple[str, ...] = ()
    own_times: bool = False
    units: Mapping[str, str] = field(default_factory=dict, repr=False)

    @property
    def names(self) -> list[str]:
        """Names of the columns in file order."""
        return list(self.frame.columns)

    def column(self, name: str) -> nw.Series[Any]:
        """One column by its exact name."""
        column: nw.Series[Any] = self.frame[name]
        return column

    def read_ahead(self, names: Sequence[str]) -> None:
        """Parse columns of a long text together, which takes less time than one by one."""
        if isinstance(self.frame, TextFrame):
            self.frame.read(names)

    def let_go(self, names: Sequence[str]) -> None:
        """Give back the room of columns of a long text that have become numbers."""
        if isinstance(self.frame, TextFrame):
            self.frame.forget(names)

    def taken(self, rows: IntArray) -> Table:
        """Rows (from 0) in another order, or some of them."""
        lines = None if self.lines is None else array("q", np.asarray(self.lines, dtype=np.int64)[rows].tobytes())
        frame = self.frame[rows] if isinstance(self.frame, TextFrame) else self.frame[rows.tolist()]
        return replace(self, frame=frame, lines=lines)

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
    filled = [" ".join(name.split("\n")).strip() or f"column {place + 1}" for place, name in enumerate(names)]
    total = Counter(filled)
    seen: Counter[str] = Counter()
    unique = []
    for name in filled:
        seen[name] += 1
        unique.append(f"{name} ({seen[name]})" if total[name] > 1 else name)
    return unique
