"""How much a link carries: ``python benchmarks/live.py [--seconds 600]``.

500 loops at 1 Hz and 50 at 10 Hz with worn valves, from servers in other processes whose scans are even, so that every
sample is known by its stamp. Each must arrive once; lag is the time from the stamp of a row to its turn.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import resource
import sys
import time
from array import array
from pathlib import Path
from threading import Event

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import live_kills
import lostmotion as lm
from lostmotion.live.first_fits import FirstFits
from lostmotion.live.loop_source import LoopSource, Signals, patience_of
from lostmotion.live.opcua.client import connected
from lostmotion.live.opcua.link import Followed, Link
from lostmotion.live.run import Plant, Watched
from lostmotion.live.warm import warm
from lostmotion.online import OnlineMonitor
from lostmotion.online.service import Kept, Service
from tests.support.live_server import killed, node, started

PUBLISHING = 0.1
WHO = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
START = 5.0  # s until all is running: not counted in the lag


def _nothing(*_):
    """Nobody listens."""


class Counted(Service):
    """A service that notes how old its rows are, and their stamps."""

    def __init__(self, source, kept, make, emit):
        super().__init__(source, kept, make, emit)
        self.lags, self.stamps = array("d"), array("d")  # of 16 bytes a row, so that they hide no growth

    def _take(self, rows, take):
        now = time.time()
        known = ~np.isnan(rows.pv)
        self.lags.frombytes((now - rows.time[known]).tobytes())
        self.stamps.frombytes(rows.time[known].tobytes())
        super()._take(rows, take)


def watched(tag, dt, start_samples=1000):
    signals = Signals(tag, {"op": node(tag, "OP"), "pv": node(tag, "PV")}, dt, patience_of(dt, PUBLISHING))
    source = LoopSource(signals)

    def make(layout):
        estimator = lm.RecursiveML(1, 0, 0, dt=dt, start_samples=start_samples)
        return OnlineMonitor(estimator, dt=dt, calendar=layout.calendar)

    return Watched(source, Counted(source, Kept(None, {}), make, _nothing))


async def listen(groups, seconds, fit):
    """Links to the servers of some groups of loops, all in this process."""
    told, stop, began = [], Event(), time.monotonic()
    links = []
    for port, loops in groups:

        async def connect(port=port):
            return await connected(f"opc.tcp://127.0.0.1:{port}", insecure=True)

        links.append(
            Link(connect, [Followed(one.source) for one in loops], PUBLISHING, lambda *what: told.append(what))
        )

    async def run_links():
        async with asyncio.TaskGroup() as group:
            for link in links:
                group.create_task(link.run())

    plant = Plant([one for _, loops in groups for one in loops], run_links(), fit)
    running = asyncio.create_task(plant.run(stop))
    sizes = []
    while time.monotonic() - began < seconds:
        await asyncio.sleep(1.0)
        sizes.append(resident())
        if time.monotonic() - began < START:
            plant.longest_block = 0.0
    stop.set()
    await running
    return plant, links, told, sizes


def resident():
    """MiB of this process."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 2**20


def processor_time():
    """Seconds of this process and of those that it has ended."""
    return sum(resource.getrusage(who).ru_utime + resource.getrusage(who).ru_stime for who in WHO)


def load(seconds, slow, fast):
    """What arrives of what is written."""
    warm()
    servers = [started(0, str(slow), "1.0", "none", "worn"), started(0, str(fast), "0.1", "none", "worn")]
    groups = [
        (servers[0][1], [watched(f"FIC{k:03d}", 1.0) for k in range(slow)]),
        (servers[1][1], [watched(f"FIC{k:03d}", 0.1, 200) for k in range(fast)]),
    ]
    try:
        with FirstFits() as fits:
            begin = processor_time()
            plant, links, told, sizes = asyncio.run(listen(groups, seconds, fits.take))
        spent = processor_time() - begin
    finally:
        for server, _ in servers:
            killed(server)
    lost = late = rows = begun = 0
    lags = []
    for one in plant.loops:
        steps = np.diff(one.service.stamps) / one.source.signals.dt
        lost += int((np.rint(steps) != 1).sum())  # the scans of the server are even
        begun += one.service.monitor is not None and one.service.monitor.estimator.started
        late += one.source.counts["late"] + one.source.counts["behind"]
        rows += len(one.service.stamps)
        lags += one.service.lags.tolist()[round(START / one.source.signals.dt) :]
    return {
        "seconds": seconds, "loops": [slow, fast], "rows": rows, "lost or twice": lost, "late": late,
        "estimates begun": begun, "connections": [link.connections for link in links], "told": told[:5],
        "lag p50": float(np.percentile(lags, 50)), "lag p99": float(np.percentile(lags, 99)), "lag max": max(lags),
        "longest block of the event loop": plant.longest_block,
        "share of a core": spent / seconds,
        "MiB after each tenth": [round(sizes[(len(sizes) * k) // 10 - 1]) for k in range(1, 11)],
    }  # fmt: skip


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--slow", type=int, default=500)
    parser.add_argument("--fast", type=int, default=50)
    parser.add_argument("--kills", type=int, default=0, help="as benchmarks/live_kills.py, after the load")
    words = parser.parse_args()
    if words.seconds:
        print(json.dumps(load(words.seconds, words.slow, words.fast), indent=1))
    if words.kills:
        live_kills.main(["--kills", str(words.kills)])


if __name__ == "__main__":
    main()
