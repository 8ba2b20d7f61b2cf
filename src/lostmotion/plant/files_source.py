"""FilesSource: the loops of files and folders."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from functools import cached_property
from pathlib import Path
from typing import Any

import polars as pl

from lostmotion.errors import DataError, FileAccessError, LostMotionError
from lostmotion.files.opened import Opened, opened
from lostmotion.files.tags import loops_of
from lostmotion.plant.address import Place, parsed, written
from lostmotion.plant.contents import in_rows
from lostmotion.plant.loop import PlantLoop
from lostmotion.plant.parquet import ALWAYS, Kind, is_parquet, schema_at, table_of, values_in
from lostmotion.plant.period import Period
from lostmotion.plant.pooled import pooled
from lostmotion.plant.reading import Reading, between, checked_range, record_of, tried, trust
from lostmotion.plant.source import Unread
from lostmotion.plant.survey import Survey, below, stamp_of, surveyed
from lostmotion.plant.walk import given_places, in_pieces, leads_out
from lostmotion.records.record import LoopRecord

Outcome = LoopRecord | LostMotionError
BROKEN = (LostMotionError, OSError, pl.exceptions.PolarsError, MemoryError)  # of one loop only


@dataclass(frozen=True)
class FilesSource:
    """Loops of files: of folders with all below them, patterns, or single files with one loop or many.

    Parameters
    ----------
    sources : tuple of Path
        Hidden files and folders (.name) are left out.
    reading : tuple of (str, value)
        Settings of :func:`lostmotion.read_loop` for all loops alike.

    Notes
    -----
    What a text or Parquet file holds is told by its first rows and its schema. At a time one file is open; of Parquet
    the columns and row groups of one loop. Addresses of loops count from :attr:`root`.
    """

    sources: tuple[Path, ...]
    reading: Reading = ()

    @cached_property
    def survey(self) -> Survey:
        """What there is; looked up once, and never sent to another process."""
        return surveyed(self.sources, dict(self.reading))

    @cached_property
    def root(self) -> Path:
        """Folder that addresses count from."""
        return self.sources[0] if len(self.sources) == 1 and self.sources[0].is_dir() else self.survey.root

    def __reduce__(self) -> tuple[Any, ...]:
        sources = tuple(source.absolute() for source in self.sources)  # workers have another working folder
        return _made, (sources, self.reading, self.root.absolute())

    @cached_property
    def _sizes(self) -> dict[str, int]:
        """Of the loops that were found, by their address; of two with one the first."""
        return {one.where: one.size for one in reversed(self.loops())}

    def loops(self) -> tuple[PlantLoop, ...]:
        """All loops, by the names of their files."""
        return self.survey.loops

    def unread(self) -> tuple[Unread, ...]:
        """Files that give no loop."""
        return self.survey.unread

    def placed(self, loop: PlantLoop) -> PlantLoop:
        """A loop of a loop list with the size and the stamp of its files.

        Raises
        ------
        FileAccessError
            One of them is not there, or not in a place that was given.
        """
        places = given_places(self.sources)
        size, told = 0, []
        for place in parsed(loop.where):
            for file in place.files:
                path = self.root / file
                if not path.is_file():
                    error = f"expected a file for {loop.tag!r}, got no such file {str(path)!r}; check it"
                    raise FileAccessError(error) from FileNotFoundError(str(path))
                out = leads_out(path, places)
                if out:
                    raise FileAccessError(f"expected a file of the plant for {loop.tag!r}, got {str(path)!r}: {out}")
                seen = path.stat()
                size += seen.st_size
                told.append(f"{seen.st_size}-{seen.st_mtime_ns}")
        return replace(loop, size=self._sizes.get(loop.where, size), stamp=stamp_of(told))

    def holding(self, columns: Collection[str]) -> str:
        """Address of the only file that has all these columns or tags; empty: none, or several."""
        fits = [unit for unit in self.survey.units if columns and set(columns) <= set(unit.names)]
        return written([Place(tuple(below(path, self.root) for path in fits[0].files))]) if len(fits) == 1 else ""

    def read(
        self, loops: Sequence[PlantLoop], since: datetime | None = None, until: datetime | None = None
    ) -> Iterator[tuple[PlantLoop, Outcome]]:
        """Record of each loop; see :class:`lostmotion.plant.PlantSource`."""
        checked_range(since, until)
        wanted: dict[tuple[str, ...], list[tuple[PlantLoop, Place]]] = {}
        left: dict[str, int] = {}
        for loop in loops:
            places = parsed(loop.where)
            left[loop.tag] = len(places)
            for place in places:
                wanted.setdefault(place.files, []).append((loop, place))
            if not places:
                yield loop, DataError.expected(f"data of {loop.tag!r}", "no file", "name it in the loop list: file")
        parts: dict[str, list[Outcome]] = {tag: [] for tag in left}
        for files, here in wanted.items():
            for loop, outcome in self._of_files(files, here, Period(since, until)):
                parts[loop.tag].append(outcome)
                if len(parts[loop.tag]) == left[loop.tag]:
                    yield loop, _whole(parts.pop(loop.tag), since, until)

    def _of_files(
        self, files: tuple[str, ...], wanted: Sequence[tuple[PlantLoop, Place]], period: Period
    ) -> Iterator[tuple[PlantLoop, Outcome]]:
        """Records of loops in the same files, opened once; one after another."""
        paths = tuple(self.root / file for file in files)
        try:
            lazy = all(is_parquet(path) for path in paths) and (len(paths) == 1 or bool(in_pieces(paths)))
            content = None if lazy else in_rows(self._opened(paths))
        except BROKEN as error:
            yield from ((loop, tried(error, loop)) for loop, _ in wanted)
            return
        for loop, place in wanted:
            try:
                yield loop, self._record(paths, content, loop, place, period)
            except BROKEN as error:
                yield loop, tried(error, loop)

    def _opened(self, paths: Sequence[Path]) -> Opened:
        return opened(list(paths) if len(paths) > 1 else paths[0], trust=trust(self.reading))

    def _record(
        self, paths: Sequence[Path], content: Opened | None, loop: PlantLoop, place: Place, period: Period
    ) -> LoopRecord:
        own = [name for name in (loop.op, loop.pv, loop.sp, loop.mode) if name]
        if content is None:
            told = bool(loop.time or loop.dt) or any(name in ("time", "dt") for name, _ in self.reading)
            content = parquet_content(paths, place.loop, own, ALWAYS if told else period)
        return record_of(content, loop, place.loop, self.reading)


def _made(sources: tuple[Path, ...], reading: Reading, root: Path) -> FilesSource:
    """In a worker the root is known without looking at the files."""
    made = FilesSource(sources, reading)
    made.__dict__["root"] = root
    return made


def parquet_content(paths: Sequence[Path], name: str, columns: Collection[str], period: Period = ALWAYS) -> Opened:
    """Rows and columns of one loop; see :func:`lostmotion.plant.parquet.table_of`."""
    schema = schema_at(paths[0])
    if schema.kind is Kind.ROWS:
        return Opened({name: table_of(paths, (), (), name, period if name else ALWAYS)}, paths[0].stem)
    if schema.kind is Kind.LONG and not columns:
        columns = list(loops_of(values_in(paths, schema.by)).get(name, {}).values())
    return Opened({"": table_of(paths, columns, columns, period=period)}, paths[0].stem)


def _whole(parts: Sequence[Outcome], since: datetime | None, until: datetime | None) -> Outcome:
    """One record of all, of the time asked for; where none can be read, the first error."""
    errors = [part for part in parts if isinstance(part, LostMotionError)]
    inside: list[LoopRecord] = []
    apart: list[LostMotionError] = []
    for part in parts:
        if isinstance(part, LoopRecord):
            try:
                inside.append(between(part, since, until))
            except DataError as error:
                apart.append(error)
    if not inside:
        return [*errors, *apart][0]
    try:
        whole = pooled(inside)
    except LostMotionError as error:
        return error
    notes = tuple(f"A record was left out: {error}." for error in errors)
    return replace(whole, notes=(*whole.notes, *notes)) if notes else whole
