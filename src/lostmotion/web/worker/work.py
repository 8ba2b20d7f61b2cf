"""``python -m lostmotion.web.worker.work``: the worker of a page, with limits; tasks in and news out as JSON.

A process of its own, because a file from outside may take all memory there is, or never end: it is killed then, and the
page goes on. Nothing but JSON passes between the two, so a reader gone wrong can make the page run nothing.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from lostmotion.files.limits import most_bytes
from lostmotion.workers.child import Channel
from lostmotion.workers.limits import limit

ROOM = 2 << 30  # bytes that packages and compiled kernels reserve beside the data
NICER = 5  # than the page, which must answer meanwhile


def main() -> None:
    """Do one task after another, until the page ends."""
    limit(most_bytes() + ROOM, NICER)
    channel = Channel()
    from lostmotion.web.worker.task import Task  # noqa: PLC0415
    from lostmotion.web.worker.tasks import do  # noqa: PLC0415  seconds, under the limits

    def say(**news: Any) -> None:
        channel.send(json.dumps(news).encode())

    while True:
        data: Mapping[str, Any] = json.loads(channel.receive())
        task = Task(**{**data, "sources": tuple(data["sources"])})
        say(phase="reading", share=0.0, said="")
        ended = do(task, lambda phase, share, said: say(phase=phase, share=share, said=said))
        say(**{"ended": True, **ended})


if __name__ == "__main__":
    main()
