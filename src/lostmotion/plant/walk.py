"""A folder, a pattern or a list of paths -> the files, and which of them are one table in pieces."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from glob import glob
from pathlib import Path

from lostmotion.errors import FileAccessError
from lostmotion.files.dataset import ENDINGS as PARQUET
from lostmotion.files.paths import is_file, is_folder, is_other, is_pattern

_NUMBERED = re.compile(r"(part|chunk|piece|batch)[-_. ]?\d+([-_.].*)?", re.IGNORECASE)


def files_below(sources: Sequence[Path]) -> tuple[Path, ...]:
    """Files of paths, in the order of their names; of a folder all below it, hidden ones and hidden folders left out.

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
        fits = [Path(one) for one in sorted(glob(str(source), recursive=True))]  # noqa: PTH207  patterns in folders too
        inside = [file for one in fits for file in (_walked(one) if one.is_dir() else (one,))]
        return _some(inside, f"none like {str(source)!r}")
    if not is_file(source) and not is_other(source):
        error = f"expected files with tables, got no such file {str(source)!r}; check the path"
        raise FileAccessError(error) from FileNotFoundError(str(source))
    return [source]


def _walked(folder: Path) -> Iterator[Path]:
    for inside, folders, names in os.walk(folder):
        folders[:] = [name for name in folders if not name.startswith(".")]
        yield from (Path(inside, name) for name in names if not name.startswith("."))


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
