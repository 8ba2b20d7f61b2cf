"""Limits of the desk hold whoever asks at the same time, and however often."""

import asyncio
import threading

import httpx
import pytest

from lostmotion.web.app import create_app
from lostmotion.web.desk.desk import Desk, Limits
from lostmotion.web.page import Page
from lostmotion.web.worker import handle as worker_module
from tests.unit.web import test_files

FORM = [("file", (f"{n}.csv", b"slow" + b"x" * 1000)) for n in range(40)]


@pytest.fixture(autouse=True)
def small_worker(monkeypatch):
    monkeypatch.setattr(worker_module, "WORKER", ("-c", test_files.SCRIPT))


@pytest.fixture
def desk():
    made = Desk(limits=Limits(file_bytes=100_000, all_bytes=400_000))
    yield made
    made.close()


def posted(desk, *requests):
    """Statuses of requests that come at the same time."""

    async def asked():
        transport = httpx.ASGITransport(create_app(Page(desk=desk)))
        async with httpx.AsyncClient(transport=transport, base_url="http://page") as client:
            return [one.status_code for one in await asyncio.gather(*(client.post(*a, **b) for a, b in requests))]

    return asyncio.run(asked())


def test_forms_that_come_together_hold_no_more_files_than_one(desk):
    assert posted(desk, *[(("/files",), {"files": FORM})] * 2) == [303, 303]
    assert len(desk.items()) == desk.limits.files
    assert len([path for path in desk.records.iterdir() if path.is_dir()]) == desk.limits.files


def test_forms_that_come_together_hold_no_more_bytes(desk):
    large = [("file", ("a.csv", b"slow" + b"x" * 60_000))]
    for _ in range(4):
        posted(desk, *[(("/files",), {"files": large})] * 3)
    used = sum(path.stat().st_size for path in desk.records.rglob("*") if path.is_file())
    assert used <= desk.limits.all_bytes
    assert len(desk.items()) >= 4


def test_the_same_work_is_asked_for_once(desk):
    """Other files do not wait for 60 studies of one."""
    item = test_files.made(desk, test_files.RESULT)
    test_files.dropped(desk, b"slow")
    study = (f"/files/{item.id}/study",), {"data": {"kp": "1"}}
    assert set(posted(desk, *[study] * 60)) == {303}
    last = test_files.dropped(desk, b"slow", "other.csv")
    assert desk.jobs.ahead(desk.jobs.of(last.id)) == 2
    posted(desk, *[((f"/files/{item.id}/study",), {"data": {"kp": str(n)}}) for n in range(60)])
    assert desk.jobs.ahead(desk.jobs.of(last.id)) == 1


def test_the_same_files_are_opened_once_by_many_at_once(desk, tmp_path):
    file = tmp_path / "a.csv"
    file.write_bytes(b"slow")
    threads = [threading.Thread(target=desk.open, args=([str(file)], "a")) for _ in range(20)]
    for one in threads:
        one.start()
    for one in threads:
        one.join()
    assert len(desk.items()) == 1
