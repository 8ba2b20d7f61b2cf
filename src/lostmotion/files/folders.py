"""Folders for what is written: made where they are named, and removed again where nothing came of it."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

MOST_NEW = 8  # folders of one path that are made: more are a mistake


def nearest(folder: Path) -> Path:
    """Folder or file at which a path begins to exist: the path itself, or what is above it."""
    place = folder.absolute()
    return next(one for one in (place, *place.parents) if os.path.lexists(one))


def depth(folder: Path) -> int:
    """Number of folders of a path that are not there."""
    return len(folder.absolute().parts) - len(nearest(folder).parts)


def make(folder: Path) -> None:
    """Make a folder and those above it, where they are not there.

    Raises
    ------
    OSError
        It cannot be made, or is too deep below what is there.
    """
    if depth(folder) > MOST_NEW:
        raise OSError(errno.ENAMETOOLONG, os.strerror(errno.ENAMETOOLONG))
    folder.mkdir(parents=True, exist_ok=True)


@contextmanager
def made(folder: Path) -> Iterator[None]:
    """Make a folder and those above it; after an error those that are new and empty are removed.

    Raises
    ------
    OSError
        It cannot be made.
    """
    new = [one for one in (folder, *folder.parents) if not os.path.lexists(one)]
    try:
        make(folder)
        yield
    except BaseException:
        for one in new:
            with suppress(OSError):
                one.rmdir()
        raise
