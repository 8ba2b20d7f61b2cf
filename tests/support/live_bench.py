"""The virtual plant behind its server in a thread, a proxy that spoils the line, and commands that run beside them."""

import asyncio
import contextlib
import json
import os
import queue
import signal
import subprocess
import sys
import threading
import time

from asyncua import ua
from asyncua.common.callback import CallbackType

from lostmotion.live.demo_files import demo_files
from lostmotion.live.opcua.client import connected
from lostmotion.live.opcua.demo_server import DemoServer
from lostmotion.live.virtual_plant import VirtualPlant
from tests.support.places import ROOT

WRITE_REQUEST = b"\x01\x00\xa1\x02"  # type id 673 of OPC 10000-6
PATIENCE = 240.0  # s; the machine may be busy


class Bench:
    """Demo server at some speed; keeps the names of what clients have written, call by call."""

    def __init__(self, speed, **plant):
        self.plant, self.speed, self.calls = VirtualPlant.worn(**plant), speed, []
        self._stop, ready = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._serve(ready)), daemon=True)
        self._thread.start()
        assert ready.wait(PATIENCE)

    async def _serve(self, ready):
        self.loop = asyncio.get_running_loop()
        async with DemoServer(self.plant, 0, self.speed) as self.server:
            self.server._server.subscribe_server_callback(CallbackType.PostWrite, self._written)
            self.address = self.server.address
            ready.set()
            await self.server.run(self._stop)

    def _written(self, event, _):
        names = [one.NodeId.Identifier for one in event.request_params.NodesToWrite if one.NodeId.NamespaceIndex == 2]
        self.calls += [names] if names else []  # the rest are clocks of the server itself

    def do(self, work):
        return asyncio.run_coroutine_threadsafe(work, self.loop).result(PATIENCE)

    def ids_written(self):
        """Calls in which the id of a request was written."""
        return [call for call in self.calls if any(name.endswith("REQUEST_ID") for name in call)]

    def seen(self, name, tag="TIC-103"):
        return self.plant.loops[tag].plc.read([name])[name]

    def press(self, tag="TIC-103"):
        """The operator's button."""
        self.plant.loops[tag].accept()

    def until(self, what, seconds=PATIENCE):
        end = time.monotonic() + seconds
        while not what():
            assert time.monotonic() < end, {
                n: self.seen(n) for n in ("supervision", "refusal", "shed_reason", "echo_id")
            }
            time.sleep(0.05)

    def write(self, **values):
        """As another client of the server would, in one call."""

        async def send():
            client = await connected(self.address, insecure=True)
            try:
                nodes = [client.get_node(f"ns=2;s=TY103.{name.upper()}") for name in values]
                kinds = [
                    ua.VariantType.Boolean if isinstance(v, bool) else ua.VariantType.Int32 for v in values.values()
                ]
                data = [ua.DataValue(ua.Variant(v, k)) for v, k in zip(values.values(), kinds, strict=True)]
                await client.write_values(nodes, data)
            finally:
                await client.disconnect()

        asyncio.run(send())

    def files(self, folder, address=None, **changes):
        """Plant file of the bench, with lines of the block changed: a value, or None to leave it out."""
        path = demo_files(folder, address or self.address, self.plant.loops["TIC-103"], self.server.period)
        lines = path.read_text().splitlines()
        for name, value in changes.items():
            k = next(k for k, line in enumerate(lines) if line.startswith(f"{name} = "))
            lines[k] = "" if value is None else f"{name} = {json.dumps(value)}"
        path.write_text("\n".join(lines) + "\n")
        return path

    def close(self):
        self._stop.set()
        self._thread.join(PATIENCE)


class Proxy:
    """A line to a server that can be held (half open), and can keep back a write of an id until it is let go."""

    def __init__(self, port):
        self._target, self.keep, self.kept = port, False, 0
        ready = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._serve(ready)), daemon=True)
        self._thread.start()
        assert ready.wait(PATIENCE)

    async def _serve(self, ready):
        self.loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        self._open, self._late = asyncio.Event(), asyncio.Event()
        self._open.set()
        self._tasks = set()
        server = await asyncio.start_server(self._line, "127.0.0.1", 0)
        self.port = server.sockets[0].getsockname()[1]
        ready.set()
        await self._end.wait()
        server.close()
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    async def _line(self, reader, writer):
        there = await asyncio.open_connection("127.0.0.1", self._target)
        for task in (self._pump(reader, there[1], True), self._pump(there[0], writer, False)):
            made = asyncio.create_task(task)
            self._tasks.add(made)
            made.add_done_callback(self._tasks.discard)

    async def _pump(self, reader, writer, outward):
        with contextlib.suppress(OSError):
            while data := await reader.read(65536):
                await self._open.wait()
                if outward and self.keep and WRITE_REQUEST in data and b"REQUEST_ID" in data:
                    self.kept += 1
                    await self._late.wait()
                writer.write(data)
                await writer.drain()
        with contextlib.suppress(OSError):
            writer.close()

    def _do(self, work):
        done = threading.Event()
        self.loop.call_soon_threadsafe(lambda: (work(), done.set()))
        assert done.wait(PATIENCE)

    def hold(self):
        """Nothing goes through any more, and nobody is told."""
        self._do(self._open.clear)

    def let_go(self):
        """Everything that was held goes through, however late."""
        self._do(self._open.set)

    def deliver(self):
        """What was kept back arrives, and nothing is kept back any more."""
        self.keep = False
        self._do(self._late.set)

    def close(self):
        self._do(self._end.set)
        self._thread.join(PATIENCE)


class Command:
    """A command in a process of its own; its messages are kept as they come."""

    def __init__(self, *words, run=("-m", "lostmotion")):
        env = {**os.environ, "PYTHONPATH": f"{ROOT / 'src'}{os.pathsep}{ROOT}"}
        line = [sys.executable, *run, *map(str, words)]
        self.process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=env)
        self.messages, self._new, self.errors = [], queue.Queue(), []
        self._threads = [
            threading.Thread(target=self._listen, daemon=True),
            threading.Thread(target=lambda: self.errors.extend(self.process.stderr), daemon=True),
        ]
        for thread in self._threads:
            thread.start()

    def _listen(self):
        for line in self.process.stdout:
            self._new.put(json.loads(line))
        self._new.put(None)

    def until(self, what, seconds=PATIENCE):
        """The first new message that is so."""
        end = time.monotonic() + seconds
        while True:
            message = self._new.get(timeout=max(0.01, end - time.monotonic()))
            assert message is not None, "".join(self.errors)
            self.messages.append(message)
            if what(message):
                return message

    def send(self, number):
        self.process.send_signal(number)

    def end(self, number=signal.SIGTERM):
        """Exit code after a signal, all messages, and what it said besides."""
        if self.process.poll() is None:
            self.process.send_signal(number)
        code = self.process.wait(PATIENCE)
        for thread in self._threads:
            thread.join(PATIENCE)
        self.process.stdout.close()
        self.process.stderr.close()
        while not self._new.empty():
            self.messages.append(self._new.get())
        self.messages = [one for one in self.messages if one is not None]
        return code, self.messages, "".join(self.errors)


def fit_of(plant, dt, path, samples=3000):
    """Saved fit of the temperature loop, from what a record of it would hold."""
    import lostmotion as lm

    loop = plant.loops["TIC-103"]
    rows = []
    for _ in range(samples):
        loop.scan()
        rows.append((loop.command, loop.values()["pv"]))
    op, pv = zip(*rows, strict=True)
    fit = lm.identify(op, pv, dt, nonlinearity="dead zone", orders=(1, 0, 1))
    fit.save(path)
    return fit
