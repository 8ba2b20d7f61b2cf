"""Trend as JSON, as piece and page: rows of the address, links without script, loops read again, hostile names."""

from __future__ import annotations

import re
import secrets
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from starlette.datastructures import QueryParams

from lostmotion.errors import ParameterError
from lostmotion.records import LoopRecord
from lostmotion.web.app import create_app
from lostmotion.web.desk.desk import Desk
from lostmotion.web.kept_record import kept_columns
from lostmotion.web.page import Page
from lostmotion.web.trend import loop_records
from lostmotion.web.trend.columns import Columns
from lostmotion.web.trend.loop_records import LoopRecords, Read, read_again
from lostmotion.web.trend.pages import sources
from lostmotion.web.trend.slot import LEAST, asked, slot, steps
from lostmotion.web.trend.sources import Source
from tests.support.patience import until
from tests.support.plant_rows import HOSTILE, finding, trace
from tests.support.plant_stores import plant_store
from tests.support.served import put_on_desk

pytestmark = pytest.mark.anyio


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


def record(**other: Any) -> LoopRecord:
    t = np.arange(5000)
    op = 50.0 + 5.0 * np.sin(t / 50.0)
    pv = 20.0 + np.sin((t - 5) / 50.0)
    pv[3000:3100] = np.nan
    return LoopRecord(op, pv, pv, dt=1.0, start="2026-03-02T06:00", op_unit="%", pv_unit="t/h", **other)


@pytest.fixture
def page(tmp_path: Path) -> Any:
    item = put_on_desk(tmp_path / "desk", record(tag=HOSTILE[0]), "FIC <script>.csv")
    desk = Desk(tmp_path / "desk")
    yield Page(plant_store(tmp_path), desk), f"file:{item}"
    desk.close()


def client(page: Page) -> httpx.AsyncClient:
    return httpx.AsyncClient(transport=httpx.ASGITransport(create_app(page)), base_url="http://here")


async def test_json_of_some_rows(page: Any) -> None:
    async with client(page[0]) as ask:
        found = (await ask.get("/api/v1/trend", params={"source": page[1], "start": 1000, "stop": 1100})).json()
        assert found["names"] == {"sp": "SP [t/h]", "pv": "PV [t/h]", "op": "OP [%]"}
        assert found["axis"] == {"from": 1000.0, "scale": 1.0, "name": "s since 2 Mar 2026 06:16"}
        assert len(found["pv"]) == 100
        whole = (await ask.get("/api/v1/trend", params={"source": page[1], "width": 50})).json()
        assert len(whole["pv"]) == 100
        assert whole["shaded"] == [[3000.0, 3100.0, "missing"]]


@pytest.mark.parametrize(
    ("query", "status"),
    [
        ({"source": "file:../../etc/passwd"}, 404),
        ({"source": "loop:FIC-999"}, 404),
        ({"source": ""}, 404),
        ({"source": "other:1"}, 404),
        ({"start": "soon"}, 400),
        ({"start": "9" * 5000, "stop": "1"}, 400),
        ({"start": "6000", "stop": "7000"}, 400),
        ({"width": "0"}, 400),
        ({"run": "x"}, 400),
    ],
)
async def test_what_is_not_there_is_said_as_json_and_as_a_page(page: Any, query: dict[str, str], status: int) -> None:
    async with client(page[0]) as ask:
        answer = await ask.get("/api/v1/trend", params={"source": page[1], **query})
        assert answer.status_code == status
        assert answer.json()["message"]
        if "width" not in query:
            shown = await ask.get("/trend", params={"source": page[1], **query})
            assert (shown.status_code, shown.headers["content-type"]) == (status, "text/html; charset=utf-8")


async def test_the_page_zooms_by_links_and_holds_no_script_of_others(page: Any) -> None:
    async with client(page[0]) as ask:
        text = (await ask.get("/trend", params={"source": page[1]})).text
        assert "<script>" not in text
        assert "FIC &lt;script&gt;.csv" in text
        assert not re.search(r"\s(style|on\w+)=", text)
        link = re.search(r'data-step="in"[^>]* href="([^"]+)"', text)
        assert link is not None
        assert "start=1250&amp;stop=3750" in link[1]
        nearer = await ask.get(link[1].replace("&amp;", "&"))
        assert "missing: 2026-03-02 06:50:00, 100 s" in nearer.text
        assert nearer.text.count("<tr>") == 13
        part = (await ask.get("/trend", params={"source": page[1], "part": "1", "start": 5, "stop": 90})).text
        assert "<html" not in part
        assert part.count("data-piece=") == 2


