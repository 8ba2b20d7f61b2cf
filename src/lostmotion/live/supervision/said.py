"""An audit log whose lines are told as well: one file for all blocks of a plant, one line at a time."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Mapping
from typing import Any

from lostmotion.live.audit_log import AuditLog

Emit = Callable[[dict[str, Any]], None]


class ToldLog(AuditLog):
    """Log that tells each line when it is on the disk.

    Parameters
    ----------
    path : path-like
    tags : mapping
        Tag of the loop by the name of its block.
    emit : callable
        Takes each line as a message of kind "request".
    """

    def __init__(self, path: str | os.PathLike[str], tags: Mapping[str, str], emit: Emit) -> None:
        super().__init__(path)
        self._tags, self._emit, self._one = dict(tags), emit, threading.Lock()

    def line(self, *, who: str, block: str, event: str, answer: str, **facts: Any) -> dict[str, Any]:
        """Append a line, give it back, and tell it; see :meth:`AuditLog.line`."""
        with self._one:
            said = super().line(who=who, block=block, event=event, answer=answer, **facts)
        words = f"{block}: {event} by {who}: {answer}"
        self._emit({"tag": self._tags.get(block, ""), "kind": "request", **said, "message": words})
        return said
