"""`demo-live --plc`: exported ST in the ST machine, behind the OPC UA server, does what the compiled kernel does."""

import asyncio
import shlex
import sys
from datetime import UTC, datetime, timedelta
from functools import partial

import pytest

pytest.importorskip("asyncua")

from asyncua import ua

from lostmotion.compensate.request import Request
from lostmotion.errors import FileAccessError
from lostmotion.live.child_plc import ChildPlc
from lostmotion.live.opcua.client import connected
from lostmotion.live.opcua.demo_server import DemoServer
from lostmotion.live.virtual_plant import VirtualPlant
from tests.plc.machine import LIBRARY, need
from tests.support.command import run
from tests.support.places import ROOT
from tests.support.supervised import supervised

pytestmark = pytest.mark.long

CHILD = (sys.executable, "-m", "tests.plc.child")
SCANS = 220
LOOPS = {"LIC-101": "LY101", "FIC-102": "FY102", "TIC-103": "TY103"}
WIDTHS = {1: (1_400, 1_400), 2: (900, 900), 3: (48_400, 51_500)}
STATES = {"LY101": {0, 1, 2, 3, 4}, "FY102": {0, 1, 2, 3}, "TY103": {0, 1, 2, 3, 4}}  # FY102 has a cold start


def asked(scan, key):
    """What a client writes before a scan: a beat but for a stretch, a request, an accept, a wrong one, a withdrawal."""
    written = {} if 150 <= scan < 185 else {"HEARTBEAT": scan}
    right = Request(7, 500, *WIDTHS[key], key)
    if scan == 20:
        written |= {name.upper(): value for name, value in right.values.items()}
    if scan == 60:
        written |= {"REQUEST_ID": 8, "CHECKSUM": right.checksum}
    if scan == 200:
        written |= {"REQUEST_ID": 0}
    return written


async def played(plant):
    """Values of all nodes of the blocks after each scan, with clients that write in between."""
    rows, stamp = [], datetime(2026, 1, 31, tzinfo=UTC)
    async with DemoServer(plant, 0, 1.0) as server:
        client = await connected(server.address, insecure=True)
        try:
            names = [name for name in server._nodes if name.partition(".")[0] in LOOPS.values()]
            nodes = [client.get_node(f"ns=2;s={name}") for name in names]
            for scan in range(SCANS):
                for key, tag in enumerate(LOOPS.values(), 1):
                    for name, value in asked(scan, key).items():
                        data = ua.DataValue(ua.Variant(value, ua.VariantType.Int32))
                        await client.get_node(f"ns=2;s={tag}.{name}").write_value(data)
                    if scan in (30, 100):
                        await client.get_node(f"ns=2;s={tag}.ACCEPT").write_value(True)
                if scan == 120:
                    plant.loops["FIC-102"].plc.restart()
                stamp += timedelta(seconds=0.5)
                await server.scan(stamp)
                rows.append(dict(zip(names, await client.read_values(nodes), strict=True)))
        finally:
            await client.disconnect()
    return rows


@pytest.mark.statistics
def test_st_behind_the_server_is_the_kernel_bit_for_bit():
    need(LIBRARY)
    kernel = asyncio.run(played(VirtualPlant.worn()))
    plant = VirtualPlant.worn(make_plc=partial(ChildPlc, command=CHILD))
    try:
        machine = asyncio.run(played(plant))
    finally:
        plant.close()
    assert machine == kernel
    for tag in LOOPS.values():
        states = {row[f"{tag}.SUPERVISION"] for row in kernel}
        assert states == STATES[tag], (tag, states)
        assert {row[f"{tag}.REFUSAL"] for row in kernel} == {0, 2}
        assert max(abs(row[f"{tag}.OFFSET"]) for row in kernel) > 0.1


def test_the_command_runs_what_is_named(capsys, monkeypatch):
    need(LIBRARY)
    monkeypatch.chdir(ROOT)
    words = ("--port", "0", "--speed", "20", "--seconds", "1", "--plc", shlex.join(CHILD))
    code, out, _ = run(capsys, "demo-live", *words)
    assert (code, "TIC103" in out) == (0, True)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("no-such-command-here", "No such file"),
        ("-c pass", "its end"),
        ("-c print('{}')", "says ready"),
        ('-c "print(\'{\\"error\\":\\"no licence\\"}\')"', "no licence"),
    ],
)
def test_a_plc_that_is_none_is_told_in_a_line(capsys, line, said):
    words = line if line.startswith("no") else f"{shlex.quote(sys.executable)} {line}"
    code, _, error = run(capsys, "demo-live", "--port", "0", "--plc", words)
    assert code == (2 if line.startswith("no") else 1)  # the path of a program that does not exist is wrong usage
    assert said in error
    assert len(error.splitlines()) == 1


def test_a_plc_that_ends_between_scans_is_told():
    need(LIBRARY)
    plc = ChildPlc(supervised("backlash"), CHILD)
    try:
        plc.scan(50.0)
        plc._child.kill()
        with pytest.raises(FileAccessError, match="an answer of the PLC"):
            plc.scan(50.0)
    finally:
        plc.close()
