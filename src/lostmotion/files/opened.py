"""Opened: what a source holds before a loop is chosen, so that all its loops are read from one opening."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import narwhals.stable.v2 as nw

from lostmotion.addresses import is_url
from lostmotion.errors import ColumnError, DataError
from lostmotion.files.archive import archived
from lostmotion.files.columns import Columns, SeveralLoopsError, columns_of_loops, no_such_loop, resolve, several_loops
from lostmotion.files.database import database_name
from lostmotion.files.frames import SEVERAL, peeked, tables, tables_of
from lostmotion.files.gathered import gathered
from lostmotion.files.joined import joined, path_stem
from lostmotion.files.long import called, with_columns_of_tags
from lostmotion.files.moments import with_moments
from lostmotion.files.narrowed import columns_to_read
from lostmotion.files.one_tag import one_tag
from lostmotion.files.paths import is_folder, is_path
from lostmotion.files.quality import ALL, Trust
from lostmotion.files.table import Table
from lostmotion.files.tags import same_tag

SHOWN = 4  # files in a message
MOST_COLUMNS = 8  # of a file of one tag: times, value, quality, unit ..


@dataclass(frozen=True, eq=False)
class Opened:
    """Tables of a source.

    Attributes
    ----------
    tables : mapping of str to Table
        One under "", or one for each loop by its name.
    name : str
        What a record without a tag of its own is called.
    by_tags : bool
        The tag that the columns share names the record, rather than the source does.
    """

    tables: Mapping[str, Table]
    name: str = ""
    by_tags: bool = False

    @cached_property
    def _needed(self) -> dict[str, list[str]]:
        """Columns that a loop of one wide table needs, by its tag: read one by one, each looks at these alone."""
        return columns_to_read(self.tables[""].names) if list(self.tables) == [""] else {}

    def _part(self, loop: str, asked: Collection[str]) -> Table:
        """The one table, without columns of other loops where all that is asked for is there by its exact name."""
        table, needed = self.tables[""], self._needed.get(loop, [])
        if not needed or len(needed) == len(table.names) or not set(asked) <= set(needed):
            return table
        columns = nw.from_dict({name: table.column(name) for name in needed})  # `select` would look at all columns
        return replace(table, frame=columns)

    def table(self, loop: str | None = None, asked: Collection[str] = ()) -> tuple[Table, str | None, str]:
        """Table of a loop, the tag that is still to be looked for in its columns, and the name of the table.

        Columns of `asked` are in it.

        Raises
        ------
        ColumnError
            Several tables, and none was named; or none of that name.
        """
        names = list(self.tables)
        if names == [""]:
            return self._part(loop, asked) if loop else self.tables[""], loop, ""
        if loop is None and len(names) > 1:
            raise several_loops(names, SEVERAL)
        fits = [name for name in names if loop in (None, name)] or _called_so(names, str(loop))
        if len(fits) != 1:
            raise no_such_loop(str(loop), names)
        return self.tables[fits[0]], None, fits[0]

    def loops(self, op: str = "OP", pv: str = "PV") -> tuple[str, ...]:
        """Names of the loops, where it holds several; empty for one, or where the columns do not tell.

        Parameters
        ----------
        op, pv : str
            Columns, where they were named: then there is one loop.
        """
        names = tuple(self.tables)
        if names != ("",):
            return names if len(names) > 1 else ()
        try:
            resolve(with_columns_of_tags(with_moments(self.tables[""])).names, op, pv)
        except SeveralLoopsError as error:
            return error.loops
        except DataError:
            return ()
        return ()

    def columns(self) -> dict[str, dict[str, str]]:
        """Column of each role of each loop; none of a loop whose columns do not tell."""
        found: dict[str, Columns] = {}
        for name, table in self.tables.items():
            with suppress(DataError):
                names = with_columns_of_tags(with_moments(table)).names
                found |= {name: resolve(names)} if name else columns_of_loops(names)
        roles = ("op", "pv", "sp", "position", "mode")
        return {
            tag: {role: name for role in roles if (name := getattr(one, role)) is not None}
            for tag, one in found.items()
        }


def opened(source: Any, asked: Collection[str] = (), query: str | None = None, trust: Trust = ALL) -> Opened:
    """Read a source, but do not yet choose a loop.

    Parameters
    ----------
    source : path, list of paths, or data frame
        As in :func:`lostmotion.read_loop`.
    asked : collection of str
        Columns that the user named; of files of one tag each, the names of the files.
    query : str, optional
        Of a database.
    trust : Trust
        What is believed of the qualities in files of one tag each.

    Raises
    ------
    FileAccessError, DataError, InputError
        As in read_loop.
    """
    if isinstance(source, Opened):
        return source
    paths = gathered(source)
    if paths is None:
        inside = archived(Path(source)) if is_path(source) and not is_url(source) and query is None else []
        if inside:
            return _of_archive(Path(source), inside, asked, trust)
        found = tables(source, query)
        table = next(iter(found.values()))
        if is_path(source) and query is None and len(table.names) <= MOST_COLUMNS and one_tag(table) is not None:
            raise _one_tag_alone(Path(source))
        return Opened(found, _name(source))
    if len(paths) == 1:
        return opened(paths[0], asked, query, trust)
    loaded = [tables(path) for path in paths]
    each = [one_tag(found[""]) if "" in found else None for found in loaded]
    whole = [path for path, one in zip(paths, each, strict=True) if one is None]
    if whole:
        raise _whole_records(paths, whole)
    files = [(path, one) for path, one in zip(paths, each, strict=True) if one is not None]
    folder = Path(source) if is_path(source) and is_folder(Path(source)) else paths[0].absolute().parent
    return Opened({"": joined(files, _called(source, paths), asked, trust)}, folder.absolute().name, by_tags=True)


def _of_archive(path: Path, inside: Sequence[tuple[Path, bytes]], asked: Collection[str], trust: Trust) -> Opened:
    """Files of one tag each are one table; whole records are one each, by their names."""
    loaded = [(place, tables_of(content, place.name)) for place, content in inside]
    each = [(place, one_tag(found[""]) if "" in found else None) for place, found in loaded]
    files = [(place, one) for place, one in each if one is not None]
    if len(loaded) == 1 and not files:
        return Opened(loaded[0][1], path_stem(loaded[0][0]))
    if len(files) == len(loaded) > 1:
        return Opened({"": joined(files, path.name, asked, trust)}, path_stem(path), by_tags=True)
    if files:
        raise _mixed(path, files[0][0], len(loaded) - len(files))
    return Opened(_records(path, loaded))


def _records(path: Path, loaded: Sequence[tuple[Path, dict[str, Table]]]) -> dict[str, Table]:
    """Records of an archive, by the names of their files, with the folders where these alone tell them apart."""
    stems = [path_stem(place) for place, _ in loaded]
    found: dict[str, Table] = {}
    for stem, (place, inside) in zip(stems, loaded, strict=True):
        name = stem if stems.count(stem) == 1 else place.with_name(stem).as_posix()
        if wide := Opened(inside).loops():
            said = f"{len(wide)} in {place.name!r}"
            raise DataError.expected(f"one loop in each file of {path.name!r}", said, "unpack it and give that file")
        found[name] = next(iter(inside.values()))
    return found


def _mixed(path: Path, tag: Path, whole: int) -> DataError:
    rest = f"and {whole} whole record{'s' if whole > 1 else ''}" if whole else "alone"
    return DataError.expected(
        f"records, or files of one tag each, in {path.name!r}",
        f"one tag in {tag.name!r} {rest}",
        "unpack it and give the files of one record",
    )


def loops_of_file(path: Path, op: str = "OP", pv: str = "PV") -> tuple[str, ...]:
    """Names of the loops of a file that holds several, from its first rows where these tell them.

    Raises
    ------
    FileAccessError, DataError
        As in :func:`opened`.
    """
    try:
        table = peeked(path)
    except SeveralLoopsError as error:
        return error.loops
    listed = all(called(table, role) for role in ("tag", "value"))
    return (opened(path) if listed else Opened({"": table})).loops(op, pv)


def _called_so(names: Sequence[str], loop: str) -> list[str]:
    """Names that are the same but for case and separators, or end so: loop1 is data.loop1."""
    return [name for name in names if same_tag(name, loop)] or [
        name for name in names if same_tag(name.rpartition(".")[2], loop)
    ]


def _one_tag_alone(path: Path) -> ColumnError:
    return ColumnError.expected(
        f"OP and PV in {path.name!r}", "the values of one tag", "give the files of all tags of the loop together"
    )


def _name(source: Any) -> str:
    if is_url(source):
        return database_name(source)
    return path_stem(Path(source)) if is_path(source) else ""


def _called(source: Any, paths: Sequence[Path]) -> str:
    return str(source) if is_path(source) else ", ".join(path.name for path in paths)


def _whole_records(paths: Sequence[Path], whole: Sequence[Path]) -> DataError:
    shown = ", ".join(path.name for path in whole[:SHOWN])
    more = f" and {len(whole) - SHOWN} more" if len(whole) > SHOWN else ""
    return DataError.expected(
        f"one record, or {len(paths)} files of one tag each", f"more than one tag in {shown}{more}", "give one of them"
    )
