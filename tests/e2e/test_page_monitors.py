"""Running loops on the page: a server, `lostmotion live` on two loops, `lostmotion serve` beside it, until it dies."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
import threading
import time

import httpx
import pytest

pytest.importorskip("asyncua")

import lostmotion as lm
from tests.support.live_server import LoopServer
from tests.support.served import ROOT, Served

pytestmark = pytest.mark.long

TAGS = ("FIC1", "LIC/2")
SAMPLES, DT, GONE = 2000, 0.1, range(1200, 1240)
PLANT = """address = "{}"
[defaults]
orders = [3, 2, 3]
dt = 0.1
start_samples = 700
report_every = 100
"""
LOOP = """[[loop]]
tag = "{0}"
op = "ns=2;s={0}.OP"
pv = "ns=2;s={0}.PV"
"""


class Plant(threading.Thread):
    """A server whose valves have a dead zone of 2; samples come when they are let go."""

    def __init__(self):
        super().__init__(daemon=True)
        self.ready, self.go, self.end = (threading.Event() for _ in range(3))
        self.start()
        assert self.ready.wait(300)

    def run(self):
        asyncio.run(self._serve())

    async def _serve(self):
        async with LoopServer(TAGS, history=True) as plant:  # on a busy machine the link may be lost
            self.address = plant.address
            self.ready.set()
            await asyncio.to_thread(self.go.wait)
            loops = [lm.routine_operation(SAMPLES, drift="none", seed=seed) for seed in range(len(TAGS))]
            for k in range(SAMPLES):
                for tag, loop in zip(TAGS, loops, strict=True):
                    if k not in GONE:
                        await plant.write(tag, "OP", float(loop.command[k]), DT * (k + 1))
                        await plant.write(tag, "PV", float(loop.measured[k]), DT * (k + 1))
                if k % 20 == 0:
                    await asyncio.sleep(0.01)
            await asyncio.to_thread(self.end.wait)


def asked(served, path):
    """Answer to a program."""
    answer = httpx.get(served.base + path, headers={"Authorization": f"Bearer {served.token}"}, timeout=60)
    assert answer.status_code == 200
    return answer


def said(served):
    """What the page says of each loop: by file and tag."""
    return {(one["name"], one["tag"]): one for one in asked(served, "/api/v1/monitors").json()["monitors"]}


def until(found, patience=240.0):
    """What is found in time."""
    ends = time.monotonic() + patience
    while not (last := found()):
        assert time.monotonic() < ends, "it did not come"
        time.sleep(0.3)
    return last


def test_loops_that_run_are_seen_with_their_gaps_and_that_their_monitor_died(tmp_path):
    plant, states, lines = Plant(), tmp_path / "states", tmp_path / "live.jsonl"
    states.mkdir()
    (tmp_path / "plant.toml").write_text(PLANT.format(plant.address) + "".join(map(LOOP.format, TAGS)))
    env = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    command = [sys.executable, "-m", "lostmotion", "live", tmp_path / "plant.toml", "--insecure", "--state", states]
    with lines.open("w") as out:
        live = subprocess.Popen(command, stdout=out, stderr=subprocess.PIPE, env=env)
    served = Served("--monitor", lines, "--monitor", states)
    try:
        until(lambda: "Connected" in lines.read_text(), 300.0)
        plant.go.set()
        keys = [(lines.name, tag) for tag in TAGS]
        found = until(lambda: (now := said(served)) and all(len(now.get(key, {}).get("points", ())) > 4 for key in keys)
                      and now)  # fmt: skip
        for key in keys:
            one = found[key]
            assert (one["status"], one["silent"], one["failure"]) == ("ok", False, "")
            width = one["report"]["width"]
            assert width["low"] < 2.0 < width["high"]
            assert one["every"] == pytest.approx(100 * DT)
        done = until(lambda: (now := said(served))[keys[0]]["report"]["sample"] > SAMPLES - 200 and now)
        missing = done[keys[0]]["report"]["counts"]["missing"]
        assert missing >= len(GONE)
        assert {("FIC1.state", "FIC1"), ("LIC%2F2.state", "LIC/2")} <= set(done)
        page = asked(served, "/monitors").text
        assert page.count("Width over time") >= 2
        assert f"samples, of these not learned from: {missing} missing" in page
        plant.end.set()
        lost = until(lambda: (now := said(served)[keys[0]])["link"] and now)
        assert lost["status"] in ("no link", "silent")
        live.kill()
        dead = until(lambda: (now := said(served)[keys[0]])["silent"] and now)
        assert dead["status"] == "silent"
    finally:
        plant.go.set()
        plant.end.set()
        live.kill()
        live.communicate(timeout=30)
        assert served.stop() == 0
