"""Loops of many files -> one tag for each loop: records of one loop together, different loops apart."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from hashlib import file_digest
from itertools import pairwise
from pathlib import Path

from lostmotion.files.joined import path_stem
from lostmotion.files.tags import isa, loop_type, same_tag, without_run
from lostmotion.plant.extent import Extent
from lostmotion.plant.source import Unread
from lostmotion.plant.unit import Found, Unit
from lostmotion.printable import label

# FIC101_2024-01-31, flows.20240131_0600
_DATED = re.compile(r"[-_. ]+(19|20)\d\d([-_.]?)(0[1-9]|1[0-2])(\2[0-3]\d)?([-_.T ]?\d{2,6}Z?){0,2}$")
SHOWN = 4  # files in a message


@dataclass(frozen=True)
class Part:
    """One record of a loop: files that are read together, and the loop in them."""

    files: tuple[Path, ...]
    found: Found
    share: int = 1  # loops in the same files
    extent: Extent | None = None


@dataclass(frozen=True)
class Named:
    """A loop with a tag of its own, and its records in the order of time."""

    tag: str
    parts: tuple[Part, ...]
    notes: tuple[str, ...] = ()


def parts_of(units: Sequence[Unit]) -> list[Part]:
    """Every loop of every unit."""
    return [Part(found.files or unit.files, found, len(unit.loops)) for unit in units for found in unit.loops]


def named(
    parts: Sequence[Part], root: Path, extent: Callable[[Sequence[Path]], Extent | None]
) -> tuple[list[Named], list[Unread]]:
    """Loops with tags of their own, and what could not be told apart.

    Parameters
    ----------
    parts : sequence of Part
    root : Path
        Folders of a name begin below it.
    extent : callable
        Files -> from when to when they were recorded; asked only where several have the same tag.

    Notes
    -----
    Records of one tag at different times are one loop, and in one folder those of which each goes on behind the one
    before it; the same file twice counts once. Records that are not dated, or
    are of the same time, are different loops: they are called by their files, and these with their folders where their
    names repeat. What is then still the same is left out, and said.
    """
    digest = cache(_digest)  # a file with many loops is asked for each of them
    by_tag: dict[str, list[Part]] = {}
    for part in parts:
        by_tag.setdefault(label(_tag(part)), []).append(part)
    found: list[Named] = []
    out: list[Unread] = []
    for tag, same in by_tag.items():
        different, copies = _without_copies(same, digest)
        out += [Unread(str(copy), f"the same as {first}", failed=False) for copy, first in copies]
        found += _one_loop(tag, different, extent) or _apart(tag, different, root)
    counts: dict[str, list[Named]] = {}
    for one in found:
        counts.setdefault(one.tag, []).append(one)
    out += [_twice(tag, ones) for tag, ones in counts.items() if len(ones) > 1]
    return [one for one in found if len(counts[one.tag]) == 1], out


def _tag(part: Part) -> str:
    """What the loop calls itself: in the file, by the file's name where that is a tag, by its columns, by the name."""
    if part.found.name:
        return part.found.tag
    name = _name(part)
    bare = _DATED.sub("", without_run(name)) or name
    if loop_type(bare) or same_tag(bare, part.found.tag) or not part.found.tag:
        run = bare if loop_type(bare) else _DATED.sub("", name)
        return run or name
    return part.found.tag


def _name(part: Part) -> str:
    """Of the file; of several the tag they share, or their folder."""
    return path_stem(part.files[0]) if len(part.files) == 1 else part.found.tag or part.files[0].absolute().parent.name


def _without_copies(parts: Sequence[Part], digest: Callable[[Path], str]) -> tuple[list[Part], list[tuple[Path, Path]]]:
    sizes = Counter(part.files[0].stat().st_size for part in parts)
    if not parts or max(sizes.values()) == 1:
        return list(parts), []
    seen: dict[tuple[object, ...], Part] = {}
    copies: list[tuple[Path, Path]] = []
    for part in parts:
        first = seen.setdefault((part.found.name, *(digest(path) for path in part.files)), part)
        if first is not part and first.files != part.files:
            copies.append((part.files[0], first.files[0]))
    return list(seen.values()), copies


