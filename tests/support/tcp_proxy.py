"""A network that can be cut: everything between a client and a server on 127.0.0.1 goes through it."""

import asyncio
from contextlib import suppress

PIECE = 65_536


class Proxy:
    """Listens on a port of its own and passes on what comes, unless it is frozen or cut."""

    def __init__(self, target):
        self.target, self.port = target, 0
        self._flows = asyncio.Event()
        self._flows.set()
        self._writers, self._tasks = set(), set()

    async def __aenter__(self):
        await self._listen()
        return self

    async def __aexit__(self, *_):
        self.thaw()
        await self.cut()
        await asyncio.gather(*self._tasks)

    @property
    def address(self):
        return f"opc.tcp://127.0.0.1:{self.port}"

    async def cut(self):
        """Break all connections; nobody listens."""
        self._server.close()
        for writer in list(self._writers):
            writer.transport.abort()
        await asyncio.sleep(0)

    async def mend(self):
        """Listen again."""
        await self._listen()

    def freeze(self):
        """Connections stay open, and new ones are taken, but nothing passes: a half-open line."""
        self._flows.clear()

    def thaw(self):
        """Pass on what has waited, and what comes."""
        self._flows.set()

    async def _listen(self):
        self._server = await asyncio.start_server(self._serve, "127.0.0.1", self.port)
        self.port = self._server.sockets[0].getsockname()[1]

    async def _serve(self, reader, writer):
        self._tasks.add(asyncio.current_task())
        asyncio.current_task().add_done_callback(self._tasks.discard)
        self._writers.add(writer)
        try:
            there, out = await asyncio.open_connection("127.0.0.1", self.target)
        except OSError:
            writer.transport.abort()
            self._writers.discard(writer)
            return
        self._writers.add(out)
        if not self._server.is_serving():  # cut in between
            out.transport.abort()
        await asyncio.gather(self._pass_on(reader, out), self._pass_on(there, writer))

    async def _pass_on(self, reader, writer):
        with suppress(OSError):
            while data := await reader.read(PIECE):
                await self._flows.wait()
                writer.write(data)
                await writer.drain()
        self._writers.discard(writer)
        writer.transport.abort()
