"""Handle on the worker process of a page: start, hand over, listen, kill."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from lostmotion.files.limits import MOST_GIB

GIB = "4"  # of memory and of what is unpacked, where the environment does not say: a dropped file has 0.5 GB at most
MOST_TASKS = 40  # of one process: whatever a library has forgotten to give back goes with it
LINE = 1 << 20  # characters of news
_QUIET = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "POLARS_MAX_THREADS": "2"}
# Threads reserve memory that the limit counts.


class WorkerDiedError(Exception):
    """The process ended before its task did; the text says why."""


class Worker:
    """One process at a time; the next task starts another one where the last was killed.

    Methods are called by one thread, but :meth:`kill` by any.
    """

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None
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
            if self._process is None or self._process.poll() is not None:
                self._process, self._tasks = _started(), 0

    def run(self, task: Mapping[str, Any], seconds: float, hear: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
        """Have a task done.

        Parameters
        ----------
        task : mapping
            Fields of :class:`lostmotion.web.worker.tasks.Task`.
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
        late = threading.Timer(seconds, self.kill, [f"It took longer than {seconds:g} s, and was stopped.", process])
        late.daemon = True
        late.start()
        try:
            return _told(process, task, hear)
        except (OSError, ValueError, EOFError) as error:
            self.kill(self._why, process)
            raise WorkerDiedError(self._why or _reason(process.returncode)) from error
        finally:
            late.cancel()

    def kill(self, why: str, only: subprocess.Popen[str] | None = None) -> None:
        """End the process and whatever it has started; `only`: if it is this one still."""
        with self._lock:
            if only is not None and self._process is not only:
                return
            process, self._process, self._why = self._process, None, why
        if process is None:
            return
        if hasattr(os, "killpg"):
            with suppress(OSError):
                os.killpg(process.pid, signal.SIGKILL)
        with suppress(OSError):
            process.kill()
        process.wait()
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                with suppress(OSError, ValueError):
                    stream.close()


def _told(
    process: subprocess.Popen[str], task: Mapping[str, Any], hear: Callable[[dict[str, Any]], None]
) -> dict[str, Any]:
    assert process.stdin is not None  # noqa: S101  pipes
    assert process.stdout is not None  # noqa: S101
    process.stdin.write(json.dumps(task) + "\n")
    process.stdin.flush()
    while line := process.stdout.readline(LINE):
        news = json.loads(line)
        if not isinstance(news, dict):
            raise ValueError("no news")  # noqa: TRY004  as what is no JSON
        if news.get("ended"):
            return news
        hear(news)
    raise EOFError


def command() -> list[str]:
    """Give the command line: this Python with a module of ours; no text from outside is part of it."""
    return [sys.executable, "-P", "-m", "lostmotion.web.worker.work"]


def _started() -> subprocess.Popen[str]:
    """Start the process, in a session of its own: Ctrl-C is for the page, which then ends it."""
    paths = os.pathsep.join(path for path in sys.path if path and Path(path).is_absolute())
    usual = {MOST_GIB: GIB} | _QUIET
    environment = {**usual, **os.environ, "PYTHONPATH": paths, "PYTHONUNBUFFERED": "1"}
    return subprocess.Popen(  # noqa: S603  this Python and a module of ours
        command(),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=environment,
        text=True,
        encoding="utf-8",
        errors="replace",
        start_new_session=True,
    )


def _reason(code: int | None) -> str:
    if code is not None and code < 0:
        with suppress(ValueError):
            return f"The worker was killed ({signal.Signals(-code).name}); most often memory ran out."
    return "The worker died; where the page was started it may say why."
