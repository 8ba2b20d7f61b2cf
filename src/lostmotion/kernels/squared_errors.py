"""Sum of squared prediction errors (``kernels.likelihood``) without any gradient: a sixth of the normal equations.

A step that goes uphill needs no more. The errors come from the same functions, so the sums agree.
"""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.gradient_signals import BLOCK, TILE, block_at, fill_errors, keep_past, whiten
from lostmotion.kernels.no_literal import no_literal
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.pole_filters import answers_of


@njit(nogil=True)
def squared_errors(
    theta: FloatArray,
    na: int,
    nb: int,
    ne: int,
    p: int,
    delay: int,
    first: int,
    segments: IntArray,
    x: FloatArray,
    y: FloatArray,
    zero: float = 0.0,
    early: float = 0.0,
) -> float:
    """Sum of e squared over all segments, arguments as in ``normal_equations``."""
    nc, level = max(na, nb) + (zero > 0.0), na + nb + 1
    shared = level + 1 + ne
    a, b, d, offset = theta[:na], theta[na:level], theta[shared : shared + p], theta[level]
    history = max(na, nb + 1, p, 4) + 1
    raw, work, white = np.empty((3, history + BLOCK + TILE)), np.empty((2, BLOCK)), np.empty(BLOCK + TILE)
    answers, cost = answers_of(a), 0.0
    for s in range(segments.shape[0]):
        head, n, at = segments[s, 0] + first, segments[s, 1] - segments[s, 0] - first, shared + p + s * nc
        if n <= p:
            continue
        c = theta[at : at + nc]
        raw[:, :history] = 0.0
        k0 = no_literal(0)
        while k0 < n:
            m, skipped = block_at(k0, n, p), max(p - k0, 0)
            part = y[head + k0 : head + k0 + m]
            fill_errors(
                a, answers, b, c, offset, k0, head - delay, x, part, raw[0], raw[1], raw[2], history, work, zero
            )
            if m > skipped or (early > 0.0 and k0 == 0):
                whiten(d, raw[2], history, m, white, no_literal(0))
                if k0 == 0:
                    cost += early * np.dot(white[:skipped], white[:skipped])
                errors = white[skipped:m]
                cost += np.dot(errors, errors)
            if k0 + m < n:
                keep_past(raw, m, history)
            k0 += m
    return cost
