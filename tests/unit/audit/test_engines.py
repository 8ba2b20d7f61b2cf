"""Engines: each item once, whatever dies; the same from processes, from Dask and in this process."""

import os
import signal
import threading
import time

import pytest

from lostmotion.audit.runner.engine import Done, EngineError, Lost, Task, open_engine
from lostmotion.audit.runner.engine.protocol import DIED
from lostmotion.errors import ParameterError
from lostmotion.workers import pool
from tests.support.patience import until

DOUBLE = "benchmarks.audit.light:double"


def outcome(engine, batches, work=DOUBLE):
    """Results by item, and why items were lost; each once."""
    found, lost = [], []
    for one in engine.run(Task(work, 3), iter(batches)):
        if isinstance(one, Done):
            found += zip(one.items, one.results, strict=True)
        else:
            assert isinstance(one, Lost)
            lost.append((one.item, one.why))
    return found, lost


@pytest.fixture(scope="module")
def engine():
    one = open_engine("processes", 2)
    yield one
    one.close()


@pytest.fixture(scope="module")
def cluster():
    pytest.importorskip("distributed")
    one = open_engine("dask", 2)
    yield one
    one.close()


def test_processes_do_every_item_once(engine):
    found, lost = outcome(engine, [tuple(range(first, first + 7)) for first in range(0, 70, 7)])
    assert sorted(found) == [(number, 3 * number) for number in range(70)]
    assert lost == []
    assert outcome(engine, []) == ([], [])


def test_a_worker_has_one_thread_and_nothing_that_it_does_not_need(engine):
    found = dict(outcome(engine, [("threads",), ("loaded",)])[0])
    assert set(found["threads"].values()) == {"1"}
    assert found["loaded"] == []


def test_what_kills_its_worker_is_found(engine):
    found, lost = outcome(engine, [(1, 2, "kill", 4, 5), (6, "raise", 7), (8, 9)])
    assert sorted(found) == [(number, 3 * number) for number in (1, 2, 4, 5, 6, 7, 8, 9)]
    assert sorted(lost) == [("kill", DIED), ("raise", "ValueError: in the work")]


def test_a_run_that_is_broken_off_leaves_nothing_for_the_next(engine):
    for _ in engine.run(Task(DOUBLE, 5), [(number,) for number in range(20)]):
        break
    assert outcome(engine, [(1,)]) == ([(1, 3)], [])


def test_work_that_is_not_there_ends_the_run(engine):
    for work in ("benchmarks.audit.light:none", "no_such_module:x"):
        with pytest.raises(EngineError, match=f"expected {work} on the worker, got .*; install the same lostmotion"):
            outcome(engine, [(1,)], work)


def test_workers_that_never_start_end_the_run(monkeypatch):
    monkeypatch.setattr(pool, "WORKER", ("-c", "raise SystemExit(3)"))
    engine = open_engine("processes", 1)
    with pytest.raises(EngineError, match="expected worker processes that start, got 3 that ended with code 3"):
        outcome(engine, [(1,)])
    engine.close()


def test_workers_end_with_their_coordinator():
    engine = open_engine("processes", 1)
    outcome(engine, [(1,)])
    (worker,) = engine._pool.workers
    worker.process._to.close()  # as if it were killed
    until(lambda: worker.process.exit_code == 0)
    engine.close()


def test_in_this_process():
    engine = open_engine("inline")
    found, lost = outcome(engine, [(1, "raise", 2), (3,)])
    assert (found, lost) == ([(1, 3), (2, 6), (3, 9)], [("raise", "ValueError: in the work")])
    with pytest.raises(EngineError, match="expected no:x on the worker"):
        outcome(engine, [(1,)], "no:x")


def test_dask_does_the_same(cluster):
    found, lost = outcome(cluster, [(1, "kill"), (6, "raise"), *((number,) for number in range(10, 40))])
    assert sorted(found) == [(number, 3 * number) for number in (1, 6, *range(10, 40))]
    assert sorted(lost) == [("kill", DIED), ("raise", "ValueError: in the work")]
    with pytest.raises(EngineError, match="expected no:x on the worker"):
        outcome(cluster, [(1,)], "no:x")


def test_a_scheduler_by_its_address_and_one_that_goes_away(monkeypatch):
    distributed = pytest.importorskip("distributed")
    from lostmotion.audit.runner.engine import dask_engine

    monkeypatch.setattr(dask_engine, "CONNECT", 1.0)
    monkeypatch.setattr(dask_engine, "LOOK", 0.1)
    cluster = distributed.LocalCluster(1, processes=False, dashboard_address=":0", protocol="tcp", host="127.0.0.1")
    engine = open_engine(cluster.scheduler_address)
    assert outcome(engine, [(1, 2)]) == ([(1, 3), (2, 6)], [])

    def batches():
        yield (1,)
        cluster.close()
        yield (2,)

    with pytest.raises(
        EngineError, match=r"expected a Dask scheduler at tcp://.*, got .*; start it and the same command"
    ):
        outcome(engine, batches())
    engine.close()
    with pytest.raises(
        EngineError, match=r"expected a Dask scheduler at tcp://127.0.0.1:1, got .*; check that it runs"
    ):
        open_engine("tcp://127.0.0.1:1")


@pytest.mark.parametrize(
    ("name", "match"),
    [
        ("threads", "expected an engine .*, got 'threads'; "), ("tcp://host", "expected an engine"),
        ("tcp://host:x", "expected an engine"), ("http://localhost:80", "expected an engine"),
        ("tcp://10.0.0.1:8786", r"expected tls:// for a scheduler on another machine \(10.0.0.1\), got tcp://, "),
        ("tcp://cluster.plant:8786", "allow it with insecure=True"),
    ],
)  # fmt: skip
def test_addresses_that_are_refused(name, match):
    with pytest.raises(ParameterError, match=match):
        open_engine(name)


def test_workers_are_counted():
    assert open_engine().workers >= 1
    with pytest.raises(ParameterError, match="expected at least 1 worker, got 0"):
        open_engine("processes", 0)


@pytest.fixture
def heard():
    """Ctrl-C is heard, also where the tests run in a process that was told not to hear it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("heard")
def test_ctrl_c_ends_the_coordinator_and_not_a_batch(engine):
    """Workers do not hear it; the coordinator ends them."""
    found, _ = outcome(engine, [(1,)])
    for worker in engine._pool.workers:
        os.kill(worker.process.pid, signal.SIGINT)
    time.sleep(0.1)
    assert outcome(engine, [(1,)])[0] == found
    threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        outcome(engine, ((number,) for number in range(30_000)))  # many seconds of work
