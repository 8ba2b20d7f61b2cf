"""Global search for a sticking valve: band, jump and first position, by the profile of a high-order ARX.

The likelihood of a valve that slips is a funnel about a tenth of the band wide with rough sides, and at its bottom a
needle: a slip must be in its sample. A grid that is fine enough for the needle is too fine to be tried everywhere, so
boxes of random places shrink about the best of a coarse one. Where the valve rests at first sets the time of its first
slips, and with them that of many after: it is sought beside band and jump, on rows that leave out the beginning, where
it matters most, until the other two are found.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.actuators.memory_family import LARGEST, SMALLEST
from lostmotion.identify.actuators.operator_profile import RIDGE, TAIL, LaggedRegression
from lostmotion.identify.actuators.polish import MOST_SEGMENTS
from lostmotion.identify.actuators.slip_draws import FEWEST_TURNS, even_draws, spaced_rests
from lostmotion.identify.likelihood.arx_gram import Lags
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels.products import explained
from lostmotion.kernels.slips import add_slip_table, trace
from lostmotion.kernels.stiction import HE, KANO

MOST_ROWS = 20_000  # of the profile: its cost hardly depends on them
BANDS = 60  # over the range of OP, 8 % apart: the funnel is wider
SHARES = (0.04, 0.12, 0.22, 0.33, 0.45, 0.57, 0.7, 0.85, 1.0)  # jump over band
RESTS = (-0.6, 0.0, 0.6)  # of the grid
# half the width of a box, relative to the band, and how many places are the middle of one
BOXES = ((0.05, 40), (0.03, 24), (0.018, 14), (0.011, 8), (0.006, 5))
FUNNEL = 0.02  # nearer places are in one funnel, of which one is enough
APART = 0.06  # the same of those that are settled
DRAWS = 24  # places in a box
JUMP_REACH, REST_REACH = 2.0, 10.0  # of a box: its other sides, in units of the first
RESTS_AGAIN = 8  # of every place, once, when the boxes have begun to shrink
LARGEST_SHARE = 1.5  # jump over band in boxes
SCANT = 6.0  # of log-likelihood over the linear model: with less after the first boxes there is nothing to sharpen
SKIPPED, SKIPPED_SHARE = 400, 0.1  # rows left out at the beginning of a segment, at most
FINAL_RESTS = 81  # over the whole band, for the places found
FINAL_BOXES = (0.006, 0.003, 0.0015)
LATER_RESTS = 9  # the same in other segments than the first
SCANS = 2  # of one parameter after the other over all that it can be
SCAN_BANDS = np.geomspace(0.88, 1.12, 61)
SCAN_SHARES = np.linspace(0.0, 1.2, 61)
MOST = 3  # places that are settled


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

    def near(self, other: Place, reach: float) -> bool:
        """Whether the other one is in a box about this one."""
        return (
            self.model == other.model
            and abs(np.log(self.band / other.band)) < reach
            and abs(self.jump - other.jump) < 1.5 * reach * self.band
        )


@dataclass(frozen=True)
class SlipProfile:
    """Profile over places, on one set of rows.

    Attributes
    ----------
    regression : LaggedRegression
    u : ndarray, shape (n,)
    segments : ndarray, shape (s, 2)
        At their heads the valve begins; the rows of the regression may begin later.
    """

    regression: LaggedRegression
    u: FloatArray
    segments: IntArray

    @cached_property
    def _totals(self) -> FloatArray:
        return np.concatenate([[0.0], np.cumsum(self.regression.y)])

    @cached_property
    def _room(self) -> tuple[FloatArray, FloatArray, IntArray]:
        longest = int((self.segments[:, 1] - self.segments[:, 0]).max())
        return np.empty(longest), np.empty(longest + 1), np.empty(longest, np.int64)

    @cached_property
    def _blocks(self) -> list[tuple[int, int, int, int]]:
        """Index and first row of the segment of every block of rows, and the block."""
        heads = self.segments[:, 0]
        found = [
            (int(np.searchsorted(heads, first, "right")) - 1, first, stop) for first, stop in self.regression.blocks
        ]
        return [(index, int(heads[index]), first, stop) for index, first, stop in found]

    def place(self, model: int, band: float, jump: float, rests: tuple[float, ...]) -> Place:
        """A place and its cost."""
        regression, (x, sums, slips) = self.regression, self._room
        lags = regression.lags
        table = np.zeros((lags.outputs + lags.inputs + 2, lags.inputs))
        turned = 0
        for index, head, first, stop in self._blocks:
            rest = rests[index] if index < len(rests) else 0.0
            start = self.u[head] + 0.5 * rest * (band + jump)
            part = x[: stop - head]
            count, turns = trace(model, self.u[head:stop], band, jump, start, part, sums, slips)
            turned += turns
            totals = self._totals[head : stop + 1]
            add_slip_table(
                part,
                sums,
                slips,
                count,
                totals,
                lags.outputs,
                lags.delay,
                lags.inputs,
                first - head,
                stop - head,
                table,
            )
        if turned < FEWEST_TURNS:
            return Place(model, band, jump, rests, np.inf, np.inf)
        floor = RIDGE * regression.samples
        squares = regression.alone - explained(table, regression.basis, regression.explained, floor, RIDGE)
        return Place(model, band, jump, rests, _minus_log_likelihood(regression, squares), squares)

    def again(self, other: Place) -> Place:
        """A place of another profile."""
        return self.place(other.model, other.band, other.jump, other.rests)

    def about(self, middle: Place, reach: float, draws: FloatArray) -> list[Place]:
        """Places in a box about another."""
        found = []
        for by_band, by_jump, by_rest in draws.tolist():
            band = middle.band * (1.0 + reach * by_band)
            jump = middle.jump + JUMP_REACH * reach * middle.band * by_jump
            moved = min(REST_REACH * reach, 1.0) * by_rest
            rests = tuple(min(max(rest + moved, -1.0), 1.0) for rest in middle.rests)
            found.append(self.place(middle.model, band, min(max(jump, 0.0), LARGEST_SHARE * band), rests))
        return found

    def scanned(self, middle: Place, bands: Iterable[float], jumps: Iterable[float]) -> Place:
        """The best of these bands and jumps."""
        found = [self.place(middle.model, float(b), float(j), middle.rests) for b in bands for j in jumps]
        return min([middle, *found], key=_cost)

    def rested(self, middle: Place, rests: Iterable[float], index: int | None = None) -> Place:
        """The best first position, in all segments or in one."""
        found = [middle]
        for rest in rests:
            trial = [rest if index is None or index == at else other for at, other in enumerate(middle.rests)]
            found.append(self.place(middle.model, middle.band, middle.jump, tuple(trial)))
        return min(found, key=_cost)


def seek_slips(late: SlipProfile, whole: SlipProfile, span: float) -> list[Place]:
    """Best places apart from each other, best first.

    Parameters
    ----------
    late, whole : SlipProfile
        On rows that leave out the beginning, and on all.
    span : float
        Range of OP without its tails.
    """
    draws = even_draws(DRAWS * sum(most for _, most in BOXES))
    live, at = _coarse(late, span), 0
    linear = _minus_log_likelihood(late.regression, late.regression.squares(late.u))
    for step, (reach, most) in enumerate(BOXES):
        if step and min(live, key=_cost).cost > linear - SCANT:
            return [_settled(whole, min(live, key=_cost))]
        live = _apart(live, max(reach, FUNNEL), most)
        if step == 1:
            live = [late.rested(place, np.linspace(-1.0, 1.0, RESTS_AGAIN).tolist()) for place in live]
        for place in list(live):
            live += late.about(place, reach, draws[at : at + DRAWS])
            at += DRAWS
    return sorted((_settled(whole, place) for place in _apart(live, APART, MOST)), key=_cost)


def _coarse(profile: SlipProfile, span: float) -> list[Place]:
    """Places of a grid with He's valve, and the best of them with Kano's.

    A valve of a smaller band than OP moves in a sample would slip all the time.
    """
    segments = min(len(profile.segments), MOST_SEGMENTS)
    moves = np.concatenate([np.diff(profile.u[start:stop]) for start, stop in profile.segments.tolist()])
    smallest = max(SMALLEST * span, min(float(np.sqrt(np.mean(moves**2))), 0.5 * LARGEST * span))
    number = max(round(BANDS * np.log(LARGEST * span / smallest) / np.log(LARGEST / SMALLEST)), 2)
    found = [
        profile.place(HE, float(band), share * float(band), (rest,) * segments)
        for band in np.geomspace(smallest, LARGEST * span, number)
        for share in SHARES
        for rest in RESTS
    ]
    best = _apart(found, *BOXES[0])
    return [*best, *(profile.place(KANO, place.band, place.jump, place.rests) for place in best)]


def _settled(profile: SlipProfile, place: Place) -> Place:
    """A place on all rows, with the first position of every segment."""
    best, draws = profile.again(place), even_draws(DRAWS)
    for _ in range(SCANS):
        before = best
        for index in range(len(best.rests)):
            start, stop = profile.segments[index].tolist()
            most = FINAL_RESTS if index == 0 else LATER_RESTS
            best = profile.rested(best, spaced_rests(profile.u[start:stop], best.band, best.jump, most), index)
        best = profile.scanned(best, best.band * SCAN_BANDS, [best.jump])
        best = profile.scanned(best, [best.band], best.band * SCAN_SHARES)
        if best is before:
            break
    for reach in FINAL_BOXES:
        best = min([best, *profile.about(best, reach, draws)], key=_cost)
    return best


def _apart(places: list[Place], reach: float, most: int) -> list[Place]:
    """The best of them that are not near a better one."""
    kept: list[Place] = []
    for place in sorted(places, key=_cost):
        if not any(place.near(other, reach) for other in kept):
            kept.append(place)
        if len(kept) == most:
            break
    return kept


def _minus_log_likelihood(regression: LaggedRegression, squares: float) -> float:
    """Minus that of the profile, up to a constant."""
    return 0.5 * regression.samples * float(np.log(max(squares, 1e-300)))


def _cost(place: Place) -> float:
    return place.cost


def slips_of(data: ScaledData, lags: Lags) -> list[Place]:
    """Best places of a record apart from each other, best first."""
    late = data.segments.copy()
    lengths = late[:, 1] - late[:, 0]
    late[:, 0] += np.minimum(SKIPPED, (SKIPPED_SHARE * lengths).astype(np.int64))
    low, high = (float(value) for value in np.quantile(data.u, [TAIL, 1.0 - TAIL]))
    span = high - low if high > low else float(np.ptp(data.u))
    whole = SlipProfile(LaggedRegression.on(data, lags, MOST_ROWS), data.u, data.segments)
    later = SlipProfile(LaggedRegression.on(replace(data, segments=late), lags, MOST_ROWS), data.u, data.segments)
    return seek_slips(later, whole, span)
