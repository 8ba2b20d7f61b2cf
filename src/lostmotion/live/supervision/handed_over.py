"""Requests of persons on their way to the process that writes: a file each, taken once or not at all.

The folder is the door: who can write there may ask. `live --write` puts a word into it that is new at each start; a
request carries that word, so that what was meant for an earlier start is never acted on. A request that nobody takes
in time is withdrawn by who made it, and one that is too old is not taken.
"""

from __future__ import annotations

import secrets
import stat
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lostmotion.errors import DataError, FileAccessError, GateError
from lostmotion.files.results import read_json, write_json
from lostmotion.files.schema import anything, checked, group, number, table, text
from lostmotion.files.tag_file import tag_file

OLDEST = 30.0  # s of the wall clock, both ways: a request is for now
SESSION = "live.json"
ENDING = ".request"
REQUEST = group(session=text(100), word=text(100), tag=text(1000), who=text(200), made=number(), fit=table(anything))
REMEDY = "use `lostmotion request`"


@dataclass(frozen=True)
class Asked:
    """What a person asks for.

    Attributes
    ----------
    tag : str
        Of the loop.
    who : str
        As said, with the owner of the file.
    word : str
        By which the answers in the log are found.
    fit : dict
        Result of ``identify --out``.
    why : str
        Why it cannot be asked for; empty where it can.
    """

    tag: str
    who: str
    word: str
    fit: dict[str, Any]
    why: str = ""


def refuse_open(folder: Path) -> None:
    """Raise FileAccessError where the folder is none, or anybody at all may write into it."""
    try:
        mode = folder.lstat().st_mode
    except OSError as error:
        raise FileAccessError(f"expected a folder for requests, got {folder}: {error.strerror}; make it") from error
    if not stat.S_ISDIR(mode):
        raise FileAccessError(f"expected a folder for requests, got {folder}, which is none; make one")
    if sys.platform != "win32" and mode & stat.S_IWOTH:
        raise FileAccessError(f"expected a folder that not everybody writes to, got {folder}; chmod o-w it")


class Inbox:
    """The door of `live --write`.

    Parameters
    ----------
    folder : Path
    tags : iterable of str
        Loops whose blocks may be asked.
    """

    def __init__(self, folder: Path, tags: Iterable[str]) -> None:
        refuse_open(folder)
        self.folder, self._tags = folder, tuple(tags)
        self._word = secrets.token_hex(16)

    @contextmanager
    def open(self) -> Iterator[list[str]]:
        """Let requests in; gives the names of those that were found, which are thrown away."""
        left = [path for path in self.folder.glob(f"*{ENDING}*") if path.name != SESSION]
        for path in left:
            with suppress(OSError):
                path.unlink()
        place = self.folder / SESSION
        write_json(place, {"session": self._word, "tags": list(self._tags)}, force=True)
        try:
            yield sorted(path.name for path in left)
        finally:
            with suppress(OSError):
                place.unlink()

    def take(self, tag: str) -> Asked | None:
        """The request for a loop, which is then gone; None where there is none.

        Raises
        ------
        DataError, FileAccessError
            What was there is no request.
        """
        path = self.folder / tag_file(tag, ENDING)
        mine = path.with_name(f"{path.name}.{secrets.token_hex(8)}")
        try:
            path.rename(mine)  # one takes it, or who made it takes it back
        except FileNotFoundError:
            return None
        try:
            owner = _owner(mine)
            said = checked(read_json(mine, "a request", REMEDY), REQUEST, "a request", REMEDY)
        finally:
            with suppress(OSError):
                mine.unlink()
        age, why = time.time() - said["made"], ""
        if said["session"] != self._word or said["tag"] != tag:
            why = "expected a request made for this start of live --write, got another; ask anew"
        elif not -OLDEST < age < OLDEST:
            why = f"expected a request not older than {OLDEST:g} s, got {age:.0f} s; ask anew"
        return Asked(tag, f"{said['who']} ({owner})", said["word"], said["fit"], why)


class Outbox:
    """The other side of the door: where a person asks.

    Raises
    ------
    GateError
        No `live --write` has opened it, or not for this loop.
    """

    def __init__(self, folder: Path, tag: str) -> None:
        refuse_open(folder)
        place = folder / SESSION
        if not place.exists():
            raise GateError.expected("lostmotion live --write at work on this plant", "none", "start it first")
        said = checked(read_json(place, "a start of live", "start it anew"), group(session=text(100), tags=anything),
                       "a start of live", "start it anew")  # fmt: skip
        if tag not in said["tags"]:
            raise GateError.expected(f"a loop out of {said['tags']}", tag, "only these have write = true")
        self._path, self._tag, self._session = folder / tag_file(tag, ENDING), tag, said["session"]
        self.word = secrets.token_hex(16)  # stands in the log beside the answer

    def hand_over(self, who: str, fit: dict[str, Any]) -> None:
        """Put the request in the door.

        Raises
        ------
        FileAccessError
            Another one is there, or the folder cannot be written.
        """
        said = {"session": self._session, "word": self.word, "tag": self._tag, "who": who}
        write_json(self._path, {**said, "made": time.time(), "fit": fit})

    def withdraw(self) -> bool:
        """Take it back; False where it has been taken."""
        try:
            self._path.unlink()
        except FileNotFoundError:
            return False
        return True


def _owner(path: Path) -> str:
    """Name of the user who made a file: the operating system says it, not the file."""
    found = path.lstat()
    if not stat.S_ISREG(found.st_mode):
        raise DataError.expected("a request in a file", "something else", REMEDY)
    if sys.platform == "win32":
        return "owner not known on Windows"
    try:
        return path.owner()
    except KeyError:  # nobody of this machine
        return f"user {found.st_uid}"
