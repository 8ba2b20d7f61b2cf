"""A folder, a pattern or a list of paths -> the files, and which of them are one table in pieces."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from lostmotion.errors import FileAccessError
from lostmotion.files.dataset import ENDINGS as PARQUET
from lostmotion.files.paths import fitting, is_file, is_folder, is_link, is_other, is_pattern

_NUMBERED = re.compile(r"(part|chunk|piece|batch)[-_. ]?\d+([-_.].*)?", re.IGNORECASE)


def files_below(sources: Sequence[Path]) -> tuple[Path, ...]:
    """Files of paths, in the order of their names; of a folder all below it, hidden ones and hidden folders left out.

    What stands among them and can be no file has a reason in :func:`no_file`.

    Raises
    ------
    FileAccessError
        No such file, nothing in a folder, or nothing fits a pattern.
    """
    found = [file for source in sources for file in _files_of(source)]
    return tuple(dict.fromkeys(found))


def _files_of(source: Path) -> list[Path]:
    if is_folder(source):
        return _some(sorted(_walked(source), key=_by_folders), f"none in the folder {str(source)!r}")
    if is_pattern(source):
        inside = [
            file
            for one in fitting(source)
            for file in (_walked(one) if is_folder(one) and not is_link(one) else (one,))
        ]
        return _some(inside, f"none like {str(source)!r}")
    if not is_file(source) and not is_other(source):
        error = f"expected files with tables, got no such file {str(source)!r}; check the path"
        raise FileAccessError(error) from FileNotFoundError(str(source))
    return [source]


def no_file(path: Path) -> str:
    """Return why a path is no file that can be read; empty where it is one.

    Links to folders are not followed: two that lead in a circle would have no end.
    """
    if is_file(path):
        return ""
    if is_link(path):
        return "a link to a folder, which is not followed" if is_folder(path) else "a link that leads to no file"
    if is_folder(path):
        return "a folder that cannot be listed"
    return "no file: a pipe, a socket or a device" if is_other(path) else "it is gone, or its path is too long"


def given_places(sources: Sequence[Path]) -> tuple[Path, ...]:
    """Folders and files that a person has named, links resolved; of a pattern the folder that it is spelled out to."""
    return tuple(_fixed(source).resolve() for source in sources)


def leads_out(path: Path, places: Sequence[Path]) -> str:
    """Return why a path that others have named is not read; empty where it lies in a place that was given.

    A loop list and a folder come from others: what they name is read, and quoted in reports where it is no table. So
    they reach only what was given to the command; who wants more gives it, too.
    """
    real = path.resolve()
    if any(real.is_relative_to(place) for place in places):
        return ""
    return f"it leads out of what was given, to {str(real)!r}; give its folder, too"


def _fixed(source: Path) -> Path:
    while is_pattern(source):
        source = source.parent
    return source


def _walked(folder: Path) -> Iterator[Path]:
    """Yield all below a folder that is no folder itself, and folders that cannot be listed; of any depth."""
    waiting = [folder]
    while waiting:
        inside = waiting.pop()
        try:
            with os.scandir(inside) as entries:
                seen = [entry for entry in entries if not entry.name.startswith(".")]
        except OSError:
            yield inside
            continue
        folders = {entry.name for entry in seen if entry.is_dir(follow_symlinks=False)}
        waiting += [inside / name for name in folders]
        yield from (inside / entry.name for entry in seen if entry.name not in folders)


def _by_folders(path: Path) -> tuple[str, ...]:
    return path.parts


def _some(found: list[Path], none: str) -> list[Path]:
    if not found:
        raise FileAccessError(f"expected files with tables, got {none}; check the path") from FileNotFoundError(none)
    return found


def in_pieces(paths: Sequence[Path]) -> dict[Path, tuple[Path, ...]]:
    """Parquet files of one table in pieces, by their folder: partitions (area=A/..), or part-0, part-1 ..

    Examples
    --------
    >>> in_pieces([Path("p/tag=F1/0.parquet"), Path("p/tag=F2/0.parquet"), Path("a.parquet")])[Path("p")][0].as_posix()
    'p/tag=F1/0.parquet'
    """
    found: dict[Path, list[Path]] = {}
    for path in paths:
        if path.suffix.lower() in PARQUET:
            top = _above_partitions(path)
            if top is not None or _NUMBERED.fullmatch(path.stem):
                found.setdefault(path.parent if top is None else top, []).append(path)
    return {
        folder: tuple(pieces) for folder, pieces in found.items() if len(pieces) > 1 or partition_of(folder, pieces[0])
    }


def _above_partitions(path: Path) -> Path | None:
    """Folder that the first partition of a path lies in; None: there is none."""
    for place, part in enumerate(path.parts[:-1]):
        if "=" in part:
            return Path(*path.parts[:place])
    return None


def partition_of(folder: Path, piece: Path) -> dict[str, str]:
    """Keys and values of the partitions of a piece.

    Examples
    --------
    >>> partition_of(Path("p"), Path("p/area=A/tag=F1/0.parquet"))
    {'area': 'A', 'tag': 'F1'}
    """
    parts = piece.relative_to(folder).parts[:-1]
    return {key: value for key, _, value in (part.partition("=") for part in parts if "=" in part)}
