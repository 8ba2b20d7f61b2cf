"""The desk of a page: a folder for dropped files and what was found in them, and the jobs that find it."""

from __future__ import annotations

import secrets
import shutil
import threading
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import IO, Any

from lostmotion.errors import FileAccessError, ParameterError
from lostmotion.files.gathered import gathered, grouped
from lostmotion.files.results import write_json
from lostmotion.files.writer import lock_file
from lostmotion.store.encoded import as_json
from lostmotion.web.desk.item import ABOUT, Item, clean_label, present
from lostmotion.web.desk.workspace import LOCK, workspace
from lostmotion.web.worker.jobs import Job, Jobs
from lostmotion.web.worker.task import DROPPED, EXPORT, RESULT, STUDY, Task, failure, keep_result

AT_ONCE = 20  # loops of one file that are diagnosed without being asked for
WRITES = {"read": RESULT, "study": STUDY, "block": EXPORT}


@dataclass(frozen=True)
class Limits:
    """What may be dropped.

    Attributes
    ----------
    file_bytes : int
        Of one file.
    files : int
        Dropped files altogether; the oldest goes when another one comes.
    all_bytes : int
        Of them and what was found in them.
    """

    file_bytes: int = 500_000_000
    files: int = 50
    all_bytes: int = 4_000_000_000


class Draft:
    """A file that is being dropped."""

    def __init__(self, folder: Path, most: int) -> None:
        self.folder, self.size, self._most = folder, 0, most
        self._stream: IO[bytes] = (folder / DROPPED).open("xb")

    def write(self, data: bytes | bytearray) -> None:
        """Next piece.

        Raises
        ------
        ParameterError
            The file is larger than one may be.
        """
        self.size += len(data)
        if self.size > self._most:
            raise too_large(self._most)
        try:
            self._stream.write(data)
        except OSError as error:
            raise FileAccessError(f"expected room for the file, got {error.strerror}; free some") from error

    def close(self) -> None:
        """Nothing more comes."""
        self._stream.close()

    def drop(self) -> None:
        """It is not wanted."""
        self.close()
        shutil.rmtree(self.folder, ignore_errors=True)


def too_large(most: int) -> ParameterError:
    """Error of a file that is larger than one may be."""
    return ParameterError.expected(
        f"a file of at most {most / 1e6:g} MB", "more", "cut the export, or open it by its path: lostmotion serve FILE"
    )


