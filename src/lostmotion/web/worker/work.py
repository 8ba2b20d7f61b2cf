"""``python -m lostmotion.web.worker.work``: the worker of a page, with limits; tasks in and news out as lines of JSON.

A process of its own, because a file from outside may take all memory there is, or never end: it is killed then, and the
page goes on. Nothing but JSON passes between the two, so a reader gone wrong can make the page run nothing.
"""

from __future__ import annotations

import json
import os
import queue
import sys
import threading
from collections.abc import Mapping
from contextlib import suppress
from typing import IO, Any

from lostmotion.files.limits import most_bytes

ROOM = 2 << 30  # bytes that packages and compiled kernels reserve beside the data
NICER = 5  # than the page, which must answer meanwhile


def limit() -> None:
    """No more memory than a file may take, no core files, less right to the processor than the page has."""
    with suppress(OSError, AttributeError):
        os.nice(NICER)
    with suppress(ImportError, ValueError, OSError):
        import resource  # noqa: PLC0415  not on Windows

        most = most_bytes() + ROOM
        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        allowed = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(resource.RLIMIT_AS, (allowed, allowed))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def main() -> None:
    """Do one task after another, until the page ends."""
    out = os.fdopen(os.dup(1), "w", encoding="utf-8", errors="replace")
    os.dup2(2, 1)  # what others print is no news
    limit()
    waiting: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(sys.stdin, waiting), daemon=True).start()
    from lostmotion.web.worker.task import Task  # noqa: PLC0415
    from lostmotion.web.worker.tasks import do  # noqa: PLC0415  seconds, under the limits

    while True:
        data: Mapping[str, Any] = json.loads(waiting.get())
        task = Task(**{**data, "sources": tuple(data["sources"])})
        _say(out, {"phase": "reading", "share": 0.0, "said": ""})
        ended = do(task, lambda phase, share, said: _say(out, {"phase": phase, "share": share, "said": said}))
        _say(out, {"ended": True, **ended})


def _listen(stream: IO[str], waiting: queue.SimpleQueue[str]) -> None:
    """Tasks, until the page is gone: then this process is not needed, whatever it does."""
    for line in stream:
        waiting.put(line)
    os._exit(0)


def _say(out: IO[str], news: Mapping[str, Any]) -> None:
    print(json.dumps(news), file=out, flush=True)


if __name__ == "__main__":
    main()
