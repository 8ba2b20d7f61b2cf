"""The virtual plant behind an OPC UA server on this machine: a bench for the live link and for a supervisor."""

from __future__ import annotations

import asyncio
import logging
import math
import time
from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from threading import Event
from typing import Any, Self

from asyncua import ua
from asyncua.server.server import Server

from lostmotion.errors import FileAccessError
from lostmotion.live.virtual_plant import HIGH, LOW, VirtualLoop, VirtualPlant
from lostmotion.live.virtual_plc import DINT, WRITABLE

HOST = "127.0.0.1"  # and no other: anybody who reaches it may write
SPACE = "urn:lostmotion:demo"
ANY_AGE: Any = None  # what a client writes may have no stamp
KEPT = 7200  # values of a history, an hour in real time
LATE = 2.0  # s behind the clock, from which the plant goes on from now instead of hurrying
LOOK = 0.1  # s between looks whether to stop
KINDS = {"bool": ua.VariantType.Boolean, "int": ua.VariantType.Int32, "real": ua.VariantType.Double}


def loop_tag(name: str) -> str:
    """Tag of a loop in the server.

    Examples
    --------
    >>> loop_tag("FIC-102"), block_tag("FIC-102")
    ('FIC102', 'FY102')
    """
    return name.replace("-", "")


def block_tag(name: str) -> str:
    """Tag of the block of a loop in the server: a computing relay."""
    return f"{name[0]}Y{name.partition('-')[2]}"


