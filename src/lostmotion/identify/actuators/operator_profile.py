"""Profile of the residual variance over the parameters of any actuator, by high-order ARX.

The past of PV and a constant are projected out once; every candidate is then one small regression on its own lagged
internal variable.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.actuators.memory_family import MemoryFamily
from lostmotion.identify.actuators.polish import MOST_SEGMENTS
from lostmotion.identify.actuators.sought import Sought
from lostmotion.identify.likelihood.arx_gram import Lags
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.in_row import answers_in_row
from lostmotion.identify.likelihood.remembered import remembered
from lostmotion.identify.scaled import ScaledData, Signals
from lostmotion.kernels.products import explained_by_lags

MOST_ROWS = 6000  # of the profile: it only makes starts
RIDGE = 1e-9  # relative; keeps noise-free Gram matrices invertible, as in static_profile
SMALLEST_DIRECTION = 1e-7  # of the past of PV, relative
GRID_ROWS = 2000  # of a record in which two places where a valve may begin are enough
FIRST_REACH, SMALLEST_REACH = 0.04, 0.004  # of the pattern search, relative
TAIL = 0.005  # on either side of the range
FIRST_RESTS, LONG_RESTS = (-0.6, 0.6), (-0.6, 0.6, 0.0)
RESTS = (0.0, -1.0, -0.75, -0.5, -0.25, 0.25, 0.5, 0.75, 1.0)  # of half the band
MOST_STARTS = 2  # of a kind: the best of the profile and the best one apart from it
AUTO_LAGS = 30  # past inputs of the profile where the delay is unknown
MARGIN = 30.0  # of log-likelihood: what is further behind the best is no start


@dataclass(frozen=True)
class LaggedRegression:
    """PV without what its own past explains.

    Attributes
    ----------
    blocks : list of (int, int)
        Start and stop of the predicted rows, one for each segment.
    basis : ndarray, shape (k, m)
        Takes the constant and the lags of PV to orthonormal columns.
    explained : ndarray, shape (m,)
        Products of these columns with PV.
    alone : float
        Sum of squares without any actuator.
    """

    lags: Lags
    y: FloatArray
    blocks: list[tuple[int, int]]
    basis: FloatArray
    explained: FloatArray
    alone: float

    @classmethod
    def on(cls, signals: Signals, lags: Lags, most: int = MOST_ROWS) -> LaggedRegression:
        """Project out constant and past of y."""
        y, blocks = signals.y, _blocks(signals.segments, lags.head, most)
        rows = np.concatenate([np.arange(start, stop) for start, stop in blocks])
        past = np.column_stack([np.ones(rows.size), y[rows[:, None] - 1 - np.arange(lags.outputs)]])
        scale = np.sqrt((past**2).mean(axis=0))
        scale[scale == 0] = 1.0
        left, sizes, right = np.linalg.svd(past / scale, full_matrices=False)
        kept = sizes > SMALLEST_DIRECTION * sizes[0]
        left = left[:, kept]
        explained = left.T @ y[rows]
        target = y[rows] - left @ explained
        basis = np.ascontiguousarray((right[kept] / sizes[kept, None] / scale).T)  # as the kernel reads it
        return cls(lags, y, blocks, basis, explained, float(target @ target))

    @cached_property
    def samples(self) -> int:
        """Predicted rows."""
        return sum(stop - start for start, stop in self.blocks)

    def squares(self, x: FloatArray) -> float:
        """Sum of squares with the lagged internal variable x (n,)."""
        lags, floor = self.lags, RIDGE * self.samples
        explained = explained_by_lags(
            self.y, lags.outputs, x, lags.delay, lags.inputs, self._rows, self.basis, self.explained, floor, RIDGE
        )
        return max(self.alone - explained, 0.0)  # of a record without noise rounding may leave less than nothing

    @cached_property
    def _rows(self) -> IntArray:
        return np.array(self.blocks)


def _blocks(segments: IntArray, head: int, most: int) -> list[tuple[int, int]]:
    """Rows with a complete past, `most` at most."""
    blocks, room = [], most
    for start, stop in segments.tolist():
        end = min(stop, start + head + room)
        if end > start + head:
            blocks.append((start + head, end))
            room -= end - start - head
    return blocks


def lags_of(data: ScaledData, asked: Asked) -> Lags:
    """Lags of the profile for what is asked."""
    if asked.orders is None:
        return Lags.for_record(data.shortest, 0 if answers_in_row(data) else 1, inputs=AUTO_LAGS)
    return Lags.for_record(data.shortest, asked.orders[2])


@remembered
def regression(data: ScaledData, asked: Asked) -> LaggedRegression:
    """PV without its own past, for profiles."""
    return LaggedRegression.on(data, lags_of(data, asked))


def seek(data: ScaledData, asked: Asked, families: Sequence[Family]) -> Sought:
    """Global search for the actuator by the profiles of its forms, over the grid of each."""
    lagged = regression(data, asked)
    profiles = [operator_profile(lagged, family, data.u, MOST_STARTS) for family in families]
    family, starts = min(profiles, key=lambda item: item[1][0].squares)
    return Sought(family, [start.eta for start in starts], starts[0].squares)


@dataclass(frozen=True)
class Start:
    """A minimum of the profile."""

    eta: FloatArray
    squares: float
    family: Family


def operator_profile(
    regression: LaggedRegression, family: Family, u: FloatArray, most: int
) -> tuple[Family, list[Start]]:
    """Best parameters of one kind of actuator, best first: a grid, then a finer one about its best points.

    The family comes back with the rests of the best point of the grid.
    """
    low, high = (float(value) for value in np.quantile(u, [TAIL, 1.0 - TAIL]))
    span = high - low if high > low else float(np.ptp(u))  # OP may rest nearly always
    first, finer = family.grid(u, span, regression.samples)
    end = regression.blocks[-1][1]  # what comes later does not count
    x = np.empty(end)

    def score(etas: list[FloatArray], member: Family) -> list[Start]:
        found, short = [], _until(member, end)
        for eta in etas:
            valid = member.project(eta)
            short.path(valid, u[:end], x)
            found.append(Start(valid, regression.squares(x), member))
        return sorted(found, key=lambda start: start.squares)

    members = _at_rests(family, FIRST_RESTS if regression.samples <= GRID_ROWS else LONG_RESTS)
    coarse = score(first, members[0])
    for member in members[1:]:  # where it rests at first matters little to most: only the better half once more
        coarse += score([start.eta for start in coarse[: len(first) // 2]], member)
    coarse = _apart(sorted(coarse, key=lambda start: start.squares), regression.samples, 3 * most, np.inf)
    fine = [start for each in coarse for start in score(finer(each.eta), each.family)[:1]]
    settled = [settle_rests(regression, start.family, start.eta, u) for start in fine]
    best = [start for each, member in zip(fine, settled, strict=True) for start in score([each.eta], member)]
    best = sorted(best, key=lambda start: start.squares)[:most]
    best = sorted((_climbed(start, score) for start in best), key=lambda start: start.squares)
    return best[0].family, _apart(best, regression.samples, most)


def _until(family: Family, end: int) -> Family:
    """The family on the first rows only; segments that begin later are empty."""
    return _cut(family, end) if isinstance(family, MemoryFamily) else family


@remembered
def _cut(family: MemoryFamily, end: int) -> MemoryFamily:
    cut = np.minimum(family.segments, end)
    cut[cut[:, 0] == end] = end - 1
    return replace(family, segments=cut)


def _at_rests(family: Family, rests: tuple[float, ...]) -> list[Family]:
    """The family from several places in its band, the same in all segments."""
    if not family.resting:
        return [family]
    return [family.with_rests([rest] * family.resting) for rest in rests]


def _climbed(start: Start, score: Callable[[list[FloatArray], Family], list[Start]]) -> Start:
    """Pattern search on the profile from one start."""
    size = len(start.eta)
    moves = [sign * move for move in (*np.eye(size), *_DIAGONALS.get(size, [])) for sign in (1.0, -1.0)]
    reach = FIRST_REACH
    while reach > SMALLEST_REACH:
        scale = reach * float(np.abs(start.eta).max())
        best = score([start.eta + scale * move for move in moves], start.family)[0]
        if best.squares < start.squares:
            start = best
        else:
            reach *= 0.5
    return start


def settle_rests(regression: LaggedRegression, family: Family, eta: FloatArray, u: FloatArray) -> Family:
    """The family with the rest at the beginning of each segment that explains PV best; those without memory as is."""
    if not 0 < family.resting <= MOST_SEGMENTS:
        return family
    end = regression.blocks[-1][1]
    x, short = np.empty(end), _until(family, end)

    def squares(rests: list[float]) -> float:
        short.with_rests(rests).path(eta, u[:end], x)
        return regression.squares(x)

    rests = [*family.rests, *[0.0] * (family.resting - len(family.rests))]
    for index in range(len(rests)):
        trials = [[*rests[:index], rest, *rests[index + 1 :]] for rest in RESTS]
        rests = min(trials, key=squares)
    return family.with_rests(rests)


def _apart(starts: list[Start], samples: int, most: int, margin: float = MARGIN) -> list[Start]:
    """Starts that differ by more than an eighth of the largest parameter, near the best."""
    limit = starts[0].squares * (1.0 + 2.0 * margin / samples)
    kept: list[Start] = []
    for start in starts:
        if len(kept) == most or start.squares > limit:
            break
        size = 0.125 * float(np.abs(start.eta).max())
        if all(np.abs(start.eta - other.eta).max() > size for other in kept):
            kept.append(start)
    return kept


_DIAGONALS = {2: [np.array([1.0, 1.0]), np.array([1.0, -1.0])]}  # of stiction
