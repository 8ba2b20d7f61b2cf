"""Scan kernel: the two moves, factor, overshoot and stand from a supervisor."""

from __future__ import annotations

from lostmotion.arrays import Reals
from lostmotion.kernels.blocks.core import ENABLE, FACTOR, HOLD_ON_DISABLE
from lostmotion.kernels.blocks.supervised.supervisor import (
    KEEP,
    RUN,
    SET_FIRST,
    SET_SECOND,
    USE_FACTOR,
    USE_FIRST,
    USE_SECOND,
    supervise,
    tell,
)
from lostmotion.kernels.blocks.two_moves import OVERSHOOT, STAND
from lostmotion.kernels.blocks.two_moves import step as compensate
from lostmotion.kernels.numba_cache import njit


@njit()
def step(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """One scan: the block as it is, with what is in force in place of its settings."""
    s[SET_FIRST] = p[OVERSHOOT]
    s[SET_SECOND] = p[STAND]
    supervise(p, s, i, o)
    q = p.copy()
    j = i.copy()
    q[FACTOR] = s[USE_FACTOR]
    q[HOLD_ON_DISABLE] = s[KEEP]
    q[OVERSHOOT] = s[USE_FIRST]
    q[STAND] = s[USE_SECOND]
    j[ENABLE] = s[RUN]
    compensate(q, s, j, o)
    tell(p, s, i, o)


@njit()
def run(p: Reals, s: Reals, inputs: Reals, outputs: Reals) -> None:
    """All scans of `inputs` (n, n_inputs) into `outputs` (n, n_outputs)."""
    for k in range(inputs.shape[0]):
        step(p, s, inputs[k], outputs[k])
