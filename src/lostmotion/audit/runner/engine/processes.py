"""Processes of this machine, one thread each. A dead worker costs its batch a try, not the run.

An own pool instead of that of the standard library: there one dead worker fails all that is under way, and nobody can
tell on which batch it died. Here each worker has its own pipe, so the one that killed it is known.
"""

from __future__ import annotations

import os
import queue
import signal
import threading
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from typing import Any

from lostmotion.audit.runner.engine.protocol import Done, Lost, Task, Tried, done, one_line
from lostmotion.audit.runner.engine.threads import one_thread
from lostmotion.audit.runner.limit import may_end
from lostmotion.errors import EngineError, SetupError

AHEAD = 2  # batches of a worker: one at work and one waiting, so that it does not wait for the store
STARTS = 3  # workers in a row that die before they are ready: then none will
PATIENCE = 5.0  # s in which an ended worker must be gone before it is killed


class Worker:
    """One process, its pipe, and the batches that it has; the first of them is at work."""

    def __init__(self) -> None:
        context = get_context("spawn")  # never fork: Polars and Numba hold threads and locks
        self.pipe, other = context.Pipe()
        self.process = context.Process(target=_serve, args=(other,), daemon=True)
        with one_thread(), _deaf():
            self.process.start()
        other.close()  # its death is seen by the end of the pipe
        self.ready = False
        self.task: Task | None = None
        self.batches: deque[Tried] = deque()

    def give(self, task: Task, batch: Tried) -> None:
        """Send a batch, before it the task where that is a new one. That a worker is dead is noticed by reading."""
        self.batches.append(batch)
        with suppress(OSError):
            if self.task is not task:
                self.pipe.send(task)
                self.task = task
            self.pipe.send(batch.items)

    def end(self) -> None:
        """End the process."""
        self.pipe.close()
        self.process.terminate()
        self.process.join(PATIENCE)
        if self.process.is_alive():
            self.process.kill()
            self.process.join()
        self.process.close()


class Processes:
    """Engine of processes on this machine.

    Parameters
    ----------
    workers : int
    """

    name = "processes"

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._workers: list[Worker] = []
        self._again: deque[Tried] = deque()
        self._failed_starts = 0

    def run(self, task: Task, batches: Iterable[tuple[Any, ...]]) -> Iterator[Done | Lost]:
        """Outcome of each item, as batches are done; see :class:`lostmotion.audit.runner.engine.Engine`."""
        try:
            yield from self._run(task, iter(batches))
        finally:  # a run that is broken off leaves workers with batches that nobody waits for
            self._again.clear()
            for worker in [one for one in self._workers if one.batches]:
                worker.end()
                self._workers.remove(worker)

    def _run(self, task: Task, source: Iterator[tuple[Any, ...]]) -> Iterator[Done | Lost]:
        more = True
        while True:
            while (more or self._again) and (worker := self._free()) is not None:
                batch = self._again.popleft() if self._again else next((Tried(one) for one in source), None)
                if batch is None:
                    more = False
                else:
                    worker.give(task, batch)
            if not any(worker.batches for worker in self._workers):
                return
            yield from self._heard()

    def close(self) -> None:
        """End all workers at once."""
        for worker in self._workers:
            worker.end()
        self._workers.clear()

    def _free(self) -> Worker | None:
        """The worker with the least to do, if it may have more; a new one as long as there are too few."""
        while len(self._workers) < self.workers:
            self._workers.append(Worker())
        worker = min(self._workers, key=lambda one: len(one.batches))
        return worker if len(worker.batches) < AHEAD else None

    def _heard(self) -> Iterator[Done | Lost]:
        by_pipe = {worker.pipe: worker for worker in self._workers}
        for pipe in wait(list(by_pipe)):
            worker = by_pipe[pipe]  # type: ignore[index]
            try:
                kind, said = worker.pipe.recv()
            except (EOFError, OSError):
                yield from self._buried(worker)
                continue
            yield from self._said(worker, kind, said)

    def _said(self, worker: Worker, kind: str, said: Any) -> Iterator[Done | Lost]:
        if kind == "ready":
            worker.ready, self._failed_starts = True, 0
        elif kind == "unable":
            raise EngineError(said)
        elif kind == "done":
            yield Done(worker.batches.popleft().items, said)
        else:
            again, lost = worker.batches.popleft().after_error(said)
            self._again.extend(again)
            yield from lost

    def _buried(self, worker: Worker) -> Iterator[Lost]:
        """A worker has died on the first of its batches, or before it was ready."""
        worker.process.join(PATIENCE)
        code = worker.process.exitcode
        worker.end()
        self._workers.remove(worker)
        if not worker.ready:
            self._failed_starts += 1
            if self._failed_starts >= STARTS:
                raise EngineError(
                    f"expected worker processes that start, got {STARTS} that ended with code {code}; "
                    "a script must do its work under if __name__ == '__main__':"
                )
        elif worker.batches:
            again, lost = worker.batches.popleft().after_death()
            self._again.extend(again)
            yield from lost
        self._again.extend(worker.batches)


@contextmanager
def _deaf() -> Iterator[None]:
    """Processes that are started inside do not hear Ctrl-C: the coordinator, which hears it afterwards, ends them."""
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # ignored, it would be lost
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _serve(pipe: Connection) -> None:
    """A worker: batches in, results out; ends with its coordinator, also in the middle of a batch."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    may_end()
    came: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(pipe, came), daemon=True).start()
    _answer(pipe, "ready", None)
    task = Task("")
    while True:
        one = came.get()
        if isinstance(one, Task):
            task = one
        else:
            _work(pipe, task, one)


def _listen(pipe: Connection, came: queue.SimpleQueue[Any]) -> None:
    """Read at once, so that the coordinator never waits for a worker that is busy."""
    try:
        while True:
            came.put(pipe.recv())
    except (EOFError, OSError):
        os._exit(0)  # the coordinator is gone: nobody wants the result
    except BaseException as error:  # noqa: BLE001  what it sent cannot be read here
        _answer(pipe, "unable", f"expected work that can be sent to a worker, got {one_line(error)}; check the source")


def _work(pipe: Connection, task: Task, items: tuple[Any, ...]) -> None:
    try:
        _answer(pipe, "done", done(task, items))
    except SetupError as error:
        _answer(pipe, "unable", str(error))
    except Exception as error:  # noqa: BLE001  whatever it is, it is said of the batch
        _answer(pipe, "failed", one_line(error))


def _answer(pipe: Connection, kind: str, said: Any) -> None:
    try:
        pipe.send((kind, said))
    except (BrokenPipeError, ConnectionError):
        os._exit(0)
