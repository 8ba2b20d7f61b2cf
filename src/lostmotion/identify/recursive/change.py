"""After an alarm: what has changed, when, to what; and the state that goes on from there.

The kernel's score test says that something has shifted within the newest blocks. Here the stored samples are fitted
again under several hypotheses, each of which forgets what was known about some parameters and keeps the rest; the
best by BIC wins, or none (then it was a false alarm). The samples since the change are relinearised while they are
still stored, so the new estimate is as good as a batch fit that knows the old process.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels import recursive_ml as kernel
from lostmotion.kernels.linear import is_stable

MOST_STEPS = 12
MARGIN = 2  # blocks before the window of an alarm in which the change may have begun
CLEAR = 3.0  # mean square of normalised errors between that of noise, 1, and that of a changed process
SCAN = 24  # positions at which a moved break point is looked for
_REPLAY: Any = kernel.replay
NEVER = int(np.iinfo(np.int64).max)


@dataclass(frozen=True)
class ChangeEvent:
    """A parameter has moved.

    Attributes
    ----------
    sample : int
        Samples seen when it was raised.
    since : int
        Estimated sample of the change.
    name : str
        "left" or "right" (break points), "offset" (a load has come) or "process" (what lies behind the actuator).
    before, after : float
        Estimates, in engineering units; of the process the static gain from OP to PV beyond right.
    standard_error : float
        Of `after`, at the time of the event.
    """

    sample: int
    since: int
    name: str
    before: float
    after: float
    standard_error: float


@dataclass(frozen=True)
class Prior:
    """What older samples say: information and the estimate that it is about."""

    h: FloatArray
    centre: FloatArray

    def cost(self, theta: FloatArray) -> float:
        """Cost of a distance from the centre."""
        return float((theta - self.centre) @ self.h @ (theta - self.centre))


@dataclass(frozen=True)
class Stretch:
    """The newest stored blocks, with the parameters that hold before sample `onset` of them.

    `blind` samples after the onset do not count: where the process changes, what it does on the way is unknown.
    """

    blocks: int
    before: FloatArray
    onset: int = 0
    blind: int = 0

    def unseen(self, refit: Refit) -> int:
        """Samples that would have counted."""
        return int(np.isfinite(refit.errors[self.onset : self.onset + self.blind]).sum())


@dataclass(frozen=True)
class Refit:
    """A stretch filtered again: its cost, the information from the onset on by block, errors, filters."""

    theta: FloatArray
    cost: float
    h: FloatArray
    r: FloatArray
    errors: FloatArray
    snapshots: FloatArray


class Memory:
    """View of the state of the recursion for those who look back."""

    def __init__(self, state: FloatArray, layout: IntArray) -> None:
        self.state, self.layout = state, layout
        self.n, self.ring, self.block = (int(layout[i]) for i in (kernel.N, kernel.RING, kernel.BLOCK))
        self.eta = int(layout[kernel.NA] + layout[kernel.NB1] + 1)

    def part(self, name: int, *shape: int) -> FloatArray:
        """Section of the state as an array that shares its memory."""
        at = int(self.layout[name])
        return self.state[at : at + int(np.prod(shape))].reshape(shape)

    @property
    def theta(self) -> FloatArray:
        """Present estimate."""
        return self.part(kernel.THETA, self.n)

    @property
    def variance(self) -> float:
        """Variance of the prediction errors."""
        return float(self.state[kernel.SQUARES] / self.state[kernel.WEIGHT])

    @property
    def stored(self) -> int:
        """Whole blocks that can be replayed."""
        return int(min(self.layout[kernel.BLOCKS], self.ring))

    def slots(self, blocks: int) -> list[int]:
        """Places of the newest blocks in the ring, oldest first."""
        newest = int(self.layout[kernel.BLOCKS])
        return [(newest - blocks + i) % self.ring for i in range(blocks)]

    def older_than(self, blocks: int) -> Prior:
        """Everything before the newest `blocks`."""
        h, r = self.part(kernel.REF_H, self.n, self.n).copy(), self.part(kernel.REF_R, self.n).copy()
        ring_h, ring_r = (
            self.part(kernel.RING_H, self.ring, self.n, self.n),
            self.part(kernel.RING_R, self.ring, self.n),
        )
        recent = set(self.slots(blocks))
        for slot in range(self.ring):
            if slot not in recent:
                h += ring_h[slot]
                r += ring_r[slot]
        scale = 1.0 / np.sqrt(np.maximum(np.diag(h), 1e-300))
        ridge = h * np.outer(scale, scale) + kernel.RIDGE * np.eye(self.n)
        return Prior(h, self.theta + scale * np.linalg.solve(ridge, scale * (r - h @ self.theta)))

    def replay(self, stretch: Stretch, theta: FloatArray, limit: float) -> Refit:
        """Filter a stretch again with `theta` from its onset on; errors beyond `limit` have bounded influence."""
        blocks = stretch.blocks
        h, r = np.empty((blocks, self.n, self.n)), np.empty((blocks, self.n))
        errors, snapshots = np.empty(blocks * self.block), np.empty((blocks + 1, int(self.layout[kernel.FILTERS])))
        cost = _REPLAY(
            stretch.before,
            theta,
            stretch.onset,
            stretch.blind,
            limit,
            self.state,
            self.layout,
            blocks,
            h,
            r,
            errors,
            snapshots,
        )
        return Refit(theta, float(cost), h, r, errors, snapshots)

    def adopt(self, refit: Refit, prior: Prior, variance: float) -> None:
        """Go on from a refit, with `prior` for everything before it."""
        blocks = len(refit.h)
        ring_h, ring_r = (
            self.part(kernel.RING_H, self.ring, self.n, self.n),
            self.part(kernel.RING_R, self.ring, self.n),
        )
        self.part(kernel.REF_H, self.n, self.n)[:] = prior.h
        self.part(kernel.REF_R, self.n)[:] = prior.h @ prior.centre
        ring_h[:], ring_r[:] = 0.0, 0.0
        filters = refit.snapshots.shape[1]
        kept = self.part(kernel.RING_F, self.ring, filters)
        for i, slot in enumerate(self.slots(blocks)):
            ring_h[slot], ring_r[slot], kept[slot] = refit.h[i], refit.r[i], refit.snapshots[i]
        self.part(kernel.FILTER, filters)[:] = refit.snapshots[blocks]
        self.theta[:] = refit.theta
        self.state[kernel.SQUARES] = variance * self.state[kernel.WEIGHT]
        kernel.newton_step(self.state, self.layout)


def forget(prior: Prior, names: list[int], weak: FloatArray) -> Prior:
    """What is known about the other parameters when nothing is known about `names` but a weak prior."""
    h, n = prior.h, prior.centre.size
    rest = [i for i in range(n) if i not in names]
    result = np.zeros_like(h)
    scale = np.sqrt(np.maximum(np.diag(h), 1e-300))
    scaled = h / np.outer(scale, scale)
    gone = np.linalg.pinv(scaled[np.ix_(names, names)], rcond=1e-12, hermitian=True)
    cross = scaled[np.ix_(rest, names)]
    left = scaled[np.ix_(rest, rest)] - cross @ gone @ cross.T
    result[np.ix_(rest, rest)] = 0.5 * (left + left.T) * np.outer(scale[rest], scale[rest])
    result[names, names] = weak[names]
    return Prior(result, prior.centre)


def fit_again(memory: Memory, stretch: Stretch, prior: Prior, start: FloatArray, variance: float) -> Refit:
    """Gauss-Newton with halved steps on a stretch plus the prior, first with all errors at full weight."""
    refit = memory.replay(stretch, start, np.inf)
    for limit in (np.inf, memory.state[kernel.CLIP] * np.sqrt(variance)):
        refit = memory.replay(stretch, refit.theta, limit)
        for _ in range(MOST_STEPS):
            better = _better(memory, stretch, prior, refit, limit)
            if better is None:
                break
            gained = refit.cost + prior.cost(refit.theta) - better.cost - prior.cost(better.theta)
            refit = better
            if gained < 1e-3 * variance:
                break
    return refit


def _better(memory: Memory, stretch: Stretch, prior: Prior, refit: Refit, limit: float) -> Refit | None:
    """One Gauss-Newton step, halved while it does not help or A would be unstable; None: no step helps."""
    h = refit.h.sum(axis=0)
    total = prior.h + h
    gradient = prior.h @ (prior.centre - refit.theta) + refit.r.sum(axis=0) - h @ refit.theta
    scale = np.sqrt(np.maximum(np.diag(total), 1e-300))
    ridge = total / np.outer(scale, scale) + kernel.RIDGE * np.eye(scale.size)
    step = np.linalg.solve(ridge, gradient / scale) / scale
    before = refit.cost + prior.cost(refit.theta)
    for _ in range(kernel.HALVINGS):
        theta = _valid(memory, refit.theta + step)
        if is_stable(np.ascontiguousarray(theta[: memory.layout[kernel.NA]]), kernel.RADIUS):
            trial = memory.replay(stretch, theta, limit)
            if trial.cost + prior.cost(theta) < before:
                return trial
        step = 0.5 * step
    return None


def _valid(memory: Memory, theta: FloatArray) -> FloatArray:
    low, high, eta = memory.state[kernel.LOW], memory.state[kernel.HIGH], memory.eta
    limit = memory.state[kernel.RATIO_LIMIT]
    result = theta.copy()
    if result[eta] > result[eta + 1]:
        result[eta : eta + 2] = 0.5 * (result[eta] + result[eta + 1])
    result[eta : eta + 2] = np.clip(result[eta : eta + 2], low, high)
    result[eta + 2] = np.clip(result[eta + 2], -limit, limit)
    kernel.calm(result[eta + 3 :], kernel.RADIUS)
    return result


def _weak(memory: Memory, theta: FloatArray, variance: float) -> FloatArray:
    """Information that every parameter lies within its plausible range."""
    na, nb1, eta = int(memory.layout[kernel.NA]), int(memory.layout[kernel.NB1]), memory.eta
    reach = np.ones(memory.n)
    reach[na : na + nb1] = max(float(np.abs(theta[na : na + nb1]).max()), 1e-6)
    reach[eta - 1] = max(1.0, abs(float(theta[eta - 1])))
    reach[eta : eta + 2] = memory.state[kernel.HIGH] - memory.state[kernel.LOW]
    return np.asarray(variance / reach**2)


def _scan(memory: Memory, stretch: Stretch, theta: FloatArray, moved: list[int]) -> FloatArray:
    """Best position of the moved break points on a coarse scan, one after the other."""
    best, least = theta, np.inf
    low, high = memory.state[kernel.LOW], memory.state[kernel.HIGH]
    for index in moved:
        origin = best
        for value in (origin[index], *np.linspace(low, high, SCAN + 2)[1:-1]):
            trial = origin.copy()
            trial[index] = value
            if trial[memory.eta] > trial[memory.eta + 1]:
                continue
            cost = memory.replay(stretch, trial, np.inf).cost
            if cost < least:
                best, least = trial, cost
    return best


@dataclass(frozen=True)
class Explanation:
    """What has changed: the kind, the refit after it, what is still known from before, and where it began."""

    kind: str
    refit: Refit
    prior: Prior
    stretch: Stretch
    variance: float


def explain(memory: Memory) -> Explanation | None:
    """Best explanation of an alarm by BIC; None: nothing has changed."""
    blocks = min(int(memory.layout[kernel.WINDOW]) + MARGIN, memory.stored)
    prior = memory.older_than(blocks)
    before = _usable(memory, prior.centre)
    squares, weight = memory.part(kernel.RING_S, memory.ring, 2)[memory.slots(blocks)[0]]
    variance = float(squares / weight)  # before the change
    stretch = Stretch(blocks, before)
    same = memory.replay(stretch, before, np.inf)
    misfit = _first_misfit(same.errors, variance)
    eta, weak = memory.eta, _weak(memory, before, variance)
    process = list(range(eta))
    kinds = {
        "right": [eta + 1], "left": [eta], "both": [eta, eta + 1], "offset": [eta - 1],
        "process": process, "all": [*process, eta, eta + 1],
    }  # fmt: skip
    penalty = variance * np.log(max(np.isfinite(same.errors[misfit:]).sum(), 2))
    found: Explanation | None = None
    least = memory.replay(stretch, before, memory.state[kernel.CLIP] * np.sqrt(variance)).cost
    for kind, names in kinds.items():
        loose = forget(prior, names, weak)
        blind = int(kernel.settling(before, memory.layout)) if 0 in names else 0
        here = Stretch(blocks, before, misfit, min(blind, blocks * memory.block // 4))
        start = _scan(memory, here, before, [i for i in names if i >= eta])
        refit = fit_again(memory, here, loose, start, variance)
        here = _sharpen(memory, here, refit.theta, variance)
        refit = fit_again(memory, here, loose, refit.theta, variance)
        value = refit.cost + loose.cost(refit.theta) + penalty * len(names) + variance * here.unseen(refit)
        if value < least:
            found, least = Explanation(kind, refit, loose, here, variance), value
    return found


def _usable(memory: Memory, wanted: FloatArray) -> FloatArray:
    """As near to `wanted` from the present estimate as A is stable and the break points are in range."""
    theta = memory.theta.copy()
    if np.all(np.isfinite(wanted)):
        kernel.step_to(theta, _valid(memory, wanted), int(memory.layout[kernel.NA]), kernel.RADIUS)
    return theta


def _first_misfit(errors: FloatArray, variance: float) -> int:
    """Sample from which the old parameters leave clearly larger errors; 0 where that is not clear."""
    excess = np.nan_to_num(np.minimum(errors**2 / variance, 100.0) - CLEAR)
    later = np.cumsum(excess[::-1])[::-1]
    return int(np.argmax(later)) if later.max() > 10.0 * CLEAR else 0


def _sharpen(memory: Memory, stretch: Stretch, theta: FloatArray, variance: float) -> Stretch:
    """The same stretch with the onset at which the change from old to new parameters costs least.

    What shows at a sample began the delay and some of the dynamics earlier, or as long before as OP did not care.
    """
    size = stretch.blocks * memory.block
    if stretch.onset > 0:
        steps = np.concatenate([[0], 2 ** np.arange(int(np.log2(size)))])
        onsets = np.unique(np.clip(np.concatenate([stretch.onset - steps, stretch.onset + steps[:5]]), 0, size - 1))
    else:
        onsets = np.arange(0, size, max(memory.block // 8, 1))
    trials = [Stretch(stretch.blocks, stretch.before, int(onset), stretch.blind) for onset in onsets]

    def cost(trial: Stretch) -> float:
        refit = memory.replay(trial, theta, np.inf)
        return refit.cost + variance * trial.unseen(refit)

    return min(trials, key=cost)


def react(state: FloatArray, layout: IntArray) -> tuple[str, FloatArray, FloatArray, FloatArray, int] | None:
    """Explain an alarm and go on from the change.

    Returns
    -------
    (kind, before, after, covariance, since) in scaled units, or None for a false alarm.
    """
    memory = Memory(state, layout)
    found = explain(memory)
    if found is None:
        kernel.newton_step(state, layout)
        return None
    refit, blocks = found.refit, found.stretch.blocks
    since = int(layout[kernel.COUNT]) - blocks * memory.block + found.stretch.onset
    covariance = found.variance * np.linalg.pinv(found.prior.h + refit.h.sum(axis=0), hermitian=True)
    memory.adopt(refit, found.prior, found.variance)
    layout[kernel.SINCE] = layout[kernel.COUNT]
    first = found.stretch.onset + found.stretch.blind
    layout[kernel.FROM_BLOCK] = layout[kernel.BLOCKS] - blocks + first // memory.block
    layout[kernel.REFIT_AT] = layout[kernel.COUNT] + memory.block
    return found.kind, found.stretch.before, refit.theta, covariance, since


def relinearise(state: FloatArray, layout: IntArray) -> None:
    """Fit the samples since the last change again, at 1, 2, 4 .. blocks after it while they are stored."""
    memory = Memory(state, layout)
    blocks = int(layout[kernel.BLOCKS] - layout[kernel.FROM_BLOCK]) - 1
    if blocks < 1:  # the change is so new that nothing has counted yet
        layout[kernel.REFIT_AT] = layout[kernel.COUNT] + memory.block
        return
    if blocks > memory.stored:
        layout[kernel.REFIT_AT] = NEVER
        return
    prior = memory.older_than(blocks)
    theta = memory.theta.copy()
    refit = fit_again(memory, Stretch(blocks, theta, onset=-1), prior, theta, memory.variance)  # began before
    memory.adopt(refit, prior, memory.variance)
    layout[kernel.REFIT_AT] = layout[kernel.COUNT] + blocks * memory.block
