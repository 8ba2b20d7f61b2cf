"""What workers of these tests do."""

import os
import signal
import sys
import time
from pathlib import Path


class TwoArgumentsError(Exception):
    """Cannot be sent as it is."""

    def __init__(self, one, two):
        super().__init__(f"{one} and {two}")


def do(what):
    if what == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    if what == "leave":
        os._exit(3)
    if what == "sleep":
        time.sleep(60)
    if what == "raise":
        raise ValueError("in\nthe work")
    if what == "odd":
        raise TwoArgumentsError(1, 2)
    if what == "unsendable":
        return lambda: None
    if what == "print":
        sys.stdout.write("not a message\n")
        sys.stdout.flush()
        os.write(1, b"nor this\n")
    if what == "memory":
        return len(bytearray(1 << 30))
    return what, os.getpid()


def told(_):
    return {
        "folder": str(Path.cwd()), "files": [one.name for one in Path.cwd().iterdir()], "path": sys.path,
        "safe": sys.flags.safe_path, "environment": os.environ.get("PYTHONSAFEPATH"),
        "threads": os.environ.get("OMP_NUM_THREADS"),
    }  # fmt: skip


def with_common(common, item):
    return common, item, os.getpid()
