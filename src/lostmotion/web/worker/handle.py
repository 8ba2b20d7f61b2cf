"""Handle on the worker process of a page: start, hand over, listen, kill. JSON alone passes between the two."""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Callable, Mapping
from typing import Any

from lostmotion.files.limits import MOST_GIB
from lostmotion.workers import Process, WorkerDiedError
from lostmotion.workers.process import signal_name

GIB = "4"  # of memory and of what is unpacked, where the environment does not say: a dropped file has 0.5 GB at most
MOST_TASKS = 40  # of one process: whatever a library has forgotten to give back goes with it
LONGEST = 1 << 20  # bytes of news
USUAL = {MOST_GIB: GIB, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "POLARS_MAX_THREADS": "2"}
# Threads reserve memory that the limit counts.
WORKER = ("-m", "lostmotion.web.worker.work")


class Worker:
    """One process at a time; the next task starts another one where the last was killed.

    Methods are called by one thread, but :meth:`kill` by any.
    """

    def __init__(self) -> None:
        self._process: Process | None = None
        self._tasks = 0
        self._why = ""
        self._lock = threading.Lock()

    @property
    def number(self) -> int | None:
        """Of the process; None: there is none."""
        return None if self._process is None else self._process.pid

    def warm(self) -> None:
        """Start the process, so that its packages are loaded when the first task comes."""
        with self._lock:
            if self._process is None or self._process.exit_code is not None:
                usual = {name: value for name, value in USUAL.items() if name not in os.environ}
                self._process, self._tasks = Process(WORKER, usual, longest=LONGEST), 0

    def run(self, task: Mapping[str, Any], seconds: float, hear: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
        """Have a task done.

        Parameters
        ----------
        task : mapping
            Fields of :class:`lostmotion.web.worker.tasks.Task`; its paths are absolute.
        seconds : float
            After which the process is killed.
        hear : callable
            Is given the news.

        Returns
        -------
        dict
            What the worker says at the end.

        Raises
        ------
        WorkerDiedError
            It was killed, or died.
        """
        if self._tasks >= MOST_TASKS:
            self.kill("")
        self._why = ""
        try:
            self.warm()
        except OSError as error:
            raise WorkerDiedError(f"No process could be started for it: {error.strerror}.") from error
        process = self._process
        if process is None:
            raise WorkerDiedError(self._why)
        self._tasks += 1
        with process.within(seconds) as late:
            try:
                return _told(process, task, hear)
            except (OSError, ValueError, EOFError) as error:
                code = process.ended()
                why = f"It took longer than {seconds:g} s, and was stopped." if late.is_set() else self._why
                self.kill(why, process)
                raise WorkerDiedError(why or _reason(code)) from error

    def kill(self, why: str, only: Process | None = None) -> None:
        """End the process and whatever it has started; `only`: if it is this one still."""
        with self._lock:
            if only is not None and self._process is not only:
                return
            process, self._process, self._why = self._process, None, why
        if process is not None:
            process.end()
            process.forget()


def _told(process: Process, task: Mapping[str, Any], hear: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
    process.send(json.dumps(task).encode())
    while True:
        news = json.loads(process.receive())
        if not isinstance(news, dict):
            raise ValueError("no news")  # noqa: TRY004  as what is no JSON
        if news.get("ended"):
            return news
        hear(news)


def _reason(code: int) -> str:
    if code < 0:
        return f"The worker was killed ({signal_name(code)}); most often memory ran out."
    return "The worker died; where the page was started it may say why."