class Desk:
    """Workspace of a page.

    Parameters
    ----------
    keep : Path, optional
        Folder that stays; None: a temporary one, which :meth:`close` removes.
    files : sequence of str
        Files, folders and patterns that are opened where they are.
    limits : Limits
    jobs_seconds : float, optional
        Limit of one job; None: the usual one.

    Raises
    ------
    FileAccessError
        A file is not there; the folder cannot be written, or another page works with it.
    """

    def __init__(
        self,
        keep: Path | None = None,
        files: Sequence[str] = (),
        limits: Limits | None = None,
        jobs_seconds: float | None = None,
    ) -> None:
        self.limits = limits or Limits()
        opened = _opened(files)
        self.kept = keep is not None
        self.records = workspace(keep)
        self._locked = lock_file(self.records / LOCK)
        self._lock = threading.RLock()
        self._drafts: set[Path] = set()  # folders of what is being dropped
        self._items: dict[str, Item] = {item.id: item for item in present(self.records)}
        self.jobs = Jobs(self._ended) if jobs_seconds is None else Jobs(self._ended, jobs_seconds)
        known = {item.sources for item in self.items() if not item.dropped}
        self._given: set[str] = set()  # of the files that the page was started with
        for place, (label, sources) in enumerate(opened):
            if sources not in known:
                item = self._add(secrets.token_hex(8), label, sources, dropped=False)
                self._given.add(item.id)
                if place < AT_ONCE:
                    self.read(item)

    def close(self) -> None:
        """End what runs, and remove what is not kept."""
        self.jobs.close()
        self._locked.close()
        if not self.kept:
            shutil.rmtree(self.records, ignore_errors=True)

    def items(self) -> list[Item]:
        """Files, newest first; loops of a file are with :meth:`loops`."""
        with self._lock:
            found = [item for item in self._items.values() if not item.parent]
        return sorted(found, key=lambda item: item.came, reverse=True)

    def loops(self, item: Item) -> list[Item]:
        """Loops of a file with several, in their order."""
        with self._lock:
            return [one for one in self._items.values() if one.parent == item.id]

    def item(self, number: str) -> Item | None:
        """Item by its id; None: there is none."""
        with self._lock:
            return self._items.get(number)

    def draft(self) -> tuple[str, Draft]:
        """Id and file for something that is being dropped; the oldest goes where there are too many."""
        number = secrets.token_hex(8)
        folder = self.records / number
        with self._lock:
            self._make_room(self.limits.file_bytes)
            folder.mkdir(mode=0o700)
            self._drafts = {one for one in self._drafts if one.is_dir()} | {folder}
        return number, Draft(folder, self.limits.file_bytes)

    def dropped(self, number: str, draft: Draft, label: str) -> Item:
        """Item of what was dropped; its job is begun.

        Raises
        ------
        ParameterError
            Nothing came.
        """
        draft.close()
        if not draft.size:
            draft.drop()
            raise ParameterError.expected("a file with a record", "an empty one", "choose another")
        with self._lock:  # limits hold for all forms together: counted where a draft becomes an item
            self._drafts.discard(draft.folder)
            item = self._add(number, clean_label(label), (str(draft.folder / DROPPED),))
            self._make_room()
        self.read(item)
        return item

    def open(self, sources: Sequence[str], label: str, asked: Mapping[str, Any] | None = None) -> Item:
        """Item of files that stay where they are, once for the same files and settings; its job is begun.

        Parameters
        ----------
        sources : sequence of str
            Paths.
        label : str
            What people call it.
        asked : mapping
            Settings of :func:`lostmotion.read_loop`; a time column called "none" is none, as in a loop list.
        """
        known = {name: False if (name, one) == ("time", "none") else one for name, one in (asked or {}).items()}
        paths = tuple(str(Path(one).absolute()) for one in sources)
        with self._lock:
            later = [item for item in self.items() if not item.dropped and item.id not in self._given]
            same = [one for one in later if (one.sources, as_json(one.asked)) == (paths, as_json(known))]
            if same and self.state(same[0]) not in ("new", "failed"):
                return same[0]
            for item in [] if same else later[self.limits.files - 1 :]:
                self.remove(item)
            made = same or [self._add(secrets.token_hex(8), clean_label(label), paths, dropped=False, asked=known)]
            self.read(made[0])
        return made[0]

    def read(self, item: Item) -> Job:
        """Read, check and diagnose, from the beginning."""
        self.jobs.cancel_of({item.id})
        for place in item.folder.iterdir():
            if place.is_dir():
                shutil.rmtree(place, ignore_errors=True)
            elif place.name not in (ABOUT, DROPPED):
                place.unlink(missing_ok=True)
        return self.start(item, "read")

    def start(self, item: Item, kind: str, given: Mapping[str, Any] | None = None) -> Job:
        """Begin a job: "read", "study" (the way to a block), "block" (its code).

        An item has one job: the same one goes on, another one takes its place, so that nobody fills the row with it.
        """
        task = Task(kind, str(item.folder), item.sources, item.label, item.stem, dict(item.asked), dict(given or {}))
        with self._lock:
            known = self.jobs.open_job(item.id, asdict(task))
            if known is not None:
                return known
            self.jobs.cancel_of({item.id})
            (item.folder / WRITES[kind]).unlink(missing_ok=True)
            return self.jobs.submit(item.id, asdict(task))

    def change(self, item: Item, asked: Mapping[str, Any]) -> Job:
        """Read it with other settings; loops that were told apart before are told anew."""
        for one in self.loops(item):
            self.remove(one)
        changed = replace(item, asked=dict(asked))
        self._put(changed)
        return self.read(changed)

    def remove(self, item: Item) -> None:
        """Take it, and the loops of it, from the desk; files that were only opened stay where they are."""
        family = [item, *self.loops(item)]
        self.jobs.cancel_of({one.id for one in family})
        with self._lock:
            for one in family:
                self._items.pop(one.id, None)
        for one in family:
            shutil.rmtree(one.folder, ignore_errors=True)

    def state(self, item: Item) -> str:
        """How it stands: "waiting", "running", "failed", "done", "several" (loops), or "new" (nothing was done yet)."""
        job = self.jobs.of(item.id)
        if job is not None and job.open:
            return job.state
        brief = item.brief
        if brief is not None:
            return "failed" if brief["failed"] else "done"
        look = item.look
        if look is not None and look.get("loops"):
            return "several"
        return "new"

    def _add(
        self,
        number: str,
        label: str,
        sources: tuple[str, ...],
        dropped: bool = True,
        asked: Mapping[str, Any] | None = None,
        parent: str = "",
    ) -> Item:
        came = datetime.now(UTC).isoformat()
        folder = self.records / number
        folder.mkdir(mode=0o700, exist_ok=True)
        item = Item(number, folder, label, sources, dropped, came, dict(asked or {}), parent)
        self._put(item)
        return item

    def _put(self, item: Item) -> None:
        write_json(item.folder / ABOUT, item.about(), force=True)
        with self._lock:
            self._items[item.id] = item

    def _ended(self, job: Job, said: Mapping[str, Any]) -> None:
        """A job is over: why it died is its result; a file of several loops becomes one item for each."""
        item = self.item(job.item)
        if item is None:
            return
        if job.state == "died":
            _keep_death(item, job)
        loops = said.get("loops")
        if job.state != "done" or not isinstance(loops, list):
            return
        for place, loop in enumerate(loops):
            asked = {**item.asked, "loop": str(loop)}
            one = self._add(secrets.token_hex(8), item.label, item.sources, item.dropped, asked, item.id)
            if place < AT_ONCE:
                self.start(one, "read")

    def _make_room(self, more: int = 0) -> None:
        """Let the oldest go, but never the newest, until limits hold with so many more bytes."""
        dropped = [item for item in self.items() if item.dropped]
        sizes = [sum(_bytes(one.folder) for one in (item, *self.loops(item))) for item in dropped]
        used = sum(sizes) + sum(map(_bytes, self._drafts)) + more
        fewest = 0 if more else 1
        while len(dropped) > fewest and (len(dropped) > self.limits.files or used > self.limits.all_bytes):
            self.remove(dropped.pop())
            used -= sizes.pop()


def _keep_death(item: Item, job: Job) -> None:
    """Why a job died is its result."""
    result = {"error": failure(job.said)}
    if job.kind == "read":
        keep_result(item.folder, result)
    else:
        write_json(item.folder / WRITES[job.kind], result, force=True)


def _opened(files: Sequence[str]) -> list[tuple[str, tuple[str, ...]]]:
    """Label and paths of each record: files of one tag each are one together."""
    for file in files:
        if gathered(file) is None and not Path(file).exists():
            error = f"expected a file, got {file!r}, which is not there; check the path"
            raise FileAccessError(error) from FileNotFoundError(file)
    paths = list(dict.fromkeys(path.absolute() for file in files for path in (gathered(file) or (Path(file),))))
    groups = [one if isinstance(one, tuple) else (one,) for one in grouped(paths)]
    return [(clean_label(group[0].name), tuple(str(path) for path in group)) for group in groups]


def _bytes(folder: Path) -> int:
    """Size of a folder in which others write and delete."""
    total = 0
    for path in folder.rglob("*"):
        with suppress(OSError):
            total += path.stat().st_size if path.is_file() else 0
    return total
