"""Monitors on the page: files that grow, are cut, replaced, foreign or hostile; who listens is told, and is let go."""

from __future__ import annotations

import asyncio
import json
import os
import re
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

import lostmotion as lm
from lostmotion.files.grid import Rows
from lostmotion.online import OnlineMonitor
from lostmotion.online.packing import STATE, pack, unpack
from lostmotion.web.app import create_app
from lostmotion.web.monitors import monitor as monitor_module
from lostmotion.web.monitors import pages as monitor_pages
from lostmotion.web.monitors.loop_log import EVENTS, POINTS
from lostmotion.web.monitors.monitor import MOST_LOOPS, Watched
from lostmotion.web.monitors.pages import Board
from lostmotion.web.monitors.said import Said
from lostmotion.web.monitors.svg import width_chart
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


class One(Watched):
    """A place with one loop."""

    def see(self) -> Said:
        """What is said of it."""
        (said,) = self.look()
        return said


def test_a_file_that_grows_is_followed_line_by_line(path: Path) -> None:
    watched = One(str(path))
    assert "no such file" in watched.see().trouble
    write(path, START, report(100))
    first = watched.see()
    assert (first.trouble, first.status, len(first.points)) == ("", "ok", 1)
    assert first.numbers()[0] == ("width", "2.00", "1.8 .. 2.2")
    half = json.dumps(report(200, 3.0))
    write(path, half[:30])
    assert watched.see().points == first.points
    write(path, half[30:] + "\n", event(250))
    again = watched.see()
    assert [point[1] for point in again.points] == [2.0, 3.0]
    assert again.said_before("events") == [("", "It moved <b>250</b>.")]
    assert again.version > first.version
    assert watched.see().version == again.version
    json.dumps(again.to_dict(), allow_nan=False)


def test_a_file_that_is_cut_or_replaced_is_read_anew(path: Path) -> None:
    watched = One(str(path))
    write(path, START, report(100), report(200))
    assert len(watched.see().points) == 2
    write(path, START, mode="w")
    assert watched.see().points == ()
    write(path.with_suffix(".new"), report(300))
    path.with_suffix(".new").replace(path)
    assert len(watched.see().points) == 1


def test_what_is_none_of_a_monitor_is_counted_and_nothing_grows_for_ever(path: Path) -> None:
    hostile = [
        {"kind": "report", "width": "wide", "status": ["x"], "trend": "none", "time": {}},
        {"kind": "report", "width": {"value": 1e300, "high": True}, "message": {"a": 1}},
        {"kind": "event"}, {"kind": ["start"]}, [1], 7,
    ]  # fmt: skip
    write(path, "no json\n", "[" * 100_000 + "\n", *hostile, *(event(number) for number in range(2 * EVENTS)))
    write(path, *(report(number) for number in range(3 * POINTS)))
    said = One(str(path)).see()
    assert said.bad == 6
    assert len(said.events) == EVENTS
    assert len(said.points) <= POINTS
    write(path, "x" * 3_000_000)
    assert One(str(path)).see().bad == 7


ODD_NUMBERS = [-5.0, -5e-324, 5e-324, 1.7e308, -1.7e308, 1e12, 1e-13, 10**19]
ODD_TIMES = [-1.0, 1.7e308, -1.7e308, 1e15, 10**19]


@pytest.mark.anyio
async def test_reports_that_no_valve_can_give_are_counted_as_bad(path: Path) -> None:
    odd = [report(1, width) for width in ODD_NUMBERS]
    odd += [report(2) | {"width": {"value": 1.0, "low": 0.5, "high": high}} for high in (1e300, 5e-324)]
    odd += [report(3) | {name: {"value": value}} for name, value in (("left", 1e13), ("slope_ratio", -1.0))]
    odd += [report(4) | {"time": time} for time in ODD_TIMES]
    write(path, START, *(one for one in odd for _ in range(2)), report(5), report(6))
    said = One(str(path)).see()
    assert (said.bad, len(said.points)) == (2 * len(odd), 2)
    async with client(path) as asked:
        assert (await asked.get("/monitors")).status_code == 200


@pytest.mark.anyio
@pytest.mark.parametrize("times", [(0, 5e-324), (0.0, 0.0), (5, 1), (1e10, 1e10 + 1e-6), (None, 3), ("9999-12-31", 1)])
@pytest.mark.parametrize("widths", [(0.0, 0.0), (1e-12, 1e11), (3.0, 1e-12)])
async def test_what_is_plausible_can_be_drawn(path: Path, times: Any, widths: Any) -> None:
    write(path, *(report(9, width) | {"time": time} for time, width in zip(times, widths, strict=True)))
    assert One(str(path)).see().bad == 0
    async with client(path) as asked:
        assert (await asked.get("/monitors")).status_code == 200
        assert (await asked.get("/api/v1/monitors")).status_code == 200


