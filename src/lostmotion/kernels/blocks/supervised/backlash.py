"""Scan kernel: inverse of a backlash, factor and both leads from a supervisor."""

from __future__ import annotations

from lostmotion.arrays import Reals
from lostmotion.kernels.blocks.backlash import LEAD_DOWN, LEAD_UP
from lostmotion.kernels.blocks.backlash import step as compensate
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
from lostmotion.kernels.numba_cache import njit


@njit()
def step(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """One scan: the block as it is, with what is in force in place of its settings."""
    s[SET_FIRST] = p[LEAD_UP]
    s[SET_SECOND] = p[LEAD_DOWN]
    supervise(p, s, i, o)
    q = p.copy()
    j = i.copy()
    q[FACTOR] = s[USE_FACTOR]
    q[HOLD_ON_DISABLE] = s[KEEP]
    q[LEAD_UP] = s[USE_FIRST]
    q[LEAD_DOWN] = s[USE_SECOND]
    j[ENABLE] = s[RUN]
    compensate(q, s, j, o)
    tell(p, s, i, o)


@njit()
def run(p: Reals, s: Reals, inputs: Reals, outputs: Reals) -> None:
    """All scans of `inputs` (n, n_inputs) into `outputs` (n, n_outputs)."""
    for k in range(inputs.shape[0]):
        step(p, s, inputs[k], outputs[k])
