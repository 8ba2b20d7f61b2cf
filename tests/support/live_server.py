"""An OPC UA server with loops on it, of asyncua's own making: in this process, or in one that can be killed.

``python -m tests.support.live_server PORT LOOPS DT HISTORY [worn | beside]`` serves until it is killed, and prints a
line when it is ready: its port, and the stamp of sample 0. PV is the number of the sample, OP a little more; with
``worn`` both are of valves with a dead zone, with ``beside`` those of the first loop are numbers.
"""

import asyncio
import logging
import os
import random
import signal
import subprocess
import sys
import time
from datetime import UTC, datetime, timedelta

from asyncua import Server, ua

from tests.support.patience import in_time
from tests.support.places import ROOT

START = datetime(2026, 5, 1, tzinfo=UTC)
NOT_YET = ua.StatusCode(ua.StatusCodes.BadWaitingForInitialData)
GOOD = ua.StatusCode(ua.StatusCodes.Good)


class LoopServer:
    """Server on 127.0.0.1 with OP, PV and mode of some loops."""

    def __init__(self, tags, port=0, history=False):
        self.tags, self.port, self.history = tags, port, history
        self.nodes = {}

    async def __aenter__(self):
        logging.getLogger("asyncua").setLevel(logging.CRITICAL)
        self.server = Server()
        await self.server.init()
        self.server.set_endpoint(f"opc.tcp://127.0.0.1:{self.port}")
        self.server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
        space = await self.server.register_namespace("urn:lostmotion:test")
        for tag in self.tags:
            folder = await self.server.nodes.objects.add_folder(ua.NodeId(tag, space), ua.QualifiedName(tag, space))
            for role in ("OP", "PV", "SP"):
                node = await folder.add_variable(ua.NodeId(f"{tag}.{role}", space), ua.QualifiedName(role, space), 0.0)
                self.nodes[tag, role] = node
                await self.write(tag, role, 0.0, START - timedelta(hours=1), NOT_YET)
            name = ua.QualifiedName("MODE", space)
            self.nodes[tag, "MODE"] = await folder.add_variable(ua.NodeId(f"{tag}.MODE", space), name, "AUTO")
        await self.server.start()
        if self.history:
            for (_, role), node in self.nodes.items():
                if role in ("OP", "PV"):
                    await self.server.historize_node_data_change(node, period=None, count=0)
        self.port = self.server.bserver._server.sockets[0].getsockname()[1]
        return self

    async def __aexit__(self, *_):
        await self.server.stop()

    @property
    def address(self):
        return f"opc.tcp://127.0.0.1:{self.port}"

    async def write(self, tag, role, value, stamp, status=GOOD):
        """A value with a stamp in seconds from START, or a datetime."""
        when = stamp if isinstance(stamp, datetime) else START + timedelta(microseconds=round(1e6 * stamp))
        data = ua.DataValue(ua.Variant(value), StatusCode=status, SourceTimestamp=when, ServerTimestamp=when)
        await self.server.write_attribute_value(self.nodes[tag, role].nodeid, data)


def node(tag, role):
    return f"ns=2;s={tag}.{role}"


class Counted:
    """Values that tell which sample they are of."""

    def __init__(self, tag):
        self.number = 0

    def scan(self):
        self.number += 1
        return self.number + 0.5, float(self.number)


class Worn:
    """A valve with a dead zone of 1 % on either side before a process of first order, and noise."""

    def __init__(self, tag):
        self.random, self.op, self.pv = random.Random(tag), 0.0, 0.0  # noqa: S311

    def scan(self):
        if self.random.random() < 0.2:
            self.op = self.random.uniform(-5.0, 5.0)
        beyond = max(abs(self.op) - 1.0, 0.0)
        self.pv += 0.3 * ((beyond if self.op > 0.0 else -beyond) - self.pv)
        return self.op, self.pv + self.random.gauss(0.0, 0.05)


async def serve(port, loops, dt, history, kinds):
    """Write values for ever; the last of the kinds is that of all further loops."""
    tags = {f"FIC{k:03d}": kinds[min(k, len(kinds) - 1)](f"FIC{k:03d}") for k in range(loops)}
    async with LoopServer(tags, port, history) as plant:
        begin = time.time()
        first = datetime.now(UTC)
        sys.stdout.write(f"ready {plant.port} {first.timestamp()!r}\n")
        sys.stdout.flush()
        number = 0
        while True:
            number += 1
            await asyncio.sleep(max(0.0, begin + number * dt - time.time()))
            scan = first + timedelta(seconds=number * dt)  # a PLC's scan is even, however busy this process is
            for tag, loop in tags.items():
                op, pv = loop.scan()
                await plant.write(tag, "OP", op, scan)
                await plant.write(tag, "PV", pv, scan)


def started(port, *words):
    """Process with a server, and its port; its attribute `first` is the stamp of sample 0."""
    env = {**os.environ, "PYTHONPATH": f"{ROOT / 'src'}:{ROOT}"}
    command = [sys.executable, "-m", "tests.support.live_server", str(port), *words]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, env=env, cwd=ROOT, text=True)
    assert process.stdout is not None
    with in_time(process):
        _, taken, process.first = process.stdout.readline().split()
    return process, int(taken)


def killed(process):
    process.send_signal(signal.SIGKILL)
    process.wait()
    process.stdout.close()


if __name__ == "__main__":
    port, loops, dt, history = sys.argv[1:5]
    kinds = {"worn": [Worn], "beside": [Counted, Worn]}[sys.argv[5]] if len(sys.argv) > 5 else [Counted]
    asyncio.run(serve(int(port), int(loops), float(dt), history == "history", kinds))
