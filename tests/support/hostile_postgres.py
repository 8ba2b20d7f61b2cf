"""A peer on 127.0.0.1 that speaks PostgreSQL as far as it likes."""

from __future__ import annotations

import socket
import struct
import threading

OK = b"R" + struct.pack("!ii", 8, 0)  # AuthenticationOk
READY = b"Z" + struct.pack("!i", 5) + b"I"
NUMBER = struct.pack("!h", 1) + b"a\0" + struct.pack("!ihihih", 0, 0, 23, 4, -1, 0)
ROW = b"T" + struct.pack("!i", 4 + len(NUMBER)) + NUMBER


def _silent(line):
    line.recv(4096)
    line.recv(1)


def _garbage(line):
    line.recv(4096)
    line.sendall(bytes(range(256)) * 64)


def _error_without_end(line):
    line.recv(4096)
    line.sendall(b"E" + struct.pack("!i", 2**30) + b"SFATAL\0")
    while True:
        line.sendall(b"M" + b"x" * 65536)


def _huge(line):
    line.recv(4096)
    line.sendall(b"R" + struct.pack("!ii", 2**31 - 1, 0))
    line.recv(1)


def _mute_after_login(line):
    line.recv(4096)
    line.sendall(OK + READY)
    while line.recv(4096):
        pass


def _garbage_after_login(line):
    line.recv(4096)
    line.sendall(OK + READY)
    line.recv(4096)
    line.sendall(bytes(range(256)) * 64)


def _trickle_after_login(line):
    """A notice each moment, and no answer."""
    line.recv(4096)
    line.sendall(OK + READY)
    while not threading.Event().wait(0.2):
        line.sendall(b"N" + struct.pack("!i", 5) + b"\0")


def _rows_without_end(line):
    line.recv(4096)
    line.sendall(OK + READY)
    line.recv(4096)
    line.sendall(b"1\x00\x00\x00\x04" + b"2\x00\x00\x00\x04" + ROW)
    one = b"D" + struct.pack("!ihi", 4 + 2 + 4 + 1, 1, 1) + b"7"
    while True:
        line.sendall(one)
        threading.Event().wait(0.001)


PEERS = {
    "silent": _silent, "garbage": _garbage, "an error without end": _error_without_end, "a huge message": _huge,
    "mute after the login": _mute_after_login, "garbage after the login": _garbage_after_login,
    "a notice each moment": _trickle_after_login, "rows without end": _rows_without_end,
}  # fmt: skip


class HostilePostgres:
    """Server of one kind of PEERS; refuses TLS, as servers do that have none."""

    def __init__(self, kind):
        self._talk = PEERS[kind]
        self._server = socket.create_server(("127.0.0.1", 0))
        self.address = f"postgresql://me:secret@127.0.0.1:{self._server.getsockname()[1]}/plant"
        self._lines = []
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self):
        while True:
            try:
                line, _ = self._server.accept()
            except OSError:
                return
            self._lines.append(line)
            threading.Thread(target=self._answer, args=(line,), daemon=True).start()

    def _answer(self, line):
        try:
            first = line.recv(8, socket.MSG_PEEK)
            while len(first) == 8 and first[4:] in (b"\x04\xd2\x16/", b"\x04\xd2\x160"):  # TLS or GSS?
                line.recv(8)
                line.sendall(b"N")
                first = line.recv(8, socket.MSG_PEEK)
            self._talk(line)
        except OSError:
            pass
        finally:
            line.close()

    def close(self):
        """End it and all its lines."""
        self._server.close()
        for line in self._lines:
            line.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
