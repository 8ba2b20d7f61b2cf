"""What the system refuses to write, in the words of the house."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from lostmotion.errors import FileAccessError

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
TAKEN = (errno.EEXIST, errno.ENOTEMPTY)  # a file, or a folder with files in it, that came just before


@contextmanager
def write_errors(target: Path, size: int | None = None) -> Iterator[None]:
    """Raise FileAccessError, with the next step, for what the system refuses inside.

    Parameters
    ----------
    target : Path
        What is written.
    size : int, optional
        Bytes that are written.
    """
    try:
        yield
    except FileAccessError:
        raise
    except (OSError, ValueError) as error:
        name, number = repr(str(target)[:200]), getattr(error, "errno", None)
        reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
        if number in TAKEN:
            said = f"expected a new file, got {str(target)!r}, which exists; use force=True to replace it"
        elif number in FULL:
            room = "room" if size is None else f"room for {size} bytes"
            said = f"expected {room} to write {name}, got {reason!r}; free some, or choose another disk"
        else:
            said = f"expected a folder that can be written, got {reason!r} for {name}; choose another path"
        raise FileAccessError(said) from error
