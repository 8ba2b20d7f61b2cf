"""Dask: processes on this machine, or a cluster that is there already. Few batches in flight, results let go."""

from __future__ import annotations

import logging
import os
import queue
import time
import uuid
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from typing import Any

import dask
from distributed import Client, KilledWorker, LocalCluster, WorkerPlugin

from lostmotion.audit.runner.engine.protocol import Done, Lost, Task, Tried, done, one_line
from lostmotion.errors import EngineError, SetupError
from lostmotion.workers import ONE_THREAD, SAFE_PATH
from lostmotion.workers.interrupt import may_end

AHEAD = 3  # batches of a worker in flight
RETRIES = 1  # of a batch that raised: a file may have been busy
FAILURES = 0  # further workers that a batch may kill before it is told: then it is halved here
CONNECT = 15.0  # s in which a scheduler must answer, and after which one that went away is gone
LOOK = 1.0  # s between two looks at the connection while nothing comes
NO_WORKERS = 120.0  # s without any worker after which none is waited for
_TASKS: dict[str, Task] = {}  # of this worker


class Common(WorkerPlugin):
    """What all batches have in common goes to each worker once, also to those that come later.

    Parameters
    ----------
    name : str
    task : Task
    """

    def __init__(self, name: str, task: Task) -> None:
        self.name, self.task = name, task

    def setup(self, worker: Any) -> None:  # noqa: ARG002
        """Before the first batch: threads are counted when NumPy, Numba and Polars are imported."""
        for name, value in ONE_THREAD.items():
            os.environ.setdefault(name, value)
        _TASKS[self.name] = self.task
        may_end()

    def teardown(self, worker: Any) -> None:  # noqa: ARG002
        """The run is over."""
        _TASKS.pop(self.name, None)


def batch_done(name: str, items: tuple[Any, ...]) -> tuple[Any, ...]:
    """Results of a batch, in a worker."""
    from threadpoolctl import threadpool_limits  # noqa: PLC0415

    with threadpool_limits(1):  # workers of others may have been started with more
        return done(_TASKS[name], items)


def local_cluster(workers: int) -> DaskEngine:
    """Processes of this machine under a scheduler in this one; nothing of the working folder runs in them."""
    safe_before = {name: os.environ.get(name) for name in SAFE_PATH}
    os.environ.update(SAFE_PATH)  # until the end of the cluster: Dask starts another worker in place of a dead one
    one_at_a_time = {"distributed.scheduler.allowed-failures": FAILURES, "distributed.scheduler.worker-saturation": 1.0}
    with dask.config.set(one_at_a_time):  # what waits at a worker would be blamed for its death, too
        cluster = LocalCluster(  # type: ignore[no-untyped-call]
            n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=":0", host="127.0.0.1",
            env=ONE_THREAD, silence_logs=logging.CRITICAL,
        )  # fmt: skip
    return DaskEngine(_client(cluster), "dask", cluster, safe_before)


def _client(where: Any, **settings: Any) -> Any:
    return Client(where, timeout=CONNECT, set_as_default=False, **settings)  # type: ignore[no-untyped-call]


def cluster_at(address: str, security: Any = None) -> DaskEngine:
    """A cluster that somebody runs.

    Raises
    ------
    EngineError
        It does not answer.
    """
    settings = {} if security is None else {"security": security}
    try:
        client = _client(address, **settings)
    except (OSError, TimeoutError, TypeError, ValueError, RuntimeError) as error:
        tls = "; its certificates stand in Dask's configuration (distributed.comm.tls)" * address.startswith("tls")
        raise EngineError(
            f"expected a Dask scheduler at {address}, got {one_line(error)}; check that it runs and can be reached{tls}"
        ) from None
    return DaskEngine(client, address, None)


