"""What a monitor that runs elsewhere has written: JSON lines of one loop or many, a state, or a folder of states."""

from __future__ import annotations

import json
import os
import threading
import time
from collections import deque
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from lostmotion.errors import LostMotionError, one_line
from lostmotion.files.schema import parsed
from lostmotion.web.monitors.loop_log import NOTES, LoopLog
from lostmotion.web.monitors.said import Said, is_small, remembered, words_of
from lostmotion.web.monitors.state_file import is_state, state_log

LONGEST = 1 << 16  # bytes of a line: a report has 3,000
LONGEST_TAG = 200  # characters
PIECE = 1 << 22  # bytes that are read at once
MOST_LOOPS = 2000  # of one file or folder
LINK = ("lost", "connected")  # kinds of messages about the link, whose tag is empty


class Watched:
    """What was written at one place. It is looked at when it is asked for; several threads may ask.

    Parameters
    ----------
    path : str
        JSON lines of ``lostmotion online`` or ``live``, the file of a `--state`, or a folder of them.
    """

    def __init__(self, path: str) -> None:
        self.path = Path(path)
        self._place: Lines | State | States | None = None
        self._lock = threading.Lock()
        self._before: tuple[Said, ...] = ()
        self._version = 0

    def look(self) -> tuple[Said, ...]:
        """What is said of each loop by now; at least one thing."""
        with self._lock:
            trouble, found = "", self._before
            try:
                found = self._found(time.time())
            except OSError as error:
                trouble = f"{self.path.name}: {(error.strerror or str(error)).lower()}."
            except LostMotionError as error:
                trouble = one_line(str(error))
            known = found or (Said(self.path.name),)
            self._before = tuple(self._dated(one, trouble) for one in known)
            return self._before

    def _found(self, now: float) -> tuple[Said, ...]:
        kind = States if self.path.is_dir() else State if is_state(self.path) else Lines
        if type(self._place) is not kind:
            self._place = kind(self.path)
        return self._place.look(now)

    def _dated(self, said: Said, trouble: str) -> Said:
        """With a version that grows where anything else of it has changed; a state of silence counts, too."""
        before = next((one for one in self._before if one.tag == said.tag), None)
        made = replace(said, trouble=trouble or said.trouble, version=0)
        if before is not None and replace(before, version=0, lines=made.lines) == made:
            return replace(made, version=before.version)
        self._version += 1
        return replace(made, version=self._version)


class Lines:
    """JSON lines, as they come; a file that was cut or replaced is read anew.

    Parameters
    ----------
    path : Path
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._seen: tuple[int, int, int] | None = None
        self._forget()

    def _forget(self) -> None:
        self._offset, self._rest = 0, b""
        self._lines = self._bad = 0
        self._logs: dict[str, LoopLog] = {}
        self._link = ""
        self._notes: deque[Mapping[str, Any]] = deque(maxlen=NOTES)

    def look(self, now: float) -> tuple[Said, ...]:
        """What is said of each loop."""
        facts = self._path.stat()
        seen = (facts.st_ino, facts.st_size, facts.st_mtime_ns)
        if seen != self._seen:
            self._follow(facts)
            self._seen = seen
        own: dict[str, Any] = {"lines": self._lines, "bad": self._bad + (len(self._rest) > LONGEST)}
        notes = tuple(reversed(self._notes))
        if self._logs:
            return tuple(log.said(now, self._link, notes, **own) for log in self._logs.values())
        return (Said(self._path.name, link=self._link, notes=notes, **own),)

    def _follow(self, facts: os.stat_result) -> None:
        another = self._seen is not None and (facts.st_ino != self._seen[0] or facts.st_size < self._offset)
        if another:
            self._forget()
        first = self._offset == 0
        with self._path.open("rb") as file:
            file.seek(self._offset)
            while piece := file.read(PIECE):
                self._offset += len(piece)
                self._take(piece, facts.st_mtime)
        if first:
            told = [log.told for log in self._logs.values() if log.told is not None]
            for log in self._logs.values():
                log.settle(facts.st_mtime, max(told, default=None))

    def _take(self, piece: bytes, by: float) -> None:
        *whole, self._rest = (self._rest + piece).split(b"\n")
        self._rest = self._rest[: LONGEST + 1]  # of a longer line, which is bad already, the end is only waited for
        for line in whole:
            if line.strip():
                self._lines += 1
                self._bad += not self._hear(line, by)

    def _hear(self, line: bytes, by: float) -> bool:
        try:
            message = parsed(line, LONGEST)
            json.dumps(message, ensure_ascii=False).encode()  # halves of characters can be shown nowhere
        except ValueError:
            return False
        if not isinstance(message, dict) or not is_small(message):
            return False
        tag, kind = message.get("tag", ""), message.get("kind")
        if not isinstance(tag, str) or len(tag) > LONGEST_TAG:
            return False
        if not tag and kind in LINK:
            self._link = words_of(message, "message") or "lost" if kind == "lost" else ""
            self._notes.append(remembered(message))
            return True
        if not tag and kind == "note" and "tag" in message:
            self._notes.append(remembered(message))
            return True
        if tag not in self._logs and len(self._logs) >= MOST_LOOPS:
            return False
        log = self._logs.get(tag) or LoopLog(self._path.name, tag)
        heard = log.hear(message, by)
        if heard:
            self._logs[tag] = log
        return heard


class State:
    """The state of one loop.

    Parameters
    ----------
    path : Path
    tag : str
        Of its loop; empty: not known.
    """

    def __init__(self, path: Path, tag: str = "") -> None:
        self._path, self._tag = path, tag
        self._seen: tuple[int, int, int] | None = None
        self._log: LoopLog | None = None

    def look(self, now: float) -> tuple[Said, ...]:
        """What it says."""
        facts = self._path.stat()
        seen = (facts.st_ino, facts.st_size, facts.st_mtime_ns)
        if seen != self._seen or self._log is None:
            self._log = state_log(self._path, self._tag, facts)
            self._seen = seen
        return (self._log.said(now),)


class States:
    """A folder with one state a loop, as ``lostmotion live --state`` keeps it: names are the tags.

    Parameters
    ----------
    path : Path
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._states: dict[str, State] = {}

    def look(self, now: float) -> tuple[Said, ...]:
        """What is said of each loop; one that cannot be read says why."""
        names = sorted(one.name for one in self._path.glob("*.state") if not one.name.startswith("."))[:MOST_LOOPS]
        for name in names:
            self._states.setdefault(name, State(self._path / name, unquote(name.removesuffix(".state"))))
        for name in set(self._states) - set(names):
            del self._states[name]
        found = tuple(self._said(name, now) for name in names)
        return found or (Said(self._path.name, trouble=f"{self._path.name}: no state is in this folder yet."),)

    def _said(self, name: str, now: float) -> Said:
        try:
            return self._states[name].look(now)[0]
        except (OSError, LostMotionError) as error:
            said = getattr(error, "strerror", None) or one_line(str(error))
            return Said(name, unquote(name.removesuffix(".state")), trouble=said)
