"""Scan kernel: inverse of a dead zone, factor and both break points from a supervisor."""

from __future__ import annotations

from lostmotion.arrays import Reals
from lostmotion.kernels.blocks.core import ENABLE, FACTOR, HOLD_ON_DISABLE
from lostmotion.kernels.blocks.dead_zone import LEFT_BREAK, RIGHT_BREAK
from lostmotion.kernels.blocks.dead_zone import step as compensate
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
from lostmotion.kernels.numba_cache import njit


@njit()
def step(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """One scan: the block as it is, with what is in force in place of its settings."""
    s[SET_FIRST] = p[LEFT_BREAK]
    s[SET_SECOND] = p[RIGHT_BREAK]
    supervise(p, s, i, o)
    q = p.copy()
    j = i.copy()
    q[FACTOR] = s[USE_FACTOR]
    q[HOLD_ON_DISABLE] = s[KEEP]
    q[LEFT_BREAK] = s[USE_FIRST]
    q[RIGHT_BREAK] = s[USE_SECOND]
    j[ENABLE] = s[RUN]
    compensate(q, s, j, o)
    tell(p, s, i, o)


@njit()
def run(p: Reals, s: Reals, inputs: Reals, outputs: Reals) -> None:
    """All scans of `inputs` (n, n_inputs) into `outputs` (n, n_outputs)."""
    for k in range(inputs.shape[0]):
        step(p, s, inputs[k], outputs[k])
