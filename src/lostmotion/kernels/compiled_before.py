"""What Numba compiled from older sources is forgotten.

Numba keeps compiled kernels beside their sources, each until its own file changes; what it calls is compiled into it.
So in a checkout where one file changes, callers in other files would go on with what it was before.
"""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

STAMP = "kernels.stamp"


def forget_stale(folder: Path) -> bool:
    """Remove Numba's indices below `folder` unless all its sources are as they were when it was last asked.

    Returns whether it did. Where the folder can't be written nothing is done: Numba keeps its indices elsewhere then,
    and an installation changes as a whole.
    """
    stamp, now = folder / "__pycache__" / STAMP, _stamp_of(folder)
    try:
        if stamp.is_file() and stamp.read_text(encoding="ascii") == now:
            return False
        stamp.parent.mkdir(exist_ok=True)
        for index in folder.rglob("*.nbi"):
            index.unlink(missing_ok=True)
        own = stamp.with_suffix(f".{os.getpid()}")  # another process may be here too: whole, or not there
        own.write_text(now, encoding="ascii")
        own.replace(stamp)
    except OSError:
        return False
    return True


def _stamp_of(folder: Path) -> str:
    """Of names, sizes and times of all sources: what Numba looks at, too, but of one file."""
    facts = ((path.relative_to(folder).as_posix(), path.stat()) for path in sorted(folder.rglob("*.py")))
    lines = (f"{name} {fact.st_size} {fact.st_mtime_ns}\n" for name, fact in facts)
    return hashlib.sha256("".join(lines).encode()).hexdigest()
