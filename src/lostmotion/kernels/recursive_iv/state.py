"""Where the recursive instrumental-variable estimator keeps its state: one array of floats, one of whole numbers.

Rows are padded with zeros to whole panels of three quads (:mod:`lostmotion.kernels.lanes`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.lanes import WIDTH

LEAST_SQUARES = 0
MODEL_OUTPUT = 1
PRINTED = 2
PANEL = 3 * WIDTH

# floats with a fixed place
KNOWN_GAIN, FORGETTING, CONSTANT_FORGETTING, CONSTANT_FOR, START = range(5)  # known gain nan: right slope 1
LOW, HIGH = 5, 6  # range of u seen
ZONE = 7  # left, right, left slope, right slope
TOTAL, TOTAL_SQUARED = 11, 12  # lambda-weighted number of samples in P; with squared weights
SEEN, SEEN_SQUARED = 13, 14  # the same since the instruments are used
SQUARES = 15  # squared misses of the output, sum with squared weights
PRESENT, EQUATION = 16, 17  # means over a shorter memory: squared miss of the output, squared prediction error
SINCE, DENSE = 18, 19  # weight that S and W have lost since a sample was added; weighted number that ends every one
GAP = 20  # step of which all moves of u are multiples; 0: none yet
HEAD = 24

# whole numbers
NA, NB, DELAY, NE, N, PAD, KIND, CONSTRAINED = range(8)
COUNT, NOW_U, NOW_Z = range(8, 11)  # samples seen; newest places in the rings of u and z
PAST_U = 11  # size of the ring of u
THETA, HELD, PHI, OUTPUTS, STEP, ROW, WORK, SLOPES, Z, P, S, W, U = range(12, 25)  # offsets of what is not fixed
EARLIER = 25  # theta after the last two powers of 2 of samples, older first
ENTRIES = 26
FIRST_ENTRIES = 25  # before there was EARLIER
MOVING = (COUNT, NOW_U, NOW_Z)


class Places(NamedTuple):
    """Orders and method: all that the sizes depend on."""

    na: int
    nb: int
    delay: int
    past_residuals: int
    kind: int
    constrained: bool


def lay_out(orders: Places) -> tuple[FloatArray, IntArray]:
    """Zeroed state and its layout for these orders."""
    na, nb, delay, ne, kind, constrained = orders
    n = na + nb + 4 + ne
    pad = -(-n // PANEL) * PANEL
    past_u = delay + (n - na if kind == PRINTED else nb + 1)  # the printed instrument is filled up with older inputs
    layout = np.zeros(ENTRIES, dtype=np.int64)
    layout[:COUNT] = na, nb, delay, ne, n, pad, kind, constrained
    layout[PAST_U] = past_u
    sizes = {
        THETA: pad,
        HELD: pad,
        PHI: pad,
        OUTPUTS: -(-na // WIDTH) * WIDTH,
        STEP: pad,
        ROW: pad,
        WORK: pad,
        SLOPES: WIDTH,
        Z: (na + 1) * pad,
        P: n * pad,
        S: n * pad,
        W: n * WIDTH,
        U: past_u,
        EARLIER: 2 * pad,
    }
    end = HEAD
    for name, size in sizes.items():
        layout[name] = end
        end += size
    return aligned(end), layout


def aligned(size: int) -> FloatArray:
    """Zeros that begin where a cache line does: no quad of the state crosses two."""
    room = np.zeros(size + 7)
    first = (-room.ctypes.data // 8) % 8
    return room[first : first + size]


def named(state: FloatArray, layout: IntArray) -> dict[str, FloatArray]:
    """Views of the parts by name, without padding."""
    na, nb, _delay, _ne, n, pad = (int(value) for value in layout[:KIND])

    def part(name: int, size: int) -> FloatArray:
        return state[layout[name] : layout[name] + size]

    return {
        "theta": part(THETA, n),
        "held": part(HELD, n),
        "p": part(P, n * pad).reshape(n, pad)[:, :n],
        "zone": state[ZONE : ZONE + 4],
        "span": state[LOW : HIGH + 1],
        "past_x": state[layout[PHI] + na + 4 : layout[PHI] + na + 4 + nb],
        "past_outputs": part(OUTPUTS, na),
        "spread": part(S, n * pad).reshape(n, pad)[:, :n],
        "earlier": part(EARLIER, 2 * pad).reshape(2, pad)[:, :n],
        "rebuilt": part(W, n * WIDTH).reshape(n, WIDTH),
        "sums": state[TOTAL:DENSE],
    }
