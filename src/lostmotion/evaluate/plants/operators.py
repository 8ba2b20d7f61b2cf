"""What operators do: set points, spells in manual with moves of the valve, loops that are never in automatic."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.evaluate.plants.made_loop import MadeLoop
from lostmotion.kernels import coupled_loops as kernel

MOVING = 0.35  # of the loops get new set points, where the number of moves is not given
MOVES_PER_DAY = (1.0, 12.0)
VARIED = (0.5, 1.5)  # times the number of moves that is given: no two loops get as many
MOVE = {"flow": 4.0, "pressure": 2.0, "level": 5.0, "temperature": 1.5}  # % of span, standard deviation
LARGER = 1.5  # times that in a plant in operation: grades and loads change
SPELLS = 0.12  # of the loops are in manual for a while
SPELL = (900.0, 14_400.0)  # seconds
ALWAYS = 0.04  # are in manual all the time
HANDS_EVERY = 1800.0  # seconds between moves of an operator in manual
RAMP = 0.3  # of the moves are ramps
RAMP_STEPS, RAMP_EVERY = 20, 15.0  # of 15 s each


def events(
    rng: np.random.Generator,
    number: int,
    loop: MadeLoop,
    seconds: float,
    dt: float,
    busy: bool,
    moves: float | None = None,
) -> list[tuple[float, ...]]:
    """Rows (row, loop, code, value) of one loop.

    Parameters
    ----------
    rng : Generator
    number : int
    loop : MadeLoop
        The slave of a cascade has its set points from its master.
    seconds, dt : float
    busy : bool
        A fault there is to be seen, so it stays in automatic.
    moves : float, optional
        Set points a day, about. None: most loops get none.
    """
    found: list[tuple[float, float, float]] = []
    if loop.master < 0 and moves is not None:
        found += _set_points(rng, loop, seconds, moves * rng.uniform(*VARIED), LARGER)
    elif loop.master < 0 and rng.random() < MOVING:
        found += _set_points(rng, loop, seconds, rng.uniform(*MOVES_PER_DAY), 1.0)
    always, sometimes = rng.random() < ALWAYS, rng.random() < SPELLS
    if always and not busy:
        found += _spell(rng, loop, 0.0, seconds)
    elif sometimes and not busy:
        length = min(float(np.exp(rng.uniform(*np.log(SPELL)))), 0.4 * seconds)
        found += _spell(rng, loop, float(rng.uniform(0.0, seconds - length)), length)
    return [(round(when / dt), number, code, value) for when, code, value in found]


def table(rows: Sequence[tuple[float, ...]]) -> FloatArray:
    """Events in the order in which they come, shape (e, 4)."""
    return np.array(sorted(rows), dtype=np.float64).reshape(-1, 4)


def _set_points(
    rng: np.random.Generator, loop: MadeLoop, seconds: float, per_day: float, larger: float
) -> list[tuple[float, float, float]]:
    """Moves about where it is at home: it is brought back, as shifts do."""
    times = np.sort(rng.uniform(0.0, seconds, size=rng.poisson(per_day * seconds / 86_400.0)))
    found: list[tuple[float, float, float]] = []
    there = loop.pv_rest
    for when in times.tolist():
        goal = float(np.clip(loop.pv_rest + rng.normal(scale=larger * MOVE[loop.loop_type]), 10.0, 90.0))
        steps = RAMP_STEPS if rng.random() < RAMP else 1
        found += [
            (when + k * RAMP_EVERY, kernel.SET_SP, there + (goal - there) * (k + 1) / steps) for k in range(steps)
        ]
        there = goal
    return found


def _spell(rng: np.random.Generator, loop: MadeLoop, begin: float, length: float) -> list[tuple[float, float, float]]:
    """In manual, with a move of the valve now and then near where it works; then back to what it was."""
    times = np.sort(rng.uniform(begin, begin + length, size=rng.poisson(length / HANDS_EVERY)))
    hands: list[tuple[float, float, float]] = [
        (when, kernel.SET_OP, loop.op_rest + float(rng.normal(scale=0.8))) for when in times.tolist()
    ]
    back = kernel.CASCADE if loop.master >= 0 else kernel.AUTO
    ends = [(begin, kernel.SET_MODE, float(kernel.MANUAL)), (begin + length, kernel.SET_MODE, float(back))]
    return [ends[0], *hands, ends[1]]
