"""The link to a server: one subscription for all loops, history after an outage, and a connection that comes again."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Awaitable, Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from asyncua import ua
from asyncua.client.client import Client
from asyncua.common.node import Node
from asyncua.common.subscription import DataChangeEvent, OverflowPolicy, StatusChangeEvent, SubEvent, Subscription
from asyncua.ua.attribute_ids import AttributeIds
from asyncua.ua.status_codes import StatusCodes
from asyncua.ua.uaerrors import UaError

from lostmotion.errors import LostMotionError, ParameterError
from lostmotion.live.loop_source import LoopSource
from lostmotion.live.opcua.data_value import overflowed, seconds_of, value_of
from lostmotion.live.opcua.history import histories, with_history
from lostmotion.live.opcua.refusal import RefusedError
from lostmotion.live.value import Value

RETRY = 1.0  # s between attempts: a server is found again this long after its port opens
TICK = 0.05  # s between looks at what has come
KEEP_ALIVE = 5.0  # s after which a silent server says that it is there
STALE = 6.0  # s without a word after which the link counts as broken
WAITING = 200_000  # values between the socket and the rows; more: the link is cut, and history asked
PER_CALL = 200  # monitored items in one request
LATER = (0.1, 0.3, 1.0)  # s after which a history that does not reach up to now is read again
LEAVE = 2.0  # s for a farewell
FIRST_HANDLE = 1000
NO_FILTERS = (
    StatusCodes.BadFilterNotAllowed,
    StatusCodes.BadMonitoredItemFilterUnsupported,
    StatusCodes.BadMonitoredItemFilterInvalid,
)
FAILURES = (OSError, TimeoutError, UaError, LostMotionError)

Connect = Callable[[], Awaitable[Client]]
Tell = Callable[[str, str, str], None]  # kind, tag ("" for all), message


@dataclass
class Followed:
    """A loop as the link sees it.

    Attributes
    ----------
    source : LoopSource
    automatic : tuple of str
        Words of the mode in automatic; empty: the usual ones.
    uncertain : "bad" or "keep"
    """

    source: LoopSource
    automatic: tuple[str, ...] = ()
    uncertain: str = "bad"
    pending: list[Value] = field(default_factory=list)

    def take(self, role: str, data: ua.DataValue, at: float) -> None:
        """Keep a value until the next look."""
        value = value_of(role, data, at, self.automatic, self.uncertain)
        if value is not None:
            self.pending.append(value)

    def hand_over(self) -> None:
        """Give the source what has come."""
        values, self.pending = self.pending, []
        self.source.feed(values)


class Link:
    """Keeps the sources fed until it is cancelled.

    Parameters
    ----------
    connect : callable
        Gives a client with an open session.
    loops : sequence of Followed
    publishing : float
        Seconds between messages of the server.
    tell : callable
        ``tell(kind, tag, message)`` for what a person should know.
    taps : sequence of callable
        Each takes ``(loop, role, data)`` of every value that comes, for a record of it.
    """

    def __init__(
        self,
        connect: Connect,
        loops: Sequence[Followed],
        publishing: float,
        tell: Tell,
        taps: Sequence[Callable[[Followed, str, ua.DataValue], None]] = (),
    ) -> None:
        self._connect, self.loops, self._publishing, self._tell, self._taps = connect, loops, publishing, tell, taps
        self._routes: dict[int, tuple[Followed, str]] = {}
        self._said = ""
        self._lost: asyncio.Event = asyncio.Event()
        self.connections = 0
        quiet = logging.getLogger("asyncua")
        quiet.addHandler(logging.NullHandler())
        quiet.propagate = False

    async def meet(self) -> None:
        """Connect once and leave: who is not believed is known before anything long begins.

        Raises
        ------
        ParameterError, RefusedError
            Trying again does not help. A server that is only not there is told, and sought by :meth:`run`.
        """
        try:
            await leave(await self._connect())
        except (ParameterError, RefusedError):
            raise
        except FAILURES as error:
            self._say("lost", str(error)[:300] or type(error).__name__)

    async def run(self) -> None:
        """Connect, listen, and again after each loss."""
        while True:
            client = None
            try:
                client = await self._connect()
                await self._serve(client)
            except (ParameterError, RefusedError) as error:
                if not self.connections:
                    raise
                self._say("lost", str(error)[:300])
            except FAILURES as error:
                self._say("lost", str(error)[:300] or type(error).__name__)
            finally:
                for loop in self.loops:
                    loop.hand_over()
                    loop.source.broken()
                if client is not None:
                    await leave(client)
            await asyncio.sleep(RETRY)

    def _say(self, kind: str, message: str) -> None:
        """Tell once until something else is to be told."""
        if message != self._said:
            self._said = message
            self._tell(kind, "", message)

    async def _serve(self, client: Client) -> None:
        self._lost = asyncio.Event()

        async def lost(_: Exception) -> None:
            self._lost.set()

        client.connection_lost_callback = lost
        nodes = await self._nodes(client)
        subscription = await client.create_subscription(
            self._parameters(), queue_maxsize=WAITING, overflow=OverflowPolicy.DISCONNECT
        )
        await self._monitor(subscription, nodes)
        reader = asyncio.create_task(self._listen(subscription))
        try:
            await self._catch_up(client, nodes)
            self.connections += 1
            self._say("connected", f"Connected, {len(nodes)} nodes of {len(self.loops)} loops.")
            while not self._lost.is_set() and not reader.done():
                await asyncio.sleep(TICK)
                self._look(subscription)
        finally:
            reader.cancel()
            with suppress(asyncio.CancelledError):
                await reader
        raise ConnectionError("The connection is lost; it is sought again.")

    def _parameters(self) -> ua.CreateSubscriptionParameters:
        period = self._publishing
        count = max(1, round(KEEP_ALIVE / period))
        return ua.CreateSubscriptionParameters(
            RequestedPublishingInterval=1000.0 * period,
            RequestedLifetimeCount=10 * count,
            RequestedMaxKeepAliveCount=count,
            MaxNotificationsPerPublish=0,
            PublishingEnabled=True,
            Priority=0,
        )

    async def _nodes(self, client: Client) -> list[tuple[Followed, str, Node]]:
        found = []
        for loop in self.loops:
            for role, name in loop.source.signals.nodes.items():
                found.append((loop, role, client.get_node(await resolved(client, name))))
        return found

    async def _monitor(self, subscription: Subscription, nodes: Sequence[tuple[Followed, str, Node]]) -> None:
        """Ask for every value of every node; tell which there are none of."""
        self._routes = {}
        for first in range(0, len(nodes), PER_CALL):
            some = nodes[first : first + PER_CALL]
            wanted = [
                _wanted(FIRST_HANDLE + first + k, node, loop.source.signals.dt, self._publishing)
                for k, (loop, _, node) in enumerate(some)
            ]
            self._routes |= {FIRST_HANDLE + first + k: (loop, role) for k, (loop, role, _) in enumerate(some)}
            answers = await subscription.create_monitored_items(wanted)
            plain = [k for k, answer in enumerate(answers) if _has_no_filters(answer)]
            for k in plain:
                wanted[k].RequestedParameters.Filter = None
            for k, answer in zip(plain, await self._again(subscription, [wanted[k] for k in plain]), strict=True):
                answers[k] = answer
            for (loop, role, node), answer in zip(some, answers, strict=True):
                if isinstance(answer, ua.StatusCode):
                    said = f"{role.upper()} {node.nodeid.to_string()} cannot be read: {answer.name}."
                    self._tell("note", loop.source.name, said)

    async def _again(
        self, subscription: Subscription, wanted: list[ua.MonitoredItemCreateRequest]
    ) -> list[int | ua.StatusCode]:
        """The same without a filter, from a server that knows none: it tells what has changed, and no new stamps."""
        if not wanted:
            return []
        self._tell("note", "", f"The server tells changes only of {len(wanted)} nodes: on_change holds PV over that.")
        return await subscription.create_monitored_items(wanted)

    async def _catch_up(self, client: Client, nodes: Sequence[tuple[Followed, str, Node]]) -> None:
        """Put what the server kept since the last row of each loop before what has come since."""
        missed = [one for one in nodes if one[0].source.newest > 0]
        if not missed:
            return
        try:
            kept = await with_history(client, [node for _, _, node in missed])
            asked = [one for one, has in zip(missed, kept, strict=True) if has]
            since = [(node, loop.source.newest - loop.source.signals.dt) for loop, _, node in asked]
            found = await histories(since)
            for pause in LATER:
                late = [k for k, (loop, role, _) in enumerate(asked) if role == "pv" and _hole(loop, found[k])]
                if not late:
                    break
                await asyncio.sleep(pause)
                found = await histories(since)
        except BaseException:
            for loop, _, _ in missed:
                loop.pending = []  # given over now, they would hide what is older: it is asked for again with them
            raise
        at = time.monotonic()
        live = {id(loop): (loop, loop.pending) for loop, _, _ in asked}
        for loop, _ in live.values():
            loop.pending = []
        for (loop, role, _), values in zip(asked, found, strict=True):
            for data in values:
                self._arrived(loop, role, data, at)
        for loop, since_then in live.values():
            newest = loop.source.newest
            earlier = [value for value in loop.pending if value.role != "pv" or value.stamp > newest]
            loop.pending = [*earlier, *(value._replace(at=at) for value in since_then)]

    def _arrived(self, loop: Followed, role: str, data: ua.DataValue, at: float) -> None:
        loop.take(role, data, at)
        for tap in self._taps:
            tap(loop, role, data)

    async def _listen(self, subscription: Subscription) -> None:
        async for event in subscription:
            self._take(event)

    def _take(self, event: SubEvent) -> None:
        if isinstance(event, StatusChangeEvent):
            self._lost.set()
        if not isinstance(event, DataChangeEvent):
            return
        route = self._routes.get(event.data.subscription_data.client_handle or 0)
        data = event.data.monitored_item.Value
        if route is None or data is None:
            return
        loop, role = route
        if overflowed(data):
            stamp = "?" if data.SourceTimestamp is None else f"{seconds_of(data.SourceTimestamp):.3f}"
            self._tell("note", loop.source.name, f"The server dropped values of {role.upper()} before {stamp}.")
            loop.hand_over()
            loop.source.broken()
        self._arrived(loop, role, data, time.monotonic())

    def _look(self, subscription: Subscription) -> None:
        heard = subscription.last_publish_at
        if heard is not None and time.monotonic() - heard > STALE:
            raise ConnectionError(f"Nothing heard from the server for {STALE:g} s; connecting anew.")
        for loop in self.loops:
            loop.hand_over()
            loop.source.alive = heard


def _hole(loop: Followed, values: Sequence[ua.DataValue]) -> bool:
    """Whether the history of PV ends more than a sample before what has come since: servers write it with a delay."""
    first = min((value.stamp for value in loop.pending if value.role == "pv"), default=None)
    if first is None or loop.source.signals.on_change:
        return False
    stamps = [seconds_of(one.SourceTimestamp) for one in values if one.SourceTimestamp is not None]
    before = max((stamp for stamp in stamps if stamp < first), default=loop.source.newest)
    return first not in stamps and first - before > 1.5 * loop.source.signals.dt


def _has_no_filters(answer: int | ua.StatusCode) -> bool:
    return isinstance(answer, ua.StatusCode) and answer.value in NO_FILTERS


def _wanted(handle: int, node: Node, dt: float, publishing: float) -> ua.MonitoredItemCreateRequest:
    """Every value with a stamp of its own, no deadband, and room for twice what one message holds."""
    sampling = 0.5 * dt
    return ua.MonitoredItemCreateRequest(
        ItemToMonitor=ua.ReadValueId(NodeId=node.nodeid, AttributeId=AttributeIds.Value),
        MonitoringMode=ua.MonitoringMode.Reporting,
        RequestedParameters=ua.MonitoringParameters(
            ClientHandle=handle,
            SamplingInterval=1000.0 * sampling,
            Filter=ua.DataChangeFilter(Trigger=ua.DataChangeTrigger.StatusValueTimestamp),
            QueueSize=max(20, 1 + round(20 * max(publishing, 1.0) / sampling)),
            DiscardOldest=True,
        ),
    )


async def resolved(client: Client, name: str) -> Any:
    """Node id; ``nsu=URI;s=..`` names the namespace, whose number may change when a server starts anew."""
    if not name.startswith("nsu="):
        return name
    uri, _, rest = name[4:].partition(";")
    return f"ns={await client.get_namespace_index(uri)};{rest}"


async def leave(client: Client) -> None:
    """Say farewell, as far as anybody listens."""
    with suppress(*FAILURES, asyncio.CancelledError):
        await asyncio.wait_for(client.disconnect(), LEAVE)
