"""What a path is: a file, a folder or a pattern."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any


def is_path(source: Any) -> bool:
    """Whether a source is a path or an address; a list of them is none."""
    return isinstance(source, str | os.PathLike)


def is_pattern(path: Path) -> bool:
    """Whether a path stands for several files: it has * or ? in it, or [..], and there is no file of that name."""
    return bool(re.search(r"[*?\[]", str(path))) and not _is(path.exists)


def is_folder(path: Path) -> bool:
    """Whether a path is a folder; one that no system can have is none."""
    return _is(path.is_dir)


def is_file(path: Path) -> bool:
    """Whether a path is a regular file: what is a pipe or a device is none, and would be waited for."""
    return _is(path.is_file)


def is_other(path: Path) -> bool:
    """Whether something is there that is neither a file nor a folder."""
    return _is(path.exists) and not is_file(path) and not is_folder(path)


def _is(asked: Callable[[], bool]) -> bool:
    try:
        return asked()
    except (OSError, ValueError):  # a name that is too long, or has a zero in it
        return False
