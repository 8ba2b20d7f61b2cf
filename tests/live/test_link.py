"""The link: values of every quality, history after an outage, servers and clients that are killed."""

import asyncio
import itertools
import json
import os
import signal
import subprocess
import sys
import time
from threading import Event

import numpy as np
import polars as pl
import pytest
from asyncua import ua
from asyncua.common.node import Node

from lostmotion.live.loop_source import LoopSource, Signals
from lostmotion.live.opcua.client import connected
from lostmotion.live.opcua.link import Followed, Link
from lostmotion.live.run import Plant, Watched
from tests.support.live_server import LoopServer, killed, node, started
from tests.support.patience import in_time
from tests.support.places import ROOT

pytestmark = pytest.mark.long

UNCERTAIN = ua.StatusCode(ua.StatusCodes.UncertainLastUsableValue)
BAD = ua.StatusCode(ua.StatusCodes.BadSensorFailure)
KILLS = 5


class Taker:
    """In place of a service: keeps all rows."""

    monitor = None

    def __init__(self, source):
        self.source, self.rows, self.notes = source, [], []

    def turn(self, _):
        rows = self.source.read(10_000)
        self.rows += list(zip(rows.time, rows.op, rows.pv, strict=True))
        self.notes += [note.text for note in rows.notes]
        return self.source.more

    def save(self):
        pass

    @property
    def known(self):
        return [row for row in self.rows if not np.isnan(row[2])]


def taker(tag, dt, position=None, **more):
    roles = more.pop("roles", ("OP", "PV"))
    nodes = {role.lower(): node(tag, role) for role in roles}
    return Taker(LoopSource(Signals(tag, nodes, dt, 0.25 * dt + 0.2, **more), position))


class Listening:
    """A link to a server while a block runs."""

    def __init__(self, address, takers, uncertain="bad", publishing=0.05):
        async def connect():
            return await connected(address(), insecure=True)

        self.told = []
        loops = [Followed(one.source, uncertain=uncertain) for one in takers]
        self.link = Link(connect, loops, publishing, lambda *what: self.told.append((time.monotonic(), *what)))
        self.plant = Plant([Watched(one.source, one) for one in takers], self.link.run())
        self.stop = Event()

    async def __aenter__(self):
        self.task = asyncio.create_task(self.plant.run(self.stop))
        await until(lambda: self.link.connections)
        return self

    async def __aexit__(self, *_):
        self.stop.set()
        await self.task


async def until(what, seconds=15.0):
    end = time.monotonic() + seconds
    while not what():
        assert time.monotonic() < end, "waited in vain"
        await asyncio.sleep(0.02)


def test_quality_mode_and_rates():
    async def scenario():
        one, kept = taker("A", 1.0, roles=("OP", "PV", "MODE")), taker("B", 1.0)
        async with LoopServer(["A", "B"]) as plant, Listening(lambda: plant.address, [one, kept], "keep"):
            for k in range(40):
                status = {10: BAD, 11: UNCERTAIN}.get(k, ua.StatusCode(ua.StatusCodes.Good))
                for tag in ("A", "B"):
                    for tenth in range(0, 10, 5):  # OP at twice the rate of PV
                        await plant.write(tag, "OP", k + 0.1 * tenth, k + 0.1 * tenth)
                    await plant.write(tag, "PV", 100.0 + k, k, status)
                if k in (20, 30):
                    await plant.write("A", "MODE", "MAN" if k == 20 else "AUTO", k)
                await asyncio.sleep(0.01)
            await until(lambda: len(one.rows) == 40 and len(kept.rows) == 40)
        return one, kept

    one, kept = asyncio.run(scenario())
    assert len(kept.known) == 39
    assert [row[1] for row in one.rows if not np.isnan(row[1])] == [float(k) for k in range(40)]
    assert np.flatnonzero(np.isnan([row[2] for row in one.rows])).tolist() == [10]
    assert one.notes[0].endswith("PV is BadSensorFailure: missing until it is good.")


def test_uncertain_values_are_missing_unless_kept():
    async def scenario():
        one = taker("A", 1.0)
        async with LoopServer(["A"]) as plant, Listening(lambda: plant.address, [one]):
            for k in range(6):
                await plant.write("A", "OP", 1.0, k)
                await plant.write("A", "PV", 100.0 + k, k, UNCERTAIN if k == 3 else ua.StatusCode(0))
            await until(lambda: len(one.rows) == 6)
        return one

    one = asyncio.run(scenario())
    assert np.flatnonzero(np.isnan([row[2] for row in one.rows])).tolist() == [3]


