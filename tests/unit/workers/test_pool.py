"""Calls in other processes: each has an outcome, whatever its worker does; one dies alone."""

import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from lostmotion.errors import EngineError
from lostmotion.workers import Background, Pool, WorkerDiedError, WorkerLateError, pool
from tests.support.patience import until
from tests.support.places import ROOT
from tests.support.worker_calls import do, told, with_common


@pytest.fixture
def two():
    with Pool(2) as made:
        yield made


def outcomes(made, jobs, function=do):
    """By call."""
    left, found = list(jobs), {}
    while left or made.busy:
        while left and made.free:
            made.give(left[0], function, left.pop(0))
        one = made.take()
        assert one.call not in found
        found[one.call] = one
    return found


def test_every_call_has_its_outcome(two):
    found = outcomes(two, [*range(6), "raise", "odd", "unsendable", "print", "leave", "die", *range(6, 9)])
    assert all(found[one].value[0] == one for one in [*range(9), "print"])
    assert (type(found["raise"].error), str(found["raise"].error)) == (ValueError, "in\nthe work")
    assert str(found["odd"].error) == "TwoArgumentsError: 1 and 2"
    assert isinstance(found["unsendable"].error, RuntimeError)
    assert type(found["leave"].error) is WorkerDiedError
    assert str(found["leave"].error) == "expected a result, got a worker that ended with code 3"
    if sys.platform != "win32":
        assert str(found["die"].error) == "expected a result, got a worker that was killed by SIGKILL"


def test_a_call_that_takes_too_long_is_stopped_alone():
    with Pool(1, seconds=1.0) as made:
        began = time.monotonic()
        found = outcomes(made, ["sleep", 1, 2])
        assert type(found["sleep"].error) is WorkerLateError
        assert [found[one].value[0] for one in (1, 2)] == [1, 2]
        assert time.monotonic() - began < 40


@pytest.mark.skipif(sys.platform != "linux", reason="no limit of memory, or one that is not kept")
def test_memory_has_a_limit():
    with Pool(1, memory=1 << 29) as made:
        found = outcomes(made, ["memory", 1])
        assert isinstance(found["memory"].error, MemoryError)
        assert found[1].value[0] == 1


def test_what_calls_share_is_sent_to_each_worker_and_may_change(two):
    two.share("common")
    found = outcomes(two, range(8), with_common)
    assert {one.value[0] for one in found.values()} == {"common"}
    two.share("another")
    assert outcomes(two, [1], with_common)[1].value[:2] == ("another", 1)


def test_results_come_in_order_and_an_error_is_raised_here(two):
    assert [one for one, _ in two.map(do, list(range(20)))] == list(range(20))
    assert list(two.map(do, [])) == []
    with pytest.raises(ValueError, match="in\nthe work"):
        list(two.map(do, [1, "raise", 2]))
    with pytest.raises(WorkerDiedError, match="expected a result, got a worker that"):
        list(two.map(do, ["die"]))
    assert [one for one, _ in two.map(do, [7])] == [7]
    assert not two.busy


def test_workers_start_in_an_empty_folder_and_find_packages(two):
    said = next(two.map(told, [None]))
    assert said["files"] == []
    assert said["folder"] != os.getcwd()  # noqa: PTH109
    assert "" not in said["path"]
    assert said["folder"] not in said["path"]
    assert (said["safe"], said["environment"], said["threads"]) == (True, "1", "1")


def test_work_that_a_worker_cannot_import_ends_the_run(two):
    with pytest.raises(EngineError, match=r"expected work that can be sent to a worker, got .*; check the source"):
        list(two.map(_local(), [1]))


def _local():
    def twice(number):
        return 2 * number

    twice.__qualname__ = "none"
    sys.modules[__name__].none = twice
    return twice


SCRIPT = """
import beside
from lostmotion.errors import EngineError
from lostmotion.workers import Pool

class Own:
    def __init__(self, number):
        self.number = number

def twice(one):
    return beside.TWO * one.number

{guard}
    with Pool(1) as pool:
        print(list(pool.map(twice, [Own(1), Own(2)])))
"""


@pytest.mark.parametrize("words", [["script.py"], ["-m", "script"]])
@pytest.mark.parametrize(
    ("guard", "said"), [("if __name__ == '__main__':", "[2, 4]"), ("if True:", "do its work under if __name__")]
)
def test_what_the_script_of_the_user_defines(tmp_path, words, guard, said):
    """Also what lies beside it; the folder is looked at last, and what is not needed does not run."""
    (tmp_path / "script.py").write_text(SCRIPT.format(guard=guard))
    (tmp_path / "beside.py").write_text("TWO = 2")
    for name in ("sitecustomize", "usercustomize"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'a').write('x')\nimport sys\n")
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    words = [sys.executable, *words]
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert said in done.stdout + done.stderr
    assert not (tmp_path / "ran").exists()


def test_workers_that_do_not_start(monkeypatch, two):
    monkeypatch.setattr(pool, "WORKER", ("-c", "raise SystemExit(4)"))
    with pytest.raises(EngineError, match="expected worker processes that start, got 3 that ended with code 4"):
        list(two.map(do, [1]))
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    with pytest.raises(EngineError, match="expected worker processes that start, got No such file"):
        list(two.map(do, [1]))


def test_a_worker_killed_while_it_waits_is_replaced(two):
    _, first = next(two.map(do, [1]))
    list(two.map(do, [1]))
    for worker in two.workers:
        os.kill(worker.process.pid, signal.SIGTERM)
        until(lambda worker=worker: worker.process.exit_code is not None)
    assert next(two.map(do, [2, 3]))[1] != first


def test_ctrl_c_ends_a_wait_and_the_workers_do_not_hear_it(two):
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        list(two.map(do, [1]))
        if sys.platform != "win32":
            os.kill(two.workers[0].process.pid, signal.SIGINT)
        assert list(two.map(do, [1]))
        threading.Timer(0.3, signal.raise_signal, (signal.SIGINT,)).start()
        with pytest.raises(KeyboardInterrupt):
            list(two.map(do, ["sleep"]))
    finally:
        signal.signal(signal.SIGINT, before)
    assert not two.busy


def test_a_call_in_the_background():
    call = Background(do, 5)
    assert until(lambda: call.outcome).value[0] == 5
    call.close()
    late = Background(do, "sleep", seconds=0.5)
    assert isinstance(until(lambda: late.outcome).error, WorkerLateError)
    never = Background(do, "sleep")
    assert never.outcome is None
    never.close()
    assert isinstance(never.outcome.error, WorkerDiedError)
