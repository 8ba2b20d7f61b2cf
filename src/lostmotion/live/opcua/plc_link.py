"""A supervised block in a controller behind OPC UA, for a supervisor that asks one thing after the other."""

from __future__ import annotations

import asyncio
import math
import threading
from collections.abc import AsyncIterator, Coroutine, Iterable, Mapping
from contextlib import asynccontextmanager, suppress
from typing import Any, Self, TypeVar

from asyncua import ua
from asyncua.client.client import Client
from asyncua.ua.attribute_ids import AttributeIds

from lostmotion.compensate.supervised import SupervisedBlock
from lostmotion.errors import LostMotionError
from lostmotion.live.link import LinkError
from lostmotion.live.opcua.client import REQUEST, connected
from lostmotion.live.opcua.data_value import quality_of
from lostmotion.live.opcua.link import FAILURES, LEAVE, Connect, leave, resolved
from lostmotion.live.opcua.security import Identity
from lostmotion.live.opcua.trust import TrustStore
from lostmotion.live.virtual_plc import DINT, WRITABLE

ANSWER = 3.0  # s for a read or a write: a block sheds after ten without a heartbeat
OPENING = 3 * REQUEST  # s for endpoints, channel and session together
STUCK = 3 * OPENING  # s after which a call is given up whose own limits were not kept
SIGNED = (ua.VariantType.Int32, ua.VariantType.Int64)
UNSIGNED = (ua.VariantType.UInt32, ua.VariantType.UInt64)
REAL = (ua.VariantType.Float, ua.VariantType.Double)  # ids and widths stay below 2^24, which both hold exactly
KINDS: dict[Any, ua.VariantType] = {k.value: k for k in (*SIGNED, *UNSIGNED, *REAL)}  # 16 bits hold no id
Answer = TypeVar("Answer")


def nodes_of(block: SupervisedBlock, prefix: str) -> dict[str, str]:
    """Node of each input and output of a block whose variables stand side by side in the server.

    Examples
    --------
    >>> from lostmotion.compensate import CompensatorBlock
    >>> plain = CompensatorBlock.of("backlash", 0.5, {"lead_up": 0.5, "lead_down": 0.5, "band": 0.1})
    >>> nodes_of(SupervisedBlock.of(plain), "ns=2;s=FY101.")["request_id"]
    'ns=2;s=FY101.REQUEST_ID'
    """
    variables = [*block.specification.section("input"), *block.specification.section("output")]
    return {variable.name.lower(): prefix + variable.name for variable in variables}