async def test_whether_data_are_read_is_asked_without_an_error(page: Any) -> None:
    """A browser tells of every status of 400 and more, and that the data cannot be read is an answer."""
    async with client(page[0]) as ask:
        found = await ask.get("/api/v1/trend/state", params={"source": page[1]})
        assert (found.status_code, found.json()["state"]) == (200, "ready")
        assert (await ask.get("/api/v1/trend/state", params={"source": "loop:NOT-THERE"})).status_code == 404


async def test_columns_are_made_once_and_again_when_the_record_is_another(page: Any) -> None:
    found = sources(page[0])
    first = found.of(page[1])
    assert first is not None
    assert first.columns is not None
    again = found.of(page[1])
    assert again is not None
    assert again.columns is first.columns


def test_steps_stay_inside_the_record() -> None:
    for start, stop in ((0, 10), (0, 3), (990, 1000), (400, 500), (0, 1000)):
        for name, _, ends in steps(start, stop, 1000):
            if ends is not None:
                assert 0 <= ends[0] < ends[1] <= 1000, name
                assert ends != (start, stop)
                assert ends[1] - ends[0] >= min(LEAST, stop - start)


def test_pv_over_op_has_the_band_of_what_was_found() -> None:
    columns = Columns.of(record())
    source = Source("loop:FIC-1", "FIC-1", "ready", columns=columns, row=finding(), trace=trace())
    made = slot(source, "/loops/FIC-1", QueryParams("run=2&start=0&stop=900"), with_actuator=True)
    assert 'class="lost"' in made.plane
    assert "Identified actuator" in made.actuator
    links = {name: address for name, _, address in made.links}
    assert links["all"] == "/loops/FIC-1?run=2&start=0&stop=5000#trend"
    bare = slot(Source("loop:FIC-1", "FIC-1", "ready", columns=columns), "/x", QueryParams(""))
    assert 'class="lost"' not in bare.plane
    assert not bare.sized


def test_a_record_without_dates_or_values_is_drawn_too() -> None:
    empty = LoopRecord([np.nan] * 100, [np.nan] * 100, dt=0.1)
    made = slot(Source("file:a", "a", "ready", columns=Columns.of(empty)), "/x", QueryParams(""))
    assert not made.plane
    assert made.shown == "0 s to 10 s after the start (10 s)"
    assert made.stretches == ("missing: 0 s, 10 s",)


def test_whole_numbers_of_an_address() -> None:
    assert asked({"start": "7"}, "start", 0) == 7
    assert asked({}, "start", 3) == 3
    with pytest.raises(ParameterError, match="a whole number as start"):
        asked({"start": "1e3"}, "start", 0)


def test_a_loop_is_read_again_from_where_the_audit_found_it(tmp_path: Path) -> None:
    read = Read(plant_store(tmp_path), 2, str(tmp_path / "plant"), "FIC-1")
    assert read_again(read, tmp_path / "one") == ""
    assert len(kept_columns(tmp_path / "one")) == 4000
    (tmp_path / "plant" / "record.csv").write_text("nothing\n")
    assert read_again(Read(read.store, 2, read.source, "FIC-2"), tmp_path / "two")
    assert not (tmp_path / "two").exists()


def test_loops_are_read_again_by_processes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Relative addresses, as the page was started with them; one that takes too long is stopped."""
    plant_store(tmp_path)
    monkeypatch.chdir(tmp_path)
    (store,) = tmp_path.glob("*.db")
    loops = LoopRecords()
    read = Read(store.name, 2, "plant", "FIC-1")
    assert loops.ask(read) is None
    folder = until(lambda: loops.ask(read))
    assert isinstance(folder, Path), folder
    assert len(kept_columns(folder)) == 4000
    assert loops.ask(read) == folder
    monkeypatch.setattr(loop_records, "SECONDS", 0.0)
    assert until(lambda: loops.ask(Read(store.name, 2, "plant", "FIC-2"))).endswith("it takes too long.")


def test_data_that_are_gone_are_said_to_be(tmp_path: Path) -> None:
    why = LoopRecords().ask(Read("plant.db", 1, str(tmp_path / secrets.token_hex(4)), "FIC-1"))
    assert isinstance(why, str)
    assert "not here any more" in why
