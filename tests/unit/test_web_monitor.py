"""Monitors on the page: files that grow, are cut, replaced, foreign or hostile; who listens is told, and is let go."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

import lostmotion as lm
from lostmotion.files.grid import Rows
from lostmotion.online import OnlineMonitor
from lostmotion.online.packing import pack
from lostmotion.online.service import KIND
from lostmotion.web.app import create_app
from lostmotion.web.monitors import pages as monitor_pages
from lostmotion.web.monitors.monitor import EVENTS, POINTS, Watched
from lostmotion.web.monitors.pages import Board
from lostmotion.web.page import Page

START = {"kind": "start", "source": "FIC-1.csv", "op": "OP", "pv": "PV", "dt": 1.0, "sample": 0, "message": ""}


def report(sample: int, width: float = 2.0, **other: Any) -> dict[str, Any]:
    numbers = {"value": width, "standard_error": 0.1, "low": width - 0.2, "high": width + 0.2}
    made = {"kind": "report", "time": f"2026-03-01T00:{sample // 60 % 60:02d}:{sample % 60:02d}", "sample": sample}
    return {**made, "status": "OK", "message": "Estimated.", "width": numbers, "left": numbers, **other}


def event(sample: int) -> dict[str, Any]:
    return {"kind": "event", "time": None, "sample": sample, "name": "left", "message": f"It moved <b>{sample}</b>."}


def write(path: Path, *messages: Any, mode: str = "a") -> None:
    with path.open(mode) as file:
        file.writelines(one if isinstance(one, str) else json.dumps(one) + "\n" for one in messages)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "fic1.jsonl"


def test_a_file_that_grows_is_followed_line_by_line(path: Path) -> None:
    watched = Watched(str(path))
    assert "no such file" in watched.look().trouble
    write(path, START, report(100))
    first = watched.look()
    assert (first.trouble, first.status, len(first.points)) == ("", "ok", 1)
    assert first.numbers()[0] == ("width", "2.00", "1.8 .. 2.2")
    half = json.dumps(report(200, 3.0))
    write(path, half[:30])
    assert watched.look().points == first.points
    write(path, half[30:] + "\n", event(250))
    again = watched.look()
    assert [point[1] for point in again.points] == [2.0, 3.0]
    assert again.said_before("events") == [("", "It moved <b>250</b>.")]
    assert again.version > first.version
    assert watched.look().version == again.version
    json.dumps(again.to_dict(), allow_nan=False)


def test_a_file_that_is_cut_or_replaced_is_read_anew(path: Path) -> None:
    watched = Watched(str(path))
    write(path, START, report(100), report(200))
    assert len(watched.look().points) == 2
    write(path, START, mode="w")
    assert watched.look().points == ()
    write(path.with_suffix(".new"), report(300))
    path.with_suffix(".new").replace(path)
    assert len(watched.look().points) == 1


def test_what_is_none_of_a_monitor_is_counted_and_nothing_grows_for_ever(path: Path) -> None:
    hostile = [
        {"kind": "report", "width": "wide", "status": ["x"], "trend": "none", "time": {}},
        {"kind": "report", "width": {"value": 1e300, "high": True}, "message": {"a": 1}},
        {"kind": "event"}, {"kind": ["start"]}, [1], 7,
    ]  # fmt: skip
    write(path, "no json\n", "[" * 100_000 + "\n", *hostile, *(event(number) for number in range(2 * EVENTS)))
    write(path, *(report(number) for number in range(3 * POINTS)))
    said = Watched(str(path)).look()
    assert said.bad == 5
    assert len(said.events) == EVENTS
    assert len(said.points) <= POINTS
    write(path, "x" * 3_000_000)
    assert Watched(str(path)).look().bad == 6


@pytest.fixture(scope="module")
def state() -> bytes:
    rng = np.random.default_rng(1)
    u = lm.signals.prs(2000, -5, 5, hold=8, seed=1)
    x = np.where(u > 1, u - 1, np.where(u < -1, u + 1, 0.0))
    y = lm.LinearModel((-0.8,), (0.2,), 1).simulate(x) + 0.05 * rng.normal(size=2000)
    estimator = lm.RecursiveML(na=1, nb=0, delay=1, noise="white", start_samples=300, dt=1.0)
    monitor = OnlineMonitor(estimator, dt=1.0, report_every=200, trend_every=400)
    monitor.take(Rows(np.arange(2000.0), u, y))
    return pack(KIND, {"settings": {}, "position": {}}, monitor.to_bytes())


def test_a_state_file_tells_the_same(path: Path, state: bytes) -> None:
    path.write_bytes(state)
    said = Watched(str(path)).look()
    assert said.trouble == ""
    assert said.status == "ok"
    assert abs(float(said.numbers()[0][1]) - 2.0) < 0.3
    assert len(said.points) >= 3
    path.write_bytes(state[: len(state) // 2])
    assert "damaged" in Watched(str(path)).look().trouble


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


def client(*paths: Path) -> httpx.AsyncClient:
    app = create_app(Page(monitors=tuple(str(path) for path in paths)))
    return httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://here")


@pytest.mark.anyio
async def test_page_and_json_say_it_without_script_and_escape_it(path: Path) -> None:
    write(path, {**START, "source": "<script>alert(1)</script>"}, report(100), report(200, 3.0), event(250))
    write(path, {"kind": "note", "line": 3, "message": "<img src=x onerror=alert(2)>"}, {"kind": "report", "trend": 1})
    async with client(path, path.with_name("none")) as asked:
        page = await asked.get("/monitors")
        assert page.status_code == 200
        assert "It moved &lt;b&gt;250" in page.text
        assert "Width over time" in page.text
        assert "<script>alert" not in page.text
        assert "<img" not in page.text
        assert "no such file" in page.text
        told = (await asked.get("/api/v1/monitors")).json()["monitors"]
        assert [one["status"] for one in told] == ["waiting", "cannot be read"]
        part = (await asked.get("/monitors?part=0")).text
        assert part.count("data-monitor=") == 1
        assert (await asked.get("/monitors?part=7")).status_code == 404
        assert (await asked.get("/monitors?part=²")).status_code == 404


@pytest.mark.anyio
async def test_who_listens_is_told_what_is_new(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(monitor_pages, "EVERY", 0.02)
    monkeypatch.setattr(monitor_pages, "BEAT", 0.2)
    write(path, START)
    board = Board([str(path)])
    stream = board.news()
    assert "retry" in await anext(stream)
    assert await anext(stream) == ": still here\n\n"
    write(path, report(100))
    news = await anext(stream)
    assert json.loads(news.split("data: ")[1]) == {"monitor": 0, "name": path.name, "status": "ok", "version": 2}
    await stream.aclose()  # type: ignore[attr-defined]
    await asyncio.sleep(0.1)
    assert board._task is not None
    assert board._task.done(), "nobody listens: the files are not looked at any more"


@pytest.mark.anyio
async def test_a_listener_that_does_not_take_its_news_is_sent_away(path: Path) -> None:
    write(path, START)
    board = Board([str(path)])
    slow = board.news()
    await anext(slow)
    said = board.look()[0]
    for _ in range(monitor_pages.WAITING + 1):
        board._tell(0, said)
    assert not board._listening
    assert len([one async for one in slow]) == monitor_pages.WAITING - 1
    others = [board.news() for _ in range(monitor_pages.MOST_CLIENTS)]
    for one in others:
        await anext(one)
    assert board.full
    for one in others:
        await one.aclose()  # type: ignore[attr-defined]
    assert not board.full
