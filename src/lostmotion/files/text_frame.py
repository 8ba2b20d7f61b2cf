"""Columns of a long text: each is parsed, block by block, when it is asked for; the others never are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import narwhals.stable.v2 as nw
import polars as pl

Reader = Callable[[Sequence[int]], Iterator[pl.DataFrame]]


class TextFrame:
    """What :class:`lostmotion.files.table.Table` needs of a data frame; all else is asked of a frame of all columns.

    Parameters
    ----------
    names : sequence of str
        Columns.
    height : int
        Rows.
    reader : callable
        Places of columns (from 0) -> these of each block, named c0, c1 .. by their places, in order of the rows.

    Examples
    --------
    >>> text = pl.DataFrame({"c0": ["1", "2"], "c1": ["3", "4"]})
    >>> frame = TextFrame(["OP", "PV"], 2, lambda places: iter([text[:, list(places)]]))
    >>> frame["PV"].to_list(), frame[[1]]["OP"].to_list(), len(frame.filter([True, False]))
    (['3', '4'], ['2'], 1)
    """

    def __init__(self, names: Sequence[str], height: int, reader: Reader) -> None:
        self.columns = list(names)
        self._places = {name: place for place, name in enumerate(names)}
        self._height, self._reader = height, reader
        self._rows: pl.Series | None = None  # of the text, where not all of them or in another order
        self._parsed: dict[str, nw.Series[Any]] = {}

    def __len__(self) -> int:
        return self._height if self._rows is None else len(self._rows)

    def __getitem__(self, wanted: Any) -> Any:
        if not isinstance(wanted, str):
            return self._taken(pl.Series(wanted, dtype=pl.Int64))
        self.read([wanted])
        return self._parsed[wanted]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self.select(self.columns), name)

    def select(self, names: Sequence[str]) -> nw.DataFrame[Any]:
        """Some columns as a frame."""
        self.read(names)
        return nw.from_native(pl.DataFrame({name: self[name].to_native() for name in names}), eager_only=True)

    def read(self, names: Sequence[str]) -> None:
        """Parse these columns, all in one pass."""
        new = [name for name in dict.fromkeys(names) if name not in self._parsed]
        if not new:
            return
        parts = list(self._reader([self._places[name] for name in new]))
        for name in new:
            cells = pl.concat([part[f"c{self._places[name]}"] for part in parts]).alias(name)
            taken = cells if self._rows is None else cells[self._rows]
            self._parsed[name] = nw.from_native(taken, series_only=True)

    def forget(self, names: Sequence[str]) -> None:
        """Give back the room of columns that the text has; they are parsed again where they are asked for again."""
        for name in names:
            if name in self._places:
                self._parsed.pop(name, None)

    def with_column(self, cells: nw.Series[Any], without: Sequence[str]) -> TextFrame:
        """The same with one column more at the end, and some less."""
        other = self._like([*(name for name in self.columns if name not in without), cells.name])
        other._rows = self._rows
        other._parsed = {name: known for name, known in self._parsed.items() if name not in without} | {
            cells.name: cells
        }
        return other

    def _taken(self, rows: pl.Series) -> TextFrame:
        other = self._like(self.columns)
        other._rows = rows if self._rows is None else self._rows[rows]
        other._parsed = {
            name: nw.from_native(known.to_native()[rows], series_only=True) for name, known in self._parsed.items()
        }
        return other

    def _like(self, columns: list[str]) -> TextFrame:
        other = TextFrame(columns, self._height, self._reader)
        other._places = self._places
        return other
