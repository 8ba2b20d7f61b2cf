"""Global search for a sticking valve: band, jump and first position, by the profile of a high-order ARX.

The likelihood of a valve that slips is a funnel about a tenth of the band wide with rough sides, and at its bottom a
needle: a slip must be in its sample. A grid that is fine enough for the needle is too fine to be tried everywhere, so
boxes of random places shrink about the best of a coarse one. Where the valve rests at first sets the time of its first
slips, and with them that of many after: it is sought beside band and jump, on rows that leave out the beginning, where
it matters most, until the other two are found.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.actuators.memory_family import LARGEST, SMALLEST
from lostmotion.identify.actuators.operator_profile import RIDGE, TAIL, LaggedRegression
from lostmotion.identify.actuators.polish import MOST_SEGMENTS
from lostmotion.identify.actuators.slip_draws import FEWEST_TURNS, even_draws, spaced_rests
from lostmotion.identify.actuators.slip_places import Place, Places, cost_of
from lostmotion.identify.likelihood.arx_gram import Lags
from lostmotion.identify.likelihood.excerpt import excerpt
from lostmotion.identify.likelihood.remembered import remembered_of_signals
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels.slip_table import LAGS, explained_by_slips
from lostmotion.kernels.stiction import HE, HE_RAMP, KANO

MOST_ROWS = 20_000  # of the profile
# the liveliest of them, on which a place is sought before it is settled on all: of 40 simulated loops of 20,000 rows
# the end was as good in all that any valve explains by over 30 but one (565 for 580), in two better by 280 and 980
LIVELY_ROWS = 10_000
PAYS, GLIDES, PLAYS = (
    15.0,
    1e-3,
    25,
)  # of log-likelihood for a jump; that of a play, in widths, of which so many are tried
BANDS = 60  # over the range of OP, 8 % apart: the funnel is wider
SHARES = (0.04, 0.12, 0.22, 0.33, 0.45, 0.57, 0.7, 0.85, 1.0)  # jump over band
SHARES_BETWEEN = (0.1, 0.25, 0.45, 0.7, 1.0)  # the same between the rows, where a slip is no needle
RESTS = (-0.6, 0.0, 0.6)  # of the grid
# half the width of a box, relative to the band, and how many places are the middle of one
BOXES = ((0.05, 40), (0.03, 24), (0.018, 14), (0.011, 8), (0.006, 5))
NEARLY = 0.45  # of what the best place gains: then places between the rows are worth a search
BOXES_BETWEEN = ((0.05, 24), (0.03, 16), (0.018, 10), (0.011, 6), (0.006, 4))  # the same between the rows
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
    def linear(self) -> float:
        """Cost of a valve that follows OP."""
        return float(_minus_log_likelihood(self.regression, self.regression.squares(self.u)))

    @cached_property
    def _totals(self) -> FloatArray:
        return np.concatenate([[0.0], np.cumsum(self.regression.y), np.zeros(LAGS)])

    @cached_property
    def _pieces(self) -> IntArray:
        """Index and first row of the segment of every block of rows, and the block."""
        heads, blocks = self.segments[:, 0], np.array(self.regression.blocks)
        indices = np.searchsorted(heads, blocks[:, 0], "right") - 1
        return np.column_stack([indices, heads[indices], blocks]).astype(np.int64)

    def places(self, models: ArrayLike, bands: ArrayLike, jumps: ArrayLike, rests: FloatArray) -> Places:
        """Places and their costs; one model, band or jump may stand for all, `rests` are (n, s)."""
        regression, count = self.regression, len(rests)
        codes = np.broadcast_to(np.asarray(models, np.int64), count).copy()
        etas = np.column_stack([np.broadcast_to(bands, count), np.broadcast_to(jumps, count)])
        etas[:, 1] = np.where(codes == HE_RAMP, np.minimum(etas[:, 1], etas[:, 0]), etas[:, 1])
        lags, floor = regression.lags, RIDGE * regression.samples
        squares = regression.alone - explained_by_slips(
            codes, etas, rests, self.u, self._totals, self._pieces, lags.outputs, lags.delay, lags.inputs,
            regression.basis, regression.explained, floor, RIDGE, FEWEST_TURNS,
        )  # fmt: skip
        return Places(codes, etas, rests, _minus_log_likelihood(regression, squares), squares)

    def place(self, model: int, band: float, jump: float, rests: tuple[float, ...]) -> Place:
        """A place and its cost."""
        return self.places(model, band, jump, np.array([rests], float))[0]

    def about(self, middles: Places, reach: float, draws: FloatArray) -> Places:
        """Places in boxes about others: of `draws` every one gets as many."""
        each = len(draws) // middles.costs.size
        by_band, by_jump, by_rest = draws[: each * middles.costs.size].T
        models, rests = np.repeat(middles.models, each), np.repeat(middles.rests, each, axis=0)
        around, jumps = np.repeat(middles.etas, each, axis=0).T
        bands = around * (1.0 + reach * by_band)
        jumps = np.clip(jumps + JUMP_REACH * reach * around * by_jump, 0.0, LARGEST_SHARE * bands)
        moved = min(REST_REACH * reach, 1.0) * by_rest[:, None]
        return self.places(models, bands, jumps, np.clip(rests + moved, -1.0, 1.0))

    def banded(self, middle: Place, bands: FloatArray) -> Place:
        """The best band."""
        rests = np.tile(np.array(middle.rests), (bands.size, 1))
        return _better(middle, self.places(middle.model, bands, middle.jump, rests))

    def jumped(self, middle: Place, jumps: FloatArray) -> Place:
        """The best jump, with the same first slip where that can be: one needle of both is thinner than either."""
        rests = self.slipping(middle, 0.5 * (middle.band + jumps))
        return _better(middle, self.places(middle.model, middle.band, jumps, rests))

    def slipping(self, place: Place, reaches: FloatArray) -> FloatArray:
        """First positions (n, s) from which valves that reach as far, (S + J) / 2, slip first where this one does."""
        found = np.empty((reaches.size, len(place.rests)))
        reach = 0.5 * (place.band + place.jump)
        for index, rest in enumerate(place.rests):
            start, stop = self.segments[index].tolist()
            away = self.u[start:stop] - self.u[start] - rest * reach
            first = int(np.argmax(np.abs(away) > reach))
            side = float(np.sign(away[first])) if abs(away[first]) > reach else 0.0
            edge = rest * reach + side * reach
            found[:, index] = np.clip((edge - side * reaches) / reaches, -1.0, 1.0) if side else rest
        return found

    def rested(self, middle: Place, rests: Sequence[float], index: int | None = None) -> Place:
        """The best first position, in all segments or in one."""
        trials = np.tile(np.array(middle.rests), (len(rests), 1))
        trials[:, slice(None) if index is None else slice(index, index + 1)] = np.reshape(rests, (-1, 1))
        return _better(middle, self.places(middle.model, middle.band, middle.jump, trials))


def seek_slips(late: SlipProfile, whole: SlipProfile, span: float) -> list[Place]:
    """Best places apart from each other, best first.

    Those of a valve that slips between the rows only where one is best, and its jump pays: a play that follows OP
    between the rows explains more than one that follows it in steps, too. They are sought by themselves, where they
    crowd nothing out, as their likelihood has no needles; and only where a coarse grid of them explains nearly as much.

    Parameters
    ----------
    late, whole : SlipProfile
        On rows that leave out the beginning, and on all.
    span : float
        Range of OP without its tails.
    """
    live, between = _shrunk(late, _coarse(late, span), BOXES), _coarse_between(late, span)
    gained, more = late.linear - float(live.costs.min()), late.linear - float(between.costs.min())
    found = _settled(late, whole, live)
    if more < max(NEARLY * gained, SCANT):
        return found
    between = _shrunk(late, between, BOXES_BETWEEN)
    best = _settled(late, whole, between, 1)[0]  # without needles the best before it is settled is the best after
    if best.cost < found[0].cost and _jumps(whole, best):
        return sorted([*_settled(late, whole, between), *found], key=cost_of)
    return found


def _shrunk(late: SlipProfile, live: Places, boxes: tuple[tuple[float, int], ...]) -> Places:
    """The best of boxes that shrink about places."""
    draws, at = even_draws(DRAWS * sum(most for _, most in boxes)), 0
    for step, (reach, most) in enumerate(boxes):
        if step and live.costs.min() > late.linear - SCANT:
            break
        live = live.apart(max(reach, FUNNEL), most)
        if step == 1:
            live = _rested(late, live)
        trials = DRAWS * live.costs.size
        live = live.joined(late.about(live, reach, draws[at : at + trials]))
        at += trials
    return live


def _settled(late: SlipProfile, whole: SlipProfile, live: Places, most: int = MOST) -> list[Place]:
    """The best of them on all rows, best first; one, where there is nothing to sharpen."""
    most = most if live.costs.min() <= late.linear - SCANT else 1
    places = live.apart(APART, most).in_segments(min(len(whole.segments), MOST_SEGMENTS))
    return sorted((settled_place(whole, place) for place in places), key=cost_of)


def _jumps(profile: SlipProfile, place: Place) -> bool:
    """Whether a valve that slips between the rows explains more than one that glides there."""
    widths = np.linspace(max(place.band - place.jump, 0.5 * place.band), 1.1 * place.band, PLAYS)
    widths = np.repeat(widths, RESTS_AGAIN)
    rests = np.tile(np.linspace(-1.0, 1.0, RESTS_AGAIN), PLAYS)[:, None].repeat(len(place.rests), axis=1)
    glides = profile.places(HE_RAMP, widths, GLIDES * widths, rests)
    return bool(glides.costs.min() > place.cost + PAYS)


def _rested(profile: SlipProfile, places: Places) -> Places:
    """The same places with the best first position of each."""
    number, moves = places.costs.size, np.linspace(-1.0, 1.0, RESTS_AGAIN)
    rows = np.repeat(np.arange(number), RESTS_AGAIN)
    rests = np.repeat(np.tile(moves, number)[:, None], places.rests.shape[1], axis=1)
    bands, jumps = places.etas[rows].T
    trials = profile.places(places.models[rows], bands, jumps, rests)
    best = np.argmin(trials.costs.reshape(number, RESTS_AGAIN), axis=1) + RESTS_AGAIN * np.arange(number)
    every = places.joined(trials)
    better = trials.costs[best] < places.costs
    return every.taken(np.where(better, number + best, np.arange(number)))


def _coarse(profile: SlipProfile, span: float) -> Places:
    """Places of a grid with He's valve, and the best of them with Kano's."""
    best = _of_grid(profile, HE, _bands(profile, span), SHARES)
    return best.joined(profile.places(KANO, best.etas[:, 0], best.etas[:, 1], best.rests))


def _coarse_between(profile: SlipProfile, span: float) -> Places:
    """Places of a coarser grid with He's valve between the rows."""
    return _of_grid(profile, HE_RAMP, _bands(profile, span)[::2], SHARES_BETWEEN)