class DaskEngine:
    """Engine of Dask.

    Parameters
    ----------
    client : distributed.Client
    name : str
    cluster : LocalCluster, optional
        Closed with the engine.
    environment : mapping, optional
        Put back when it is closed; None: such a variable was not there.
    """

    def __init__(
        self, client: Any, name: str, cluster: Any, environment: Mapping[str, str | None] | None = None
    ) -> None:
        self.client, self.name, self._cluster = client, name, cluster
        self._environment = environment or {}
        self.workers = len(self._call(client.nthreads)) or 1

    def run(self, task: Task, batches: Iterable[tuple[Any, ...]]) -> Iterator[Done | Lost]:
        """Outcome of each item, as batches are done; see :class:`lostmotion.audit.runner.engine.Engine`."""
        name = f"lostmotion-{uuid.uuid4().hex}"
        self._call(lambda: self.client.register_plugin(Common(name, task), name=name))
        source, again, apart, more = iter(batches), deque[Tried](), deque[Tried](), True
        flying: dict[Any, Tried] = {}
        came: queue.SimpleQueue[Any] = queue.SimpleQueue()
        try:
            while more or again or apart or flying:
                room = AHEAD * max(len(self._call(self.client.nthreads)), 1) - len(flying)
                block = [again.popleft() for _ in range(min(room, len(again)))]
                while more and len(block) < room:
                    items = next(source, None)
                    more = items is not None
                    block += [] if items is None else [Tried(items)]
                if not (block or flying or more) and apart:  # alone in the cluster: nobody else can be the culprit
                    block = [apart.popleft()]
                flying |= self._sent(name, block, came)
                for future in self._landed(came) if flying else ():
                    parts, outcome = self._outcome(flying.pop(future), future)
                    again.extend(one for one in parts if not one.deaths)
                    apart.extend(one for one in parts if one.deaths)
                    yield from outcome
        finally:
            self._let_go(name, flying)

    def close(self) -> None:
        """Leave the cluster; end it if it is our own."""
        for one in (self.client, self._cluster):
            if one is not None:
                with suppress(Exception):
                    one.close(timeout=CONNECT)
        for name, value in self._environment.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value

    def _sent(self, name: str, block: list[Tried], came: queue.SimpleQueue[Any]) -> dict[Any, Tried]:
        """Batches in one message."""
        if not block:
            return {}
        keys = [f"{name}-{uuid.uuid4().hex}" for _ in block]
        futures = self._call(
            lambda: self.client.map(
                batch_done, [name] * len(block), [one.items for one in block], key=keys, retries=RETRIES, pure=False
            )
        )
        for future in futures:
            future.add_done_callback(came.put)
        return dict(zip(futures, block, strict=True))

    def _landed(self, came: queue.SimpleQueue[Any]) -> list[Any]:
        """All that has come; waits for the first."""
        since = time.monotonic()
        while True:
            with suppress(queue.Empty):
                landed = [came.get(timeout=LOOK)]
                while not came.empty():
                    landed.append(came.get())
                return landed
            self._look(since)

    def _look(self, since: float) -> None:
        """Whether anything can still come.

        Raises
        ------
        EngineError
        """
        silent = time.monotonic() - since
        if self.client.status != "running" and silent > CONNECT:
            raise self._gone("none that answers any more")
        if self.client.status == "running" and silent > NO_WORKERS and not self._call(self.client.nthreads):
            raise self._gone("one without workers")

    def _outcome(self, batch: Tried, future: Any) -> tuple[list[Tried], list[Done | Lost]]:
        """What becomes of a batch: what is tried again, and what is done."""
        try:
            results = future.result(timeout=CONNECT)
        except KilledWorker:
            again, lost = batch.after_death()
            return again, list(lost)
        except SetupError as error:
            raise EngineError(str(error)) from None
        except Exception as error:  # noqa: BLE001  of the work, or of the connection
            if self.client.status != "running":
                raise self._gone(one_line(error)) from None
            if future.status != "error":  # its result was lost with its worker
                return [batch], []
            again, lost = batch.after_error(one_line(error))
            return again, list(lost)
        finally:
            with suppress(Exception):
                future.release()
        return [], [Done(batch.items, results)]

    def _let_go(self, name: str, flying: dict[Any, Tried]) -> None:
        with suppress(Exception):
            if flying and self.client.status == "running":
                self.client.cancel(list(flying), force=True)
            if self.client.status == "running":
                self.client.unregister_worker_plugin(name)

    def _call(self, ask: Any) -> Any:
        try:
            return ask()
        except Exception as error:  # noqa: BLE001  many kinds, and all mean that nothing can be done
            raise self._gone(one_line(error)) from None

    def _gone(self, said: str) -> EngineError:
        return EngineError(
            f"expected a Dask scheduler at {self.name}, got {said}; start it and the same command again: "
            "what was done is kept"
        )
