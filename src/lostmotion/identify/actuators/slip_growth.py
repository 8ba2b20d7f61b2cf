"""A second search for a sticking valve: a grid on the first rows, thinned out and refined while the rows double.

The first slips are in their samples for many valves; every slip after them excludes most of these. So places are many
while the rows are few, and few once they are all. It misses other valves than the search over all rows
(:mod:`lostmotion.identify.actuators.slip_profile`), which goes first.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.identify.actuators.memory_family import LARGEST
from lostmotion.identify.actuators.operator_profile import LaggedRegression
from lostmotion.identify.actuators.polish import MOST_SEGMENTS
from lostmotion.identify.actuators.slip_draws import even_draws
from lostmotion.identify.actuators.slip_places import Place, Places, cost_of
from lostmotion.identify.actuators.slip_profile import MOST_ROWS, SCANT, SlipProfile, range_of, settled_place
from lostmotion.identify.likelihood.arx_gram import Lags
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels.stiction import HE

FIRST_ROWS = 1000
SMALLEST, BANDS = 0.1, 200  # in ranges of OP; 1.1 % apart
SHARES = (0.25, 0.5, 0.75, 1.0)  # jump over band
RESTS = np.linspace(-0.9, 0.9, 13)
ROOM = (60, 24, 10)  # places that stay: of the grid, and each time that the rows have doubled
FUNNEL, REACH = 0.01, 0.02  # distance of places that stay, and half the width of a box about one; halved each time
DRAWS = 24  # places in a box
CLEARLY = 3.0  # of log-likelihood, before a known place is left
LAST, APART = 8, 0.003  # places that are settled on all rows


def likelier_slip_of(
    data: ScaledData, lags: Lags, model: int, eta: tuple[float, float], rests: tuple[float, ...]
) -> Place | None:
    """The best place of a record where it is clearly better than a known one; None where it is not."""
    best = growing_slips_of(data, lags)[0]
    profile = _profile(data, lags, data.u.size)
    known = profile.place(model, *eta, (*rests, *[0.0] * (len(data.segments) - len(rests))))
    return best if best.cost < known.cost - CLEARLY else None


def growing_slips_of(data: ScaledData, lags: Lags) -> list[Place]:
    """Best places of a record, best first."""
    rows, every = FIRST_ROWS, int((data.segments[:, 1] - data.segments[:, 0]).sum())
    segments, span = min(len(data.segments), MOST_SEGMENTS), range_of(data)
    profile = _profile(data, lags, rows)
    grid = _grid(profile, span, segments)
    while rows < every and grid.costs.min() > profile.linear - SCANT:  # nothing of the valve is seen there
        rows *= 2
        profile = _profile(data, lags, rows)
        grid = _grid(profile, span, segments)
    live, at, draws = grid.apart(FUNNEL, ROOM[0]), 0, even_draws(DRAWS * sum(ROOM[:-1]))
    for step, room in enumerate(ROOM[1:]):
        rows = min(2 * rows, every)
        profile, shrunk = _profile(data, lags, rows), 0.5**step
        trials = DRAWS * live.costs.size
        found = profile.about(live, shrunk * REACH, draws[at : at + trials])
        live = _on(profile, live).joined(found).apart(shrunk * FUNNEL, room)
        at += trials
    whole = _profile(data, lags, every)
    return sorted((settled_place(whole, place) for place in _on(whole, live).apart(APART, LAST)), key=cost_of)


def _grid(profile: SlipProfile, span: float, segments: int) -> Places:
    """Bands, jumps and first positions, these the same in all segments."""
    bands, shares, rests = np.meshgrid(np.geomspace(SMALLEST, LARGEST, BANDS) * span, SHARES, RESTS, indexing="ij")
    begun = np.repeat(rests.reshape(-1, 1), segments, axis=1)
    return profile.places(HE, bands.ravel(), (shares * bands).ravel(), begun)


def _on(profile: SlipProfile, places: Places) -> Places:
    """The same places with their costs on the rows of a profile."""
    bands, jumps = places.etas.T
    return profile.places(places.models, bands, jumps, places.rests)


def _profile(data: ScaledData, lags: Lags, rows: int) -> SlipProfile:
    """On the first rows of all segments together, those at the beginning of each that have no past among them."""
    segments: list[tuple[int, int]] = []
    room = rows
    for start, stop in data.segments.tolist():
        if room <= 2 * lags.head and segments:
            break
        segments.append((start, min(stop, start + room)))
        room -= segments[-1][1] - start
    first = replace(data, segments=np.array(segments))
    return SlipProfile(LaggedRegression.on(first, lags, MOST_ROWS), data.u, first.segments)