def _bands(profile: SlipProfile, span: float) -> FloatArray:
    """Of a grid; a valve of a smaller band than OP moves in a sample would slip all the time."""
    moves = np.concatenate([np.diff(profile.u[start:stop]) for start, stop in profile.segments.tolist()])
    smallest = max(SMALLEST * span, min(float(np.sqrt(np.mean(moves**2))), 0.5 * LARGEST * span))
    number = max(round(BANDS * np.log(LARGEST * span / smallest) / np.log(LARGEST / SMALLEST)), 2)
    return np.geomspace(smallest, LARGEST * span, number)


def _of_grid(profile: SlipProfile, model: int, tried: FloatArray, shares: tuple[float, ...]) -> Places:
    """The best places of bands, jumps and first positions."""
    bands, jumps, rests = np.meshgrid(tried, shares, RESTS, indexing="ij")
    begun = np.repeat(rests.reshape(-1, 1), min(len(profile.segments), MOST_SEGMENTS), axis=1)
    return profile.places(model, bands.ravel(), (jumps * bands).ravel(), begun).apart(*BOXES[0])


def settled_place(profile: SlipProfile, place: Place) -> Place:
    """A place on all rows, with the first position of every segment."""
    best, draws = profile.place(place.model, place.band, place.jump, place.rests), even_draws(DRAWS)
    for _ in range(SCANS):
        before = best
        for index in range(len(best.rests)):
            start, stop = profile.segments[index].tolist()
            most = FINAL_RESTS if index == 0 else LATER_RESTS
            best = profile.rested(best, spaced_rests(profile.u[start:stop], best.band, best.jump, most), index)
        best = profile.banded(best, best.band * SCAN_BANDS)
        best = profile.jumped(best, best.band * SCAN_SHARES)
        if best is before:
            break
    for reach in FINAL_BOXES:
        middle = profile.places(best.model, best.band, best.jump, np.array([best.rests]))
        best = _better(best, profile.about(middle, reach, draws))
    return best


