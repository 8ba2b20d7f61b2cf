"""Recursive maximum likelihood of a dead zone, a linear process and AR noise, in information form.

Every sample gives a prediction error e and its gradient psi = -de/dtheta by the recursions of
:mod:`lostmotion.kernels.likelihood`; their products are summed over a block. At the end of a block the normal
equations of everything remembered are solved: a Gauss-Newton step (Ljung and Soderstrom, *Theory and Practice of
Recursive Identification*, section 3.7, with information instead of covariance matrices).

What is remembered: `reference`, a sum over old blocks, and a ring of the newest blocks, which carry full weight.
A block that leaves the ring enters the reference, which forgets, direction by direction, as much as comes in and
no more: without excitation nothing is lost. Linearised equations are kept about the origin of theta, so they add.

Order of theta: a (na), b (nb+1), offset, left, right, log_ratio, d (p). Right slope 1.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.linear import is_stable

# `layout`: sizes, offsets into `state`, counters
NA, NB1, DELAY, P, N, BLOCK, RING, FILTERS = range(8)
THETA, SHOWN, FILTER, REF_H, REF_R, SUM_H, SUM_G, RING_H, RING_R, RING_F, U, Y, USED = range(8, 21)
TOTAL_H, TOTAL_R, ROOT, PERIOD_H, PERIOD_R, WORK, SIZE = range(21, 28)
COUNT, FILLED, BLOCKS, SETTLE, WAIT, LOST, SINCE, LEFT_AT, RIGHT_AT, CLIPPED, MISSING, MASKED = range(28, 40)
PERIOD_FROM, WINDOW, REFIT_AT, TEST_AFTER, FROM_BLOCK, EXPLAIN_AT, RING_S, INVERSE, LAYOUT_SIZE = range(40, 49)

# head of `state`
TAIL, KEEP, CLIP, THRESHOLD, SQUARES, WEIGHT, LOW, HIGH, HELD, ZERO, RATIO_LIMIT, STATISTIC, HEAD = range(13)

LEFT, RIGHT, GAIN = range(3)  # directions that are tested for a change
NOTHING, ALARMED, REFIT = range(3)  # why `run` came back
RIDGE = 1e-11  # relative information put into every direction, about the present estimate
SURE = 1e9  # times the information about an offset that is known to be zero
SMALLEST = 1e-200  # information below this is none: filters fade to denormal numbers
UNKNOWN = -1  # in place of the samples to wait: the command is not known yet
HALVINGS = 20
RADIUS = 1.0 - 1e-7
CALMER, CALM_STEPS = 0.9, 80
ENOUGH = 4  # blocks of an alarm that are fitted again at least
HOLD = 2  # missing commands between two equal ones that count as these, without waiting for the process to settle
SETTLED = 1e-3  # what is left of an unknown state when it no longer matters
LONGEST_SETTLING = 5000


@njit(cache=True, nogil=True)
def advance(
    u: float, y: float, theta: FloatArray, filters: FloatArray, na: int, nb1: int, delay: int, p: int, psi: FloatArray
) -> float:
    """One sample through all filters; fill `psi` (n,), return the prediction error (NaN without y).

    `filters`: newest first, u (delay+1), X = (1/A) x (nx), (1/A) dx/deta (3 nx), W = -(1/A) z (na), v (p), D X (nb1),
    D W (na), then the last p of X, W and the three E = (B/A) dx/deta.
    """
    nx = max(na, nb1)
    at_x = delay + 1
    at_v = at_x + nx
    at_w = at_v + 3 * nx
    at_r = at_w + na
    at_xd = at_r + p
    at_wd = at_xd + nb1
    at_p = at_wd + na
    eta = na + nb1 + 1
    for i in range(delay, 0, -1):
        filters[i] = filters[i - 1]
    filters[0] = u
    delayed = filters[delay]
    ratio = np.exp(theta[eta + 2])
    x, x_left, x_right, x_ratio = 0.0, 0.0, 0.0, 0.0
    if delayed > theta[eta + 1]:
        x, x_right = delayed - theta[eta + 1], -1.0
    elif delayed < theta[eta]:
        x, x_left = ratio * (delayed - theta[eta]), -ratio
        x_ratio = x
    v1, v2 = at_v + nx, at_v + 2 * nx
    for i in range(na):
        a = theta[i]
        x -= a * filters[at_x + i]
        x_left -= a * filters[at_v + i]
        x_right -= a * filters[v1 + i]
        x_ratio -= a * filters[v2 + i]
    for i in range(4 * nx - 1, 0, -1):  # the four stretches lie one behind the other; their heads are overwritten
        filters[at_x + i] = filters[at_x + i - 1]
    filters[at_x], filters[at_v], filters[v1], filters[v2] = x, x_left, x_right, x_ratio
    z, e_left, e_right, e_ratio = 0.0, 0.0, 0.0, 0.0
    for i in range(nb1):
        b = theta[na + i]
        z += b * filters[at_x + i]
        e_left += b * filters[at_v + i]
        e_right += b * filters[v1 + i]
        e_ratio += b * filters[v2 + i]
    w = -z
    for i in range(na):
        psi[i] = filters[at_wd + i]
        w -= theta[i] * filters[at_w + i]
    v = y - theta[na + nb1] - z
    error = v
    x_d, w_d, d_sum = x, w, 1.0
    for j in range(p):
        d = theta[eta + 3 + j]
        error += d * filters[at_r + j]
        psi[eta + 3 + j] = -filters[at_r + j]
        d_sum += d
        x_d += d * filters[at_p + j]
        w_d += d * filters[at_p + p + j]
    known_left, known_right, known_ratio = e_left, e_right, e_ratio
    for j in range(p):
        d = theta[eta + 3 + j]
        e_left += d * filters[at_p + 2 * p + j]
        e_right += d * filters[at_p + 3 * p + j]
        e_ratio += d * filters[at_p + 4 * p + j]
    if p > 0:
        if np.isnan(v):
            v = 0.0
            for j in range(p):
                v -= theta[eta + 3 + j] * filters[at_r + j]
        for i in range(at_r + p - 1, at_r, -1):
            filters[i] = filters[i - 1]
        filters[at_r] = v
        for i in range(at_p + 5 * p - 1, at_p, -1):
            filters[i] = filters[i - 1]
        filters[at_p], filters[at_p + p], filters[at_p + 2 * p] = x, w, known_left
        filters[at_p + 3 * p], filters[at_p + 4 * p] = known_right, known_ratio
    for i in range(nb1 - 1, 0, -1):
        filters[at_xd + i] = filters[at_xd + i - 1]
    filters[at_xd] = x_d
    for i in range(na - 1, 0, -1):
        filters[at_w + i] = filters[at_w + i - 1]
        filters[at_wd + i] = filters[at_wd + i - 1]
    if na > 0:
        filters[at_w], filters[at_wd] = w, w_d
    for i in range(nb1):
        psi[na + i] = filters[at_xd + i]
    psi[na + nb1] = d_sum
    psi[eta], psi[eta + 1], psi[eta + 2] = e_left, e_right, e_ratio
    return float(error)


@njit(cache=True, nogil=True)
def gather(psi: FloatArray, error: float, weight: float, h: FloatArray, g: FloatArray) -> None:
    """Add psi psi' and psi e to the sums of the block, with the weight of a bounded influence."""
    for i in range(psi.size):
        value = weight * psi[i]
        g[i] += value * error
        for j in range(psi.size):
            h[i, j] += value * psi[j]


