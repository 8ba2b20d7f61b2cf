"""The server of node-opcua in a process of its own."""

import contextlib
import json
import os
import queue
import shutil
import subprocess
import threading
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
PATIENCE = 120.0  # s for an answer; four servers take 6 s of processor time, of a machine that may be busy


def needed():
    """Skip, or fail where CI is set, without the server."""
    why = None
    if shutil.which("node") is None:
        why = "needs node; see `make opcua`"
    elif not (HERE / "node_modules" / "node-opcua").is_dir():
        why = "needs node-opcua: run `make opcua`"
    if why is not None:
        (pytest.fail if os.environ.get("CI") and shutil.which("npm") else pytest.skip)(why)


def config(folder, pair, uri, **more):
    """What server.js has to know of one server; see there for more."""
    return {
        "folder": str(folder), "certificate": str(pair.der.with_suffix(".crt.pem")), "key": str(pair.pem), "uri": uri,
        "modes": ["SignAndEncrypt"], "policies": ["Basic256Sha256"], **more,
    }  # fmt: skip


class NodeServer:
    """Servers, each with a simulated loop, in one process; `configs` by name, of which "plant" takes the commands."""

    def __init__(self, folder, **configs):
        needed()
        self.configs = configs
        self.log = Path(folder) / "server.log"
        self.log.parent.mkdir(parents=True, exist_ok=True)
        self.start()

    def start(self):
        """Start the process, once more after a kill; the ports stay."""
        environment = {**os.environ, "NODE_OPTIONS": "", "HOME": str(self.log.parent)}
        self._answers = queue.Queue()
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(
                [shutil.which("node"), str(HERE / "server.js")],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, text=True, env=environment,
            )  # fmt: skip
        self._listener = threading.Thread(target=self._listen, args=(self.process,), daemon=True)
        self._listener.start()
        try:
            for name, port in self._ask(self.configs)["ready"].items():
                self.configs[name]["port"] = port
        except BaseException:
            self.close()
            raise

    def _listen(self, process):
        for line in process.stdout:
            self._answers.put(line)
        self._answers.put("")

    def _ask(self, line):
        self.process.stdin.write(json.dumps(line) + "\n")
        self.process.stdin.flush()
        answer = self._answers.get(timeout=PATIENCE)
        assert answer, self.log.read_text()[-2000:]
        said = json.loads(answer)
        assert "error" not in said, said
        return said

    def do(self, command, **words):
        """Answer to a command."""
        return self._ask({"do": command, **words})

    def address(self, name="plant"):
        """Where a server is."""
        return f"opc.tcp://127.0.0.1:{self.configs[name]['port']}/plant"

    def kill(self):
        """As a power cut does."""
        self.process.kill()
        self.process.wait()
        self._let_go()

    def _let_go(self):
        """Pipes that are left open are a warning, which is an error."""
        self._listener.join(10)
        with contextlib.suppress(OSError):
            self.process.stdin.close()
        self.process.stdout.close()

    def close(self):
        """End it."""
        with contextlib.suppress(OSError):
            self.process.stdin.close()
        try:
            self.process.wait(3)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self._let_go()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
