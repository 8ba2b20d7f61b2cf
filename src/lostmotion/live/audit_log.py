"""Log of everything that a supervisor has asked of a PLC: JSON lines, on the disk before anything is sent."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from lostmotion.errors import FileAccessError


def _now() -> datetime:
    return datetime.now(UTC)


class AuditLog:
    """A file that only grows: one line of JSON an event, synced to the disk before :meth:`line` returns.

    Parameters
    ----------
    path : path-like
        Made where it is not there; a link is refused.
    now : callable, optional
        Wall clock for the stamps. Nothing is decided by it.
    """

    def __init__(self, path: str | os.PathLike[str], now: Callable[[], datetime] = _now) -> None:
        self.path = Path(path)
        self._now = now

    def line(self, *, who: str, block: str, event: str, answer: str, **facts: Any) -> dict[str, Any]:
        """Append a line and give it back.

        Raises
        ------
        FileAccessError
            It cannot be written: then nothing may be sent.
        """
        said = {"when": self._now().isoformat(), "who": who, "block": block, "event": event, **facts, "answer": answer}
        data = json.dumps(said, allow_nan=False, separators=(", ", ": ")).encode() + b"\n"
        flags = os.O_RDWR | os.O_APPEND | os.O_CREAT
        flags |= getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)  # POSIX; Windows
        try:
            number = os.open(self.path, flags, 0o640)
            try:
                self._append(number, data)
            finally:
                os.close(number)
        except OSError as error:
            reason = error.strerror or str(error)
            raise FileAccessError(f"expected a log at {self.path}, got: {reason}; nothing is sent without") from error
        return said

    @staticmethod
    def _append(number: int, data: bytes) -> None:
        """One write, behind an end of line where a loss of power has left half a line."""
        size = os.fstat(number).st_size
        if size:
            os.lseek(number, size - 1, os.SEEK_SET)
            if os.read(number, 1) != b"\n":
                data = b"\n" + data
        if os.write(number, data) != len(data):
            raise OSError("the disk is full")
        os.fsync(number)


def read_log(path: str | os.PathLike[str]) -> list[Mapping[str, Any]]:
    """Lines of a log that are whole."""
    lines = []
    for text in Path(path).read_text(encoding="utf-8").splitlines():
        try:
            lines.append(json.loads(text))
        except ValueError:  # half a line, from a loss of power
            continue
    return lines
