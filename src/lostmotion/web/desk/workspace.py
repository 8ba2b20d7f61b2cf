"""The folder of a page: a temporary one that goes with it, or one that is kept."""

from __future__ import annotations

import shutil
import tempfile
import time
from contextlib import suppress
from pathlib import Path

from lostmotion.errors import FileAccessError
from lostmotion.files.writer import lock_file

PREFIX = "lostmotion-page-"
LOCK = "desk"  # what the lock of a page stands for
STALE = 3600.0  # s: a page that has just begun may not have its lock yet


def workspace(keep: Path | None) -> Path:
    """Folder for its owner alone.

    Raises
    ------
    FileAccessError
        It cannot be made.
    """
    if keep is None:
        sweep(Path(tempfile.gettempdir()))
        return Path(tempfile.mkdtemp(prefix=PREFIX))
    try:
        keep.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        said = (error.strerror or str(error)).lower()
        raise FileAccessError(f"expected a folder to keep files in, got {str(keep)!r}: {said}") from None
    return keep.absolute()


def sweep(folder: Path) -> None:
    """Remove temporary folders of pages that were killed: old ones of ours that nobody works with."""
    for place in folder.glob(f"{PREFIX}*"):
        with suppress(OSError, FileAccessError):
            if place.is_symlink() or not place.is_dir() or time.time() - place.stat().st_mtime < STALE:
                continue
            with lock_file(place / LOCK):  # another user's cannot be locked
                shutil.rmtree(place, ignore_errors=True)
            shutil.rmtree(place)  # Windows keeps what is open: the lock