@njit(cache=True, nogil=True)
def influence(error: float, limit: float) -> float:
    """Huber's weight: 1 up to `limit`, then falling so that an error counts as `limit`."""
    return 1.0 if abs(error) <= limit else limit / abs(error)


@njit(cache=True, nogil=True)
def factor(h: FloatArray, root: FloatArray) -> None:
    """Cholesky factor of h + ridge in `root` (lower); a direction without any information gets a unit.

    What is left of a pivot below the ridge is rounding, and so is the rest of its column: divided by the pivot it
    would grow from row to row, beyond all numbers where h spans more digits than they have.
    """
    n = h.shape[0]
    told = np.ones(n, dtype=np.bool_)
    for i in range(n):
        for j in range(i + 1):
            total = h[i, j]
            if i == j:
                total = total * (1.0 + RIDGE) if total > SMALLEST else 1.0
            for k in range(j):
                total -= root[i, k] * root[j, k]
            if i == j:
                floor = RIDGE * h[i, i] if h[i, i] > SMALLEST else 1.0
                told[i] = total >= floor
                root[i, i] = np.sqrt(max(total, floor))
            else:
                root[i, j] = total / root[j, j] if told[j] else 0.0


@njit(cache=True, nogil=True)
def solve(root: FloatArray, b: FloatArray) -> None:
    """Solve root root' x = b in place."""
    n = b.size
    for i in range(n):
        total = b[i]
        for k in range(i):
            total -= root[i, k] * b[k]
        b[i] = total / root[i, i]
    for i in range(n - 1, -1, -1):
        total = b[i]
        for k in range(i + 1, n):
            total -= root[k, i] * b[k]
        b[i] = total / root[i, i]


