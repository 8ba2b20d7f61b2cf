"""Processes that are killed while they write: at a moment, or at each call that the writer makes."""

import os
import signal
import sys
import time

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
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        _child(work, call, writing)
    os.close(writing)
    os.read(reading, 1)
    os.close(reading)
    if seconds is not None:
        time.sleep(seconds)
        os.kill(child, signal.SIGKILL)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _child(work, call, writing):
    code = 1
    try:
        os.write(writing, b"x")
        dies_at(call)
        work()
        code = 0
    except SystemExit as stop:
        code = int(stop.code or 0)
    except BaseException as error:  # noqa: BLE001  nothing may go on in two processes
        os.write(2, f"{type(error).__name__}: {error}\n".encode())
    finally:
        sys.setprofile(None)
        os._exit(code)
