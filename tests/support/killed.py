"""Processes that are killed while they write: at a moment, or at each call that the writer makes."""

import gc
import os
import signal
import sys
import time
from pathlib import Path

from lostmotion.files import writer


def dies_at(call):
    """Kill this process just before the writer makes its call of that number; 0: never."""
    calls = 0

    def count(frame, event, _):
        nonlocal calls
        if event == "c_call" and frame.f_code.co_filename == writer.__file__:
            calls += 1
            if calls == call:
                os.kill(os.getpid(), signal.SIGKILL)

    sys.setprofile(count if call else None)


def forked(work, call=0, seconds=None):
    """Exit code of `work` in a process of its own, killed at a call, or `seconds` after it has begun; negative: killed.

    An exception in it gives 1 and is told on standard error; a SystemExit gives its own code.
    """
    child = begun(work, call)
    if seconds is not None:
        time.sleep(seconds)
        os.kill(child, signal.SIGKILL)
    return ended(child)


def begun(work, call=0, out=None, error=None):
    """Process that has begun to work; `out` and `error` are where its standard output and error go, -1: nowhere."""
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        os.close(reading)
        _child(work, call, writing, out, error)
    os.close(writing)
    os.read(reading, 1)
    os.close(reading)
    return child


def ended(child):
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def threads_of_polars():
    """A process with them hangs when it is forked."""
    names = [(task / "comm").read_text().strip() for task in Path("/proc/self/task").iterdir()]
    return [name for name in names if name.startswith("polars-") and name[7:].isdigit()]


def _child(work, call, writing, out, error):
    code = 1
    gc.disable()  # what is left of other tests may wait at its end for threads that are not here
    try:
        _stand_on(out, error)
        os.write(writing, b"x")
        dies_at(call)
        work()
        code = 0
    except SystemExit as stop:
        code = int(stop.code or 0)
    except BaseException as fault:  # noqa: BLE001  nothing may go on in two processes
        os.write(2, f"Traceback {type(fault).__name__}: {fault}\n".encode())
    finally:
        sys.setprofile(None)
        os._exit(_last(code) if out is not None else code)


def _stand_on(out, error):
    """Standard output and error anew, as Python has them at its start."""
    if error is not None:
        os.dup2(error, 2)
        sys.stderr = os.fdopen(2, "w", closefd=False, errors="backslashreplace")
    if out == -1:
        os.close(1)
        sys.stdout = None
    elif out is not None:
        os.dup2(out, 1)
        sys.stdout = os.fdopen(1, "w", closefd=False)


def _last(code):
    """Python writes what is left at its end, and complains where it cannot."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
        sys.stderr.flush()
    except OSError as error:
        os.write(2, f"Exception ignored {error}\n".encode())
        return 120
    return code
