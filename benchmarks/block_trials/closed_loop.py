"""A PI controller, with or without a block behind it, holds a process through a valve."""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

import numpy as np

from block_trials.draw import Loop
from block_trials.process import nothing_on_its_way, through_a_row
from block_trials.signals import Signals
from block_trials.valves import FULL_STROKE, STEM, TRAVEL, Array, Valve, valve_at_rest

SETTLING = 200  # rows before those that count
OF_PV = 3  # signals of a run that are in units of PV
CARRIED_OUT = 1e-9  # %: less between OP and what the block put out of it is rounding


class Block(Protocol):
    """What is asked of a block."""

    last: dict[str, float]  # "back": the OP that belongs to the command

    def step(self, op: float) -> float: ...

    def reset(self) -> None: ...


class Run(NamedTuple):
    """Signals, a value a row, in units of PV and %."""

    set_point: Array
    pv: Array
    true_pv: Array  # without noise
    op: Array
    command: Array  # behind the block
    stem: Array
    travel: Array  # of the stem within the row

    def after(self, rows: int) -> Run:
        """Without the first rows."""
        return Run(*(signal[rows:] for signal in self))


def simulated(loop: Loop, signals: Signals, block: Block | None = None, valve: Valve | None = None) -> Run:
    """The loop with its own valve or another one; the block is on from the first row."""
    valve, controller, steps = valve or loop.valve, loop.controller, loop.fine_steps
    state, lags, delayed = valve_at_rest(valve), np.zeros(2), nothing_on_its_way(loop.process, steps)
    made = np.empty((signals.noise.size, len(Run._fields)))
    reset_gain = controller.gain / controller.reset
    integral, pv = valve.rest, 0.0
    if block is not None:
        block.reset()
    for row, (set_point, load, noise) in enumerate(zip(*signals, strict=True)):
        error = set_point - (pv + noise)
        wanted = integral + controller.gain * error + reset_gain * error
        op = min(FULL_STROKE, max(0.0, wanted))
        command, carried_out = _through(block, op)
        integral += reset_gain * error
        if op != wanted or abs(carried_out - op) > CARRIED_OUT:
            integral += carried_out - wanted  # back calculation
        state[TRAVEL], before = 0.0, pv
        pv = through_a_row(valve, loop.process, state, lags, delayed, row, steps, command, load)
        made[row] = set_point, before + noise, before, op, command, state[STEM], state[TRAVEL]
    made[:, :OF_PV] += loop.pv_rest
    return Run(*np.ascontiguousarray(made.T))


def _through(block: Block | None, op: float) -> tuple[float, float]:
    """Command, and the OP that belongs to it."""
    if block is None:
        return op, op
    command = block.step(op)
    back = block.last["back"]
    return command, back if math.isfinite(back) else op
