"""``lostmotion live --store``: estimates of a running plant stand beside the sizes of an audit, on its page too."""

import asyncio
import json
import os
import re
import signal
import subprocess
import sys

import httpx
import pytest

pytest.importorskip("asyncua")

from lostmotion.store.run_rows import RunState
from lostmotion.store.store import Store
from lostmotion.web.app import create_app
from lostmotion.web.page import Page
from tests.support.live_server import killed, node, started
from tests.support.patience import in_time
from tests.support.places import ROOT
from tests.support.plant_stores import plant_store

pytestmark = pytest.mark.long


def live(port, store, tag, *words):
    """The command on the worn loop of the server, under the name of a loop of the audit."""
    line = [
        sys.executable, "-m", "lostmotion", "live", f"opc.tcp://127.0.0.1:{port}", "--insecure", "--tag", tag,
        "--op", node("FIC001", "OP"), "--pv", node("FIC001", "PV"), "--orders", "1,0,0", "--dt", "0.05",
        "--start-samples", "200", "--report-every", "50", "--store", str(store), *words,
    ]  # fmt: skip
    env = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    return subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=env, text=True)


def estimates(process, count):
    """The next reports with an estimate."""
    found = []
    with in_time(process):
        while len(found) < count:
            line = process.stdout.readline()
            assert line, process.stderr.read()
            message = json.loads(line)
            if message["kind"] == "report" and message["width"]:
                found.append(message)
    return found


def asked(store, path):
    async def of_page():
        transport = httpx.ASGITransport(app=create_app(Page(store)))
        async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1") as client:
            return await client.get(path)

    answer = asyncio.run(of_page())
    assert answer.status_code == 200, answer.text
    return answer


def test_estimates_of_a_running_plant_are_on_the_page_of_the_audit(tmp_path):
    store = plant_store(tmp_path, data=False)
    server, port = started(0, "2", "0.05", "none", "beside")
    try:
        process = live(port, store, "FIC-2")
        told = estimates(process, 3)
        other = live(port, store, "FIC-2")
        _, said = other.communicate(timeout=120)
        process.send_signal(signal.SIGTERM)
        rest, _ = process.communicate(timeout=60)
    finally:
        killed(server)
    assert (other.returncode, process.returncode) == (1, 0)
    assert "expected loops that nobody else watches into the store" in said
    assert "got FIC-2 of watch 1 of process" in said
    told += [one for one in map(json.loads, rest.splitlines()) if one["kind"] == "report" and one["width"]]
    with Store(store, write=False) as kept:
        found = {row.sample: row for _, row in kept.estimates("FIC-2")}
        assert [(one.state, one.source) for one in kept.watches()] == [
            (RunState.STOPPED, f"opc.tcp://127.0.0.1:{port}")
        ]
        assert len(kept.runs()) == 2, "no audit came from it"
        assert kept.loop("FIC-2").op == "", "as the audit has the loop"
    assert {one["sample"] for one in told} == set(found)
    for one in told:
        row, width = found[one["sample"]], one["width"]
        assert (row.width, row.low, row.high, row.status) == (
            width["value"],
            width["low"],
            width["high"],
            one["status"],
        )
        assert row.at.isoformat().startswith(one["time"].removesuffix("Z"))
    history = asked(store, "/api/v1/loops/FIC-2").json()["history"]
    assert [one["live"] for one in history].count(True) == len(found)
    page = asked(store, "/loops/FIC-2").text
    assert len(re.findall(r">live 1<", page)) == len(found)
    assert "on the running plant" in page


def test_a_store_that_cannot_be_used_is_told_before_anything_is_watched(tmp_path):
    (tmp_path / "a.csv").write_text("time,OP,PV\n" * 200)
    process = live(1, tmp_path / "a.csv", "FIC-2")
    _, said = process.communicate(timeout=120)
    assert process.returncode == 1
    assert "got a file that is none; give the store another name" in said
