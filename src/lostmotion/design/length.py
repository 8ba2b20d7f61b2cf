"""The shortest test that reaches what is wanted."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from lostmotion.design.staircase import Staircase
from lostmotion.design.task import MOST_HOLDS, Task

ROUNDS = 6  # lengths tried, each for half the work of a search: one or two to reach, the rest to halve the gap
ROUND_SHARE = 0.5  # of the work of one search
MARGIN = 1.05  # samples more than the square law asks for
SHORTEST = 0.5  # of a length that reaches: a shorter one is not tried at once
CLOSE = 0.93  # a test this near to one that is too short is short enough


def shortest(task: Task, fewest: int, most: int, said: Callable[[str], None]) -> tuple[Staircase, bool]:
    """Shortest staircase between `fewest` and `most` samples that reaches the criterion, and whether one does.

    The interval narrows at least with the square root of time, so the first search tells about how long the test
    must be. Once a test reaches, lengths between it and the longest that failed are tried. `said` hears of progress.
    """
    samples = min(max(MOST_HOLDS * task.usual, fewest), most)
    failed = fewest - 1
    reached: Staircase | None = None
    for _ in range(ROUNDS):
        said(f"trying a test of {samples * task.plants[0].model.linear.dt:g} s")
        stairs = task.best(samples, ROUND_SHARE)
        ratio = task.ratio(task.signal(stairs))
        if ratio <= 1.0:
            reached = _cut(task, stairs, fewest)
        else:
            failed = samples
        if reached is None:
            if samples == most:
                break
            samples = int(np.clip(MARGIN * samples * min(ratio, 1e3) ** 2, samples + 1, most))
        elif failed > CLOSE * reached.samples or reached.samples <= fewest:
            break
        else:
            samples = max(int(np.sqrt(failed * reached.samples)), int(SHORTEST * reached.samples), fewest)
    return (stairs, False) if reached is None else (reached, True)


def _cut(task: Task, stairs: Staircase, fewest: int) -> Staircase:
    """Shortest prefix that still reaches the criterion and ends with a whole hold."""
    low, high = fewest - 1, stairs.samples
    while high - low > max(high // 200, 1):
        middle = (low + high) // 2
        if task.ratio(task.signal(stairs.until(middle, task.limits.hold))) <= 1.0:
            high = middle
        else:
            low = middle
    return stairs.until(high, task.limits.hold)
