"""What a path is: a file, a folder or a pattern."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from glob import glob
from pathlib import Path
from typing import Any


def is_path(source: Any) -> bool:
    """Whether a source is a path or an address; a list of them is none."""
    return isinstance(source, str | os.PathLike)


def is_pattern(path: Path) -> bool:
    """Whether a path stands for several files: it has * or ? in it, or [..], and there is no file of that name."""
    return bool(re.search(r"[*?\[]", str(path))) and not _is(path.exists)


def fitting(pattern: Path) -> list[Path]:
    """Paths that fit a pattern, sorted; ``**`` stands for folders of any depth, and follows no links to them.

    Two links that lead in a circle would double the paths with each of forty levels.
    """
    parts = [part if part == "**" else re.sub(r"\*+", "*", part) for part in pattern.parts]
    try:
        if "**" not in parts:
            return sorted(Path(one) for one in glob(str(Path(*parts))))  # noqa: PTH207  a pattern in the folders too
        place = parts.index("**")
        tops = [(top, top.glob(str(Path(*parts[place:])))) for top in fitting(Path(*parts[:place]))]
        found = [(one, one.relative_to(top).parts) for top, inside in tops for one in inside]
    except ValueError:  # a zero in it
        return []
    return sorted(one for one, below in found if not any(part.startswith(".") for part in below))


def is_folder(path: Path) -> bool:
    """Whether a path is a folder; one that no system can have is none."""
    return _is(path.is_dir)


def is_file(path: Path) -> bool:
    """Whether a path is a regular file: what is a pipe or a device is none, and would be waited for."""
    return _is(path.is_file)


def is_link(path: Path) -> bool:
    """Whether a path is a symbolic link, to whatever."""
    return _is(path.is_symlink)


def is_other(path: Path) -> bool:
    """Whether something is there that is neither a file nor a folder."""
    return _is(path.exists) and not is_file(path) and not is_folder(path)


def _is(asked: Callable[[], bool]) -> bool:
    try:
        return asked()
    except (OSError, ValueError):  # a name that is too long, or has a zero in it
        return False