def _better(place: Place, others: Places) -> Place:
    """The best of all."""
    return min(place, others.best, key=cost_of) if others.costs.size else place


def _minus_log_likelihood(regression: LaggedRegression, squares: FloatArray | float) -> FloatArray:
    """Minus that of the profile, up to a constant."""
    return 0.5 * regression.samples * np.log(np.maximum(squares, 1e-300))


@remembered_of_signals
def slips_of(data: ScaledData, lags: Lags) -> list[Place]:
    """Best places of a record apart from each other, best first."""
    rows = excerpt(data, LIVELY_ROWS)
    late, lengths = rows.copy(), rows[:, 1] - rows[:, 0]
    late[:, 0] += np.minimum(SKIPPED, (SKIPPED_SHARE * lengths).astype(np.int64))
    later = SlipProfile(LaggedRegression.on(replace(data, segments=late), lags, MOST_ROWS), data.u, rows)
    return seek_slips(later, profile_of(data, lags), range_of(data))


def profile_of(data: ScaledData, lags: Lags) -> SlipProfile:
    """On all rows."""
    return SlipProfile(LaggedRegression.on(data, lags, MOST_ROWS), data.u, data.segments)


def range_of(data: ScaledData) -> float:
    """Range of OP without its tails."""
    low, high = (float(value) for value in np.quantile(data.u, [TAIL, 1.0 - TAIL]))
    return high - low if high > low else float(np.ptp(data.u))