@pytest.mark.anyio
@pytest.mark.parametrize("filling", ["[" * 30 + "]" * 30, '"' + "x" * 30 + '"', "{}", "1", "null"])
async def test_answers_stay_small_however_large_the_lines_are(path: Path, filling: str) -> None:
    many = ",".join([filling] * (900_000 // len(filling)))
    few = ",".join([filling] * 10)
    write(path, START, *(f'{{"kind": "{kind}", "x": [{many}]}}\n' for kind in ("report", "event", "note", "start")))
    write(path, *(f'{{"kind": "{kind}", "message": "{"x" * 20_000}", "x": [{few}]}}\n' for kind in ("event", "note")))
    said = One(str(path)).see()
    assert said.bad == 4
    assert len(json.dumps(said.to_dict())) < 10_000
    async with client(path) as asked:
        assert len((await asked.get("/api/v1/monitors")).content) < 20_000


@pytest.fixture(scope="module")
def state() -> bytes:
    rng = np.random.default_rng(1)
    u = lm.signals.prs(2000, -5, 5, hold=8, seed=1)
    x = np.where(u > 1, u - 1, np.where(u < -1, u + 1, 0.0))
    y = lm.LinearModel((-0.8,), (0.2,), 1).simulate(x) + 0.05 * rng.normal(size=2000)
    estimator = lm.RecursiveML(na=1, nb=0, delay=1, noise="white", start_samples=300, dt=1.0)
    monitor = OnlineMonitor(estimator, dt=1.0, report_every=200, trend_every=400)
    monitor.take(Rows(np.arange(2000.0), u, y))
    return pack(STATE, {"settings": {}, "position": {}}, monitor.to_bytes())


def test_a_state_file_tells_the_same(path: Path, state: bytes) -> None:
    path.write_bytes(state)
    said = One(str(path)).see()
    assert said.trouble == ""
    assert said.status == "ok"
    assert abs(float(said.numbers()[0][1]) - 2.0) < 0.3
    assert len(said.points) >= 3
    kept = OnlineMonitor.from_bytes(unpack(STATE, state)[1]).trend.to_dict()["points"]
    halves = [1.96 / weight**0.5 for _, _, weight in kept]  # of intervals of 95 %
    assert [high - value for _, value, _, high in said.points] == pytest.approx(halves)
    path.write_bytes(state[: len(state) // 2])
    assert "damaged" in One(str(path)).see().trouble


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
    assert json.loads(news.split("data: ")[1]) == {"monitor": 0, "name": "FIC-1.csv", "status": "ok", "version": 2}
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


def live(tag: str, sample: int, minute: int, **other: Any) -> dict[str, Any]:
    made = {**report(sample, **other), "tag": tag, "time": f"2026-03-01T00:{minute:02d}:00.000Z"}
    return {**made, "counts": {"samples": sample, "missing": 3, "manual": 0, "frozen": 2}}


def link(kind: str, message: str) -> dict[str, Any]:
    return {"tag": "", "kind": kind, "time": "2026-03-01T00:03:00.000Z", "message": message}


def test_each_loop_of_one_file_has_its_own_story(path: Path) -> None:
    write(path, link("connected", "Connected."), *({**START, "source": tag, "tag": tag} for tag in ("A", "B")))
    write(path, live("A", 60, 1), live("B", 60, 1, width=5.0), {**event(61), "tag": "B"}, live("A", 120, 9, width=3.0))
    watched = Watched(str(path))
    one, other = watched.look()
    assert [(said.title, len(said.points), len(said.events)) for said in (one, other)] == [("A", 2, 0), ("B", 1, 1)]
    assert [said.numbers()[0][1] for said in (one, other)] == ["3.00", "5.00"]
    assert one.used == "120 samples, of these not learned from: 3 missing, 2 frozen"
    assert [one.every, other.every] == [480.0, 60.0]
    write(path, link("lost", "nobody is there"), {"tag": "A", "kind": "failed", "message": "The order is wrong."})
    one, other = watched.look()
    assert (one.status, other.status) == ("given up", "silent")
    assert one.warnings[0] == "The monitor has given this loop up: The order is wrong."
    assert any("no link to its server: nobody is there" in text for text in other.warnings)
    write(path, link("connected", "Connected."), {"tag": "C", "kind": "note", "message": "New."})
    found = watched.look()
    assert [said.link for said in found] == ["", "", ""]
    assert [text for _, text in found[1].said_before("notes")] == ["Connected.", "nobody is there", "Connected."]


def test_only_loops_of_which_something_is_new_are_told(path: Path) -> None:
    write(path, live("A", 60, 1), live("B", 60, 1))
    watched = Watched(str(path))
    before = [said.version for said in watched.look()]
    assert [said.version for said in watched.look()] == before
    write(path, live("B", 120, 2))
    after = [said.version for said in watched.look()]
    assert after[0] == before[0]
    assert after[1] > max(before)


def test_a_monitor_that_has_ended_is_silent(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(path, {**START, "tag": "A"}, live("A", 60, 1), live("A", 120, 2))
    os.utime(path, (1772323320.0, 1772323320.0))
    clock = [0.0]
    monkeypatch.setattr(monitor_module.time, "time", lambda: clock[0])
    told = datetime(2026, 3, 1, 0, 2, tzinfo=UTC).timestamp()
    watched = One(str(path))
    clock[0] = told + 179.0
    alive = watched.see()
    assert (alive.status, alive.warnings, alive.last_heard) == ("ok", [], "2026-03-01 00:02:00 UTC")
    clock[0] = told + 181.0
    dead = watched.see()
    assert dead.status == "silent"
    assert "since 2026-03-01 00:02:00 UTC, though something was due every 60 s" in dead.warnings[0]
    assert dead.version > alive.version
    os.utime(path, (told + 200.0, told + 200.0))
    write(path, live("A", 180, 3))
    os.utime(path, (told + 200.0, told + 200.0))
    clock[0] = told + 201.0
    assert watched.see().status == "ok"


def test_a_folder_of_states_has_a_loop_in_each(tmp_path: Path, state: bytes) -> None:
    folder = tmp_path / "states"
    folder.mkdir()
    watched = Watched(str(folder))
    assert "no state is in this folder" in watched.look()[0].trouble
    (folder / "FIC%2F101.state").write_bytes(state)
    (folder / "LIC 7.state").write_bytes(state[:50])
    (folder / ".LIC 7.state.lock").touch()
    first, second = watched.look()
    assert (first.title, first.status, first.trouble) == ("FIC/101", "ok", "")
    assert first.used.startswith("2000 samples")
    assert (second.title, second.status) == ("LIC 7", "cannot be read")
    os.utime(folder / "FIC%2F101.state", (1.7e9, 1.7e9))
    assert watched.look()[0].status == "silent"
    (folder / "FIC%2F101.state").unlink()
    assert [said.title for said in watched.look()] == ["LIC 7"]


def test_tags_of_a_hostile_file_do_not_grow_for_ever(path: Path) -> None:
    write(path, *({"tag": f"T{number}", "kind": "note", "message": ""} for number in range(MOST_LOOPS + 10)))
    write(path, {"tag": "x" * 1000, "kind": "note"}, {"tag": ["x"], "kind": "note"}, {"tag": "new", "kind": "odd"})
    found = Watched(str(path)).look()
    assert len(found) == MOST_LOOPS
    assert found[0].bad == 13


@pytest.mark.anyio
async def test_the_page_lists_all_loops_and_shows_those_that_need_somebody(path: Path) -> None:
    write(path, *(live(f"FIC-{number:03d}", 60, 1) for number in range(80)), {**event(61), "tag": "FIC-077"})
    async with client(path) as asked:
        page = (await asked.get("/monitors")).text
        assert page.count("data-monitor=") == page.count("data-row=") == monitor_pages.MOST_SHOWN
        assert "80 loops; shown are the 60" in page
        assert 'id="monitor-77"' in page
        one = (await asked.get("/monitors?text=fic-042")).text
        assert one.count("data-monitor=") == 1
        assert "No loop fits" in (await asked.get("/monitors?text=<b>")).text
        part = (await asked.get("/monitors?part=77")).text
        assert 'data-row="77"' in part
        told = (await asked.get("/api/v1/monitors")).json()["monitors"]
        assert [one["monitor"] for one in told] == list(range(80))
        assert told[77]["tag"] == "FIC-077"


def test_a_report_between_two_gaps_is_seen():
    """A line through one point has no length."""
    hours = [*range(10), 30, *range(50, 60)]
    drawn = str(width_chart([(float(3600 * hour), 1.0, 0.8, 1.2) for hour in hours]))
    lines = re.findall(r'class="pv" d="M([^"]*)"', drawn)
    assert len(lines) == 3
    for one in lines:
        places = [float(place) for place in one.split()[::2]]
        assert max(places) > min(places)
    assert "in 21 reports" in drawn
    assert " 2 gaps." in drawn
    assert " 1 gap." in str(width_chart([(float(hour), 1.0, None, None) for hour in (0, 1, 2, 9, 10)]))
