"""Jobs of the page and their worker: progress, cancel, kill, limits; the worker is a small program of the test."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

from lostmotion.web.worker import handle as worker_module
from lostmotion.web.worker.handle import Worker
from lostmotion.web.worker.jobs import Jobs
from lostmotion.workers import WorkerDiedError
from tests.support.patience import until

SCRIPT = """
import json, os, sys, time
from lostmotion.workers.child import Channel
channel = Channel()
def say(**news):
    channel.send(json.dumps(news).encode())
while True:
    task = json.loads(channel.receive())
    kind = task["kind"]
    say(phase="reading", share=0.5, said="half")
    if kind == "slow":
        time.sleep(60)
    if kind == "die":
        os.kill(os.getpid(), 9)
    if kind == "leave":
        sys.exit(3)
    if kind == "garbage":
        channel.send(b"no JSON")
    if kind == "list":
        channel.send(b"[1]")
    if kind == "long":
        channel.send(bytes(2_000_000))
    if kind == "odd":
        say(phase=7, share="x")
    say(ended=True, pid=os.getpid(), loops=task.get("loops"))
"""


@pytest.fixture(autouse=True)
def small_worker(monkeypatch):
    monkeypatch.setattr(worker_module, "WORKER", ("-c", SCRIPT))


@pytest.fixture
def jobs():
    ended = []
    made = Jobs(lambda job, said: ended.append((job, dict(said))), seconds=20.0)
    made.ended = ended
    yield made
    made.close()


def gone(number):
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return True
    return False


def test_jobs_are_done_in_their_order_by_one_process(jobs):
    made = [jobs.submit(f"item {n}", {"kind": "quick"}) for n in range(3)]
    assert [jobs.wait(job.id, 10).state for job in made] == ["done"] * 3
    assert [job.item for job, _ in jobs.ended] == ["item 0", "item 1", "item 2"]
    assert len({said["pid"] for _, said in jobs.ended}) == 1


def test_a_job_tells_how_far_it_is_and_can_be_cancelled(jobs):
    job = jobs.submit("a", {"kind": "slow"})
    until(lambda: jobs.job(job.id).share == 0.5)
    shown = jobs.job(job.id).to_dict()
    assert (shown["phase"], shown["said"], shown["state"], shown["open"]) == ("reading", "half", "running", True)
    json.dumps(shown)
    number = jobs.worker
    assert jobs.cancel(job.id)
    assert not jobs.cancel(job.id)
    until(lambda: jobs.ended)
    assert jobs.ended[0][0].state == "cancelled"
    assert gone(number)
    assert jobs.wait(jobs.submit("b", {"kind": "quick"}).id, 10).state == "done"


def test_a_job_that_waits_is_taken_out_of_the_row(jobs):
    first, second, third = (
        jobs.submit(name, {"kind": kind}) for name, kind in (("a", "slow"), ("b", "quick"), ("c", "quick"))
    )
    until(lambda: jobs.job(first.id).state == "running")
    assert [jobs.ahead(job) for job in (first, second, third)] == [0, 1, 2]
    jobs.cancel_of({"b", "a"})
    assert jobs.wait(third.id, 10).state == "done"
    assert [jobs.job(job.id).state for job in (first, second)] == ["cancelled"] * 2


@pytest.mark.parametrize(
    ("kind", "why"),
    [("die", "killed (SIGKILL)"), ("leave", "died"), ("garbage", ""), ("list", ""), ("long", "")],
)
def test_a_worker_that_dies_is_an_error_and_the_next_job_works(jobs, kind, why):
    job = jobs.wait(jobs.submit("a", {"kind": kind}).id, 10)
    assert job.state == "died"
    assert why in job.said
    assert jobs.wait(jobs.submit("b", {"kind": "quick"}).id, 10).state == "done"


def test_a_worker_killed_from_outside_is_an_error_and_the_next_job_works(jobs):
    job = jobs.submit("a", {"kind": "slow"})
    until(lambda: jobs.job(job.id).share == 0.5)
    os.kill(jobs.worker, signal.SIGKILL)
    assert jobs.wait(job.id, 10).state == "died"
    assert jobs.wait(jobs.submit("b", {"kind": "quick"}).id, 10).state == "done"


def test_a_job_that_takes_too_long_is_stopped():
    made = Jobs(seconds=0.3)
    try:
        job = made.wait(made.submit("a", {"kind": "slow"}).id, 10)
        assert (job.state, job.said) == ("died", "It took longer than 0.3 s, and was stopped.")
    finally:
        made.close()


def test_odd_news_do_no_harm(jobs):
    assert jobs.wait(jobs.submit("a", {"kind": "odd"}).id, 10).state == "done"


def test_close_ends_the_worker_and_waits_for_nobody():
    made = Jobs()
    job = made.submit("a", {"kind": "slow"})
    made.submit("b", {"kind": "slow"})
    until(lambda: made.job(job.id).share == 0.5)
    number = made.worker
    began = time.monotonic()
    made.close()
    assert time.monotonic() - began < 4
    assert gone(number)


def test_a_worker_is_replaced_after_many_tasks(monkeypatch):
    monkeypatch.setattr(worker_module, "MOST_TASKS", 2)
    one = Worker()
    numbers = [one.run({"kind": "quick"}, 10.0, lambda news: None)["pid"] for _ in range(4)]
    one.kill("")
    assert numbers[0] == numbers[1] != numbers[2] == numbers[3]


def test_a_worker_that_cannot_be_started_is_an_error(monkeypatch):
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    with pytest.raises(WorkerDiedError, match="No process"):
        Worker().run({"kind": "quick"}, 10.0, lambda news: None)
    made = Jobs()
    try:
        assert made.wait(made.submit("a", {"kind": "quick"}).id, 10).state == "died"
    finally:
        made.close()


def test_a_result_that_cannot_be_kept_does_not_stop_the_jobs(caplog):
    def full(job, said):
        raise OSError("disk full")

    made = Jobs(full)
    try:
        assert [made.wait(made.submit("a", {"kind": "quick"}).id, 10).state for _ in range(2)] == ["died"] * 2
    finally:
        made.close()


def test_the_worker_ends_with_the_page():
    """Its standard input is closed when the page dies, however that was."""
    one = subprocess.Popen(
        [sys.executable, "-m", "lostmotion.web.worker.work"], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    one.stdin.close()
    assert one.wait(30) == 0
    one.stdout.close()
