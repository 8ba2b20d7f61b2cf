"""Records of the loops of a plant, read again from where the audit found them, by processes that can be killed."""

from __future__ import annotations

import hashlib
import multiprocessing
import shutil
import tempfile
import threading
import time
import weakref
from dataclasses import dataclass
from multiprocessing.process import BaseProcess
from pathlib import Path

from lostmotion.addresses import is_url
from lostmotion.audit.audit_run import as_loop
from lostmotion.errors import LostMotionError, one_line
from lostmotion.files.writer import write_bytes
from lostmotion.plant import PlantLoop, PlantSource, open_plant
from lostmotion.plant.files_source import FilesSource
from lostmotion.store.store import Store
from lostmotion.web.kept_record import keep_record
from lostmotion.web.worker.work import limit

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
        self._home = tempfile.mkdtemp(prefix="lostmotion-loops-")
        weakref.finalize(self, shutil.rmtree, self._home, ignore_errors=True)  # at the end of the page, at the latest
        self._at_work: dict[str, tuple[BaseProcess, float]] = {}
        self._failed: dict[str, tuple[str, float]] = {}
        self._lock = threading.Lock()

    def ask(self, read: Read) -> Path | str | None:
        """Folder of the columns; why there are none; None: they are being read, ask again."""
        folder = Path(self._home) / read.name
        with self._lock:
            if folder.is_dir():
                self._at_work.pop(read.name, None)
                return folder
            why, when = self._failed.get(read.name, ("", 0.0))
            if why and time.monotonic() - when < AGAIN:
                return why
            if read.name in self._at_work:
                return self._look(read.name)
            if not is_url(read.source) and not Path(read.source).exists():
                return f"The data of the run are not here any more: {one_line(read.source)}."
            self._begin(read)
            return None

    def _look(self, name: str) -> str | None:
        process, since = self._at_work[name]
        late = time.monotonic() - since > SECONDS
        if process.is_alive() and not late:
            return None
        if late:
            process.kill()
        process.join()
        del self._at_work[name]
        home = Path(self._home)
        if (home / name).is_dir():
            return None  # ready since it was looked for; the next question finds it
        said = home / f"{name}.txt"
        why = said.read_text(encoding="utf-8") if said.is_file() else "its reader died; most often memory ran out"
        why = f"The data of the loop cannot be read: {'it takes too long' if late else why}."
        self._failed[name] = why, time.monotonic()
        return why

    def _begin(self, read: Read) -> None:
        if sum(process.is_alive() for process, _ in self._at_work.values()) >= AT_ONCE:
            return
        self._make_room()
        context = multiprocessing.get_context("spawn")
        process = context.Process(target=read_again, args=(read, self._home), daemon=True)
        process.start()
        self._at_work[read.name] = process, time.monotonic()

    def _make_room(self) -> None:
        folders = sorted((one for one in Path(self._home).iterdir() if one.is_dir()), key=_age)
        sizes = [sum(file.stat().st_size for file in folder.iterdir()) for folder in folders]
        while folders and sum(sizes) > MOST_BYTES:
            shutil.rmtree(folders.pop(0), ignore_errors=True)
            sizes.pop(0)


def read_again(read: Read, home: str) -> None:
    """Read a loop and keep its columns in a folder of `home`; why not, as a text beside where it would be."""
    limit()
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
            raise LostMotionError("there is no such loop in them any more")  # noqa: TRY301
        if isinstance(found[1], LostMotionError):
            raise found[1]
        keep_record(Path(home) / read.name, found[1])
    except LostMotionError as error:
        write_bytes(Path(home) / f"{read.name}.txt", one_line(str(error)).encode(), force=True)


def _age(folder: Path) -> float:
    return folder.stat().st_mtime
