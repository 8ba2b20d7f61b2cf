"""View of the recursion's state for those who look back: what older samples say, and the newest filtered again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.recursive_ml import advance, change, drift, information, watch
from lostmotion.kernels.recursive_ml import state as ml
from lostmotion.kernels.recursive_ml.equations import RIDGE

NONE = 1e-300  # information of a parameter without any, so that it can be divided by
CONNECTED = 1e-12  # relative information below which two parameters share rounding
_REPLAY: Any = change.replay


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
    """View of the state of the recursion."""

    def __init__(self, state: FloatArray, layout: IntArray) -> None:
        self.state, self.layout = state, layout
        self.parts = ml.named(state, layout)
        self.n, self.ring, self.block = (int(layout[i]) for i in (ml.N, ml.RING, ml.BLOCK))
        self.na, self.nb1, self.delay = (int(layout[i]) for i in (ml.NA, ml.NB1, ml.DELAY))
        self.eta = self.na + self.nb1 + 1

    @property
    def theta(self) -> FloatArray:
        """Present estimate."""
        return self.parts["theta"]

    @property
    def variance(self) -> float:
        """Variance of the prediction errors."""
        return float(self.state[ml.SQUARES] / self.state[ml.WEIGHT])

    @property
    def stored(self) -> int:
        """Whole blocks that can be replayed."""
        return int(min(self.layout[ml.BLOCKS], self.ring))

    def slots(self, blocks: int) -> list[int]:
        """Places of the newest blocks in the ring, oldest first."""
        newest = int(self.layout[ml.BLOCKS])
        return [(newest - blocks + i) % self.ring for i in range(blocks)]

    def older_than(self, blocks: int) -> Prior:
        """Everything before the newest `blocks`."""
        h, r = self.parts["ref_h"].copy(), self.parts["ref_r"].copy()
        recent = set(self.slots(blocks))
        for slot in range(self.ring):
            if slot not in recent:
                h += self.parts["ring_h"][slot]
                r += self.parts["ring_r"][slot]
        scale = 1.0 / np.sqrt(np.maximum(np.diag(h), NONE))
        ridge = h * np.outer(scale, scale) + RIDGE * np.eye(self.n)
        return Prior(h, self.theta + scale * np.linalg.solve(ridge, scale * (r - h @ self.theta)))

    def replay(self, stretch: Stretch, theta: FloatArray, limit: float) -> Refit:
        """Filter a stretch again with `theta` from its onset on; errors beyond `limit` have bounded influence."""
        blocks = stretch.blocks
        h, r = np.empty((blocks, self.n, self.n)), np.empty((blocks, self.n))
        errors, snapshots = np.empty(blocks * self.block), np.empty((blocks + 1, int(self.layout[ml.FILTERS])))
        cost = _REPLAY(
            stretch.before, theta, stretch.onset, stretch.blind, limit, self.state, self.layout, blocks,
            h, r, errors, snapshots,
        )  # fmt: skip
        return Refit(theta, float(cost), h, r, errors, snapshots)

    def adopt(self, refit: Refit, prior: Prior, variance: float) -> None:
        """Go on from a refit, with `prior` for everything before it."""
        parts, blocks = self.parts, len(refit.h)
        self.refer_to(prior)
        for i, slot in enumerate(self.slots(blocks)):
            parts["ring_h"][slot], parts["ring_r"][slot] = refit.h[i], refit.r[i]
            parts["ring_filters"][slot] = refit.snapshots[i]
        parts["filters"][:] = refit.snapshots[blocks]
        self.theta[:] = refit.theta
        watch.begin_watch(self.state, self.layout)
        self.state[ml.SQUARES] = variance * self.state[ml.WEIGHT]
        self.solve()

    def refer_to(self, prior: Prior) -> None:
        """Make `prior` the reference and empty the ring of information: all that is remembered."""
        self.parts["ref_h"][:] = prior.h
        self.parts["ref_r"][:] = prior.h @ prior.centre
        self.parts["ring_h"][:], self.parts["ring_r"][:] = 0.0, 0.0
        drift.agree(self.state, self.layout)

    def solve(self) -> None:
        """Move theta to the solution of all that is remembered."""
        information.newton_step(self.state, self.layout)

    def settling(self, theta: FloatArray) -> int:
        """Samples until what is not known about the command no longer matters."""
        return int(advance.settling(theta, self.na, self.nb1, self.delay))

    @property
    def span(self) -> tuple[float, float]:
        """Range of u seen."""
        return float(self.state[ml.LOW]), float(self.state[ml.HIGH])


def forget(prior: Prior, names: list[int], weak: FloatArray) -> Prior:
    """What is known about the other parameters when nothing is known about `names` but a weak prior."""
    h, n = prior.h, prior.centre.size
    rest = [i for i in range(n) if i not in names]
    result = np.zeros_like(h)
    scale = np.sqrt(np.maximum(np.diag(h), NONE))
    scaled = h / np.outer(scale, scale)
    gone = np.linalg.pinv(scaled[np.ix_(names, names)], rcond=CONNECTED, hermitian=True)
    cross = scaled[np.ix_(rest, names)]
    left = scaled[np.ix_(rest, rest)] - cross @ gone @ cross.T
    result[np.ix_(rest, rest)] = 0.5 * (left + left.T) * np.outer(scale[rest], scale[rest])
    result[names, names] = weak[names]
    return Prior(result, prior.centre)
