"""How a link stands kills: ``python benchmarks/live_kills.py [--kills 100] [--of server network client]``.

The server is killed (-9) and started again; the network is cut, or frozen half-open; the command is killed. In the
server, one loop has numbers as values, so that of every row it is known whether the server had it, and one has a worn
valve with a dead zone of 2, so that estimates and events can be judged.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import queue
import subprocess
import sys
import tempfile
import threading
import time
from datetime import datetime
from pathlib import Path
from threading import Event

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import lostmotion as lm
from lostmotion.live.loop_source import LoopSource, Signals, patience_of
from lostmotion.live.opcua.client import connected
from lostmotion.live.opcua.link import Followed, Link
from lostmotion.live.run import Plant, Watched
from lostmotion.live.warm import warm
from lostmotion.online import OnlineMonitor
from lostmotion.online.service import Kept, Service
from lostmotion.store.store import Store
from tests.support.live_server import killed, node, started
from tests.support.tcp_proxy import Proxy

ROOT = Path(__file__).resolve().parents[1]
DT, PUBLISHING, WIDTH = 0.1, 0.1, 2.0
SERVER = ("2", str(DT), "history", "beside")
NUMBERS, WORN = "FIC000", "FIC001"
EARLY = 0.3  # share of faults that come before the link is back from the last one
WAIT = 60.0  # s after which a link is given up


class Noted(Service):
    """A service that keeps its rows."""

    def __init__(self, *words):
        super().__init__(*words)
        self.rows = []

    def _take(self, rows, take):
        known = ~np.isnan(rows.pv)
        self.rows += list(zip(rows.time[known], rows.op[known], rows.pv[known], strict=True))
        super()._take(rows, take)


def watched(tag, told):
    """A loop in service; what it tells goes into `told`."""
    source = LoopSource(Signals(tag, {"op": node(tag, "OP"), "pv": node(tag, "PV")}, DT, patience_of(DT, PUBLISHING)))

    def make(layout):
        start = 500 if tag == WORN else 1_000_000
        estimator = lm.RecursiveML(1, 0, 0, dt=DT, start_samples=start, forgetting=0.9998)
        return OnlineMonitor(estimator, dt=DT, calendar=layout.calendar, report_every=100)

    return Watched(source, Noted(source, Kept(None, {}), make, told.append))


class Faults:
    """Faults of a kind, one after the other, while two loops are watched in this process."""

    def __init__(self, address, seed):
        self.rng, self.told = np.random.default_rng(seed), []
        self.loops = [watched(tag, self.told) for tag in (NUMBERS, WORN)]

        async def connect():
            return await connected(address(), insecure=True)

        self.link = Link(connect, [Followed(one.source) for one in self.loops], PUBLISHING, lambda *_: None)
        self.returns, self.done = [], 0

    async def run(self, kills, fault, minutes):
        """`fault` does its work and gives the moment from which on the port was open again."""
        end = time.monotonic() + 60.0 * minutes
        stop = Event()
        running = asyncio.create_task(Plant(self.loops, self.link.run()).run(stop))
        await self._until(lambda: self.link.connections)
        for _ in range(kills):
            if time.monotonic() > end:
                break
            self.done += 1
            await asyncio.sleep(self.rng.uniform(0.0, 2.0))
            seen = self.link.connections
            opened = await fault(self.rng)
            if self.rng.random() < EARLY:
                continue
            if await self._until(lambda seen=seen: self.link.connections > seen):
                self.returns.append(time.monotonic() - opened)
        last = self.loops[0].service.rows[-1][0]
        await self._until(lambda: self.loops[0].service.rows[-1][0] > last + 3.0)
        stop.set()
        await running

    async def _until(self, what):
        end = time.monotonic() + WAIT
        while not what() and time.monotonic() < end:
            await asyncio.sleep(0.005)
        return what()

    def found(self, firsts):
        """What came, against what the servers had since the stamps of their samples 0."""
        rows = self.loops[0].service.rows
        times = np.array([row[0] for row in rows])
        there = [
            op == pv + 0.5 and any(abs(time - first - pv * DT) < 1e-3 for first in firsts) for time, op, pv in rows
        ]
        reports = [one["width"] for one in self.told if one["kind"] == "report" and one["width"]]
        return {
            "faults": self.done,
            "connections": self.link.connections,
            "back within, s: median, max": [float(np.median(self.returns)), max(self.returns)] if self.returns else [],
            "measured": len(self.returns),
            "rows": len(rows),
            "rows that no server had": there.count(False),
            "twice or out of order": int((np.diff(times) <= 0).sum()),
            "estimates": len(reports),
            "estimates whose interval has the width": sum(one["low"] <= WIDTH <= one["high"] for one in reports),
            "last estimate": None if not reports else [reports[-1][name] for name in ("low", "value", "high")],
            "events": [one["message"] for one in self.told if one["kind"] == "event"],
        }


async def of_server(kills, minutes):
    """The server is killed and started again: its memory is gone."""
    process, port = await asyncio.to_thread(started, 0, *SERVER)
    servers = [process]
    faults = Faults(lambda: f"opc.tcp://127.0.0.1:{port}", 0)

    async def fault(_):
        killed(servers[-1])
        process, _ = await asyncio.to_thread(started, port, *SERVER)
        servers.append(process)
        return time.monotonic()

    try:
        await faults.run(kills, fault, minutes)
    finally:
        killed(servers[-1])
    return faults.found([float(one.first) for one in servers])


async def of_network(kills, minutes):
    """Every second fault cuts the line for up to 3 s, the others freeze it for up to 10 s. The server keeps all."""
    process, port = await asyncio.to_thread(started, 0, *SERVER)
    kinds = iter(["cut", "freeze"] * kills)
    try:
        async with Proxy(port) as proxy:
            faults = Faults(lambda: proxy.address, 1)

            async def fault(rng):
                if next(kinds) == "cut":
                    await proxy.cut()
                    await asyncio.sleep(rng.uniform(0.0, 3.0))
                    await proxy.mend()
                else:
                    proxy.freeze()
                    await asyncio.sleep(rng.uniform(7.0, 10.0))  # the link gives up what is silent for 6 s
                    proxy.thaw()
                return time.monotonic()

            await faults.run(kills, fault, minutes)
    finally:
        killed(process)
    found = faults.found([float(process.first)])
    numbers = [row[2] for row in faults.loops[0].service.rows]
    return found | {"lost": int(numbers[-1] - numbers[0] + 1 - len(set(numbers)))}


class Command:
    """``lostmotion live`` in a process of its own; its messages come through a queue."""

    def __init__(self, folder):
        command = [sys.executable, "-m", "lostmotion", "live", str(folder / "plant.toml"), "--insecure"]
        command += ["--state", str(folder / "states"), "--record", str(folder / "values")]
        command += ["--store", str(folder / "plant.db")]
        env = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=env, text=True)
        self.said = queue.SimpleQueue()
        self.messages = []
        threading.Thread(target=self._hear, daemon=True).start()

    def _hear(self):
        for line in self.process.stdout:
            with_end = line.endswith("\n")
            if with_end:  # a kill may cut the last line
                self.said.put(json.loads(line))

    def hear(self, seconds):
        """Collect messages for a while."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            try:
                self.messages.append(self.said.get(timeout=left))
            except queue.Empty:
                return