@njit(cache=True, nogil=True)
def pin(theta: FloatArray, root: FloatArray, c: FloatArray, value: float) -> None:
    """Move theta to c' theta = value, at the least cost in likelihood; `c` is overwritten."""
    miss = -value
    for i in range(theta.size):
        miss += c[i] * theta[i]
    direction = c.copy()
    solve(root, c)
    along = 0.0
    for i in range(theta.size):
        along += direction[i] * c[i]
    if along > 0.0:
        for i in range(theta.size):
            theta[i] -= c[i] * (miss / along)


@njit(cache=True, nogil=True)
def constrain(theta: FloatArray, root: FloatArray, eta: int, low: float, high: float, ratio: float) -> None:
    """Break points in order and inside the range seen, slope ratio within bounds; the others follow."""
    c = np.zeros(theta.size)
    if theta[eta] > theta[eta + 1]:
        c[eta], c[eta + 1] = 1.0, -1.0
        pin(theta, root, c, 0.0)
    for i in range(2):
        if not low <= theta[eta + i] <= high:
            c[:] = 0.0
            c[eta + i] = 1.0
            pin(theta, root, c, min(max(theta[eta + i], low), high))
    if abs(theta[eta + 2]) > ratio:
        c[:] = 0.0
        c[eta + 2] = 1.0
        pin(theta, root, c, ratio if theta[eta + 2] > 0.0 else -ratio)
    theta[eta] = min(max(theta[eta], low), high)  # two bounds at once
    theta[eta + 1] = min(max(theta[eta + 1], theta[eta]), high)


@njit(cache=True, nogil=True)
def step_to(theta: FloatArray, wanted: FloatArray, na: int, radius: float) -> None:
    """Go from theta to `wanted`, or halves of the way while A would be unstable."""
    trial = wanted.copy()
    for _ in range(HALVINGS):
        if is_stable(trial[:na], radius):
            theta[:] = trial
            return
        for i in range(theta.size):
            trial[i] = 0.5 * (trial[i] + theta[i])


@njit(cache=True, nogil=True)
def calm(d: FloatArray, radius: float) -> None:
    """Draw in the roots of an unstable noise model: 1/D bridges missing samples and outliers."""
    for _ in range(CALM_STEPS):
        if is_stable(d, radius):
            return
        power = 1.0
        for i in range(d.size):
            power *= CALMER
            d[i] *= power
    d[:] = 0.0


@njit(cache=True, nogil=True)
def merge(ref_h: FloatArray, ref_r: FloatArray, h: FloatArray, r: FloatArray, tail: float) -> None:
    """Let a block enter the reference, which forgets a share `tail`, but in no direction more than comes in.

    In the basis in which the reference is 1 the block is diagonal, mu; the reference loses min(tail, mu).
    """
    n = r.size
    if tail > 0.0:
        root = np.zeros((n, n))
        factor(ref_h, root)
        left = h.copy()
        for column in range(n):  # C = L^-1 h L^-T
            for i in range(n):
                total = left[i, column]
                for k in range(i):
                    total -= root[i, k] * left[k, column]
                left[i, column] = total / root[i, i]
        for row in range(n):
            for i in range(n):
                total = left[row, i]
                for k in range(i):
                    total -= root[i, k] * left[row, k]
                left[row, i] = total / root[i, i]
        mu, vectors = np.linalg.eigh(0.5 * (left + left.T))
        at = ref_r.copy()
        solve(root, at)
        for m in range(n):
            lost = min(max(mu[m], 0.0), tail)
            if lost <= 0.0:
                continue
            direction = np.zeros(n)
            for i in range(n):
                for k in range(i + 1):
                    direction[i] += root[i, k] * vectors[k, m]
            along = 0.0
            for i in range(n):
                along += direction[i] * at[i]
            for i in range(n):
                ref_r[i] -= lost * direction[i] * along
                for j in range(n):
                    ref_h[i, j] -= lost * direction[i] * direction[j]
    for i in range(n):
        ref_r[i] += r[i]
        for j in range(n):
            ref_h[i, j] += h[i, j]


