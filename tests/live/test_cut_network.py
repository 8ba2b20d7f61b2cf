"""A network that is cut, or frozen half-open, before a server with a history: nothing is lost, nothing comes twice."""

import asyncio
import time

import pytest

pytest.importorskip("asyncua")

from tests.live.test_link import Listening, taker, until
from tests.support.live_server import killed, started
from tests.support.tcp_proxy import Proxy

pytestmark = pytest.mark.long


@pytest.mark.parametrize("fault", ["cut", "frozen"])
def test_a_network_that_comes_back(fault):
    async def scenario():
        one = taker("FIC000", 0.1)
        server, port = await asyncio.to_thread(started, 0, "1", "0.1", "history")
        try:
            async with Proxy(port) as proxy, Listening(lambda: proxy.address, [one]) as listening:
                await until(lambda: len(one.known) > 5)
                if fault == "cut":
                    await proxy.cut()
                    await asyncio.sleep(1.5)
                    await proxy.mend()
                else:
                    proxy.freeze()
                    await until(lambda: any(kind == "lost" for _, kind, *_ in listening.told), 30.0)
                    await asyncio.sleep(1.5)
                    proxy.thaw()
                opened = time.monotonic()
                await until(lambda: listening.link.connections == 2, 30.0)
                back = time.monotonic() - opened
                seen = len(one.known)
                await until(lambda: len(one.known) > seen + 5)
        finally:
            killed(server)
        return one, back

    one, back = asyncio.run(scenario())
    assert back < 5.0
    numbers = [pv for _, _, pv in one.known]
    assert numbers == [float(k) for k in range(int(numbers[0]), int(numbers[0]) + len(numbers))]
    assert all(op == pv + 0.5 for _, op, pv in one.known)
