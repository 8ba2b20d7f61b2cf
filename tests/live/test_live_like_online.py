"""Live and from a file, the same samples give the same estimates, bit for bit."""

import asyncio
from threading import Event

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.files.follow import Follower
from lostmotion.files.layout import Asked
from lostmotion.live.loop_source import LoopSource, Signals, patience_of
from lostmotion.live.opcua.client import connected
from lostmotion.live.opcua.link import Followed, Link
from lostmotion.live.run import Plant, Watched
from lostmotion.online import OnlineMonitor
from lostmotion.online.service import Kept, Service
from tests.support.live_server import LoopServer, node

SAMPLES, DT = 1500, 0.1
WATCH = {"report_every": 500}


def monitor(layout):
    estimator = lm.RecursiveML(3, 2, 3, start_samples=700, dt=layout.dt)
    return OnlineMonitor(estimator, dt=layout.dt, calendar=layout.calendar, **WATCH)


def from_file(path, rows):
    path.write_text("time,OP,PV\n" + "".join(f"2026-05-01T{clock(t)}Z,{u!r},{y}\n" for t, u, y in rows))
    said = []
    with Follower(path, Asked()) as follower:
        service = Service(follower, Kept(None, {}), monitor, said.append)
        service.run(follow=False, stop=Event())
    return said, service


def clock(t):
    seconds, micro = divmod(round(1e6 * t), 1_000_000)
    return f"{seconds // 3600:02d}:{seconds // 60 % 60:02d}:{seconds % 60:02d}.{micro:06d}"


async def live(plant, tags, write, enough, **signals):
    """Sources and services of loops while `write` writes."""
    said = {tag: [] for tag in tags}
    watched = []
    for tag in tags:
        nodes = {"op": node(tag, "OP"), "pv": node(tag, "PV")}
        source = LoopSource(Signals(tag, nodes, DT, patience_of(DT, 0.05), **signals))
        watched.append(Watched(source, Service(source, Kept(None, {}), monitor, said[tag].append)))

    async def connect():
        return await connected(plant.address, insecure=True)

    notes = []
    link = Link(connect, [Followed(one.source) for one in watched], 0.05, lambda *what: notes.append(what))
    stop = Event()
    running = asyncio.create_task(Plant(watched, link.run()).run(stop))
    async with asyncio.timeout(60.0):
        while not link.connections:
            await asyncio.sleep(0.02)
    await write()
    for _ in range(200):
        await asyncio.sleep(0.05)
        if all(enough(one) for one in watched):
            break
    stop.set()
    await running
    return said, watched, notes


@pytest.mark.long
def test_estimates_are_those_of_online_bit_for_bit(tmp_path):
    loop = lm.routine_operation(SAMPLES, drift="none", seed=1)
    times = DT * np.arange(1, SAMPLES + 1)
    gone = set(range(900, 940))  # a gap
    rows = [
        (t, u, y) for k, (t, u, y) in enumerate(zip(times, loop.command, loop.measured, strict=True)) if k not in gone
    ]
    bad = {300, 301, 1100}

    async def scenario():
        async with LoopServer(["A"]) as plant:

            async def write():
                from asyncua import ua

                for number, (t, u, y) in enumerate(rows):
                    status = ua.StatusCode(ua.StatusCodes.BadSensorFailure if number in bad else ua.StatusCodes.Good)
                    await plant.write("A", "OP", float(u), t)
                    await plant.write("A", "PV", float(y), t, status)
                    if number % 20 == 0:
                        await asyncio.sleep(0.01)

            return await live(
                plant,
                ["A"],
                write,
                lambda one: one.source.newest > 0 and not one.source.waiting and one.service.monitor.samples >= SAMPLES,
            )

    said, (watched,), _ = asyncio.run(scenario())
    cells = [(t, float(u), "Bad" if number in bad else repr(float(y))) for number, (t, u, y) in enumerate(rows)]
    expected, service = from_file(tmp_path / "a.csv", cells)
    assert service.monitor.samples == SAMPLES
    reports = [message for message in said["A"] if message["kind"] == "report"]
    assert [one["sample"] for one in reports] == [500, 1000, 1500]
    assert reports == [message for message in expected if message["kind"] == "report"]
    assert watched.service.monitor.estimator.to_bytes() == service.monitor.estimator.to_bytes()
