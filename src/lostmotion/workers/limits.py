"""Limits of a process for itself: memory where the system knows such a limit, and a lower right to the processor."""

from __future__ import annotations

import os
import sys
from contextlib import suppress


def limit(memory: int = 0, nicer: int = 0) -> None:
    """Take no more memory, leave no core file, and give way to others.

    Parameters
    ----------
    memory : int
        Bytes of address space; 0: no limit. Windows has no such limit, macOS does not keep it.
    nicer : int
        Steps of lower priority.
    """
    if sys.platform == "win32":
        return
    import resource  # noqa: PLC0415  not on Windows

    with suppress(OSError):
        os.nice(nicer)
    with suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if memory:
            hard = resource.getrlimit(resource.RLIMIT_AS)[1]
            allowed = memory if hard == resource.RLIM_INFINITY else min(memory, hard)
            resource.setrlimit(resource.RLIMIT_AS, (allowed, allowed))
