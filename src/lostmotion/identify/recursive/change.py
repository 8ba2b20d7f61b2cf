"""After an alarm: what has changed, when, to what; and the state that goes on from there.

The kernel's score test says that something has shifted within the newest blocks. Here the stored samples are fitted
again under several hypotheses, each of which forgets what was known about some parameters and keeps the rest; the
best by BIC wins, or none (then it was a false alarm). The samples since the change are relinearised while they are
still stored, so the new estimate is as good as a batch fit that knows the old process.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.recursive.refit import fit_again, valid
from lostmotion.identify.recursive.remembered import Memory, Prior, Refit, Stretch, forget
from lostmotion.kernels.recursive_ml import state as ml
from lostmotion.kernels.recursive_ml.bounds import RADIUS, step_to

MARGIN = 2  # blocks before the window of an alarm in which the change may have begun
CLEAR = 3.0  # mean square of normalised errors between that of noise, 1, and that of a changed process
LARGEST = 100.0  # normalised square beyond which an error counts no more: an outlier is no change
SURE = 10.0  # samples of the size CLEAR by which the old parameters must miss before an onset is read from them
SCAN = 24  # positions at which a moved break point is looked for
SMALLEST_B = 1e-6  # of scaled data: a process without any gain still has a plausible range


def _weak(memory: Memory, theta: FloatArray, variance: float) -> FloatArray:
    """Information that every parameter lies within its plausible range."""
    na, nb1, eta = memory.na, memory.nb1, memory.eta
    low, high = memory.span
    reach = np.ones(memory.n)
    reach[na : na + nb1] = max(float(np.abs(theta[na : na + nb1]).max()), SMALLEST_B)
    reach[eta - 1] = max(1.0, abs(float(theta[eta - 1])))
    reach[eta : eta + 2] = high - low
    return np.asarray(variance / reach**2)


def _scan(memory: Memory, stretch: Stretch, theta: FloatArray, moved: list[int]) -> FloatArray:
    """Best position of the moved break points on a coarse scan, one after the other."""
    best, least = theta, np.inf
    low, high = memory.span
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
    blocks = min(int(memory.layout[ml.WINDOW]) + MARGIN, memory.stored)
    prior = memory.older_than(blocks)
    before = _usable(memory, prior.centre)
    squares, weight = memory.parts["ring_scale"][memory.slots(blocks)[0]]
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
    least = memory.replay(stretch, before, memory.state[ml.CLIP] * np.sqrt(variance)).cost
    for kind, names in kinds.items():
        loose = forget(prior, names, weak)
        blind = memory.settling(before) if 0 in names else 0
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
        step_to(theta, valid(memory, wanted), memory.na, RADIUS)
    return theta


def _first_misfit(errors: FloatArray, variance: float) -> int:
    """Sample from which the old parameters leave clearly larger errors; 0 where that is not clear."""
    excess = np.nan_to_num(np.minimum(errors**2 / variance, LARGEST) - CLEAR)
    later = np.cumsum(excess[::-1])[::-1]
    return int(np.argmax(later)) if later.max() > SURE * CLEAR else 0


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
        memory.solve()
        return None
    refit, blocks = found.refit, found.stretch.blocks
    since = int(layout[ml.COUNT]) - blocks * memory.block + found.stretch.onset
    covariance = found.variance * np.linalg.pinv(found.prior.h + refit.h.sum(axis=0), hermitian=True)
    memory.adopt(refit, found.prior, found.variance)
    layout[ml.SINCE] = layout[ml.COUNT]
    first = found.stretch.onset + found.stretch.blind
    layout[ml.FROM_BLOCK] = layout[ml.BLOCKS] - blocks + first // memory.block
    layout[ml.REFIT_AT] = layout[ml.COUNT] + memory.block
    return found.kind, found.stretch.before, refit.theta, covariance, since


def relinearise(state: FloatArray, layout: IntArray) -> None:
    """Fit the samples since the last change again, at 1, 2, 4 .. blocks after it while they are stored."""
    memory = Memory(state, layout)
    blocks = int(layout[ml.BLOCKS] - layout[ml.FROM_BLOCK]) - 1
    if blocks < 1:  # the change is so new that nothing has counted yet
        layout[ml.REFIT_AT] = layout[ml.COUNT] + memory.block
        return
    if blocks > memory.stored:
        layout[ml.REFIT_AT] = ml.NEVER
        return
    prior = memory.older_than(blocks)
    theta = memory.theta.copy()
    refit = fit_again(memory, Stretch(blocks, theta, onset=-1), prior, theta, memory.variance)  # began before
    memory.adopt(refit, prior, memory.variance)
    layout[ml.REFIT_AT] = layout[ml.COUNT] + blocks * memory.block
