"""Long work of a page: jobs in a row, done one after the other by a worker process, never by the page itself."""

from __future__ import annotations

import logging
import secrets
import threading
import time
from collections import OrderedDict, deque
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Any

from lostmotion.web.worker.handle import Worker
from lostmotion.workers import WorkerDiedError

SECONDS = 900.0  # of one job: a year of a loop at 1 s is read by its stretches in less
REMEMBERED = 500  # jobs
CANCELLED = "Cancelled."
OPEN = ("waiting", "running")


@dataclass(frozen=True)
class Job:
    """One job as it stands.

    Attributes
    ----------
    id, item : str
        Of itself, and of what it works on.
    kind : str
        "read", "study" or "block".
    state : {"waiting", "running", "done", "cancelled", "died"}
    phase : str
        What is being done.
    share : float
        Of the work, 0 to 1.
    said : str
        How far the phase is, or why the job ended.
    since : float
        Monotonic seconds at which it was begun; 0: not yet.
    """

    id: str
    item: str
    kind: str
    state: str = "waiting"
    phase: str = ""
    share: float = 0.0
    said: str = ""
    since: float = 0.0

    @property
    def open(self) -> bool:
        """Whether it is still to be done."""
        return self.state in OPEN

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        seconds = round(time.monotonic() - self.since, 1) if self.since and self.open else None
        return {**asdict(self), "since": None, "seconds": seconds, "open": self.open}


class Jobs:
    """Jobs in their order. Every method may be called by any thread and returns at once.

    Parameters
    ----------
    ended : callable
        Is told of every job that ends, with what its worker said; in the thread of the jobs.
    seconds : float
        Limit of one job.
    """

    def __init__(self, ended: Callable[[Job, Mapping[str, Any]], None] | None = None, seconds: float = SECONDS) -> None:
        self._ended, self._seconds = ended, seconds
        self._worker = Worker()
        self._known: OrderedDict[str, Job] = OrderedDict()
        self._tasks: dict[str, Mapping[str, Any]] = {}
        self._row: deque[str] = deque()
        self._changed = threading.Condition()
        self._closed = False
        self._thread: threading.Thread | None = None

    @property
    def worker(self) -> int | None:
        """Number of the process that works; None: there is none now."""
        return self._worker.number

    def warm(self) -> None:
        """Start the worker beside the page, before there is work."""
        if self._worker.number is None and not self._closed:
            threading.Thread(target=self._worker.warm, daemon=True).start()

    def submit(self, item: str, task: Mapping[str, Any]) -> Job:
        """Put a task at the end of the row."""
        job = Job(secrets.token_hex(8), item, str(task["kind"]))
        with self._changed:
            self._known[job.id], self._tasks[job.id] = job, task
            self._row.append(job.id)
            self._forget()
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, daemon=True, name="jobs of the page")
                self._thread.start()
            self._changed.notify_all()
        return job

    def job(self, number: str) -> Job | None:
        """Job by its id."""
        with self._changed:
            return self._known.get(number)

    def of(self, item: str) -> Job | None:
        """Latest job of an item."""
        with self._changed:
            return next((job for job in reversed(self._known.values()) if job.item == item), None)

    def open_job(self, item: str, task: Mapping[str, Any]) -> Job | None:
        """Job of an item that does, or will do, this very task; None: there is none."""
        with self._changed:
            job = self.of(item)
            return job if job is not None and job.open and self._tasks.get(job.id) == task else None

    def ahead(self, job: Job) -> int:
        """Jobs that are done before this one."""
        with self._changed:
            return self._row.index(job.id) + 1 if job.id in self._row else 0

    def cancel(self, number: str) -> bool:
        """Take a job out of the row, or kill its worker; False: it is over, or there is none."""
        with self._changed:
            job = self._known.get(number)
            if job is None or not job.open:
                return False
            running = job.state == "running"
            self._known[number] = replace(job, state="cancelled", said=CANCELLED)
            if running:
                self._worker.kill(CANCELLED)  # before another one can be begun
            else:
                self._row.remove(number)
                self._tasks.pop(number, None)
        return True

    def cancel_of(self, items: set[str]) -> None:
        """Cancel all jobs of some items."""
        with self._changed:
            found = [job.id for job in self._known.values() if job.item in items and job.open]
        for number in found:
            self.cancel(number)

    def wait(self, number: str, seconds: float) -> Job | None:
        """Job once it is over, or as it is after so many seconds."""
        until = time.monotonic() + seconds
        with self._changed:
            while (job := self._known.get(number)) is not None and job.open:
                if not self._changed.wait(until - time.monotonic()) and time.monotonic() >= until:
                    break
            return job

    def close(self) -> None:
        """End the worker; what was in the row is not done any more."""
        with self._changed:
            self._closed = True
            self._row.clear()
            self._changed.notify_all()
        self._worker.kill("The page was ended.")
        if self._thread is not None:
            self._thread.join(5.0)

    def _forget(self) -> None:
        for number in [number for number, job in self._known.items() if not job.open]:
            if len(self._known) <= REMEMBERED:
                break
            del self._known[number]

    def _work(self) -> None:
        while (job := self._next()) is not None:
            said: Mapping[str, Any] = {}
            state, why = "done", ""
            try:
                said = self._worker.run(self._tasks[job.id], self._seconds, partial(self._hear, job))
            except WorkerDiedError as error:
                state, why = "died", str(error)
            self._end(job.id, state, why, said)

    def _next(self) -> Job | None:
        with self._changed:
            while not self._row and not self._closed:
                self._changed.wait()
            if self._closed:
                return None
            number = self._row.popleft()
            job = replace(self._known[number], state="running", phase="starting", since=time.monotonic())
            self._known[number] = job
            self._changed.notify_all()
            return job

    def _hear(self, job: Job, news: Mapping[str, Any]) -> None:
        share = news.get("share")
        share = min(max(float(share), 0.0), 1.0) if isinstance(share, int | float) else 0.0
        with self._changed:
            now = self._known.get(job.id)
            if now is not None and now.state == "running":
                said = str(news.get("said", ""))[:200]
                self._known[job.id] = replace(now, phase=str(news.get("phase", ""))[:60], share=share, said=said)
                self._changed.notify_all()

    def _end(self, number: str, state: str, why: str, said: Mapping[str, Any]) -> None:
        """The worker is through with it; who was cancelled stays so."""
        with self._changed:
            self._tasks.pop(number, None)
            now = self._known.get(number)
            over = None if now is None else now if now.state == "cancelled" else replace(now, state=state, said=why)
        if over is None or self._closed:
            return
        if self._ended is not None:
            try:
                self._ended(over, said)  # before it is called over: who waits finds everything
            except Exception:  # the next job must be done, whatever became of this one
                logging.getLogger("lostmotion.web").exception("a job could not be put on the desk")
                over = replace(
                    over, state="died", said="Its result could not be kept; the page says why where it runs."
                )
        with self._changed:
            if number in self._known:
                self._known[number] = replace(over, share=1.0 if over.state == "done" else over.share)
            self._changed.notify_all()
