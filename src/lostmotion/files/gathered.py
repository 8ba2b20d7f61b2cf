"""What a folder, a pattern or a list of paths stands for: files, and which of them belong to one record."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from lostmotion.addresses import is_url
from lostmotion.errors import FileAccessError, LostMotionError
from lostmotion.files.dataset import pieces_of
from lostmotion.files.frames import peeked
from lostmotion.files.one_tag import one_tag
from lostmotion.files.paths import fitting, is_file, is_folder, is_path, is_pattern

ENDINGS = (
    ".csv", ".txt", ".tsv", ".dat", ".asc", ".parquet", ".pq", ".feather", ".arrow", ".mat", ".xlsx", ".xls", ".xlsm",
    ".xlsb", ".gz", ".zip",
)  # fmt: skip
Group = Path | tuple[Path, ...]


def gathered(source: Any) -> tuple[Path, ...] | None:
    """Files of a folder, of a pattern such as ``FIC101_*.csv`` or of a list; None: one table, or no path.

    Parameters
    ----------
    source : path, list of paths, or anything
        Of a folder those files whose ending is one of data, hidden ones left out, in the order of their names.

    Raises
    ------
    FileAccessError
        Nothing in the folder, or nothing fits the pattern.

    Examples
    --------
    >>> gathered("FIC-101.csv") is None, gathered(["a.csv", "b.csv"])[1].name
    (True, 'b.csv')
    """
    if isinstance(source, list | tuple) and source and all(is_path(one) for one in source):
        return tuple(path for one in source for path in gathered(one) or (Path(one),))
    if not is_path(source) or is_url(source):
        return None
    path = Path(source)
    if pieces_of(path):
        return None
    if is_folder(path):
        inside = [one for one in path.iterdir() if one.is_file() and not one.name.startswith(".")]
        return _found([one for one in inside if one.suffix.lower() in ENDINGS], f"none in the folder {str(path)!r}")
    if is_pattern(path):
        return _found([one for one in fitting(path) if one.is_file()], f"none like {str(path)!r}")
    return None


def _found(paths: list[Path], none: str) -> tuple[Path, ...]:
    if not paths:
        raise FileAccessError(f"expected files with tables, got {none}; check the path") from FileNotFoundError(none)
    return tuple(sorted(paths))


def grouped(paths: Sequence[Path]) -> list[Group]:
    """Files of one tag each, together, where there are several; every other file by itself.

    Parameters
    ----------
    paths : sequence of Path
        In the order in which they are to be read.

    Notes
    -----
    Only the beginning of text files is read for it. A file that cannot be read is one by itself: reading it says why.
    """
    tags = [path for path in paths if holds_one_tag(path)] if len(paths) > 1 else []
    if len(tags) < 2:
        return list(paths)
    first = tags[0]
    return [tuple(tags) if path == first else path for path in paths if path == first or path not in tags]


def holds_one_tag(path: Path) -> bool:
    """Whether a file holds the values of one tag, and so no whole record; what is no regular file is not looked at."""
    if not is_file(path):  # a pipe would wait for whoever writes into it
        return False
    try:
        content = peeked(path)
    except (LostMotionError, OSError):
        return False
    return one_tag(content) is not None
