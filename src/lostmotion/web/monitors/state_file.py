"""The file of `--state` of a monitor: where it stands, and the widths of its periods; events are not in it."""

from __future__ import annotations

import os
from pathlib import Path

from lostmotion.errors import ParameterError
from lostmotion.files.limits import most_bytes
from lostmotion.online.packing import STATE, unpack
from lostmotion.web.monitors.loop_log import LoopLog

SAVED = 60.0  # s after which a monitor at work writes its state at the latest, where rows come


def is_state(path: Path) -> bool:
    """Whether it begins like one.

    Raises
    ------
    OSError
    """
    with path.open("rb") as file:
        return file.read(len(STATE)) == STATE.encode()


def state_log(path: Path, tag: str, facts: os.stat_result) -> LoopLog:
    """What a state says, as if its last report had just been heard.

    Raises
    ------
    OSError, LostMotionError
        It cannot be read, is too large, damaged or of another version.
    """
    if facts.st_size > most_bytes():
        raise ParameterError.expected("a state", f"{facts.st_size} bytes", "give the file of --state")
    _, blob = unpack(STATE, path.read_bytes())
    log = LoopLog(path.name, tag)
    log.silence.heard, log.silence.every = facts.st_mtime, SAVED
    if not blob:
        return log
    from lostmotion.online import OnlineMonitor, messages  # noqa: PLC0415  all estimators

    monitor = OnlineMonitor.from_bytes(blob)
    clock = monitor.timeline
    for time, value, weight in monitor.trend.to_dict()["points"]:
        half = 1.96 * weight**-0.5
        log.add(clock.text(clock.stamp(time)), value, max(value - half, 0.0), value + half)
    estimate = monitor.estimator.estimate if monitor.estimator.started else None
    report = messages.report(estimate, monitor.samples, clock)
    counts = {"samples": monitor.samples, **monitor.counts, **monitor.masks.counts}
    log.take_report({**report, "counts": counts})
    return log
