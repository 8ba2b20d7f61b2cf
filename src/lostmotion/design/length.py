"""The shortest test that reaches what is wanted."""

from __future__ import annotations

import numpy as np

from lostmotion.design.staircase import Staircase
from lostmotion.design.task import MOST_HOLDS, Task

ROUNDS = 4
ROUND_SHARE = 0.5  # of the work of one search
MARGIN = 1.05  # samples more than the square law asks for
CLOSE = 0.93  # a test cut to less than this share of its length is worth another search


def shortest(task: Task, fewest: int, most: int) -> tuple[Staircase, bool]:
    """Shortest staircase between `fewest` and `most` samples that reaches the criterion, and whether one does.

    The interval narrows at least with the square root of time, so the first search tells about how long the test
    must be; the next ones are for that length. A test that reaches is cut where it does: a prefix never knows more.
    """
    samples = min(max(MOST_HOLDS * task.usual, fewest), most)
    reached: Staircase | None = None
    for _ in range(ROUNDS):
        stairs = task.best(samples, ROUND_SHARE)
        ratio = task.ratio(task.signal(stairs))
        if ratio <= 1.0:
            before = samples
            stairs = _cut(task, stairs, fewest)
            if reached is None or stairs.samples < reached.samples:
                reached = stairs
            samples = max(int(CLOSE * reached.samples), fewest)
            if reached.samples == fewest or samples > CLOSE * before:
                break
        elif reached is not None or samples == most:
            break
        else:
            samples = int(np.clip(MARGIN * samples * min(ratio, 1e3) ** 2, samples + 1, most))
    return (stairs, False) if reached is None else (reached, True)


def _cut(task: Task, stairs: Staircase, fewest: int) -> Staircase:
    """Shortest prefix that still reaches the criterion."""
    signal = task.signal(stairs)
    low, high = fewest - 1, signal.size
    while high - low > max(high // 200, 1):
        middle = (low + high) // 2
        if task.ratio(signal[:middle]) <= 1.0:
            high = middle
        else:
            low = middle
    return stairs.cut(high, task.limits.hold)
