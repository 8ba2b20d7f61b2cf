"""``lostmotion demo-live``: its loops are found and watched, its blocks do what a supervisor and an operator say."""

import asyncio
import contextlib
import itertools
import json
import math
import os
import re
import signal
import subprocess
import sys
import threading
import time
from types import SimpleNamespace

import pytest

pytest.importorskip("asyncua")

from asyncua import ua

from lostmotion.cli import main
from lostmotion.errors import GateError
from lostmotion.live.audit_log import AuditLog
from lostmotion.live.opcua.client import connected
from lostmotion.live.opcua.discover import discovered
from lostmotion.live.opcua.plc_link import PlcLink, nodes_of
from lostmotion.live.supervisor import Supervisor
from lostmotion.live.virtual_plant import VirtualPlant
from tests.support.patience import in_time
from tests.support.places import ROOT

pytestmark = pytest.mark.long

SPEED = 4.0  # a scan is 0.125 s, and the time-out of the block 2.5 s
PRESSED = "ns=2;s=FY102.ACCEPT"


def command(*words):
    env = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    line = [sys.executable, "-m", "lostmotion", *words]
    return subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=env)


@pytest.fixture(scope="module")
def plant():
    """Address of a plant that runs; Ctrl-C ends it."""
    process = command("demo-live", "--port", "0", "--speed", f"{SPEED:g}", "--seconds", "300")
    lines = list(itertools.takewhile(lambda line: "Ctrl-C" not in line, process.stdout))
    assert lines, process.stderr.read()
    yield re.search(r"opc\.tcp://\S+:\d+", lines[0]).group()
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=30)
    assert (process.returncode, sum("  lostmotion live " in line for line in lines)) == (0, 2)
    assert len(said.splitlines()) == 1, said
    assert said.startswith("INSECURE")


async def on(address, work):
    client = await connected(address, insecure=True)
    try:
        return await work(client)
    finally:
        await client.disconnect()


def test_its_loops_are_found(plant):
    found = asyncio.run(on(plant, discovered))
    assert [(loop.tag, loop.op) for loop in found] == [
        (tag, f"ns=2;s={tag}.OP") for tag in ("LIC101", "FIC102", "TIC103")
    ]
    assert all(loop.sp and loop.mode for loop in found)


def test_its_loops_are_watched(plant):
    live = command(
        "live", plant, "--op", "ns=2;s=FIC102.OP", "--pv", "ns=2;s=FIC102.PV", "--orders", "1,0,1",
        "--dt", f"{0.5 / SPEED:g}", "--report-every", "10", "--insecure",
    )  # fmt: skip
    try:
        kinds = (json.loads(line) for line in live.stdout)
        with in_time(live):
            samples = [next(one["sample"] for one in kinds if one["kind"] == "report") for _ in range(2)]
    finally:
        live.send_signal(signal.SIGINT)
        _, said = live.communicate(timeout=60)
    assert samples == [10, 20]
    assert (live.returncode, len(said.splitlines())) == (0, 1), said


def until(supervisor, what, seconds=10.0):
    """Cycles until the supervisor has seen it."""
    end = time.monotonic() + seconds
    while not what(seen := supervisor.cycle()):
        assert time.monotonic() < end, seen
        time.sleep(0.05)
    return seen


def proposed(supervisor, study, seconds=30.0):
    """A request, of a block that sees the heartbeat: on a busy machine it loses it from one line to the next."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        until(supervisor, lambda report: report.seen["link_ok"])
        with contextlib.suppress(GateError):
            return supervisor.propose(study, "anna")
    return supervisor.propose(study, "anna")


def test_a_request_is_shown_accepted_in_force_and_shed_without_a_heartbeat(plant, tmp_path):
    block = VirtualPlant.worn().loops["FIC-102"].block
    tried = block.block.with_settings(factor=0.5)
    study = SimpleNamespace(safe=True, recommendation="compensate", block=tried, described="a test")

    async def press(client):
        await asyncio.sleep(0.5)  # shown for two scans at least
        await client.get_node(PRESSED).write_value(True)

    with PlcLink(plant, nodes_of(block, "ns=2;s=FY102."), insecure=True) as link:
        supervisor = Supervisor(block, link, AuditLog(tmp_path / "log"), name="FY102", write=True)
        request = proposed(supervisor, study)
        until(supervisor, lambda report: report.request == "verified")
        operator = threading.Thread(target=asyncio.run, args=(on(plant, press),))
        operator.start()
        seen = until(supervisor, lambda report: report.request == "accepted").seen
        operator.join()
        assert (seen["force_id"], seen["force_factor"]) == (request.id, 0.5)
        until(supervisor, lambda report: report.block == "active")
        before = time.monotonic()
        while link.read(["supervision"])["supervision"] != 4.0:
            assert time.monotonic() - before < 10.0
            time.sleep(0.05)
        seen = link.read(["force_id", "shed_reason"])
        assert seen == {"force_id": 0.0, "shed_reason": 2.0}


def test_what_is_no_number_is_left_where_it_stands(plant):
    odd = {
        "LIC101.SP": [ua.Variant(math.nan, ua.VariantType.Double), ua.Variant("high"), ua.Variant(1e9)],
        "LY101.HEARTBEAT": [ua.Variant(-(2**31), ua.VariantType.Int32), ua.Variant("high"), ua.Variant(None)],
        "LY101.ACCEPT": [ua.Variant("yes"), ua.Variant(7)],
    }

    async def write(client):
        for name, values in odd.items():
            for value in values:
                with contextlib.suppress(ua.UaError):  # some are refused by their type
                    await client.get_node(f"ns=2;s={name}").write_value(value)
                await asyncio.sleep(0.2)
        await asyncio.sleep(0.3)
        return await client.get_node("ns=2;s=LIC101.SP").read_value()

    assert asyncio.run(on(plant, write)) == 100.0


@pytest.mark.parametrize("words", [("--speed", "0"), ("--speed", "nan"), ("--seconds", "-1")])
def test_odd_settings_are_refused(words, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["demo-live", *words])
    assert stop.value.code == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_a_port_in_use_is_told_in_one_line(plant, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["demo-live", "--port", plant.rpartition(":")[2]])
    assert stop.value.code == 1
    assert capsys.readouterr().err.splitlines()[-1].startswith("error: expected a free port, got ")