PLANT = """address = "opc.tcp://127.0.0.1:{port}"
[defaults]
orders = [1, 0, 0]
dt = 0.1
report_every = 20
start_samples = 400
"""
LOOP = """[[loop]]
tag = "{tag}"
op = "ns=2;s={tag}.OP"
pv = "ns=2;s={tag}.PV"
"""


def of_client(kills, minutes):
    """The command is killed; the server keeps what it does not hear."""
    rng = np.random.default_rng(2)
    process, port = started(0, *SERVER)
    runs = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for one in ("states", "values"):
            (folder / one).mkdir()
        text = PLANT.format(port=port) + "".join(LOOP.format(tag=tag) for tag in (NUMBERS, WORN))
        (folder / "plant.toml").write_text(text)
        try:
            end = time.monotonic() + 60.0 * minutes
            last = False
            while not last:
                last = len(runs) == kills or time.monotonic() > end
                command = Command(folder)
                runs.append(command)
                while not any(one["kind"] == "report" for one in command.messages) and command.process.poll() is None:
                    command.hear(0.2)
                command.hear(rng.uniform(0.0, 4.0))
                if last:
                    command.process.terminate()
                else:
                    command.process.kill()
                command.process.wait(60)
                command.hear(0.3)
        finally:
            killed(process)
        with Store(folder / "plant.db", write=False) as store:
            stored = {one.sample: one for _, one in store.estimates(WORN)}
            rows, states = len(store.estimates(WORN)), [str(one.state) for one in store.watches()]
    return clients_found(len(runs) - 1, runs, stored, rows, states)


