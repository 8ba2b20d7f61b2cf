"""Signals of which all gradients of the prediction errors are lags, a block of samples at a time.

The rows of a block are (1/A)z, (1/A)x, (1/A)delta, (B/A)dx/deta of every eta, and v = y - offset - z
(``kernels.likelihood``); where the noise has a zero, delta / (1 - zero q^-1) stands for delta. Behind D the last one
is the prediction error. The columns before a block hold its past.
"""

from __future__ import annotations

from lostmotion.arrays import FloatArray
from lostmotion.kernels.lanes import (
    WIDEST,
    Quad,
    address,
    load_widest,
    plus_product,
    spread_widest,
    store,
    times,
    widest,
)
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.pole_filters import GONE, pole_filter

BLOCK = 512  # samples: a dozen signals of this length stay in the fastest memory
TILE = 4 * WIDEST  # samples at a time behind D; as many columns are behind a block
DEAD = 1e-30  # an initial state that has decayed to this share tells nothing more
Z, X, H, ETA = 0, 1, 2, 3  # rows; v comes after the last eta


@njit(nogil=True, forceinline=True)
def block_at(k0: int, n: int, p: int) -> int:
    """How many of n samples are in the block that begins with k0; the first is shorter, that p of it may be skipped."""
    return min(BLOCK if k0 > 0 else BLOCK - WIDEST + p % WIDEST, n - k0)


@njit(nogil=True)
def keep_past(rows: FloatArray, m: int, history: int) -> None:
    """Move what is behind a block of m samples in front of it."""
    for row in range(rows.shape[0]):
        for k in range(history):
            rows[row, k] = rows[row, m + k]


@njit(nogil=True)
def is_quiet(values: FloatArray) -> bool:
    """Whether what has decayed tells nothing more."""
    loudest = 0.0
    for value in values:
        loudest = max(loudest, abs(value))
    return loudest < DEAD


@njit(nogil=True, fastmath={"contract"})
def _add_taps(taps: FloatArray, row: FloatArray, at: int, out: FloatArray) -> None:
    """Add sum_i taps_i row[at + k - i] to `out`."""
    widest()
    done, n = 0, out.size
    while done + 4 <= taps.size:  # four at a time: fewer passes over memory
        t0, t1, t2, t3 = taps[done], taps[done + 1], taps[done + 2], taps[done + 3]
        r0, r1, r2, r3 = row[at - done :], row[at - done - 1 :], row[at - done - 2 :], row[at - done - 3 :]
        for k in range(n):
            out[k] += t0 * r0[k] + t1 * r1[k] + t2 * r2[k] + t3 * r3[k]
        done += 4
    for i in range(done, taps.size):
        tap, lagged = taps[i], row[at - i :]
        for k in range(n):
            out[k] += tap * lagged[k]


@njit(nogil=True)
def fill_errors(
    a: FloatArray,
    answers: FloatArray,
    b: FloatArray,
    c: FloatArray,
    offset: float,
    k0: int,
    begin: int,
    x: FloatArray,
    y: FloatArray,
    driven: FloatArray,
    pulse: FloatArray,
    errors: FloatArray,
    at: int,
    work: FloatArray,
    zero: float,
) -> None:
    """Continue the rows `driven` = (1/A) x, `pulse` = (1/A) delta and `errors` = v; z is left in work[0].

    `answers` are those of A to samples (``pole_filters``).
    """
    m = y.size
    z, drive = work[0, :m], work[1, :m]
    pole_filter(a, answers, x[begin + k0 : begin + k0 + m], driven, at)
    z[:] = 0.0
    _add_taps(b, driven, at, z)
    start = zero**k0 if k0 > 0 else 1.0
    if start < DEAD and is_quiet(pulse[:at]):
        pulse[at : at + m] = 0.0
    else:
        drive[:] = 0.0
        for k in range(m):
            if start < GONE:
                break
            drive[k] = start
            start *= zero
        pole_filter(a, answers, drive, pulse, at)
        _add_taps(c, pulse, at, z)
    v = errors[at : at + m]
    for k in range(m):
        v[k] = y[k] - offset - z[k]


