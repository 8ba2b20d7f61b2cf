"""Global search: profile of the residual variance over the break points, by high-order ARX.

A high-order ARX needs no orders, no noise model and no start values, and is consistent in closed loop. The two
sides of the dead zone are inputs of their own, so the slope ratio is free; their sum is the dead zone of equal slopes,
likelier and half as many inputs, which noise-free feedback tells better. All grid points share one Gram matrix of
lagged hinge functions, from which past outputs are eliminated once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.actuators.bends import Hinges, Jumps
from lostmotion.identify.actuators.paired_inputs import regress_on_pairs
from lostmotion.identify.likelihood.arx_gram import Lags
from lostmotion.identify.scaled import ScaledData

KNOTS = 16  # 136 pairs; a local search from the nearest knot converges for widths of a tenth of the range
ZOOM_KNOTS = 9  # on two knots of the coarse grid: a quarter of its spacing
MOST_STARTS = 3  # minima of the profile within START_MARGIN that are refined
NEAR_RATIO = 0.7  # of the log: slopes nearer than this climb to the same place
# places of the jump over the range of OP, 1.6 % apart: zones of 2 to 3 % are missed by KNOTS (docs/method.md, "narrow
# zones")
NARROW_KNOTS = 60
SMALLEST_SPACING = 1e-12  # OP may rest nearly always
MOST_NARROW = 2  # of them, four spacings apart: noise makes the others
NARROW_ROWS = 8192  # enough to place a narrow zone; the likelihood then takes all rows
# spacings of the grid that a narrower zone is near, and log-likelihood by which a wider one leaves these behind
FEW_KNOTS, BEYOND_DOUBT = 2, 100.0
START_MARGIN = 12.0  # grid minima this much worse in log-likelihood are not worth a start


@dataclass(frozen=True)
class Candidate:
    """A minimum of the profile: break points, log of left/right gain, residual sum of squares.

    Where the slopes are free, `rss` is raised by what the inputs of the second side may explain by chance (Akaike).
    """

    left: float
    right: float
    log_ratio: float
    rss: float


def profile(data: ScaledData, lags: Lags, low: float, high: float) -> list[Candidate]:
    """Minima of the residual sum of squares over left <= right in [low, high], best first.

    A grid finds wide dead zones, a scan of the location of a jump finds those narrower than the grid.
    """
    knots = np.linspace(low, high, KNOTS)
    coarse, samples = _scan(data, lags, knots, knots)
    spacing = knots[1] - knots[0]
    places = [(surface.rss[place], *place) for surface in coarse for place in _minima(surface.rss, samples)]
    best = list(dict.fromkeys((row, column) for _, row, column in sorted(places)))[: MOST_STARTS + 1]
    centres = [(knots[row], knots[column], spacing) for row, column in best]
    if not _is_wide(np.minimum(*(surface.rss for surface in coarse)), samples):
        centres += narrow_zones(data, lags, low, high)
    found: list[Candidate] = []
    for left_centre, right_centre, reach in centres:
        left = _around(left_centre, reach, low, high)
        right = _around(right_centre, reach, low, high)
        fine, _ = _scan(data, lags, left, right)
        for rss, ratio in ((surface.rss, surface.log_ratio) for surface in fine):
            i, j = np.unravel_index(np.argmin(rss), rss.shape)
            found.append(Candidate(left[i], right[j], ratio[i, j], rss[i, j]))
    found.sort(key=lambda candidate: candidate.rss)
    limit = found[0].rss * (1.0 + 2.0 * START_MARGIN / samples)
    return _apart([candidate for candidate in found if candidate.rss <= limit], max(0.5 * spacing, SMALLEST_SPACING))[
        :MOST_STARTS
    ]


def _is_wide(rss: FloatArray, samples: int) -> bool:
    """Whether a zone wider than a few knots is beyond doubt: a narrow one is nearly one of those on the grid."""
    left, right = np.indices(rss.shape)
    best, narrow = float(rss.min()), float(rss[right - left <= FEW_KNOTS].min())
    return bool(0.5 * samples * np.log(max(narrow, 1e-300) / max(best, 1e-300)) > BEYOND_DOUBT)


def _apart(candidates: list[Candidate], distance: float) -> list[Candidate]:
    """Without those that are near a better one in all."""
    kept: list[Candidate] = []
    for one in candidates:
        moves = [
            max(abs(one.left - other.left), abs(one.right - other.right)) / distance
            + abs(one.log_ratio - other.log_ratio) / NEAR_RATIO
            for other in kept
        ]
        if min(moves, default=np.inf) > 1.0:
            kept.append(one)
    return kept


def narrow_zones(data: ScaledData, lags: Lags, low: float, high: float) -> list[tuple[float, float, float]]:
    """Left, right and reach of the best narrow dead zones.

    Seen from outside, a narrow dead zone at m is a jump of minus its width: x = u - m - width [u > m] + constant.
    So u and [u > m] are inputs of one ARX, and the ratio of their gains is the width.
    """
    few = data if data.u.size <= NARROW_ROWS else replace(data, segments=_longest(data.segments, NARROW_ROWS))
    places = np.linspace(low, high, NARROW_KNOTS + 2)[1:-1]
    found = regress_on_pairs(Jumps(places), few, lags, uniform=False)
    rss, (slopes, jumps) = found.rss, found.gains.T
    widths = np.divide(-jumps, slopes, out=np.zeros(NARROW_KNOTS), where=slopes != 0.0)
    widths = np.minimum(widths, 0.5 * (high - low))
    order = [int(index) for index in np.argsort(rss) if widths[index] > 0.0]
    limit = rss.min() * (1.0 + 2.0 * START_MARGIN / found.samples)
    spacing = places[1] - places[0]
    zones: list[tuple[float, float, float]] = []
    for index in order:
        left, right = places[index] - widths[index] / 2, places[index] + widths[index] / 2
        apart = all(abs(left + right - a - b) > 4 * spacing for a, b, _ in zones)
        if apart and rss[index] <= limit and len(zones) < MOST_NARROW:
            zones.append((left, right, max(spacing, widths[index] / 2)))
    return zones


def _longest(segments: IntArray, rows: int) -> IntArray:
    """The first rows of the longest segment."""
    start, stop = segments[int(np.argmax(segments[:, 1] - segments[:, 0]))]
    return np.array([[start, min(stop, start + rows)]])


def _around(centre: float, spacing: float, low: float, high: float) -> FloatArray:
    return np.linspace(max(centre - spacing, low), min(centre + spacing, high), ZOOM_KNOTS)


def _minima(rss: FloatArray, samples: int) -> list[tuple[int, int]]:
    """Grid points with no better neighbour, within the margin of the best, best first."""
    padded = np.pad(rss, 1, constant_values=np.inf)
    n, m = rss.shape
    shifts = [(i, j) for i in (0, 1, 2) for j in (0, 1, 2) if (i, j) != (1, 1)]
    neighbours = np.min([padded[i : i + n, j : j + m] for i, j in shifts], axis=0)
    limit = rss.min() * (1.0 + 2.0 * START_MARGIN / samples)
    rows, columns = np.nonzero((rss <= neighbours) & (rss <= limit))
    order = np.argsort(rss[rows, columns])
    return [(int(rows[k]), int(columns[k])) for k in order]


@dataclass(frozen=True)
class _Surface:
    """Residual sum of squares and log gain ratio for every pair (left, right); inf where left > right."""

    rss: FloatArray
    log_ratio: FloatArray


def _scan(data: ScaledData, lags: Lags, left: FloatArray, right: FloatArray) -> tuple[tuple[_Surface, _Surface], int]:
    """Of a dead zone with free slopes and with equal slopes."""
    hinges = Hinges(left, right)
    found = regress_on_pairs(hinges, data, lags, uniform=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        log_ratio = np.log(np.abs(found.gains[:, 0] / found.gains[:, 1]))
    log_ratio = np.where(np.isfinite(log_ratio), np.clip(log_ratio, -2.0, 2.0), 0.0)
    chance = np.exp(2.0 * lags.inputs / found.samples)
    rows, columns = hinges.places.T

    def surface(rss: FloatArray, ratio: FloatArray) -> _Surface:
        placed = _Surface(np.full((left.size, right.size), np.inf), np.zeros((left.size, right.size)))
        placed.rss[rows, columns], placed.log_ratio[rows, columns] = rss, ratio
        return placed

    return (surface(found.rss * chance, log_ratio), surface(found.rss_of_sum, np.zeros(rows.size))), found.samples
