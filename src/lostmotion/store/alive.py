"""Whether the coordinator of a run still lives: its heartbeat, and its process where it is on this machine."""

from __future__ import annotations

import os
import platform
import sys
import uuid
from datetime import datetime, timedelta
from pathlib import Path

BEAT = 10.0  # s between two beats of the heart
SILENT = 60.0  # s without one after which a coordinator is dead: five beats lost, or the writer's lock held that long


def coordinator() -> str:
    """Name of this process that no other one has: host, process, and a random number."""
    return f"{_host()} {os.getpid()} {uuid.uuid4().hex}"


def _host() -> str:
    return platform.node().replace(" ", "-") or "unknown"


def where(name: str) -> str:
    """Host and process of a coordinator, for messages."""
    host, process, _ = name.split(" ")
    return f"process {process} on {host}"


def lives(name: str, heartbeat: datetime | None, now: datetime) -> bool:
    """Whether a coordinator is at work.

    A heart that was silent for a minute is dead. A young beat is none either where its process is no more: what was
    killed on this machine is taken over at once.
    """
    if heartbeat is None or now - heartbeat > timedelta(seconds=SILENT):
        return False
    host, process, _ = name.split(" ")
    return host != _host() or _runs(int(process))


def _runs(process: int) -> bool:
    """Whether a process runs here; one that has ended and was not yet fetched by its parent does not."""
    if sys.platform == "win32":  # there the signal 0 ends a process
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:  # somebody else's
        return True
    try:
        state = Path(f"/proc/{process}/stat").read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
    except OSError:  # no such folder on this system
        return True
    return state[0] not in ("Z", "X")
