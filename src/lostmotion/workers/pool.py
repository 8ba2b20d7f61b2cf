"""Pool: calls in isolated processes; one that dies, or takes too long, costs its call only.

An own pool in place of a kept one (loky, pebble): neither starts its workers away from the working folder, and loky
fails all that is under way when a worker dies. Here each worker has its own pipe, so the call that killed it is known.
"""

from __future__ import annotations

import os
import pickle
import queue
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from lostmotion.errors import EngineError
from lostmotion.workers import child
from lostmotion.workers.isolated import ONE_THREAD
from lostmotion.workers.process import END, Process, death
from lostmotion.workers.script import need_no_import, script

AHEAD = 2  # calls of a worker: one at work and one waiting, so that it does not wait for who takes the results
START = 120.0  # s in which a worker must be ready: on a busy machine it takes some seconds
STARTS = 3  # workers in a row that end before they are ready: then none will
WORKER = ("-m", "lostmotion.workers")
LOOK = 1.0  # s between two looks at the clock; a wait without end cannot be interrupted on Windows


class WorkerDiedError(EngineError):
    """A worker died on a call."""


class WorkerLateError(WorkerDiedError):
    """A call took longer than it may."""


@dataclass(frozen=True)
class Outcome:
    """What came of a call.

    Attributes
    ----------
    call : object
        As it was given.
    value : object
        What the function returned.
    error : Exception, optional
        What it raised, or how its worker died; one that cannot be sent is a RuntimeError with its words.
    """

    call: Any
    value: Any = None
    error: Exception | None = None


class Worker:
    """One process and the calls that it has; the first of them is at work."""

    def __init__(self, limits: Sequence[str], environment: Mapping[str, str], came: queue.SimpleQueue[Any]) -> None:
        self.process = Process([*WORKER, *limits], environment)
        self.ready = False
        self.common: Any = None
        self.calls: deque[tuple[Any, bytes]] = deque()
        self.since = 0.0
        self.late = False
        with suppress(OSError):
            self.process.send(pickle.dumps((child.SCRIPT, None, (script(),))))
        self._listens = threading.Thread(target=self._listen, args=(came,), daemon=True)
        self._listens.start()

    def give(self, call: Any, message: bytes) -> None:
        """Send a call. That the worker is dead is noticed by reading."""
        if not self.calls:
            self.since = time.monotonic()
        self.calls.append((call, message))
        with suppress(OSError):
            self.process.send(message)

    def pop(self) -> Any:
        """The call that has come to an end; the next one begins."""
        self.since = time.monotonic()
        return self.calls.popleft()[0]

    def end(self, *, died: bool = False) -> int:
        """Exit code."""
        code = self.process.ended() if died else self.process.end()
        self._listens.join(END)
        self.process.forget()
        return code

    def _listen(self, came: queue.SimpleQueue[Any]) -> None:
        try:
            while True:
                came.put((self, self.process.receive()))
        except EOFError:
            came.put((self, None))


