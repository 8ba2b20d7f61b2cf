"""Files of a plant -> its loops with their addresses, and what gives none. Nothing is read but names and beginnings."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from os.path import commonpath
from pathlib import Path
from typing import Any

from lostmotion.errors import LostMotionError
from lostmotion.files.dataset import DATE_KEYS
from lostmotion.files.joined import name_of
from lostmotion.files.paths import is_link
from lostmotion.files.tags import folded, loop_type, loops_of
from lostmotion.plant.address import Place, written
from lostmotion.plant.contents import ROLES, contents_of, of_tags, one_line, parquet_unit
from lostmotion.plant.extent import extent_of
from lostmotion.plant.loop import PlantLoop
from lostmotion.plant.naming import Named, Part, area_of, named, parts_of
from lostmotion.plant.parquet import LOOP_KEYS, Kind, names_in, schema_at, schema_of
from lostmotion.plant.source import Unread
from lostmotion.plant.unit import Found, Unit
from lostmotion.plant.walk import files_below, given_places, in_pieces, leads_out, no_file, partition_of

AREAS = ("area", "unit", "plant", "section", "site", "anlage", "bereich", "zone")
ALONE = "the values of one tag only, without OP and PV of one loop"


@dataclass(frozen=True)
class Survey:
    """What there is.

    Attributes
    ----------
    root : Path
        What addresses are counted from.
    loops : tuple of PlantLoop
    unread : tuple of Unread
    units : tuple of Unit
    """

    root: Path
    loops: tuple[PlantLoop, ...]
    unread: tuple[Unread, ...]
    units: tuple[Unit, ...]


def surveyed(sources: Sequence[Path], reading: Mapping[str, Any]) -> Survey:
    """Look at all files.

    Raises
    ------
    FileAccessError
        No file at all.
    """
    paths = files_below(sources)
    root = root_of(sources, paths)
    places = given_places(sources)
    odd = {path: why for path in paths if (why := no_file(path) or (is_link(path) and leads_out(path, places)))}
    files = [path for path in paths if path not in odd]
    units = _together([one for path_units in _units(files, reading) for one in path_units])
    units += [Unit((path,), why=why, failed=True) for path, why in odd.items()]
    found, twice = named(parts_of(units), root, cache(extent_of))
    loops = tuple(_plant_loop(one, root) for one in found)
    out = [Unread(_where(unit, root), unit.why, unit.failed) for unit in units if not unit.loops]
    return Survey(root, loops, (*out, *twice), tuple(units))


def root_of(sources: Sequence[Path], paths: Sequence[Path]) -> Path:
    """Folder that was given, or the one that all files lie in."""
    if len(sources) == 1 and sources[0].is_dir():
        return sources[0]
    return Path(commonpath([path.absolute().parent for path in paths])) if paths else Path()


def _units(paths: Sequence[Path], reading: Mapping[str, Any]) -> list[list[Unit]]:
    pieces = in_pieces(paths)
    known = {path for files in pieces.values() for path in files}
    units = [_pieces(folder, files, reading) for folder, files in pieces.items()]
    return [*([contents_of(path, reading)] for path in paths if path not in known), *units]


def _pieces(folder: Path, files: Sequence[Path], reading: Mapping[str, Any]) -> list[Unit]:
    """Units of Parquet in pieces: where a partition tells the loop, each loop has files of its own."""
    keys = partition_of(folder, files[0])
    tag_key = next((key for key in keys if folded(key) in LOOP_KEYS), "") or next(
        (key for key in keys if key.lower() not in DATE_KEYS and folded(key) not in AREAS), ""
    )
    try:
        schema = schema_of(names_in(files[0]))
        if not keys:
            return _alike(files, reading, schema.names)
        if schema.kind is Kind.COLUMNS and schema_at(files[0]).kind is Kind.LONG:
            return [_tags_in_partitions(folder, files, tag_key)]
        if schema.kind is Kind.COLUMNS and tag_key:
            return [_partitions(folder, files, tag_key, reading)]
    except LostMotionError as error:
        return [Unit((path,), why=one_line(error), failed=True) for path in files]
    return [parquet_unit(part, reading) for part in _by_area(folder, files).values()]


def _alike(files: Sequence[Path], reading: Mapping[str, Any], names: Sequence[str]) -> list[Unit]:
    """Numbered pieces as one table, where all have the same columns."""
    same = [path for path in files if list(names_in(path)) == list(names)]
    others = [contents_of(path, reading) for path in files if path not in same]
    return [parquet_unit(same, reading), *others]


def _by_area(folder: Path, files: Sequence[Path]) -> dict[tuple[str, ...], tuple[Path, ...]]:
    """Pieces of the same partitions but for dates: of another area they may hold the same tags."""
    found: dict[tuple[str, ...], tuple[Path, ...]] = {}
    for path in files:
        values = tuple(v for k, v in partition_of(folder, path).items() if k.lower() not in DATE_KEYS)
        found[values] = (*found.get(values, ()), path)
    return found


def _partitions(folder: Path, files: Sequence[Path], tag_key: str, reading: Mapping[str, Any]) -> Unit:
    """A loop for each value of a key; the columns are those of the first piece."""
    first = parquet_unit(files[:1], reading)
    if len(first.loops) != 1:
        return Unit(tuple(files), names=first.names, why=first.why or "several loops in one partition", failed=True)
    columns = first.loops[0].columns
    pieces: dict[tuple[str, str], list[Path]] = {}
    for path in files:
        keys = partition_of(folder, path)
        area = ".".join(value for key, value in keys.items() if folded(key) in AREAS)
        pieces.setdefault((keys.get(tag_key, ""), area), []).append(path)
    loops = tuple(Found("", tag, columns, area, tuple(paths)) for (tag, area), paths in pieces.items())
    return Unit(tuple(files), loops, first.names)


def _tags_in_partitions(folder: Path, files: Sequence[Path], tag_key: str) -> Unit:
    """A row for each value, and the tag in the name of the partition."""
    pieces: dict[str, tuple[Path, ...]] = {}
    for path in files:
        tag = partition_of(folder, path).get(tag_key, "")
        pieces[tag] = (*pieces.get(tag, ()), path)
    loops = tuple(
        Found(one.tag, one.tag, one.columns, files=tuple(path for tag in one.columns.values() for path in pieces[tag]))
        for one in of_tags(tuple(pieces))
    )
    return Unit(tuple(files), loops, tuple(pieces), "" if loops else ALONE, failed=not loops)


def _together(units: Sequence[Unit]) -> list[Unit]:
    """Files of one tag each, of one folder, put together to loops."""
    folders: dict[Path, list[Unit]] = {}
    for unit in units:
        if unit.one_tag is not None:
            folders.setdefault(unit.files[0].parent, []).append(unit)
    joined = [one for folder, alone in folders.items() for one in _joined(folder, alone)]
    return [*(unit for unit in units if unit.one_tag is None), *joined]


def _joined(folder: Path, units: Sequence[Unit]) -> list[Unit]:
    files: dict[str, tuple[Path, ...]] = {}
    for unit in units:
        if unit.one_tag is not None:
            name = name_of(unit.files[0], unit.one_tag)
            files[name] = (*files.get(name, ()), unit.files[0])
    loops = loops_of(files)
    if not loops and {"op", "pv"} <= {name.lower() for name in files}:  # FIC101/OP.csv beside FIC101/PV.csv
        roles = {role: name for name in files for role in ROLES if name.lower() == role}
        loops = {folder.absolute().name: roles}
    found = [
        Unit(
            inside := tuple(path for name in roles.values() for path in files[name]),
            (Found("", tag, roles, files=inside),),
            tuple(roles.values()),
        )
        for tag, roles in loops.items()
    ]
    used = {path for unit in found for path in unit.files}
    return [*found, *(Unit(unit.files, why=ALONE) for unit in units if not set(unit.files) & used)]


def _where(unit: Unit, root: Path) -> str:
    first = below(unit.files[0], root)
    return first if len(unit.files) == 1 else f"{first} and {len(unit.files) - 1} more"


def below(path: Path, root: Path) -> str:
    """Address of a file: from the root on where it lies below it."""
    return path.relative_to(root).as_posix() if path.is_relative_to(root) else path.as_posix()


def _plant_loop(one: Named, root: Path) -> PlantLoop:
    columns = one.parts[0].found.columns
    area, area_from = area_of(one.parts[0], root, one.tag)
    kind = loop_type(one.tag) or loop_type(one.parts[0].found.tag)
    notes = (*one.notes, *_inferred(kind, area, area_from))
    size, stamp = _size_and_stamp(one.parts)
    return PlantLoop(
        one.tag,
        columns.get("op", ""),
        columns.get("pv", ""),
        columns.get("sp", ""),
        columns.get("mode", ""),
        kind,
        area=area,
        where=written([_place(part, root) for part in one.parts]),
        size=size,
        stamp=stamp,
        notes=notes,
    )


def _inferred(kind: str, area: str, area_from: str) -> tuple[str, ...]:
    said = f"Type {kind!r} by the first letter of the tag." if kind else ""
    where = f"Area {area!r} by the {area_from}." if area_from in ("folder", "tag") else ""
    return tuple(one for one in (said, where) if one)


def _place(part: Part, root: Path) -> Place:
    return Place(tuple(below(path, root) for path in part.files), part.found.name)


def _size_and_stamp(parts: Sequence[Part]) -> tuple[int, str]:
    """Bytes that are read for it, of a file with several loops its share; and size and time of its files."""
    size, told = 0, []
    for part in parts:
        for path in part.files:
            try:
                seen = path.stat()
            except OSError:
                continue
            size += seen.st_size // (1 if part.found.files else part.share)
            told.append(f"{seen.st_size}-{seen.st_mtime_ns}")
    return size, stamp_of(told)


def stamp_of(told: Sequence[str]) -> str:
    """Size and time of each file as one word."""
    return told[0] if len(told) == 1 else hashlib.sha256(" ".join(told).encode()).hexdigest()[:16]