@njit(cache=True, nogil=True)
def settling_time(a: FloatArray) -> int:
    """Samples until a wrong initial state of A has faded to SETTLED."""
    n = a.size
    if n == 0:
        return 0
    companion = np.zeros((n, n))
    for i in range(n):
        companion[0, i] = -a[i]
        if i > 0:
            companion[i, i - 1] = 1.0
    power = companion
    samples = 1
    while samples < LONGEST_SETTLING:
        if np.abs(power).max() < SETTLED:
            break
        power = np.dot(power, power)
        samples *= 2
    return min(samples, LONGEST_SETTLING)


@njit(cache=True, nogil=True)
def informed_sides(h: FloatArray, variance: float, eta: int, reach: float, root: FloatArray) -> tuple[bool, bool]:
    """Whether one block alone could place each break point inside the range of u, everything else unknown."""
    least = variance / (reach * reach)
    if not (h[eta, eta] > least or h[eta + 1, eta + 1] > least):
        return False, False
    n = h.shape[0]
    others = n - 2
    for i in range(n):  # the break points last
        row = i if i < eta else (i + 2 if i < others else i - others + eta)
        for j in range(i + 1):
            total = h[row, j if j < eta else (j + 2 if j < others else j - others + eta)]
            whole = total
            for k in range(min(j, others)):
                total -= root[i, k] * root[j, k]
            if i >= others and j >= others:
                root[i, j] = total
            elif i == j:
                root[i, i] = np.sqrt(max(total, RIDGE * whole)) if whole > SMALLEST else 1.0
            else:
                root[i, j] = total / root[j, j]
    left, right, cross = root[n - 2, n - 2], root[n - 1, n - 1], root[n - 1, n - 2]
    shared = cross * cross
    return (
        bool(right > 0.0 and left - shared / right > least) or bool(right <= 0.0 and left > least),
        bool(left > 0.0 and right - shared / left > least) or bool(left <= 0.0 and right > least),
    )


@njit(cache=True, nogil=True)
def invert(root: FloatArray, inverse: FloatArray) -> None:
    """Inverse of root root'."""
    n = root.shape[0]
    for i in range(n):  # inverse of the factor, in the lower triangle
        inverse[i, i] = 1.0 / root[i, i]
        for j in range(i):
            total = 0.0
            for k in range(j, i):
                total -= root[i, k] * inverse[k, j]
            inverse[i, j] = total / root[i, i]
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for k in range(i, n):
                total += inverse[k, i] * inverse[k, j]
            inverse[j, i] = total
    for i in range(n):
        for j in range(i):
            inverse[i, j] = inverse[j, i]


@njit(cache=True, nogil=True)
def total_information(state: FloatArray, layout: IntArray) -> None:
    """Sum reference and ring into TOTAL; its factor into ROOT and its inverse into INVERSE."""
    n, ring = layout[N], layout[RING]
    square = n * n
    h = state[layout[TOTAL_H] : layout[TOTAL_H] + square]
    r = state[layout[TOTAL_R] : layout[TOTAL_R] + n]
    h[:] = state[layout[REF_H] : layout[REF_H] + square]
    r[:] = state[layout[REF_R] : layout[REF_R] + n]
    for slot in range(ring):
        at = layout[RING_H] + slot * square
        for i in range(square):
            h[i] += state[at + i]
        at = layout[RING_R] + slot * n
        for i in range(n):
            r[i] += state[at + i]
    at = (layout[NA] + layout[NB1]) * (n + 1)
    offset_information = h[at]
    if state[ZERO] > 0.0:  # known to be zero: solved and linearised there
        h[at] += SURE * h[at]
    root = state[layout[ROOT] : layout[ROOT] + square].reshape(n, n)
    factor(h.reshape(n, n), root)
    h[at] = offset_information
    invert(root, state[layout[INVERSE] : layout[INVERSE] + square].reshape(n, n))


