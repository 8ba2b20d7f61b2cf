"""Signals of which all gradients of the prediction errors are lags, a block of samples at a time.

The rows of a block are (1/A)z, (1/A)x, (1/A)delta, (B/A)dx/deta of every eta, and v = y - offset - z
(``kernels.likelihood``); where the noise has a zero, delta / (1 - zero q^-1) stands for delta. Behind D the last one
is the prediction error. The columns before a block hold its past.
"""

from __future__ import annotations

from numba import njit

from lostmotion.arrays import FloatArray
from lostmotion.kernels.lanes import WIDTH, Quad, address, load, plus_product, spread, store, times
from lostmotion.kernels.likelihood import GONE

TILE = 4 * WIDTH  # samples at a time behind D
Z, X, H, ETA = 0, 1, 2, 3  # rows; v comes after the last eta


@njit(cache=True, nogil=True, fastmath={"contract"})
def _one_pole_filter(a: FloatArray, x: FloatArray, row: FloatArray, at: int) -> None:
    """Continue row[at..] = (1/A) x; up to four poles run in registers."""
    if a.size > 4:
        for k in range(x.size):
            value = x[k]
            for i in range(a.size):
                value -= a[i] * row[at + k - 1 - i]
            row[at + k] = value if abs(value) > GONE else 0.0
        return
    a1 = a[0] if a.size > 0 else 0.0
    a2 = a[1] if a.size > 1 else 0.0
    a3 = a[2] if a.size > 2 else 0.0
    a4 = a[3] if a.size > 3 else 0.0
    y1, y2, y3, y4 = row[at - 1], row[at - 2], row[at - 3], row[at - 4]
    if abs(y1) < GONE and abs(y2) < GONE and abs(y3) < GONE and abs(y4) < GONE:
        y1 = y2 = y3 = y4 = 0.0
    out = row[at:]
    for k in range(x.size):
        value = (x[k] - a4 * y4 - a3 * y3 - a2 * y2) - a1 * y1  # the newest last: it is the critical path
        y4, y3, y2, y1 = y3, y2, y1, value
        out[k] = value


@njit(cache=True, nogil=True, fastmath={"contract"})
def _two_pole_filters(
    a: FloatArray, x: FloatArray, row: FloatArray, other_x: FloatArray, other: FloatArray, at: int
) -> None:
    """The same for two signals at once: neither waits for the other."""
    if a.size > 3:
        _one_pole_filter(a, x, row, at)
        _one_pole_filter(a, other_x, other, at)
        return
    a1 = a[0] if a.size > 0 else 0.0
    a2 = a[1] if a.size > 1 else 0.0
    a3 = a[2] if a.size > 2 else 0.0
    y1, y2, y3 = row[at - 1], row[at - 2], row[at - 3]
    z1, z2, z3 = other[at - 1], other[at - 2], other[at - 3]
    if abs(y1) < GONE and abs(y2) < GONE and abs(y3) < GONE:
        y1 = y2 = y3 = 0.0
    if abs(z1) < GONE and abs(z2) < GONE and abs(z3) < GONE:
        z1 = z2 = z3 = 0.0
    out, other_out = row[at:], other[at:]
    for k in range(x.size):
        first = (x[k] - a3 * y3 - a2 * y2) - a1 * y1
        second = (other_x[k] - a3 * z3 - a2 * z2) - a1 * z1
        y3, y2, y1, z3, z2, z1 = y2, y1, first, z2, z1, second
        out[k], other_out[k] = first, second


@njit(cache=True, nogil=True, fastmath={"contract"})
def _add_taps(taps: FloatArray, row: FloatArray, at: int, out: FloatArray) -> None:
    """Add sum_i taps_i row[at + k - i] to `out`."""
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


