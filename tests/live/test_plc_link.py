"""A supervised block over OPC UA: what is written, in which calls, and what happens to what fails."""

import asyncio
import threading
import time

import pytest

pytest.importorskip("asyncua")

from asyncua import Server, ua
from asyncua.common.callback import CallbackType

from lostmotion.compensate.request import Request
from lostmotion.compensate.supervision_variables import supervision
from lostmotion.errors import FileAccessError
from lostmotion.live.link import LinkError
from lostmotion.live.opcua.plc_link import PlcLink

pytestmark = pytest.mark.long

NAMES = [variable.name for variable in supervision("", "") if variable.section in ("input", "output")]
NODES = {name.lower(): f"ns=2;s=FY.{name}" for name in NAMES}
ASKED = Request(1, 500, 600, 700).values


class BlockServer:
    """Server with the variables of a block that does not scan, in a thread; keeps each call that writes."""

    def __init__(self, port=0):
        self.port, self.calls, self.nodes = port, [], {}
        started = threading.Event()
        self.loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._run, args=(started,), daemon=True)
        self._thread.start()
        assert started.wait(30)

    def _run(self, started):
        asyncio.set_event_loop(self.loop)
        self.loop.run_until_complete(self._start())
        started.set()
        self.loop.run_forever()
        self.loop.run_until_complete(self.server.stop())
        self.loop.close()

    async def _start(self):
        self.server = Server()
        await self.server.init()
        self.server.set_endpoint(f"opc.tcp://127.0.0.1:{self.port}")
        self.server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
        await self.server.register_namespace("urn:lostmotion:test")
        for name in NAMES:
            kind = ua.VariantType.Boolean if name == "ACCEPT" else ua.VariantType.Int32
            variable = ua.NodeId(f"FY.{name}", 2), name, 0, kind
            self.nodes[name] = await self.server.nodes.objects.add_variable(*variable)
        await self.reset()
        self.server.subscribe_server_callback(CallbackType.PostWrite, self._written)
        await self.server.start()
        self.port = self.server.bserver._server.sockets[0].getsockname()[1]

    def _written(self, event, _):
        nodes = [str(one.NodeId.Identifier) for one in event.request_params.NodesToWrite]
        ours = [name.removeprefix("FY.").lower() for name in nodes if name.startswith("FY.")]
        self.calls += [ours] if ours else []

    async def reset(self):
        for name, node in self.nodes.items():
            await node.set_writable(name not in ("ECHO_ID", "CHECKSUM"))
            kind = ua.VariantType.Boolean if name == "ACCEPT" else ua.VariantType.Int32
            value = ua.DataValue(ua.Variant(0, kind))
            await self.server.write_attribute_value(node.nodeid, value)

    def do(self, work):
        return asyncio.run_coroutine_threadsafe(work, self.loop).result(10)

    @property
    def address(self):
        return f"opc.tcp://127.0.0.1:{self.port}"

    def close(self):
        if not self.loop.is_closed():
            self.loop.call_soon_threadsafe(self.loop.stop)
            self._thread.join(20)


@pytest.fixture(scope="module")
def only():
    """Starting one takes seconds."""
    made = BlockServer()
    yield made
    made.close()


@pytest.fixture
def server(only):
    """As it was at its start."""
    only.do(only.reset())
    only.calls.clear()
    return only


def linked(server, **settings):
    return PlcLink(server.address, NODES, insecure=True, **settings)


def test_the_id_is_written_alone_after_the_others(server):
    server.do(server.nodes["CHECKSUM"].set_writable())
    server.calls.clear()
    with linked(server) as link:
        link.write(dict(reversed(ASKED.items())))
        assert link.read(ASKED) == ASKED
        link.write({"heartbeat": 7})
        assert link.read(["heartbeat", "echo_id"]) == {"heartbeat": 7.0, "echo_id": 0.0}
    others = sorted(set(ASKED) - {"request_id"})
    assert [sorted(call) for call in server.calls] == [others, ["request_id"], ["heartbeat"]]
    with pytest.raises(LinkError, match="closed"):
        link.read(["heartbeat"])


@pytest.mark.parametrize("refused", [*ASKED, "all of them"])
def test_a_server_that_lets_nobody_write_gets_no_request(server, refused):
    """Without the permission, for one variable or all: one line, and the block is asked nothing."""
    server.do(server.nodes["CHECKSUM"].set_writable())
    for name in ASKED if refused == "all of them" else [refused]:
        server.do(server.nodes[name.upper()].set_writable(False))
    with linked(server) as link:
        with pytest.raises(LinkError) as said:
            link.write(ASKED)
        assert "\n" not in str(said.value)
        assert link.read(["request_id"]) == {"request_id": 0.0}


def test_a_write_that_is_refused_in_part_is_never_a_request(server):
    with linked(server) as link:
        with pytest.raises(LinkError, match="checksum"):
            link.write(ASKED)
        assert link.read(["request_id", "asked_first"]) == {"request_id": 0.0, "asked_first": 600.0}
    assert all("request_id" not in call for call in server.calls)


def test_what_belongs_to_others_and_what_is_no_dint_is_not_sent(server):
    with linked(server) as link:
        for values in ({"accept": 1}, {"enable": 1}, {"heartbeat": 2**31}, {"heartbeat": 0.5}):
            with pytest.raises(LinkError):
                link.write(values)
    assert server.calls == []


def test_values_of_bad_quality_are_no_values(server):
    bad = ua.DataValue(ua.Variant(3, ua.VariantType.Int32), StatusCode=ua.StatusCode(ua.StatusCodes.BadSensorFailure))
    server.do(server.server.write_attribute_value(server.nodes["ECHO_ID"].nodeid, bad))
    with linked(server) as link, pytest.raises(LinkError, match="echo_id"):
        link.read(["heartbeat", "echo_id"])


def test_a_late_answer_is_no_answer_and_the_next_call_begins_anew(server):
    with linked(server, answer=0.3) as link:
        server.loop.call_soon_threadsafe(time.sleep, 1.0)
        time.sleep(0.1)
        before = time.monotonic()
        with pytest.raises(LinkError, match="nothing is sent again"):
            link.write(ASKED)
        assert time.monotonic() - before < 3.0
        time.sleep(1.0)
        assert link.read(["request_id"]) == {"request_id": 0.0}


def test_a_server_that_goes_and_comes():
    server = BlockServer()
    with linked(server) as link:
        server.close()
        with pytest.raises(LinkError):
            link.write({"heartbeat": 1})
        with pytest.raises(LinkError):
            link.read(["heartbeat"])
        again = BlockServer(server.port)
        try:
            assert link.read(["heartbeat"]) == {"heartbeat": 0.0}
            assert again.calls == []
        finally:
            again.close()
    with pytest.raises(FileAccessError, match="check that it runs"):
        linked(server)
