"""Sticking valves as the search for them compares them: model, band, jump, first positions, and their cost."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class Place:
    """One sticking valve.

    Attributes
    ----------
    model : int
        Of :mod:`lostmotion.kernels.stiction`.
    band, jump : float
    rests : tuple of float
        First position in each segment, in halves of the band from its middle.
    cost : float
        Minus log-likelihood of the profile, up to a constant.
    squares : float
        Residual sum of squares.
    """

    model: int
    band: float
    jump: float
    rests: tuple[float, ...]
    cost: float
    squares: float


@dataclass(frozen=True)
class Places:
    """Many of them, row by row; as in :class:`Place`.

    Attributes
    ----------
    models : ndarray, shape (n,)
    etas : ndarray, shape (n, 2)
        Bands and jumps.
    rests : ndarray, shape (n, s)
    costs, squares : ndarray, shape (n,)
    """

    models: IntArray
    etas: FloatArray
    rests: FloatArray
    costs: FloatArray
    squares: FloatArray

    def __getitem__(self, at: int) -> Place:
        """One of them."""
        band, jump = self.etas[at].tolist()
        rests = tuple(self.rests[at].tolist())
        return Place(int(self.models[at]), band, jump, rests, float(self.costs[at]), float(self.squares[at]))

    def __iter__(self) -> Iterator[Place]:
        """All of them."""
        return (self[at] for at in range(self.costs.size))

    @property
    def best(self) -> Place:
        """The one of least cost."""
        return self[int(np.argmin(self.costs))]

    def taken(self, rows: IntArray) -> Places:
        """Some of them."""
        return Places(self.models[rows], self.etas[rows], self.rests[rows], self.costs[rows], self.squares[rows])

    def joined(self, *others: Places) -> Places:
        """These and others."""
        every = (self, *others)
        return Places(
            np.concatenate([one.models for one in every]),
            np.concatenate([one.etas for one in every]),
            np.concatenate([one.rests for one in every]),
            np.concatenate([one.costs for one in every]),
            np.concatenate([one.squares for one in every]),
        )

    def in_segments(self, number: int) -> Places:
        """The same valves in so many segments: where those are others, a first position is only where to begin."""
        known = self.rests.shape[1]
        rests = self.rests if known == number else np.repeat(self.rests[:, :1], number, axis=1)
        return Places(self.models, self.etas, rests, self.costs, self.squares)

    def apart(self, reach: float, most: int) -> Places:
        """The best of them that are not in a box about a better one, best first."""
        order = np.argsort(self.costs, kind="stable")
        models, (bands, jumps) = self.models[order], self.etas[order].T
        sizes = np.log(np.maximum(bands, 1e-300))
        kept: list[int] = []
        open_, at = np.ones(order.size, bool), 0
        while len(kept) < most and open_[at]:
            kept.append(int(order[at]))
            near = np.abs(sizes - sizes[at]) < reach
            near &= (np.abs(jumps - jumps[at]) < 1.5 * reach * bands) & (models == models[at])
            open_ &= ~near
            open_[at] = False
            at = int(np.argmax(open_))
        return self.taken(np.array(kept))


def cost_of(place: Place) -> float:
    """Minus log-likelihood of a place."""
    return place.cost
