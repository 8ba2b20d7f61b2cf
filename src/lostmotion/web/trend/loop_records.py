"""Records of the loops of a plant, read again from where the audit found them, by processes that can be killed."""

from __future__ import annotations

import hashlib
import shutil
import tempfile
import threading
import time
import weakref
from dataclasses import dataclass, replace
from pathlib import Path

from lostmotion.addresses import absolute, is_url
from lostmotion.audit.audit_run import as_loop
from lostmotion.errors import LostMotionError, one_line
from lostmotion.files.limits import most_bytes
from lostmotion.plant import PlantLoop, PlantSource, open_plant
from lostmotion.plant.files_source import FilesSource
from lostmotion.store.store import Store
from lostmotion.web.kept_record import keep_record
from lostmotion.web.worker.work import NICER, ROOM
from lostmotion.workers import Background, Outcome, WorkerDiedError, WorkerLateError

AT_ONCE = 2  # readers
SECONDS = 120.0  # of one
AGAIN = 30.0  # s after which what failed is tried once more
MOST_BYTES = 2_000_000_000  # of all that is kept; the oldest goes first


@dataclass(frozen=True)
class Read:
    """A loop of a run.

    Attributes
    ----------
    store : str
    run : int
    source : str
        What was audited, as the run says.
    tag : str
    """

    store: str
    run: int
    source: str
    tag: str

    @property
    def name(self) -> str:
        """Of its folder."""
        return hashlib.sha256("\0".join([self.store, str(self.run), self.source, self.tag]).encode()).hexdigest()[:24]


class LoopRecords:
    """Reads at most two loops at a time; what was read stays until the page ends, or others need the room."""

    def __init__(self) -> None:
        self._home = Path(tempfile.mkdtemp(prefix="lostmotion-loops-"))
        weakref.finalize(self, shutil.rmtree, self._home, ignore_errors=True)  # at the end of the page, at the latest
        self._at_work: dict[str, Background[str]] = {}
        self._failed: dict[str, tuple[str, float]] = {}
        self._lock = threading.Lock()

    def ask(self, read: Read) -> Path | str | None:
        """Folder of the columns; why there are none; None: they are being read, ask again."""
        folder = self._home / read.name
        with self._lock:
            for name in list(self._at_work):
                self._inspect(name)
            if folder.is_dir() and read.name not in self._at_work:
                return folder
            why, when = self._failed.get(read.name, ("", 0.0))
            if why and time.monotonic() - when < AGAIN:
                return why
            if not is_url(read.source) and not Path(read.source).exists():
                return f"The data of the run are not here any more: {one_line(read.source)}."
            self._begin(read)
            return None

    def _inspect(self, name: str) -> None:
        outcome = self._at_work[name].outcome
        if outcome is not None:
            del self._at_work[name]
            if why := _why_none(outcome):
                self._failed[name] = f"The data of the loop cannot be read: {why}.", time.monotonic()

    def _begin(self, read: Read) -> None:
        if read.name in self._at_work or len(self._at_work) >= AT_ONCE:
            return
        self._make_room()
        there = replace(read, store=absolute(read.store), source=absolute(read.source))
        self._at_work[read.name] = Background(
            read_again, there, self._home / read.name, seconds=SECONDS, memory=most_bytes() + ROOM, nicer=NICER
        )

    def _make_room(self) -> None:
        folders = sorted((one for one in self._home.iterdir() if one.is_dir()), key=_age)
        sizes = [sum(file.stat().st_size for file in folder.iterdir()) for folder in folders]
        while folders and sum(sizes) > MOST_BYTES:
            shutil.rmtree(folders.pop(0), ignore_errors=True)
            sizes.pop(0)


def _why_none(outcome: Outcome) -> str:
    """Why there is no record; empty: there is one."""
    if outcome.error is None:
        return str(outcome.value)
    if isinstance(outcome.error, WorkerLateError):
        return "it takes too long"
    if isinstance(outcome.error, WorkerDiedError | MemoryError):
        return "its reader died; most often memory ran out"
    return one_line(f"{outcome.error}")


def read_again(read: Read, folder: Path) -> str:
    """Read a loop and keep its columns in a folder; why not, in a line."""
    try:
        with Store(read.store, write=False) as store:
            run = next(run for run in store.runs() if run.number == read.run)
            loop = store.loop(read.tag)
        assert loop is not None  # noqa: S101  the page has just seen it
        wanted = as_loop(loop)
        if wanted.where and Path(read.source).is_dir():  # of 26,000 files one is looked at
            plant: PlantSource = FilesSource((Path(read.source),))
            wishes: tuple[PlantLoop, ...] = (wanted,)
        else:
            plant = open_plant(read.source, [wanted])
            wishes = plant.loops()
        found = next(iter(plant.read(wishes, run.since, run.until)), None)
        if found is None:
            return "there is no such loop in them any more"
        if isinstance(found[1], LostMotionError):
            return one_line(str(found[1]))
        keep_record(folder, found[1])
    except LostMotionError as error:
        return one_line(str(error))
    return ""


def _age(folder: Path) -> float:
    return folder.stat().st_mtime