def clients_found(kills, runs, stored, rows, states):
    """What the commands told, in a row, against the clock of the server and the store."""
    told, again, other, backwards, misplaced = {}, 0, 0, 0, 0
    origin = {}
    for command in runs:
        for one in command.messages:
            if one["kind"] == "start" and one["sample"] < max((s for t, s in told if t == one["tag"]), default=0) - 40:
                backwards += 1  # a state is written with each report
            if one["kind"] != "report":
                continue
            key = one["tag"], one["sample"]
            moment = datetime.fromisoformat(one["time"]).timestamp() - one["sample"] * DT
            misplaced += abs(origin.setdefault(one["tag"], moment) - moment) > 0.5 * DT
            if key in told:
                again += 1
                other += told[key] != {name: value for name, value in one.items() if name != "counts"}
            told[key] = {name: value for name, value in one.items() if name != "counts"}
    worn = {sample: one for (tag, sample), one in told.items() if tag == WORN and one["width"]}
    last = [one for one in runs[-1].messages if one["kind"] == "report"][-1]
    events = [one["message"] for run in runs for one in run.messages if one["kind"] == "event"]
    return {
        "faults": kills,
        "reports": len(told),
        "told again": again,
        "told again with other numbers": other,
        "begun anew": backwards,
        "reports at another sample than the clock says": misplaced,
        "missing of the samples": [last["counts"]["missing"], last["counts"]["samples"]],
        "estimates": len(worn),
        "estimates whose interval has the width": sum(
            one["width"]["low"] <= WIDTH <= one["width"]["high"] for one in worn.values()
        ),
        "events": events,
        "estimates in the store": rows,
        "of them not told": len(set(stored) - set(worn)),
        "of them other than told": sum(
            stored[sample].width != one["width"]["value"] for sample, one in worn.items() if sample in stored
        ),
        "told and not in the store": len(set(worn) - set(stored)),
        "watches in the store": states,
        "last exit code": runs[-1].process.returncode,
    }


def main(words=None):
    parser = argparse.ArgumentParser()
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--of", nargs="*", default=["server", "network", "client"])
    parser.add_argument("--minutes", type=float, default=30.0, help="of each kind; then it ends with what it has")
    asked = parser.parse_args(words)
    warm()
    for what in asked.of:
        begin = time.monotonic()
        most = asked.kills, asked.minutes
        found = of_client(*most) if what == "client" else asyncio.run(KINDS[what](*most))
        print(json.dumps({"killed": what, **found, "minutes": (time.monotonic() - begin) / 60.0}, indent=1), flush=True)


KINDS = {"server": of_server, "network": of_network}

if __name__ == "__main__":
    main()
