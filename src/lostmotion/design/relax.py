"""Where the wanted interval is out of reach: what the limits cost, in figures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from lostmotion.design.design_wording import in_words
from lostmotion.design.operating_limits import EVERYTHING, Range
from lostmotion.design.simulated_plant import Plant
from lostmotion.design.staircase import Staircase
from lostmotion.design.task import Task

SHARE = 0.08  # of the work of a search, for each limit that is relaxed
WIDER = (1.5, 3.0, 10.0)  # times: the next is tried where one does not help
HELPS = 0.93  # a relaxed limit that narrows the interval to this share is worth a sentence
HELPS_MUCH = 0.2  # the same where nothing was wanted, and nothing could be told
HOPELESS = 100.0  # times too wide: no time makes up for that

Relaxation = Callable[[float], tuple[str, Task]]


def advice(task: Task, stairs: Staircase, better_known: Callable[[float], Task]) -> tuple[str, ...]:
    """Sentences on what would have to be relaxed, where `stairs` is the best and does not reach.

    `better_known` gives the same task with plausible plants so many times closer together.
    """
    said = _blind(task)
    ratio, dt = task.ratio(task.signal(stairs)), task.plants[0].model.linear.dt
    if task.plants[0].integrating and task.plants[0].controller is None:
        said.append(_LEVEL)
    if task.goal and ratio < HOPELESS:
        said.append(f"With these limits it would take about {in_words(stairs.samples * ratio**2 * dt)}.")
    for relaxation in [*_relaxations(task, dt), lambda times: (_ROUGH.format(times), better_known(times))]:
        sentence = _first_help(relaxation, stairs.samples, ratio)
        if sentence:
            said.append(sentence)
    return tuple(said or [_NOTHING])


_ROUGH = "With a model {:g} times better known (a shorter test within the limits first, then this again)"
_LEVEL = "An integrating process wanders off in open loop: make the test in closed loop, where the controller holds it."
_NOTHING = (
    "No single limit helps, even relaxed ten times: OP cannot pass the break points without some plausible plant "
    "breaking a limit. Relax several at once, or begin with a better model."
)


def _first_help(relaxation: Relaxation, samples: int, ratio: float) -> str | None:
    for times in WIDER:
        words, task = relaxation(times)
        reached = task.ratio(task.signal(task.best(samples, SHARE)))
        if not task.goal and reached < min(HELPS_MUCH * ratio, task.plants[0].zone.width):
            name = next(iter(task.criterion.wanted))
            return f"{words} the interval of the {name} would be about +-{reached:.2g}."
        if task.goal and reached <= 1.0:
            return f"{words} it would be reached in the same time."
        if task.goal and reached < HELPS * ratio and reached < HOPELESS:
            now = f"{ratio:.3g} times" if ratio < HOPELESS else "out of reach"
            return f"{words} the interval would be {reached:.3g} times the wanted one; now it is {now}."
    return None


def _blind(task: Task) -> list[str]:
    """Break points that OP cannot pass in every plausible plant."""
    if task.plants[0].controller is not None:
        return []
    low, high = task.limits.levels
    said = []
    for side, beyond, limit in (("right", _farthest(task.plants, "right"), high),
                                ("left", _farthest(task.plants, "left"), low)):  # fmt: skip
        given = getattr(task.plants[0].zone, side)
        if (beyond >= limit) if side == "right" else (beyond <= limit):
            said.append(
                f"OP may go to {limit:g} only, the {side} break point is at {given:g} (plausible as far as "
                f"{beyond:.3g}): the OP limits must reach clearly beyond it."
            )
    return said


def _farthest(plants: list[Plant], side: str) -> float:
    ends = [float(getattr(plant.zone, side)) for plant in plants]
    return max(ends) if side == "right" else min(ends)


def _relaxations(task: Task, dt: float) -> list[Relaxation]:
    """Limits relaxed one at a time, with the words for each."""
    limits, given = task.limits, task.plants[0]
    in_loop = given.controller is not None
    what = "SP" if in_loop else "OP"

    def other(words: str, **changes: Any) -> tuple[str, Task]:
        return words, replace(task, limits=replace(limits, **changes))

    def levels(times: float) -> tuple[str, Task]:
        wider = _about(limits.levels, limits.start, times)
        return other(f"With {what} limits {wider[0]:.4g} .. {wider[1]:.4g}", levels=wider)

    def pv(times: float) -> tuple[str, Task]:
        wider = _about(limits.pv, given.pv_now, times)
        return other(f"With PV limits {wider[0]:.4g} .. {wider[1]:.4g}", pv=wider)

    def op(times: float) -> tuple[str, Task]:
        wider = _about(limits.op, given.op_now, times)
        return other(f"With OP limits {wider[0]:.4g} .. {wider[1]:.4g}", op=wider)

    def hold(times: float) -> tuple[str, Task]:
        shorter = max(int(limits.hold / times), 1)
        return other(f"With holds from {shorter * dt:.3g} s on", hold=shorter)

    def rate(times: float) -> tuple[str, Task]:
        return other(f"With moves {times:g} times as fast", per_sample=times * limits.per_sample)

    return [
        levels,
        *([pv] if limits.pv != EVERYTHING else []),
        *([op] if limits.op != EVERYTHING else []),
        *([hold] if limits.hold > 1 else []),
        *([rate] if np.isfinite(limits.per_sample) else []),
    ]


def _about(limits: Range, centre: float, times: float) -> Range:
    low, high = (centre + times * (end - centre) for end in limits)
    return low, high