@njit(cache=True, nogil=True)
def fill_errors(
    a: FloatArray,
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
    """Continue the rows `driven` = (1/A) x, `pulse` = (1/A) delta and `errors` = v; z is left in work[0]."""
    m = y.size
    z, drive = work[0, :m], work[1, :m]
    drive[:] = 0.0
    start = zero**k0 if k0 > 0 else 1.0
    for k in range(m):
        if start < GONE:
            break
        drive[k] = start
        start *= zero
    _two_pole_filters(a, x[begin + k0 : begin + k0 + m], driven, drive, pulse, at)
    z[:] = 0.0
    _add_taps(b, driven, at, z)
    _add_taps(c, pulse, at, z)
    v = errors[at : at + m]
    for k in range(m):
        v[k] = y[k] - offset - z[k]


@njit(cache=True, nogil=True, forceinline=True)
def _with_four(total: Quad, t0: Quad, t1: Quad, t2: Quad, t3: Quad, values: FloatArray, at: int) -> Quad:
    """`total` and the four taps of four samples, added in the order of ``_add_taps``."""
    early = plus_product(times(t1, load(values, at - 1)), t0, load(values, at))
    late = plus_product(plus_product(early, t2, load(values, at - 2)), t3, load(values, at - 3))
    return plus_product(total, spread(1.0), late)


@njit(cache=True, nogil=True)
def whiten(d: FloatArray, row: FloatArray, at: int, out: FloatArray) -> None:
    """Fill `out` (m,) with D row[at ..]; sixteen samples stay in registers, and only the last few go through memory."""
    taps, values, to = address(d), address(row), address(out)
    done = 0
    while done + TILE <= out.size:
        here = at + done
        s0, s1 = load(values, here), load(values, here + WIDTH)
        s2, s3 = load(values, here + 2 * WIDTH), load(values, here + 3 * WIDTH)
        i = 0
        while i + 4 <= d.size:
            t0, t1, t2, t3 = spread(taps[i]), spread(taps[i + 1]), spread(taps[i + 2]), spread(taps[i + 3])
            lagged = here - 1 - i
            s0 = _with_four(s0, t0, t1, t2, t3, values, lagged)
            s1 = _with_four(s1, t0, t1, t2, t3, values, lagged + WIDTH)
            s2 = _with_four(s2, t0, t1, t2, t3, values, lagged + 2 * WIDTH)
            s3 = _with_four(s3, t0, t1, t2, t3, values, lagged + 3 * WIDTH)
            i += 4
        while i < d.size:
            tap, lagged = spread(taps[i]), here - 1 - i
            s0, s1 = plus_product(s0, tap, load(values, lagged)), plus_product(s1, tap, load(values, lagged + WIDTH))
            s2 = plus_product(s2, tap, load(values, lagged + 2 * WIDTH))
            s3 = plus_product(s3, tap, load(values, lagged + 3 * WIDTH))
            i += 1
        store(to, done, s0)
        store(to, done + WIDTH, s1)
        store(to, done + 2 * WIDTH, s2)
        store(to, done + 3 * WIDTH, s3)
        done += TILE
    rest, source = out[done:], row[at + done :]
    for k in range(rest.size):
        rest[k] = source[k]
    _add_taps(d, row, at + done - 1, rest)


@njit(cache=True, nogil=True)
def _moved(b: FloatArray, dx: FloatArray, shapes: FloatArray, e: int, begin: int, k0: int, out: FloatArray) -> None:
    """Fill `out` with B dx/deta for samples k0 .. of a segment whose first input is at `begin`."""
    row = dx[e] if e < dx.shape[0] else shapes[e - dx.shape[0]]
    out[:] = 0.0
    for i in range(b.size):
        skipped = max(i - k0, 0)
        later, source, weight = out[skipped:], row[begin + k0 + skipped - i :], b[i]
        for k in range(later.size):
            later[k] += weight * source[k]


@njit(cache=True, nogil=True)
def fill_block(
    a: FloatArray,
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
    fill_errors(a, b, c, offset, k0, begin, x, y, raw[X], raw[H], raw[ETA + ne], at, work, zero)
    done = 0
    if ne > 0:
        _moved(b, dx, shapes, 0, begin, k0, drive)
        _two_pole_filters(a, z, raw[Z], drive, raw[ETA], at)
        done = 1
    else:
        _one_pole_filter(a, z, raw[Z], at)
    while done < ne:
        _moved(b, dx, shapes, done, begin, k0, drive)
        if done + 1 < ne:
            _moved(b, dx, shapes, done + 1, begin, k0, z)
            _two_pole_filters(a, drive, raw[ETA + done], z, raw[ETA + done + 1], at)
        else:
            _one_pole_filter(a, drive, raw[ETA + done], at)
        done += 2
    if d.size > 0:
        for row in range(ETA + ne + 1):
            if row == H and gone:
                white[row, at : at + m] = 0.0
                continue
            whiten(d, raw[row], at, white[row, at : at + m])
