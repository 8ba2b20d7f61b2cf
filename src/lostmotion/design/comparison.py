"""The rival: a pseudo-random staircase within the same limits."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.design.bound import expected
from lostmotion.design.operating_limits import Limits
from lostmotion.design.simulated_plant import Plant
from lostmotion.design.staircase import Staircase
from lostmotion.simulate import signals

SEEDS = 6  # a PRS is drawn: the median over them is told
HALVINGS = 6  # of the share of the range of a PRS that keeps the limits: to 2 % of it
LONGER = (1, 2, 4, 8)  # holds that are tried, in shortest holds
FEWEST_HOLDS = 4  # of a PRS: with fewer it stays on one side of the zone too often


def prs_signal(plants: list[Plant], limits: Limits, samples: int, hold: int, seed: int) -> FloatArray:
    """PRS over the whole range of the levels, drawn in towards the start until all plants keep the limits.

    Its holds grow where the rate limit needs it. shape (samples,).
    """
    low, high = limits.levels
    if np.isfinite(limits.per_sample):
        hold += int(np.ceil((high - low) / limits.per_sample))
    count = -(-samples // hold)
    levels = signals.prs(count, low, high, 1, seed) - limits.start

    def drawn_in(share: float) -> FloatArray:
        stairs = Staircase(limits.start + share * levels, np.full(count, hold))
        return stairs.signal(limits.start, limits.per_sample)[:samples]

    if limits.kept(plants, drawn_in(1.0)):
        return drawn_in(1.0)
    allowed, refused = 0.0, 1.0
    for _ in range(HALVINGS):
        share = 0.5 * (allowed + refused)
        if limits.kept(plants, drawn_in(share)):
            allowed = share
        else:
            refused = share
    return drawn_in(allowed)


def prs_expected(plants: list[Plant], limits: Limits, samples: int, hold: int, seed: int) -> dict[str, float]:
    """95 % half-widths of a PRS at the first plant: median over seeds."""
    runs = [
        expected(plants[0], prs_signal(plants, limits, samples, hold, seed + draw), seeds=1) for draw in range(SEEDS)
    ]
    return {name: float(np.median([run[name] for run in runs])) for name in runs[0]}


def prs_by_hold(plants: list[Plant], limits: Limits, samples: int, seed: int) -> dict[int, dict[str, float]]:
    """Half-widths of PRSs with the shortest hold and with longer ones, by the hold in samples."""
    holds = [limits.hold * times for times in LONGER if times == 1 or limits.hold * times * FEWEST_HOLDS <= samples]
    return {hold: prs_expected(plants, limits, samples, hold, seed) for hold in holds}
