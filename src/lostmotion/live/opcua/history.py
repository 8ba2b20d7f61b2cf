"""What the server kept while nobody listened."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta

from asyncua import ua
from asyncua.client.client import Client
from asyncua.common.node import Node
from asyncua.ua.attribute_ids import AttributeIds
from asyncua.ua.status_codes import StatusCodes
from asyncua.ua.uaerrors import UaStatusCodeError

AT_ONCE = 8  # requests under way
AHEAD = timedelta(days=1)  # the server's clock may be ahead of ours
BROKEN = {
    StatusCodes.BadTimeout, StatusCodes.BadConnectionClosed, StatusCodes.BadSecureChannelClosed,
    StatusCodes.BadSecureChannelIdInvalid, StatusCodes.BadSessionClosed, StatusCodes.BadSessionIdInvalid,
    StatusCodes.BadCommunicationError, StatusCodes.BadServerHalted, StatusCodes.BadShutdown, StatusCodes.BadDisconnect,
}  # fmt: skip
_READ = 1 << ua.AccessLevel.HistoryRead.value


async def with_history(client: Client, nodes: Sequence[Node]) -> list[bool]:
    """Which nodes have a history that we may read."""
    found = await client.read_attributes(nodes, AttributeIds.UserAccessLevel)
    return [bool(data.Value is not None and int(data.Value.Value or 0) & _READ) for data in found]


async def histories(nodes: Sequence[tuple[Node, float]]) -> list[list[ua.DataValue]]:
    """Raw values of each node since a time in seconds from 1970; none where the server refuses."""
    limit = asyncio.Semaphore(AT_ONCE)

    async def one(node: Node, since: float) -> list[ua.DataValue]:
        async with limit:
            try:
                begin = datetime.fromtimestamp(since, UTC)
                return await node.read_raw_history(begin, datetime.now(UTC) + AHEAD, return_bounds=False)
            except UaStatusCodeError as error:
                if error.code in BROKEN:  # that is no answer about a history
                    raise
                return []

    return await asyncio.gather(*(one(node, since) for node, since in nodes))
