"""What the historian has of a loop."""

from __future__ import annotations

import numpy as np

import lostmotion as lm
from block_trials.closed_loop import SETTLING, simulated
from block_trials.draw import Loop
from block_trials.signals import in_operation
from block_trials.valves import Array

SEED = 1000  # of the run that is recorded
DIGITS, DIGITS_OF_SET_POINT = 8, 10  # of the numbers in the file


def recorded(loop: Loop) -> lm.LoopRecord:
    """OP, PV and set point, as a reader would give them from a file of text."""
    run = simulated(loop, in_operation(loop, loop.rows + SETTLING, SEED)).after(SETTLING)
    op, pv, instrument = run.op, run.pv, loop.instrument
    if instrument.rounds:
        op = np.round(op / instrument.op_step) * instrument.op_step
        pv = np.round(pv / instrument.pv_step) * instrument.pv_step
    set_point = written(run.set_point, DIGITS_OF_SET_POINT)
    tag = f"{loop.kind} {loop.seed}"
    return lm.LoopRecord(written(op, DIGITS), written(pv, DIGITS), set_point, dt=loop.seconds, tag=tag)


def written(values: Array, digits: int) -> Array:
    """To so many significant digits."""
    return np.array([float(f"{value:.{digits}g}") for value in values])
