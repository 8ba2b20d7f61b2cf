"""How fast do the break points move? The reference under some hypotheses, the best of which is gone on from.

Under hypothesis j the break points do a random walk of SPEEDS[j] in WALK samples; 0: they stay. A group of blocks that
leaves the ring is judged by what each hypothesis foretold of it, then enters all references, and these lose what the
walk makes uncertain. (Bar-Shalom, Li and Kirubarajan, *Estimation with Applications to Tracking and Navigation* (2001),
section 11.6: multiple models.)

A group in which OP tells of neither break point adds no walk: valves wear where they move, and nothing is lost at rest.
"""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.recursive_ml import state as ml
from lostmotion.kernels.recursive_ml.equations import factor, merge, solve

WALK = 10_000.0  # samples
SPEEDS = np.array([0.0, 0.003, 0.01, 0.03, 0.1, 0.3])  # standard deviations of u; a factor 3 costs a few % of accuracy
GROUP = 8  # blocks that are judged at once: a walk is far slower
MOST_EVIDENCE = 8.0  # that one group may give: a jump is no walk
LONGEST_EVIDENCE = 10.0  # by which a hypothesis may be behind: what was true for a year may end
RATED = 16.0  # groups
LONGER = 10.0  # memory of the hypotheses, where one forgets: what is forgotten explains a drift as well
BETTER = 5.0  # log-likelihood by which a walk must be better than none, or none than a walk, to be gone on from


@njit(nogil=True)
def walk(h: FloatArray, r: FloatArray, eta: int, q: float) -> None:
    """Let both break points of N(inv(h) r, variance inv(h)) walk by the variance `variance` q; the estimate stays."""
    if q <= 0.0:
        return
    n = r.size
    one, other, cross = 1.0 / q + h[eta, eta], 1.0 / q + h[eta + 1, eta + 1], h[eta, eta + 1]
    below = one * other - cross * cross
    at_left, at_right = h[:, eta].copy(), h[:, eta + 1].copy()
    r_left, r_right = r[eta], r[eta + 1]
    for i in range(n):
        to_left = (other * at_left[i] - cross * at_right[i]) / below
        to_right = (one * at_right[i] - cross * at_left[i]) / below
        r[i] -= to_left * r_left + to_right * r_right
        for j in range(n):
            h[i, j] -= to_left * at_left[j] + to_right * at_right[j]


@njit(nogil=True)
def foretold(
    h: FloatArray, r: FloatArray, new_h: FloatArray, new_r: FloatArray, theta: FloatArray, variance: float
) -> float:
    """Log-likelihood of a group (new_h, new_r) under the reference (h, r), up to what all references share."""
    n = r.size
    root = np.zeros((n, n))
    factor(h, root)
    away, news = r - np.dot(h, theta), new_r - np.dot(new_h, theta)
    solve(root, away)  # estimate of the reference, from theta on
    moved = np.dot(new_h, away)
    cost = np.dot(away, moved) - 2.0 * np.dot(away, news)
    volume = 0.0
    for i in range(n):
        volume += np.log(root[i, i])
    factor(h + new_h, root)
    for i in range(n):
        volume -= np.log(root[i, i])
    score = news - moved
    gained = score.copy()
    solve(root, gained)
    return float(volume - 0.5 * (cost - np.dot(score, gained)) / variance)


@njit(nogil=True)
def walked(speed: float, samples: int, variance: float) -> float:
    """Variance of a walk over so many samples, as a multiple of that of the errors."""
    return speed * speed * samples / (WALK * variance)


@njit(nogil=True)
def leave(h: FloatArray, r: FloatArray, state: FloatArray, layout: IntArray) -> None:
    """Take note of a block that leaves the ring; judge the hypotheses where a group is complete."""
    gone_h, gone_r = ml.matrix(state, layout, ml.GONE_H), ml.vector(state, layout, ml.GONE_R)
    gone_h += h
    gone_r += r
    layout[ml.GROUPED] += 1
    if layout[ml.GROUPED] == GROUP:
        judge(state, layout)
        gone_h[:] = 0.0
        gone_r[:] = 0.0
        layout[ml.GROUPED] = 0