def _digest(path: Path) -> str:
    with path.open("rb") as stream:
        return file_digest(stream, "sha256").hexdigest()


def _one_loop(tag: str, parts: list[Part], extent: Callable[[Sequence[Path]], Extent | None]) -> list[Named]:
    """All parts as one loop; empty where they are not dated, or of the same time."""
    if len(parts) == 1:
        return [Named(tag, tuple(parts), _said(tag, parts[0]))]
    dated = [(one, part) for part in parts if (one := extent(part.files)) is not None]
    if len(dated) < len(parts):
        return []
    dated.sort(key=lambda pair: pair[0])
    if not all(_follows(before, later) for before, later in pairwise(dated)):
        return []
    first, last = dated[0][0].first, dated[-1][0].last
    note = f"{len(parts)} records, {first:%Y-%m-%d %H:%M} to {last:%Y-%m-%d %H:%M}, are of one tag: one loop."
    return [Named(tag, tuple(replace(part, extent=one) for one, part in dated), (note,))]


def _follows(before: tuple[Extent, Part], later: tuple[Extent, Part]) -> bool:
    """Whether a record goes on behind another; in one folder it may repeat the end of it, as exports do."""
    (first, one), (second, other) = before, later
    if second.first > first.last:
        return True
    same_folder = one.files[0].parent == other.files[0].parent
    return same_folder and second.first > first.first and second.last > first.last


def _said(tag: str, part: Part) -> tuple[str, ...]:
    name = _name(part)
    if part.found.name or name == tag:
        return ()
    if tag == part.found.tag:
        return (f"The tag is that of the columns; the file is called {name!r}.",)
    return (f"The tag is the name of the file, {name!r}, without its end.",)


def _apart(tag: str, parts: Sequence[Part], root: Path) -> list[Named]:
    """Each as a loop by itself: by the name of its file, and its folder where that repeats."""
    inside = any(part.found.name for part in parts)
    names = [tag if inside else _name(part) for part in parts]
    if len(set(names)) < len(names):
        names = [_in_folder(part.files[0], root, name) for part, name in zip(parts, names, strict=True)]
    note = f"{len(parts)} records are of {tag!r} and not of different times: each counts as a loop."
    return [Named(name, (part,), (note,)) for name, part in zip(names, parts, strict=True)]


def _in_folder(path: Path, root: Path, name: str) -> str:
    folder = path.parent.relative_to(root).as_posix() if path.is_relative_to(root) else path.parent.name
    return name if folder in ("", ".") else f"{folder}/{name}"


def _twice(tag: str, ones: Sequence[Named]) -> Unread:
    files = [str(part.files[0]) for one in ones for part in one.parts]
    more = f" and {len(files) - SHOWN} more" if len(files) > SHOWN else ""
    remedy = "name each in a loop list (tag, file), or leave one out"
    return Unread(" and ".join(files[:SHOWN]) + more, f"expected loops of different tags, got {tag!r} twice; {remedy}")


def area_of(part: Part, root: Path, tag: str) -> tuple[str, str]:
    """Part of the plant and a word on where it is from: the partition, the folder, what stands before the letters.

    Examples
    --------
    >>> area_of(Part((Path("plant/unit 2/FIC101.csv"),), Found()), Path("plant"), "FIC101")
    ('unit 2', 'folder')
    >>> area_of(Part((Path("plant/2411FIC20102.csv"),), Found()), Path("plant"), "2411FIC20102")
    ('2411', 'tag')
    """
    if part.found.area:
        return part.found.area, "partition"
    folder = next((one for one in part.files[0].parents if "=" not in one.name), root)
    if folder != root and folder.is_relative_to(root):
        return folder.relative_to(root).as_posix(), "folder"
    parsed = isa(tag) if loop_type(tag) else None
    before = parsed[0].strip(" -_./:") if parsed is not None else ""
    return before, "tag" if before else ""
