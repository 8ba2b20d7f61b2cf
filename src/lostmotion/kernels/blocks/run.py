"""Any compensating block by number: one scan, and all scans of a record."""

from __future__ import annotations

from lostmotion.arrays import Reals
from lostmotion.kernels.blocks import backlash, dead_zone, knocker, two_moves
from lostmotion.kernels.numba_cache import njit

DEAD_ZONE, BACKLASH, KNOCKER, TWO_MOVES = 1, 2, 3, 4


@njit()
def step(kind: int, p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """One scan of a block."""
    if kind == DEAD_ZONE:
        dead_zone.step(p, s, i, o)
    elif kind == BACKLASH:
        backlash.step(p, s, i, o)
    elif kind == KNOCKER:
        knocker.step(p, s, i, o)
    else:
        two_moves.step(p, s, i, o)


@njit()
def run(kind: int, p: Reals, s: Reals, inputs: Reals, outputs: Reals) -> None:
    """All scans of `inputs` (n, INPUTS) into `outputs` (n, OUTPUTS)."""
    for k in range(inputs.shape[0]):
        step(kind, p, s, inputs[k], outputs[k])
