"""Limits of time for a client: to send its head, each piece of its body, and to take each piece of the answer.

uvicorn has a limit for idle connections only: one that sends a letter a second would hold its connection for ever.
"""

from __future__ import annotations

import asyncio
from collections.abc import MutableMapping
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

from lostmotion.web.server.guard import App, Receive, Scope, Send

HEAD = 10.0  # s from the connection, or the first sign of another request, to the end of the head
PIECE = 20.0  # s from piece to piece
WAITING = 100  # connections without a request that is answered: one more ends the one that has waited longest


class PatientProtocol(H11Protocol):
    """Closes connections on which the head of a request is not there in time, and those that keep others out.

    Who waits needs no token. A browser sends its head at once, so the connection that has waited longest is none that
    somebody needs: it makes room for the newest, and never takes part in the limit for requests.
    """

    head_timer: asyncio.TimerHandle | None = None
    waits_since: float | None = None  # by the loop's clock; None: a request is being answered

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """The head of the first request may come."""
        super().connection_made(transport)
        self._await_head()
        self._wait()

    def data_received(self, data: bytes) -> None:
        """Bytes of a head, or of a body."""
        super().data_received(data)
        if self.cycle is None or self.cycle.response_complete:
            self._await_head()
        else:
            self._forget_head()
            self.waits_since = None

    def on_response_complete(self) -> None:
        """The next request may come."""
        super().on_response_complete()
        if self.cycle.response_complete:
            self._wait()

    def _wait(self) -> None:
        self.waits_since = self.loop.time()
        waiting = [one for one in self.connections if isinstance(one, PatientProtocol) and one.waits_since is not None]
        if len(waiting) > WAITING:
            oldest = min(waiting, key=lambda one: one.waits_since or 0.0)
            self.connections.discard(oldest)  # now: its end comes later
            oldest.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """It is over."""
        self._forget_head()
        super().connection_lost(exc)

    def _await_head(self) -> None:
        if self.head_timer is None:
            self.head_timer = self.loop.call_later(HEAD, self.transport.abort)

    def _forget_head(self) -> None:
        if self.head_timer is not None:
            self.head_timer.cancel()
            self.head_timer = None


class Patience:
    """ASGI middleware that gives up on a client that neither sends its body nor takes its answer."""

    def __init__(self, app: App, piece: float = PIECE) -> None:
        self._app = app
        self._piece = piece

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request; one that stays away is told so once, where that is still possible."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        exchange = _Exchange(receive, send, self._piece)
        try:
            await self._app(scope, exchange.receive, exchange.send)
        except TimeoutError:
            if exchange.gone:
                await exchange.give_up()
                return
            raise


class _Exchange:
    """One request and its answer."""

    def __init__(self, receive: Receive, send: Send, piece: float) -> None:
        self._receive, self._send, self._piece = receive, send, piece
        self._whole = self._begun = False
        self.gone = False

    async def receive(self) -> MutableMapping[str, Any]:
        """Next piece of the body; once it is whole, whatever comes, however late."""
        if self._whole:
            return await self._receive()
        message: MutableMapping[str, Any] = await self._in_time(self._receive())
        self._whole = not message.get("more_body", False)
        return message

    async def send(self, message: MutableMapping[str, Any]) -> None:
        """Next piece of the answer."""
        if self.gone:
            return
        self._begun = True
        await self._in_time(self._send(message))

    async def _in_time(self, awaited: Any) -> Any:
        try:
            async with asyncio.timeout(self._piece):
                return await awaited
        except TimeoutError:
            self.gone = True
            raise

    async def give_up(self) -> None:
        """An answer that is not begun says why; the connection closes in either case."""
        if not self._begun:
            head = [(b"content-type", b"text/plain; charset=utf-8"), (b"connection", b"close")]
            await self._send({"type": "http.response.start", "status": 408, "headers": head})
            await self._send({"type": "http.response.body", "body": b"The rest of the request did not come in time."})
