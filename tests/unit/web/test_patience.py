"""Clients that keep the page waiting."""

import asyncio

import pytest
import uvicorn

from lostmotion.web.server import patience
from lostmotion.web.server.patience import Patience, PatientProtocol

SHORT = 0.15  # s


@pytest.fixture
def anyio_backend():
    return "asyncio"


pytestmark = pytest.mark.anyio


async def echo(scope, receive, send):
    """Answers with the length of the body."""
    size, more = 0, True
    while more:
        message = await receive()
        size, more = size + len(message.get("body", b"")), message.get("more_body", False)
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": str(size).encode()})


async def asked(*pieces, pause=0.0):
    """What a server answers to pieces of a request, and how long it took."""
    config = uvicorn.Config(Patience(echo, SHORT), http=PatientProtocol, ws="none", lifespan="off", log_config=None)
    config.load()
    server = uvicorn.Server(config)
    server.lifespan = config.lifespan_class(config)
    loop = asyncio.get_running_loop()

    def protocol():
        return PatientProtocol(config, server.server_state, {})

    listening = await loop.create_server(protocol, "127.0.0.1", 0)
    reader, writer = await asyncio.open_connection(*listening.sockets[0].getsockname())
    began = loop.time()
    try:
        for piece in pieces:
            writer.write(piece)
            await asyncio.sleep(pause)
        try:
            answer = await asyncio.wait_for(reader.read(), 5.0)
        except ConnectionError:
            answer = b""
    finally:
        writer.close()
        listening.close()
    return answer, loop.time() - began


HEAD = b"POST / HTTP/1.1\r\nhost: x\r\nconnection: close\r\ncontent-length: 4\r\n\r\n"


async def test_a_request_in_time_is_answered():
    answer, _ = await asked(HEAD, b"ab", b"cd", pause=0.02)
    assert answer.startswith(b"HTTP/1.1 200")
    assert b"\r\n4\r\n" in answer


@pytest.mark.parametrize("pieces", [(), (HEAD[:20],), tuple(HEAD[k : k + 1] for k in range(40))])
async def test_a_head_that_does_not_come_ends_the_connection(monkeypatch, pieces):
    monkeypatch.setattr(patience, "HEAD", SHORT)
    answer, took = await asked(*pieces, pause=0.02)
    assert answer == b""
    assert took < 4.0


async def test_a_body_that_does_not_come_is_said_so():
    answer, took = await asked(HEAD, b"ab")
    assert answer.startswith(b"HTTP/1.1 408")
    assert took < 4.0


async def test_who_does_not_take_the_answer_is_given_up():
    class Stuck:
        """Sends nothing away, as a client that does not read."""

        sent = 0

        async def send(self, message):
            self.sent += 1
            await asyncio.sleep(60.0)

    async def receive():
        return {"type": "http.request", "body": b"", "more_body": False}

    stuck = Stuck()
    await asyncio.wait_for(Patience(echo, SHORT)({"type": "http"}, receive, stuck.send), 5.0)
    assert stuck.sent == 1


async def test_an_application_that_is_late_itself_is_not_hidden():
    async def late(scope, receive, send):
        raise TimeoutError

    with pytest.raises(TimeoutError):
        await Patience(late, SHORT)({"type": "http"}, None, None)


async def held(monkeypatch, begin, count):
    """What a server of 20 connections answers beside `count` others that each begin with `begin`."""
    monkeypatch.setattr(patience, "WAITING", 10)
    config = uvicorn.Config(
        Patience(echo), http=PatientProtocol, ws="none", lifespan="off", log_config=None, limit_concurrency=20
    )
    config.load()
    server = uvicorn.Server(config)
    loop = asyncio.get_running_loop()
    listening = await loop.create_server(lambda: PatientProtocol(config, server.server_state, {}), "127.0.0.1", 0)
    address = listening.sockets[0].getsockname()
    held = []
    try:
        for _ in range(count):
            reader, writer = await asyncio.open_connection(*address)
            writer.write(begin)
            if begin.endswith(b"\r\n\r\n"):
                await reader.readuntil(b"\r\n\r\n")
            held.append(writer)
        reader, writer = await asyncio.open_connection(*address)
        held.append(writer)
        writer.write(HEAD + b"abcd")
        answer = await asyncio.wait_for(reader.read(), 5.0)
        return answer, len(server.server_state.connections)
    finally:
        for writer in held:
            writer.close()
        listening.close()


@pytest.mark.parametrize("begin", [b"", HEAD[:20], HEAD[:-1], b"GET / HTTP/1.1\r\nhost: x\r\n\r\n"])
async def test_connections_that_wait_keep_nobody_out(monkeypatch, begin):
    """Silent ones, half heads, and those that are kept open after their answer."""
    answer, connections = await held(monkeypatch, begin, 60)
    assert answer.startswith(b"HTTP/1.1 200")
    assert connections <= 11