class DemoServer:
    """Server of a virtual plant, without security; used as ``async with``.

    Each loop is a folder with OP, PV, SP and MODE; its block is another with all its inputs and outputs. OP, PV, SP and
    OP_OUT have a history. What a supervisor writes, ACCEPT and SP can be written. ACCEPT is a button: it springs back.

    Parameters
    ----------
    plant : VirtualPlant
    port : int
        0: a free one; see `address`.
    speed : float
        Seconds of the plant in one of the clock. Stamps are those of the clock.

    Raises
    ------
    FileAccessError
        The port is not free.
    """

    def __init__(self, plant: VirtualPlant, port: int = 0, speed: float = 1.0) -> None:
        self.plant, self._port = plant, port
        self.period = next(iter(plant.loops.values())).scan_time / speed
        self._nodes: dict[str, Any] = {}
        self._shown: dict[str, Any] = {}
        self._set_points: dict[str, Any] = {}  # that were shown: another one is an operator's
        logging.getLogger("asyncua").addHandler(logging.NullHandler())

    @property
    def address(self) -> str:
        """Where clients find it."""
        return f"opc.tcp://{HOST}:{self._port}"

    async def __aenter__(self) -> Self:
        self.plant.step()  # compiled before anybody waits for a value
        self._server = Server()
        await self._server.init()
        self._server.set_endpoint(self.address)
        self._server.set_server_name("lostmotion demo-live")
        self._server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
        space = await self._server.register_namespace(SPACE)
        for loop in self.plant.loops.values():
            await self._add(space, loop_tag(loop.name), _types(self._signals(loop)), ("SP",))
            await self._add(space, block_tag(loop.name), _types_of_block(loop), [name.upper() for name in WRITABLE])
            await self._nodes[f"{block_tag(loop.name)}.ACCEPT"].set_writable()
        await self._show(datetime.now(UTC))
        try:
            await self._server.start()
        except OSError as error:
            raise FileAccessError(f"expected a free port, got {self._port} in use; try --port 0") from error
        listening: Any = self._server.bserver
        self._port = listening._server.sockets[0].getsockname()[1]
        for name, node in self._nodes.items():
            if name.endswith((".OP", ".PV", ".SP", ".OP_OUT")):
                await self._server.historize_node_data_change(node, ANY_AGE, KEPT)
        return self

    async def __aexit__(self, *_: object) -> None:
        await self._server.stop()

    async def run(self, stop: Event, seconds: float = math.inf) -> None:
        """Scan until `stop` is set or `seconds` of the clock have passed."""
        end = time.monotonic() + seconds
        due, stamp = time.monotonic(), datetime.now(UTC)
        while not stop.is_set() and time.monotonic() < end:
            due, stamp = due + self.period, stamp + timedelta(seconds=self.period)
            if time.monotonic() - due > LATE:
                due, stamp = time.monotonic(), datetime.now(UTC)
            while (left := due - time.monotonic()) > 0 and not stop.is_set():
                await asyncio.sleep(min(left, LOOK))
            await self.scan(stamp)

    async def scan(self, stamp: datetime) -> None:
        """One scan: take what was written, step the plant, show what came of it."""
        for loop in self.plant.loops.values():
            await self._take(loop)
        self.plant.step()
        await self._show(stamp)
        await asyncio.sleep(0)

    async def _add(self, space: int, tag: str, kinds: Mapping[str, ua.VariantType], writable: Any) -> None:
        objects = self._server.nodes.objects
        folder = await objects.add_folder(_id(space, tag), ua.QualifiedName(tag, space))
        for name, kind in kinds.items():
            first = "" if kind == ua.VariantType.String else 0
            where = _id(space, f"{tag}.{name}"), ua.QualifiedName(name, space)
            self._nodes[f"{tag}.{name}"] = node = await folder.add_variable(*where, first, kind)
            if name in writable:
                await node.set_writable()

    async def _take(self, loop: VirtualLoop) -> None:
        """The id of a request before the values that it stands for: they were written before it."""
        block = block_tag(loop.name)
        asked = {name: self._value(f"{block}.{name.upper()}") for name in WRITABLE}
        loop.plc.write({name: value for name, value in asked.items() if isinstance(value, int) and abs(value) < DINT})
        if self._value(f"{block}.ACCEPT") is True:
            loop.accept()
            await self._write(f"{block}.ACCEPT", False, datetime.now(UTC))
        sp = self._value(f"{loop_tag(loop.name)}.SP")
        if sp != self._set_points.get(loop.name) and isinstance(sp, int | float) and math.isfinite(sp):
            loop.sp = min(max(float(sp), LOW), HIGH)

    async def _show(self, stamp: datetime) -> None:
        for loop in self.plant.loops.values():
            for name, value in self._signals(loop).items():
                await self._write(f"{loop_tag(loop.name)}.{name}", value, stamp)
            self._set_points[loop.name] = loop.set_point
            kinds = _types_of_block(loop)
            known = loop.plc.read([name.lower() for name in kinds])
            for name in kinds.keys() - {"ACCEPT", *(name.upper() for name in WRITABLE)}:
                key, value = f"{block_tag(loop.name)}.{name}", known[name.lower()]
                if self._shown.get(key) != value:
                    await self._write(key, _cast(value, kinds[name]), stamp, kinds[name])
                    self._shown[key] = value

    def _signals(self, loop: VirtualLoop) -> dict[str, Any]:
        values = loop.values()
        return {**{name.upper(): values[name] for name in ("op", "pv", "sp")}, "MODE": "AUTO"}

    def _value(self, key: str) -> Any:
        held = self._server.read_attribute_value(self._nodes[key].nodeid).Value
        return None if held is None else held.Value

    async def _write(self, key: str, value: Any, stamp: Any, kind: Any = None) -> None:
        data = ua.DataValue(ua.Variant(value, kind), SourceTimestamp=stamp, ServerTimestamp=stamp)
        await self._server.write_attribute_value(self._nodes[key].nodeid, data)


def _id(space: int, text: str) -> ua.NodeId:
    return ua.NodeId.from_string(f"ns={space};s={text}")


def _types(signals: Mapping[str, Any]) -> dict[str, ua.VariantType]:
    return {
        name: ua.VariantType.String if isinstance(value, str) else ua.VariantType.Double
        for name, value in signals.items()
    }


def _types_of_block(loop: VirtualLoop) -> dict[str, ua.VariantType]:
    specification = loop.block.specification
    return {one.name: KINDS[one.kind] for section in ("input", "output") for one in specification.section(section)}


def _cast(value: float, kind: ua.VariantType) -> Any:
    if kind == ua.VariantType.Boolean:
        return bool(value)
    return int(value) if kind == ua.VariantType.Int32 else value