@njit(cache=True, nogil=True)
def newton_step(state: FloatArray, layout: IntArray) -> None:
    """Move theta to the solution of all that is remembered, and `shown` to the same without a needless offset."""
    n, na, eta = layout[N], layout[NA], layout[NA] + layout[NB1] + 1
    square = n * n
    total_information(state, layout)
    root = state[layout[ROOT] : layout[ROOT] + square].reshape(n, n)
    h = state[layout[TOTAL_H] : layout[TOTAL_H] + square].reshape(n, n)
    theta = state[layout[THETA] : layout[THETA] + n]
    move = state[layout[TOTAL_R] : layout[TOTAL_R] + n].copy()
    for i in range(n):
        for j in range(n):
            move[i] -= h[i, j] * theta[j]
    if state[ZERO] > 0.0:
        move[eta - 1] -= SURE * h[eta - 1, eta - 1] * theta[eta - 1]
    solve(root, move)
    wanted = theta + move
    constrain(wanted, root, eta, state[LOW], state[HIGH], state[RATIO_LIMIT])
    calm(wanted[n - layout[P] :], RADIUS)
    step_to(theta, wanted, na, RADIUS)
    show(state, layout)


@njit(cache=True, nogil=True)
def show(state: FloatArray, layout: IntArray) -> None:
    """Fill `shown`: theta, with the offset pinned to zero where it explains nothing (BIC) or must not be there.

    ZERO: nan free, 0 decide, 1 always zero. Zero inside the dead zone is asked for, as in the batch.
    """
    n, at = layout[N], layout[NA] + layout[NB1]
    theta = state[layout[THETA] : layout[THETA] + n]
    shown = state[layout[SHOWN] : layout[SHOWN] + n]
    shown[:] = theta
    if not pinned(state, layout):
        return
    column = layout[INVERSE] + at * n
    for i in range(n):
        shown[i] -= state[column + i] * (theta[at] / state[column + at])
    shown[at] = 0.0
    for i in range(at + 1, at + 3):
        shown[i] = min(max(shown[i], state[LOW]), state[HIGH])
    if shown[at + 1] > shown[at + 2]:
        shown[at + 1 : at + 3] = 0.5 * (shown[at + 1] + shown[at + 2])
    shown[at + 3] = min(max(shown[at + 3], -state[RATIO_LIMIT]), state[RATIO_LIMIT])
    if not is_stable(shown[: layout[NA]], RADIUS):
        shown[:] = theta


@njit(cache=True, nogil=True)
def pinned(state: FloatArray, layout: IntArray) -> bool:
    """Whether the offset counts as zero now."""
    if np.isnan(state[ZERO]):
        return False
    if state[ZERO] > 0.0:
        return True
    n, at = layout[N], layout[NA] + layout[NB1]
    theta = state[layout[THETA] : layout[THETA] + n]
    if not theta[at + 1] <= 0.0 <= theta[at + 2]:
        return False
    variance = state[SQUARES] / state[WEIGHT] * state[layout[INVERSE] + at * n + at]
    return bool(theta[at] * theta[at] < np.log(max(state[WEIGHT], 2.0)) * variance)