class Pool:
    """Workers for calls of functions that they can import.

    Parameters
    ----------
    workers : int
        Processes; each is started when it is needed.
    seconds : float, optional
        For one call, once its worker is ready; then the worker is killed.
    memory : int
        Bytes of a worker, where the system has such a limit; 0: no limit.
    nicer : int
        Steps of lower priority.
    environment : mapping, optional
        Of the workers; default: one thread each, so that sums do not depend on the number of workers.

    Raises
    ------
    EngineError
        By any method that waits: workers do not start, or cannot do such work at all.
    """

    def __init__(
        self,
        workers: int,
        *,
        seconds: float | None = None,
        memory: int = 0,
        nicer: int = 0,
        environment: Mapping[str, str] = ONE_THREAD,
    ) -> None:
        self.size, self._seconds = workers, seconds
        self._limits, self._environment = (str(memory), str(nicer)), environment
        self.workers: list[Worker] = []
        self._again: deque[tuple[Any, bytes]] = deque()
        self._common: tuple[Any, ...] = ()
        self._came: queue.SimpleQueue[tuple[Worker, bytes | None]] = queue.SimpleQueue()
        self._failed_starts = 0

    def share(self, *common: Any) -> None:
        """Arguments of all calls that follow, before their own; each worker is sent them once."""
        self._common = common

    @property
    def free(self) -> bool:
        """Whether one more call would find a worker."""
        return len(self.workers) < self.size or any(len(one.calls) < AHEAD for one in self.workers)

    @property
    def busy(self) -> bool:
        """Whether an outcome is still to come."""
        return bool(self._again) or any(one.calls for one in self.workers)

    def give(self, call: Any, function: Callable[..., Any], *given: Any) -> None:
        """Have a function called.

        Parameters
        ----------
        call : object
            Comes back with the outcome.
        function : callable
            Of a module that workers can import.
        *given
            Its arguments behind the common ones.
        """
        self._send(call, pickle.dumps((child.CALL, function, given)))

    def take(self) -> Outcome:
        """Wait for the outcome of a call, in any order."""
        while True:
            found = self._next(LOOK)
            if found is not None:
                return found

    def poll(self) -> Outcome | None:
        """Outcome that is there already."""
        return self._next(0.0)

    def map(self, function: Callable[..., Any], jobs: Sequence[Any]) -> Iterator[Any]:
        """Results of a function of the common arguments and a job, in the order of the jobs.

        Raises
        ------
        Exception
            What a call raised; WorkerDiedError of one on which its worker died.
        """
        found: dict[int, Any] = {}
        left, number = deque(enumerate(jobs)), 0
        try:
            while number < len(jobs):
                while left and self.free:
                    place, job = left.popleft()
                    self.give(place, function, job)
                outcome = self.take()
                if outcome.error is not None:
                    raise outcome.error
                found[outcome.call] = outcome.value
                while number in found:
                    yield found.pop(number)
                    number += 1
        finally:
            self.drop()

    def drop(self) -> None:
        """Forget all calls: workers that have some are ended, the others wait for what comes next."""
        self._again.clear()
        for worker in [one for one in self.workers if one.calls]:
            self.workers.remove(worker)
            worker.end()

    def close(self) -> None:
        """End all workers at once."""
        self._again.clear()
        while self.workers:
            self.workers.pop().end()

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _send(self, call: Any, message: bytes) -> None:
        worker = self._least_busy()
        if worker.common is not self._common:
            worker.common = self._common
            with suppress(OSError):
                worker.process.send(pickle.dumps((child.COMMON, None, self._common)))
        worker.give(call, message)

    def _least_busy(self) -> Worker:
        for worker in [one for one in self.workers if not one.calls and one.process.exit_code is not None]:
            self.workers.remove(worker)  # killed while it waited: no call is to blame
            worker.end()
        idle = next((one for one in self.workers if not one.calls), None)
        if idle is None and len(self.workers) < self.size:
            need_no_import()
            try:
                self.workers.append(Worker(self._limits, self._environment, self._came))
            except OSError as error:
                raise EngineError(f"expected worker processes that start, got {error.strerror}") from error
            return self.workers[-1]
        return min(self.workers, key=lambda one: len(one.calls))

    def _next(self, seconds: float) -> Outcome | None:
        while self._again and self.free:
            self._send(*self._again.popleft())
        wait = min(seconds, self._end_late())
        try:
            worker, message = self._came.get(timeout=wait) if wait else self._came.get_nowait()
        except queue.Empty:
            return None
        if worker not in self.workers:
            return None  # what one had still to say that was ended
        return self._dead(worker) if message is None else self._heard(worker, message)

    def _end_late(self) -> float:
        """Kill the workers whose time is over; seconds until that of the next one is."""
        wait = LOOK
        for worker in self.workers:
            allowed = self._seconds if worker.ready else START
            if worker.calls and allowed is not None and not worker.late:
                left = worker.since + allowed - time.monotonic()
                worker.late = left <= 0.0
                wait = min(wait, max(left, 0.01))
                if worker.late:
                    worker.process.kill()
        return wait

    def _heard(self, worker: Worker, message: bytes) -> Outcome | None:
        kind, value = pickle.loads(message)  # noqa: S301  of a worker that runs this program
        if kind == child.READY:
            worker.ready, self._failed_starts, worker.since = True, 0, time.monotonic()
            return None
        if kind == child.UNABLE:
            self.workers.remove(worker)
            worker.end()
            raise EngineError(str(value)) from value
        call = worker.pop()
        return Outcome(call, value) if kind == child.RESULT else Outcome(call, error=value)

    def _dead(self, worker: Worker) -> Outcome | None:
        """A worker has died on the first of its calls, or before it was ready; the others wait for another one."""
        self.workers.remove(worker)
        code, first = worker.end(died=True), None
        if worker.ready and worker.calls:
            error = WorkerDiedError(f"expected a result, got a worker that {death(code)}")
            if worker.late:
                error = WorkerLateError(f"expected a result within {self._seconds:g} s, got none")
            first = Outcome(worker.pop(), error=error)
        self._again.extend(worker.calls)
        if not worker.ready:
            self._failed_starts += 1
            if self._failed_starts >= STARTS:
                self.drop()
                raise EngineError(f"expected worker processes that start, got {STARTS} that {death(code)}")
        return first


def usable_processors() -> int:
    """Those that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