@njit(nogil=True, forceinline=True)
def _with_four(total: Quad, t0: Quad, t1: Quad, t2: Quad, t3: Quad, values: FloatArray, at: int) -> Quad:
    """`total` and the four taps of as many samples as a register holds, added in the order of ``_add_taps``."""
    early = plus_product(times(t1, load_widest(values, at - 1)), t0, load_widest(values, at))
    late = plus_product(plus_product(early, t2, load_widest(values, at - 2)), t3, load_widest(values, at - 3))
    return plus_product(total, spread_widest(1.0), late)


@njit(nogil=True)
def whiten(d: FloatArray, row: FloatArray, at: int, m: int, out: FloatArray, to: int) -> None:
    """Fill `out` from `to` on with D row[at ..], for m samples; up to TILE - 1 more are read and overwritten.

    A tile stays in registers.
    """
    taps, values, there = address(d), address(row), address(out)
    for done in range(0, m, TILE):
        here = at + done
        s0, s1 = load_widest(values, here), load_widest(values, here + WIDEST)
        s2, s3 = load_widest(values, here + 2 * WIDEST), load_widest(values, here + 3 * WIDEST)
        i = 0
        while i + 4 <= d.size:
            t0, t1 = spread_widest(taps[i]), spread_widest(taps[i + 1])
            t2, t3 = spread_widest(taps[i + 2]), spread_widest(taps[i + 3])
            lagged = here - 1 - i
            s0 = _with_four(s0, t0, t1, t2, t3, values, lagged)
            s1 = _with_four(s1, t0, t1, t2, t3, values, lagged + WIDEST)
            s2 = _with_four(s2, t0, t1, t2, t3, values, lagged + 2 * WIDEST)
            s3 = _with_four(s3, t0, t1, t2, t3, values, lagged + 3 * WIDEST)
            i += 4
        while i < d.size:
            tap, lagged = spread_widest(taps[i]), here - 1 - i
            s0 = plus_product(s0, tap, load_widest(values, lagged))
            s1 = plus_product(s1, tap, load_widest(values, lagged + WIDEST))
            s2 = plus_product(s2, tap, load_widest(values, lagged + 2 * WIDEST))
            s3 = plus_product(s3, tap, load_widest(values, lagged + 3 * WIDEST))
            i += 1
        begin = to + done
        store(there, begin, s0)
        store(there, begin + WIDEST, s1)
        store(there, begin + 2 * WIDEST, s2)
        store(there, begin + 3 * WIDEST, s3)


@njit(nogil=True)
def _moved(b: FloatArray, dx: FloatArray, shapes: FloatArray, e: int, begin: int, k0: int, out: FloatArray) -> None:
    """Fill `out` with B dx/deta for samples k0 .. of a segment whose first input is at `begin`."""
    widest()
    row = dx[e] if e < dx.shape[0] else shapes[e - dx.shape[0]]
    out[:] = 0.0
    for i in range(b.size):
        skipped = max(i - k0, 0)
        later, source, weight = out[skipped:], row[begin + k0 + skipped - i :], b[i]
        for k in range(later.size):
            later[k] += weight * source[k]


@njit(nogil=True, inline="always")
def fill_block(
    a: FloatArray,
    answers: FloatArray,
    b: FloatArray,
    c: FloatArray,
    d: FloatArray,
    offset: float,
    k0: int,
    begin: int,
    x: FloatArray,
    dx: FloatArray,
    shapes: FloatArray,
    y: FloatArray,
    raw: FloatArray,
    white: FloatArray,
    at: int,
    work: FloatArray,
    zero: float,
    gone: bool,
) -> None:
    """Next samples of all signals, from column `at` on, as many as `y` has; the past is in the columns before.

    `raw` are the signals before D, `white` behind it; without D they are one array. `gone`: (1/A)delta has decayed, and
    stays what it was behind D.
    """
    m, ne = y.size, dx.shape[0] + shapes.shape[0]
    z, drive = work[0, :m], work[1, :m]
    fill_errors(a, answers, b, c, offset, k0, begin, x, y, raw[X], raw[H], raw[ETA + ne], at, work, zero)
    pole_filter(a, answers, z, raw[Z], at)
    for e in range(ne):
        _moved(b, dx, shapes, e, begin, k0, drive)
        pole_filter(a, answers, drive, raw[ETA + e], at)
    if d.size > 0:
        for row in range(ETA + ne + 1):
            if row == H and gone:
                white[row, at : at + m] = 0.0
                continue
            whiten(d, raw[row], at, m, white[row], at)
