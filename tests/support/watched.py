"""What a piece of work does outside of this process, as Python itself reports it: files, processes, sockets."""

import json
import os
import sys
from pathlib import Path

import lostmotion
from tests.support.killed import begun, ended

PACKAGE = Path(lostmotion.__file__).parent
WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
CHANGES = {"os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.link", "os.symlink", "os.truncate", "os.chmod"}
RUNS = {"os.system", "os.exec", "os.posix_spawn", "os.spawn", "os.startfile", "subprocess.Popen"}
REACHES = {"socket.connect", "socket.bind", "socket.sendto", "urllib.Request"}


def doings(work, folder):
    """Exit code of `work` in a process of its own, and what it did: pairs of event and arguments, with our modules."""
    told = folder / "doings.jsonl"
    with Path(os.devnull).open("w") as nowhere:
        code = ended(begun(lambda: _watched(work, told), out=nowhere.fileno(), error=nowhere.fileno()))
    found = [json.loads(line) for line in told.read_text(encoding="utf-8").splitlines()]
    told.unlink()
    return code, found


def _watched(work, told):
    out = os.open(told, os.O_WRONLY | os.O_CREAT | os.O_APPEND)

    def note(event, arguments):
        writes = event == "open" and isinstance(arguments[2], int) and arguments[2] & WRITES
        if writes or event in CHANGES | RUNS | REACHES:
            line = {"event": event, "what": [str(one) for one in arguments[:2]], "by": _modules()}
            os.write(out, (json.dumps(line) + "\n").encode())

    sys.addaudithook(note)  # of the forked process, which ends
    work()


def _modules():
    """Modules of ours on the stack, the nearest first."""
    frame, found = sys._getframe(2), []
    while frame is not None:
        path = Path(frame.f_code.co_filename)
        if path.is_relative_to(PACKAGE):
            name = frame.f_globals.get("__name__", "")
            if name not in found:
                found.append(name)
        frame = frame.f_back
    return found