class PlcLink:
    """A :class:`~lostmotion.live.link.Link` over OPC UA; its connection is made by :func:`connected` alone.

    A read is one call, a write one call for all values but the id of the request, which follows in a call of its own
    once the server has taken the others. What failed is over: it is neither kept nor sent again, and the connection is
    dropped, so that nothing of it arrives later. The next call makes a new one.

    Parameters
    ----------
    address : str
    nodes : mapping
        Node of each input and output by its name, see :func:`nodes_of`; ``nsu=URI;s=..`` too.
    identity, trust, insecure
        See :func:`connected`.
    answer : float
        Seconds for a read or a write.

    Raises
    ------
    LostMotionError
        See :func:`connected`.
    """

    def __init__(
        self,
        address: str,
        nodes: Mapping[str, str],
        identity: Identity | None = None,
        trust: TrustStore | None = None,
        insecure: bool = False,
        *,
        answer: float = ANSWER,
    ) -> None:
        self._begin(lambda: connected(address, identity, trust, insecure), nodes, answer)

    @classmethod
    def over(cls, connect: Connect, nodes: Mapping[str, str], *, answer: float = ANSWER) -> Self:
        """The same over a connection that is made elsewhere; errors are those of `connect`."""
        made = cls.__new__(cls)
        made._begin(connect, nodes, answer)
        return made

    def _begin(self, connect: Connect, nodes: Mapping[str, str], answer: float) -> None:
        self._connect, self._names, self._answer = connect, dict(nodes), answer
        self._client: Client | None = None
        self._nodes: dict[str, ua.NodeId] = {}
        self._kinds: dict[str, ua.VariantType] = {}
        self._one = threading.Lock()
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="link to the block", daemon=True)
        self._thread.start()
        try:
            self._told(self._opened(), LostMotionError)
        except BaseException:
            self.close()
            raise

    def read(self, names: Iterable[str]) -> Mapping[str, float]:
        """Present values, of good quality all of them; see :meth:`Link.read`."""
        wanted = list(names)
        self._refuse(wanted, self._names, "names of the block")
        return dict(zip(wanted, self._told(self._read(wanted)), strict=True))

    def write(self, values: Mapping[str, int]) -> None:
        """Write the inputs of the supervision, once; see :meth:`Link.write`."""
        self._refuse(values, [name for name in WRITABLE if name in self._names], "inputs of the supervision")
        for name, value in values.items():
            if not (abs(value) < DINT and int(value) == value):
                raise LinkError(f"expected a whole number for {name}, got {value}; it is a DINT")
        if values:
            self._told(self._write(dict(values)))

    def close(self) -> None:
        """Say farewell; harmless where that has been done."""
        if self._loop.is_closed():
            return
        with suppress(*FAILURES):
            self._wait(self._ended())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(LEAVE)
        if not self._thread.is_alive():
            self._loop.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _refuse(self, names: Iterable[str], known: Iterable[str], what: str) -> None:
        odd = sorted(set(names) - set(known))
        if odd:
            raise LinkError(f"expected {what}, got {odd}; the PLC owns the others")

    def _wait(self, work: Coroutine[Any, Any, Answer]) -> Answer:
        running = asyncio.run_coroutine_threadsafe(work, self._loop)
        try:
            return running.result(STUCK)
        finally:
            running.cancel()

    def _told(self, work: Coroutine[Any, Any, Answer], plain: type[LostMotionError] = LinkError) -> Answer:
        """What `work` returns; any failure but a `plain` one is a LinkError."""
        if self._loop.is_closed():
            work.close()
            raise LinkError("expected an open link, got a closed one; make a new one")
        with self._one:
            try:
                return self._wait(work)
            except plain:
                raise
            except FAILURES as error:
                why = str(error)[:300] or type(error).__name__
                raise LinkError(
                    f"expected an answer of the block's server, got {why}; nothing is sent again"
                ) from error

    async def _read(self, names: list[str]) -> list[float]:
        client = await self._opened()
        async with self._whole(client):
            found = await client.uaclient.read_attributes([self._nodes[name] for name in names], AttributeIds.Value)
        return [_number(name, data) for name, data in zip(names, found, strict=True)]

    async def _write(self, values: dict[str, int]) -> None:
        client = await self._opened()
        last = [name for name in values if name == "request_id"]
        first = [name for name in values if name != "request_id"]
        for names in (first, last):
            if names:
                await self._send(client, {name: values[name] for name in names})

    async def _send(self, client: Client, values: dict[str, int]) -> None:
        data = [_data(name, value, self._kinds.get(name)) for name, value in values.items()]
        async with self._whole(client):
            answers = await client.uaclient.write_attributes([self._nodes[name] for name in values], data)
        for name, answer in zip(values, answers, strict=True):
            if answer.value != 0:  # "good, completes later" is doubtful as well
                raise LinkError(f"expected {name} to be taken, got {answer.name}; look at the rights of its node")

    @asynccontextmanager
    async def _whole(self, client: Client) -> AsyncIterator[None]:
        """A call that is answered in time, or costs the connection with what may still wait in it."""
        try:
            async with asyncio.timeout(self._answer):
                yield
        except BaseException:
            self._client = None
            protocol = client.uaclient.protocol
            if protocol is not None and protocol.transport is not None:
                protocol.transport.abort()
            await leave(client)
            raise

    async def _opened(self) -> Client:
        if self._client is None:
            async with asyncio.timeout(OPENING):
                client = await self._connect()
            try:
                async with asyncio.timeout(OPENING):
                    await self._learn(client)
            except BaseException:
                await leave(client)
                raise
            self._client = client
        return self._client

    async def _ended(self) -> None:
        client, self._client = self._client, None
        if client is not None:
            await leave(client)
        others = asyncio.all_tasks() - {asyncio.current_task()}
        for task in others:
            task.cancel()
        if others:
            await asyncio.wait(others, timeout=LEAVE)

    async def _learn(self, client: Client) -> None:
        """Ids of the nodes, and the types in which the inputs are written."""
        for name, node in self._names.items():
            self._nodes[name] = client.get_node(await resolved(client, node)).nodeid
        inputs = [name for name in WRITABLE if name in self._nodes]
        types = await client.uaclient.read_attributes([self._nodes[name] for name in inputs], AttributeIds.DataType)
        said = {name: data.Value.Value for name, data in zip(inputs, types, strict=True) if data.Value is not None}
        self._kinds = {
            name: KINDS[kind.Identifier]
            for name, kind in said.items()
            if isinstance(kind, ua.NodeId) and kind.NamespaceIndex == 0 and kind.Identifier in KINDS
        }
        unfit = [name for name in inputs if name not in self._kinds]
        if unfit:  # known before anything is written
            raise LinkError(f"expected nodes of 32 bits or more for {unfit}, got other types; make them DINT")


def _number(name: str, data: ua.DataValue) -> float:
    content = None if data.Value is None else data.Value.Value
    if quality_of(data) != "Good" or not isinstance(content, bool | int | float) or not math.isfinite(content):
        said = quality_of(data).lower()
        raise LinkError(f"expected a good number of {name}, got {content!r} of {said} quality; look at its node")
    return float(content)


def _data(name: str, value: int, kind: ua.VariantType | None) -> ua.DataValue:
    if kind is None:
        raise LinkError(f"expected a node of 32 bits or more for {name}, got another type; make it a DINT")
    if kind in UNSIGNED and value < 0:
        raise LinkError(
            f"expected a value of 0 or more for {name}, whose node has no sign, got {value}; make it a DINT"
        )
    return ua.DataValue(ua.Variant(float(value) if kind in REAL else int(value), kind), StatusCode=None)
