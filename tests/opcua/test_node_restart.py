"""The link of `lostmotion live`, signed and encrypted, to node-opcua, which is killed and starts again."""

import asyncio
import time
from threading import Event

import numpy as np
import pytest

pytest.importorskip("asyncua")

from lostmotion.live.loop_source import LoopSource, Signals
from lostmotion.live.opcua.certificates import own_certificate
from lostmotion.live.opcua.client import connected
from lostmotion.live.opcua.link import Followed, Link
from lostmotion.live.opcua.secrets import Secret, User
from lostmotion.live.opcua.security import Identity
from lostmotion.live.opcua.trust import TrustStore
from lostmotion.live.run import Plant, Watched
from tests.opcua.certificates import URI, pair
from tests.opcua.node_server import NodeServer, config

pytestmark = pytest.mark.long

DT, ROWS = 0.1, 25
BUSY = 30.0  # s to connect again; 5 on a machine that does nothing else, here anything may run beside it
NODES = {"op": "ns=1;s=FIC101.OP", "pv": "ns=1;s=FIC101.PV"}
READER = User("reader", Secret("correct horse battery"))


class Taker:
    """In place of the estimators: keeps all rows."""

    monitor = None

    def __init__(self):
        self.source, self.rows = LoopSource(Signals("FIC101", NODES, DT, 2.0)), []

    def turn(self, take=True, *, at_end=True):
        rows = self.source.read(10_000)
        self.rows += list(zip(rows.time, rows.op, rows.pv, strict=True))
        return self.source.more

    def save(self):
        pass

    @property
    def known(self):
        return [row for row in self.rows if not np.isnan(row[2])]


async def until(there, seconds=60):
    """Wait for what a busy machine may be late with."""
    end = time.monotonic() + seconds
    while not there():
        assert time.monotonic() < end, "waited in vain"
        await asyncio.sleep(0.02)


async def advanced(server, arrived, rows):
    """Let the loop advance, each sample once the one before has arrived; samples of the server."""
    for _ in range(rows):
        before = len(arrived)
        await asyncio.to_thread(server.do, "advance", steps=1)
        await until(lambda before=before: len(arrived) >= before + len(NODES))
    return (await asyncio.to_thread(server.do, "samples"))["samples"]


@pytest.fixture
def secured(tmp_path):
    """Server with a loop, our link to it, and what it has told."""
    pki, theirs = tmp_path / "pki", pair(tmp_path / "server")
    own = own_certificate(pki)
    store = TrustStore(pki)
    store.add(theirs.certificate, "127.0.0.1")
    users = {READER.name: READER.password.reveal()}
    one = config(tmp_path, theirs, URI, clients=[str(own.certificate)], users=users, step=DT)
    with NodeServer(tmp_path, plant=one) as server:
        messages, arrived, taker = [], [], Taker()

        def connect():
            return connected(server.address(), Identity(pki, READER), store)

        def tell(*what):
            messages.append((time.monotonic(), *what))

        taps = [lambda _loop, role, data: arrived.append((role, data))]
        yield server, Link(connect, [Followed(taker.source)], 0.05, tell, taps), taker, messages, arrived


def test_a_server_that_is_killed_comes_back_without_an_invented_sample(secured):
    server, link, taker, messages, arrived = secured

    async def story():
        stop, plant = Event(), Plant([Watched(taker.source, taker)], link.run())
        running = asyncio.create_task(plant.run(stop))
        await until(lambda: link.connections == 1 and len(arrived) >= len(NODES))  # what is there comes first
        first = await advanced(server, arrived, ROWS)
        await until(lambda: len(taker.known) >= ROWS)
        server.kill()
        before = len(arrived)
        await until(lambda: messages[-1][1] == "lost")
        await asyncio.to_thread(server.start)
        back = time.monotonic()
        await until(lambda: link.connections == 2)
        took = messages[-1][0] - back
        await until(lambda: len(arrived) >= before + len(NODES))
        second = await advanced(server, arrived, ROWS)
        await until(lambda: len(taker.known) >= 2 * ROWS)
        stop.set()
        await running
        return first, second, took

    first, second, took = asyncio.run(story())
    assert took < BUSY, took
    sent = [(row[0] / 1000, row[1], row[2]) for row in first[-ROWS:] + second[-ROWS:]]
    assert len(taker.known) == len(sent)
    np.testing.assert_allclose([row[1:] for row in taker.known], [row[1:] for row in sent], rtol=0, atol=0)
    times = [row[0] for row in taker.rows]
    assert np.all(np.diff(times) > 0)
    assert b"horse" not in server.log.read_bytes()
    assert all("horse" not in str(message) for message in messages)