@njit(nogil=True)
def judge(state: FloatArray, layout: IntArray) -> None:
    """Compare the hypotheses on a group, let it enter all references, and take over the reference of the best."""
    eta, variance = ml.eta_at(layout), ml.variance(state)
    gone_h, gone_r = ml.matrix(state, layout, ml.GONE_H), ml.vector(state, layout, ml.GONE_R)
    ref_h, ref_r = ml.matrix(state, layout, ml.REF_H), ml.vector(state, layout, ml.REF_R)
    evidence = state[layout[ml.EVIDENCE] : layout[ml.EVIDENCE] + ml.DRIFTS]
    least = variance / (state[ml.HIGH] - state[ml.LOW]) ** 2
    told = gone_h[eta, eta] > least or gone_h[eta + 1, eta + 1] > least
    tail = 1.0 - (1.0 - state[ml.TAIL] / LONGER) ** GROUP
    theta = ml.vector(state, layout, ml.THETA)
    first = 0.0
    for j in range(ml.DRIFTS):
        h, r = hypothesis(state, layout, j)
        if told:
            gained = foretold(h, r, gone_h, gone_r, theta, variance)
            first = gained if j == 0 else first
            evidence[j] += min(max(gained - first, -MOST_EVIDENCE), MOST_EVIDENCE)
        merge(h, r, gone_h, gone_r, tail)
        if told:
            walk(h, r, eta, walked(SPEEDS[j], GROUP * layout[ml.BLOCK], variance))
    if told:
        note_rate(state, layout)
    best = int(np.argmax(evidence))
    most = evidence[best]
    for j in range(ml.DRIFTS):
        evidence[j] = max(evidence[j] - most, -LONGEST_EVIDENCE)
    now = layout[ml.DRIFT]
    if evidence[now] < (-BETTER if now == 0 or best == 0 else 0.0):
        layout[ml.DRIFT] = best
    if tail == 0.0:
        h, r = hypothesis(state, layout, layout[ml.DRIFT])
        ref_h[:], ref_r[:] = h, r
    elif told:
        walk(ref_h, ref_r, eta, walked(SPEEDS[layout[ml.DRIFT]], GROUP * layout[ml.BLOCK], variance))


@njit(nogil=True)
def hypothesis(state: FloatArray, layout: IntArray, j: int) -> tuple[FloatArray, FloatArray]:
    """Views of the reference under hypothesis j, (n, n) and (n,)."""
    n = layout[ml.N]
    at_h, at_r = layout[ml.BANK_H] + j * n * n, layout[ml.BANK_R] + j * n
    return state[at_h : at_h + n * n].reshape(n, n), state[at_r : at_r + n]


@njit(nogil=True)
def agree(state: FloatArray, layout: IntArray) -> None:
    """Make the reference that of all hypotheses: it has been set from outside, or this is the start."""
    ref_h, ref_r = ml.matrix(state, layout, ml.REF_H), ml.vector(state, layout, ml.REF_R)
    for j in range(ml.DRIFTS):
        h, r = hypothesis(state, layout, j)
        h[:], r[:] = ref_h, ref_r
    ml.matrix(state, layout, ml.GONE_H)[:] = 0.0
    ml.vector(state, layout, ml.GONE_R)[:] = 0.0
    layout[ml.GROUPED] = 0
    at, eta = layout[ml.WATCH], layout[ml.THETA] + ml.eta_at(layout)
    state[at + ml.WAS : at + ml.WAS + 2] = state[eta : eta + 2]


@njit(nogil=True)
def note_rate(state: FloatArray, layout: IntArray) -> None:
    """Follow how far the break points move in a group, on average over RATED groups."""
    at, eta = layout[ml.WATCH], layout[ml.THETA] + ml.eta_at(layout)
    for side in range(2):
        moved = state[eta + side] - state[at + ml.WAS + side]
        state[at + ml.RATE + side] += (moved - state[at + ml.RATE + side]) / RATED
        state[at + ml.WAS + side] = state[eta + side]


@njit(nogil=True)
def unsettled(state: FloatArray, layout: IntArray, side: int) -> float:
    """Variance that drift adds in the ring, whose samples count alike: a third of the walk, and the lag of a ramp."""
    if layout[ml.DRIFT] == 0:
        return 0.0
    blocks = min(layout[ml.BLOCKS], layout[ml.RING])
    lag = 0.5 * state[layout[ml.WATCH] + ml.RATE + side] * blocks / GROUP
    return float(SPEEDS[layout[ml.DRIFT]] ** 2 * blocks * layout[ml.BLOCK] / (3.0 * WALK) + lag * lag)