@njit(cache=True, nogil=True)
def find_change(state: FloatArray, layout: IntArray) -> bool:
    """Efficient score test of a shift within the newest 1, 2, 4 .. blocks; keep the largest statistic.

    At the estimate from everything, the score s of a window is normal with covariance
    variance (H - H T^-1 H), H its information and T the total, if nothing has changed; a shift along c gives it
    the mean of that matrix times c. z = c's / sqrt(c' cov c) is the likelihood ratio against that shift.
    """
    n, ring, eta = layout[N], layout[RING], layout[NA] + layout[NB1] + 1
    square = n * n
    inverse = state[layout[INVERSE] : layout[INVERSE] + square].reshape(n, n)
    right_hand = state[layout[TOTAL_R] : layout[TOTAL_R] + n]
    best = np.zeros(n)
    for i in range(n):
        for j in range(n):
            best[j] += inverse[i, j] * right_hand[i]
    h = state[layout[WORK] : layout[WORK] + square]
    h[:] = 0.0
    r, c, along, score = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    deviation = np.sqrt(state[SQUARES] / state[WEIGHT])
    largest = 0.0
    wanted = 1
    for back in range(min(ring, layout[BLOCKS])):
        slot = (layout[BLOCKS] - 1 - back) % ring
        h += state[layout[RING_H] + slot * square : layout[RING_H] + (slot + 1) * square]
        r += state[layout[RING_R] + slot * n : layout[RING_R] + (slot + 1) * n]
        if back + 1 != wanted:
            continue
        wanted *= 2
        for i in range(n):
            score[i] = r[i]
            for j in range(n):
                score[i] -= h[i * n + j] * best[j]
        for direction in range(3):
            c[:] = 0.0
            if direction == GAIN:
                c[layout[NA] : eta - 1] = best[layout[NA] : eta - 1]
            else:
                c[eta + direction] = 1.0
            spread, above = 0.0, 0.0
            for i in range(n):
                along[i] = 0.0
                for j in range(n):
                    along[i] += h[i * n + j] * c[j]
                spread += c[i] * along[i]
                above += c[i] * score[i]
            whole = spread
            for i in range(n):
                value = 0.0
                for j in range(n):
                    value += inverse[i, j] * along[j]
                spread -= along[i] * value
            if spread > 1e-6 * whole and deviation > 0.0:
                statistic = above / (deviation * np.sqrt(spread))
                if abs(statistic) > abs(largest):
                    largest = statistic
                    layout[WINDOW] = back + 1
    state[STATISTIC] = largest
    return bool(abs(largest) > state[THRESHOLD])


@njit(cache=True, nogil=True)
def close_block(state: FloatArray, layout: IntArray) -> int:
    """Put the block into the ring, the oldest one into the reference; solve; look for a change."""
    n, ring, eta = layout[N], layout[RING], layout[NA] + layout[NB1] + 1
    square = n * n
    slot = layout[BLOCKS] % ring
    kept_h = state[layout[RING_H] + slot * square : layout[RING_H] + (slot + 1) * square]
    kept_r = state[layout[RING_R] + slot * n : layout[RING_R] + (slot + 1) * n]
    if layout[BLOCKS] >= ring:
        reference = state[layout[REF_H] : layout[REF_H] + square].reshape(n, n)
        merge(reference, state[layout[REF_R] : layout[REF_R] + n], kept_h.reshape(n, n), kept_r, state[TAIL])
    h = state[layout[SUM_H] : layout[SUM_H] + square]
    g = state[layout[SUM_G] : layout[SUM_G] + n]
    theta = state[layout[THETA] : layout[THETA] + n]
    for i in range(n):
        for j in range(n):
            g[i] += h[i * n + j] * theta[j]
    kept_h[:] = h
    kept_r[:] = g
    state[layout[PERIOD_H] : layout[PERIOD_H] + square] += h
    state[layout[PERIOD_R] : layout[PERIOD_R] + n] += g
    work = state[layout[WORK] : layout[WORK] + square].reshape(n, n)
    variance, reach = state[SQUARES] / state[WEIGHT], state[HIGH] - state[LOW]
    left, right = informed_sides(h.reshape(n, n), variance, eta, reach, work)
    if left:
        layout[LEFT_AT] = layout[COUNT]
    if right:
        layout[RIGHT_AT] = layout[COUNT]
    h[:] = 0.0
    g[:] = 0.0
    layout[FILLED] = 0
    layout[BLOCKS] += 1
    if layout[EXPLAIN_AT] > 0:  # under suspicion: the estimate waits until there is enough to explain
        layout[WINDOW] = min(layout[WINDOW] + 1, ring)
        if layout[BLOCKS] < layout[EXPLAIN_AT]:
            return NOTHING
        layout[EXPLAIN_AT] = 0
        total_information(state, layout)
        return ALARMED
    newton_step(state, layout)
    if layout[COUNT] - layout[SINCE] >= layout[TEST_AFTER] and find_change(state, layout):
        layout[EXPLAIN_AT] = layout[BLOCKS] + max(min(ENOUGH, ring) - layout[WINDOW], 0)
        if layout[EXPLAIN_AT] == layout[BLOCKS]:
            layout[EXPLAIN_AT] = 0
            return ALARMED
        return NOTHING
    return REFIT if layout[COUNT] >= layout[REFIT_AT] else NOTHING


