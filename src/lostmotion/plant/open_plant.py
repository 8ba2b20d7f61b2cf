"""open_plant: anything that holds the data of many loops -> a source of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from lostmotion.addresses import is_url
from lostmotion.errors import InputError, ParameterError
from lostmotion.files.every_loop import read_loops
from lostmotion.files.frames import is_database
from lostmotion.files.paths import is_path
from lostmotion.plant.database_source import DatabaseSource
from lostmotion.plant.files_source import FilesSource
from lostmotion.plant.listed import ListedSource
from lostmotion.plant.loop import PlantLoop
from lostmotion.plant.loop_list import LoopList, read_loop_list
from lostmotion.plant.reading import checked_reading
from lostmotion.plant.records_source import records_source
from lostmotion.plant.source import PlantSource
from lostmotion.records.as_record import as_record, is_source
from lostmotion.records.record import LoopRecord


def open_plant(source: Any, loops: Any = None, **reading: Any) -> PlantSource:
    """Open the data of a plant.

    Parameters
    ----------
    source : path, list of paths, address, frame, records or PlantSource
        A folder (with all folders below it; hidden files and folders are left out), a pattern, files: of one loop each,
        of many loops side by side (FIC101.PV ..) or below each other, of one tag each; Parquet in partitions or pieces.
        The address of a database, with ``query="SELECT .."``. A data frame. Records, as a list or by tag; what
        :func:`lostmotion.identify` takes as a record is one.
    loops : path, LoopList or sequence of PlantLoop, optional
        Loop list; see :func:`lostmotion.plant.read_loop_list`. None: all loops that can be told.
    **reading
        Settings of :func:`lostmotion.read_loop` for all loops alike (`dt`, `time`, `automatic` ..).

    Returns
    -------
    PlantSource

    Raises
    ------
    FileAccessError
        No such file, or an empty folder.
    DataError
        A wrong loop list; two records of one tag.
    InputError, ParameterError
        A source of another kind; a setting that is of one loop only.

    Examples
    --------
    >>> from lostmotion.records.record import LoopRecord
    >>> plant = open_plant({"FIC101": LoopRecord([1.0, 2.0], [3.0, 4.0], dt=1.0)})
    >>> [loop.tag for loop in plant.loops()]
    ['FIC101']
    """
    base = _base(source, dict(reading))
    if loops is None:
        return base
    if is_path(loops):
        listed = read_loop_list(loops)
        return ListedSource(base, listed.loops, listed.notes)
    given = tuple(loops.loops if isinstance(loops, LoopList) else loops)
    if not all(isinstance(loop, PlantLoop) for loop in given):
        raise InputError.expected("a loop list: a path, or PlantLoops", type(loops).__name__, "give one of them")
    return ListedSource(base, given)


def _base(source: Any, reading: dict[str, Any]) -> PlantSource:
    if all(hasattr(source, name) for name in ("loops", "unread", "read")):
        made: PlantSource = source
        return made
    if isinstance(source, LoopRecord):
        return records_source([source])
    if isinstance(source, Mapping) and all(map(_is_record, source.values())):
        return records_source({tag: _read(one, reading) for tag, one in source.items()})
    if _is_list(source) and not any(map(is_path, source)) and all(map(_is_record, source)):
        return records_source([_read(one, reading) for one in source])
    if is_path(source) and (is_url(source) or is_database(Path(source))):
        query = reading.pop("query", None)
        return DatabaseSource(str(source), query, checked_reading(reading))
    if reading.pop("query", None) is not None:
        raise ParameterError.expected("a query of a database only", "one of something else", "leave it out")
    if is_path(source) or (_is_list(source) and all(is_path(one) for one in source)):
        paths = tuple(Path(one) for one in (source if _is_list(source) else [source]))
        found = FilesSource(paths, checked_reading(reading))
        found.survey  # noqa: B018  no file at all is said here
        return found
    if isinstance(source, list | tuple):
        got = f"a list of {', '.join(sorted({type(one).__name__ for one in source}))}"
        raise InputError.expected("paths, or records", got, "give things of one kind")
    return records_source(read_loops(source, **dict(checked_reading(reading))))


def _is_record(value: Any) -> bool:
    return isinstance(value, LoopRecord) or is_source(value)


def _read(value: Any, reading: dict[str, Any]) -> LoopRecord:
    return value if isinstance(value, LoopRecord) else as_record(value, **dict(checked_reading(reading)))


def _is_list(source: Any) -> bool:
    return isinstance(source, Sequence) and not isinstance(source, str | bytes) and len(source) > 0