@pytest.mark.parametrize("history", [True, False])
def test_a_server_that_comes_back(history):
    """With a history nothing is lost; without one the outage is missing samples, and nothing is made up."""
    written = []

    async def write(plant, first, stop):
        for k in range(first, stop):
            await plant.write("A", "OP", k + 0.5, k)
            await plant.write("A", "PV", float(k), k)
            written.append(k)
            await asyncio.sleep(0.005)

    async def scenario():
        one = taker("A", 1.0)
        async with LoopServer(["A"], history=history) as first:
            port = first.port
            listening = Listening(lambda: f"opc.tcp://127.0.0.1:{port}", [one])
            await listening.__aenter__()
            await write(first, 0, 50)
            await until(lambda: len(one.rows) == 50)
        async with LoopServer(["A"], port, history=history) as second:
            opened = time.monotonic()
            await write(second, 70, 90)  # before anybody listens
            await until(lambda: listening.link.connections == 2)
            found = time.monotonic() - opened
            await asyncio.sleep(0.1)
            await write(second, 90, 120)
            await until(lambda: one.rows and one.rows[-1][2] == 119.0)
            await listening.__aexit__()
        return one, found

    one, found = asyncio.run(scenario())
    assert found < 5.0
    pv = [row[2] for row in one.known]
    expected = [float(k) for k in written]
    assert sorted(set(pv)) == pv  # none twice, none out of order
    told = expected if history else [*expected[:50], *(value for value in expected[50:] if value >= pv[50])]
    assert pv == told
    assert history or 70.0 <= pv[50] <= 89.0  # the value that stands when the link is back
    assert all(op == value + 0.5 for _, op, value in one.known)
    assert len(one.rows) == 120


@pytest.mark.parametrize(
    "error", [ConnectionError("gone"), TimeoutError(), ua.UaStatusCodeError(ua.StatusCodes.BadSessionClosed)]
)
def test_a_link_that_breaks_while_the_history_is_read_asks_for_it_again(error, monkeypatch):
    """What came before the break must not hide what is older."""

    async def scenario():
        one = taker("A", 1.0)
        async with LoopServer(["A"], history=True) as plant, Listening(lambda: plant.address, [one]) as listening:

            async def write(first, stop):
                for k in range(first, stop):
                    await plant.write("A", "OP", k + 0.5, k)
                    await plant.write("A", "PV", float(k), k)
                await asyncio.sleep(0.2)

            await write(0, 20)
            await until(lambda: len(one.rows) == 20)
            read, calls = Node.read_raw_history, []

            async def breaks(self, *words, **more):
                calls.append(self)
                if len(calls) <= 2:  # of the first time, OP and PV
                    await write(30, 40)
                    raise error
                return await read(self, *words, **more)

            monkeypatch.setattr(Node, "read_raw_history", breaks)
            listening.link._lost.set()
            await until(lambda: any(kind == "lost" for _, kind, *_ in listening.told))
            await write(20, 30)  # while nobody listens
            await until(lambda: listening.link.connections == 2)
            await until(lambda: one.rows[-1][2] == 39.0)
        return one

    one = asyncio.run(scenario())
    assert [pv for _, _, pv in one.known] == [float(k) for k in range(40)]


def test_servers_that_are_killed_at_random():
    """Each row is one that the server had, once and in order; the link is back within 5 s."""
    rng = np.random.default_rng(1)

    async def scenario():
        one = taker("FIC000", 0.1)
        process, port = started(0, "1", "0.1", "history")
        returns = []
        try:
            async with Listening(lambda: f"opc.tcp://127.0.0.1:{port}", [one]) as listening:
                for kill in range(KILLS):
                    await asyncio.sleep(rng.uniform(0.1, 0.8))
                    killed(process)
                    process, _ = await asyncio.to_thread(started, port, "1", "0.1", "history")
                    opened = time.monotonic()
                    await until(lambda kill=kill: listening.link.connections == kill + 2, 30.0)
                    returns.append(time.monotonic() - opened)
                seen = len(one.known)
                await until(lambda: len(one.known) > seen + 5)
        finally:
            killed(process)
        return one, returns

    one, returns = asyncio.run(scenario())
    assert max(returns) < 5.0
    times = [row[0] for row in one.known]
    assert all(after > before for before, after in itertools.pairwise(times))
    assert all(op == pv + 0.5 for _, op, pv in one.known)


def client(port, folder):
    script = [
        sys.executable, "-m", "lostmotion", "live", f"opc.tcp://127.0.0.1:{port}", "--insecure", "--orders", "1,0,1",
        "--op", node("FIC000", "OP"), "--pv", node("FIC000", "PV"), "--dt", "0.1", "--report-every", "20",
        "--start-samples", "1000", "--state", str(folder / "states"), "--record", str(folder / "values"),
    ]  # fmt: skip
    env = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    return subprocess.Popen(script, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=env, text=True)


def reports(process, count):
    found = []
    with in_time(process):
        while len(found) < count:
            line = process.stdout.readline()
            assert line, process.stderr.read()
            message = json.loads(line)
            if message["kind"] == "report":
                found.append(message)
    return found


def test_a_command_that_is_killed_goes_on_from_its_state(tmp_path):
    for name in ("states", "values"):
        (tmp_path / name).mkdir()
    server, port = started(0, "1", "0.1", "history")
    try:
        first = client(port, tmp_path)
        before = reports(first, 2)
        killed(first)
        first.stderr.close()
        second = client(port, tmp_path)
        after = reports(second, 3)
        second.send_signal(signal.SIGTERM)
        out, _ = second.communicate(timeout=60)
    finally:
        killed(server)
    assert second.returncode == 0, out
    assert [one["sample"] for one in before] == [20, 40]
    assert after[0]["sample"] in (40, 60)  # what was told after the state was written comes again
    assert after[-1]["counts"]["missing"] == 0  # the server kept what came while nobody listened
    kept = pl.concat([pl.read_parquet(piece) for piece in (tmp_path / "values").glob("*.parquet")])
    assert set(kept["tag"].unique()) == {"loop.OP", "loop.PV"}
    assert not [name for name in (tmp_path / "values").iterdir() if name.suffix != ".parquet"]