@njit(cache=True, nogil=True)
def settling(theta: FloatArray, layout: IntArray) -> int:
    """Samples until what is not known about the command no longer matters."""
    return int(settling_time(theta[: layout[NA]]) + layout[DELAY] + layout[NB1])


@njit(cache=True, nogil=True)
def take(
    u: float,
    y: float,
    used: bool,
    state: FloatArray,
    layout: IntArray,
    theta: FloatArray,
    filters: FloatArray,
    h: FloatArray,
    g: FloatArray,
    psi: FloatArray,
) -> float:
    """One sample: bridge or mask what is missing, filter, add to the block. Return the error (NaN without y)."""
    p = layout[P]
    if np.isnan(u):
        u = state[HELD]
        layout[MISSING] += 1
        layout[LOST] += 1
        if layout[LOST] > HOLD:
            layout[SETTLE] = UNKNOWN
        used = False
    else:
        if layout[LOST] > 0 and u != state[HELD]:  # it has moved in the gap, at an unknown sample
            layout[SETTLE] = UNKNOWN
        layout[LOST] = 0
        if not used:
            layout[SETTLE] = UNKNOWN
            layout[MASKED] += 1
            layout[WAIT] = p + 1
            u = min(max(u, state[LOW]), state[HIGH])  # whatever it is, the filters forget it in the time to settle
        elif layout[SETTLE] == UNKNOWN:
            layout[SETTLE] = settling(theta, layout)
        elif layout[SETTLE] > 0:
            layout[SETTLE] -= 1
        state[HELD] = u
    slot = layout[BLOCKS] % layout[RING]
    if layout[FILLED] == 0:
        at = layout[RING_F] + slot * layout[FILTERS]
        state[at : at + layout[FILTERS]] = filters
        state[layout[RING_S] + 2 * slot] = state[SQUARES]
        state[layout[RING_S] + 2 * slot + 1] = state[WEIGHT]
    error = advance(u, y, theta, filters, layout[NA], layout[NB1], layout[DELAY], p, psi)
    if np.isnan(y):
        layout[MISSING] += 1
        layout[WAIT] = p
        used = False
    elif layout[WAIT] > 0:
        layout[WAIT] -= 1
        used = False
    used = used and layout[SETTLE] == 0
    if used:
        state[LOW], state[HIGH] = min(state[LOW], u), max(state[HIGH], u)
        limit = state[CLIP] * np.sqrt(state[SQUARES] / state[WEIGHT])
        weight = influence(error, limit)
        gather(psi, error, weight, h, g)
        state[SQUARES] = state[KEEP] * state[SQUARES] + min(error * error, limit * limit)
        state[WEIGHT] = state[KEEP] * state[WEIGHT] + 1.0
        if weight < 1.0:
            layout[CLIPPED] += 1
            if p > 0:  # the outlier is no noise that goes on
                filters[filters.size - 5 * p - layout[NA] - layout[NB1] - p] -= (1.0 - weight) * error
    at = slot * layout[BLOCK] + layout[FILLED]
    state[layout[U] + at] = u
    state[layout[Y] + at] = y
    state[layout[USED] + at] = 1.0 if used else 0.0
    layout[FILLED] += 1
    layout[COUNT] += 1
    return error


@njit(cache=True, nogil=True)
def run(
    u: FloatArray,
    y: FloatArray,
    used: npt.NDArray[np.bool_],
    begin: int,
    state: FloatArray,
    layout: IntArray,
    errors: FloatArray,
    every: int,
    trace: FloatArray,
) -> tuple[int, int]:
    """Samples from `begin` on, until the end or until a block closes with a reason to come back.

    Fills `errors` (n,) and, after every `every`-th sample counted from 0, a row of `trace` with `shown`. Returns
    the next sample and the reason.
    """
    n = layout[N]
    psi = np.zeros(n)
    shown = state[layout[SHOWN] : layout[SHOWN] + n]
    theta = state[layout[THETA] : layout[THETA] + n]
    filters = state[layout[FILTER] : layout[FILTER] + layout[FILTERS]]
    h = state[layout[SUM_H] : layout[SUM_H] + n * n].reshape(n, n)
    g = state[layout[SUM_G] : layout[SUM_G] + n]
    for k in range(begin, u.size):
        errors[k] = take(u[k], y[k], used[k], state, layout, theta, filters, h, g, psi)
        reason = NOTHING
        if layout[FILLED] == layout[BLOCK]:
            reason = close_block(state, layout)
        if (k + 1) % every == 0:
            row = (k + 1) // every - 1
            if row < trace.shape[0]:
                trace[row] = shown
        if reason != NOTHING:
            return k + 1, reason
    return u.size, NOTHING


@njit(cache=True, nogil=True)
def one(u: float, y: float, used: bool, state: FloatArray, layout: IntArray, psi: FloatArray) -> tuple[float, int]:
    """One sample from Python: error and reason to look closer."""
    n = layout[N]
    theta = state[layout[THETA] : layout[THETA] + n]
    filters = state[layout[FILTER] : layout[FILTER] + layout[FILTERS]]
    h = state[layout[SUM_H] : layout[SUM_H] + n * n].reshape(n, n)
    g = state[layout[SUM_G] : layout[SUM_G] + n]
    error = take(u, y, used, state, layout, theta, filters, h, g, psi)
    return error, close_block(state, layout) if layout[FILLED] == layout[BLOCK] else NOTHING


@njit(cache=True, nogil=True)
def replay(
    old: FloatArray,
    theta: FloatArray,
    onset: int,
    blind: int,
    limit: float,
    state: FloatArray,
    layout: IntArray,
    blocks: int,
    h: FloatArray,
    r: FloatArray,
    errors: FloatArray,
    snapshots: FloatArray,
) -> float:
    """Filter the newest `blocks` whole blocks again, with `old` up to sample `onset`, then with `theta`.

    Fills h (blocks, n, n), r (blocks, n), errors (blocks * block; NaN where not used) and `snapshots` of the filters
    before each block and at the end (blocks + 1, filters);
    the information is that from `onset` on. Returns the cost, errors beyond `limit` counting as Huber has it. The
    first `blind` samples from `onset` on, in which the filters do not know how the change came about, add neither.
    """
    n, ring, block, p = layout[N], layout[RING], layout[BLOCK], layout[P]
    na, nb1, delay = layout[NA], layout[NB1], layout[DELAY]
    nx = max(na, nb1)
    oldest = (layout[BLOCKS] - blocks) % ring
    at = layout[RING_F] + oldest * layout[FILTERS]
    filters = state[at : at + layout[FILTERS]].copy()
    psi = np.zeros(n)
    cost = 0.0
    for i in range(blocks):
        slot = (oldest + i) % ring
        snapshots[i] = filters
        h[i] = 0.0
        r[i] = 0.0
        for j in range(block):
            k, at = slot * block + j, i * block + j
            if at == onset:  # the new break points have not acted before
                filters[delay + 1 + nx : delay + 1 + 4 * nx] = 0.0
                filters[filters.size - 3 * p :] = 0.0
            now = theta if at >= onset else old
            error = advance(state[layout[U] + k], state[layout[Y] + k], now, filters, na, nb1, delay, p, psi)
            errors[at] = np.nan
            if state[layout[USED] + k] > 0.0:
                errors[at] = error
                weight = influence(error, limit)
                if weight < 1.0 and p > 0:
                    filters[filters.size - 5 * p - na - nb1 - p] -= (1.0 - weight) * error
                if onset <= at < onset + blind:
                    continue
                if at >= onset:
                    gather(psi, error, weight, h[i], r[i])
                cost += error * error if weight == 1.0 else limit * (2.0 * abs(error) - limit)
        r[i] += np.dot(h[i], theta)
    snapshots[blocks] = filters
    return cost
