"""What swings with what: the same plant with the same luck, with and without one source."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.fft

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.oscillation import find_oscillation
from lostmotion.errors import DataError
from lostmotion.evaluate.plants.plant import OUTSIDE, MadePlant
from lostmotion.evaluate.plants.simulated import Single
from lostmotion.evaluate.plants.truth import CAUSES, LoopTruth

HARMONICS, BAND = 3, 0.12  # of the frequency, to both sides
REACHED = 0.15  # of the variance of PV, faster than three periods: what counts as swinging with the source
ENOUGH = 43_200.0  # seconds: 18 cycles of a swing of 40 minutes
MOST_ROWS = 20_000  # looked at: longer records are thinned
SWINGS = ("stiction", "backlash", "tight tuning")  # faults that can make an oscillation
REGULAR, SHARE = 1.0, 0.3  # of an oscillation of the source itself


@dataclass(frozen=True)
class Spread:
    """How far an oscillation reaches.

    Attributes
    ----------
    source : str
        Tag, or "outside".
    period : float
        Seconds.
    shares : dict of float
        By tag: part of the variance of PV that is gone without the source, in the band of the oscillation.
    """

    source: str
    period: float
    shares: dict[str, float]

    @property
    def reached(self) -> tuple[str, ...]:
        """Tags of the loops that swing with it, itself included."""
        return tuple(tag for tag, share in self.shares.items() if share >= REACHED)


def spread(plant: MadePlant, source: int | None) -> Spread | None:
    """Which loops swing because of one loop's fault, or (None) because of the swings from outside.

    Returns
    -------
    Spread or None
        None: the source does not swing, or nothing is the less for its repair.
    """
    period = _period(plant, source)
    if period is None:
        return None
    apart = plant.without(source).signals
    shares = {
        loop.tag: _gone(_thin(plant.signals.pv[:, i]), _thin(apart.pv[:, i]), period * _per_second(plant))
        for i, loop in enumerate(plant.loops)
    }
    found = Spread(OUTSIDE if source is None else plant.loops[source].tag, period, shares)
    return found if found.reached else None


def with_spread(plant: MadePlant) -> tuple[LoopTruth, ...]:
    """Truth of all loops, with what each swings with most; half a day is simulated for each fault that can swing."""
    whole, plant = plant, replace(plant, seconds=min(plant.seconds, ENOUGH))
    sources: list[int | None] = [number for number, fault in enumerate(plant.faults) if fault in SWINGS]
    sources += [None] if plant.swings else []
    found = [one for one in (spread(plant, source) for source in sources) if one is not None]
    return tuple(_swings(truth, found) for truth in whole.truth())


def _swings(truth: LoopTruth, found: list[Spread]) -> LoopTruth:
    mine = [one for one in found if truth.tag in one.reached]
    if not mine:
        return truth
    most = max(mine, key=lambda one: one.shares[truth.tag])
    return replace(truth, swings_with=most.source, period=most.period)


def _period(plant: MadePlant, source: int | None) -> float | None:
    """Seconds; None: the source does not swing by itself."""
    if source is None:
        return plant.swings[0].period
    if plant.faults[source] not in CAUSES:
        return None
    try:
        found = find_oscillation(_thin(plant.signals.op[:, source]))
    except DataError:
        return None
    swings = found.regularity > REGULAR and found.share > SHARE
    return found.period / _per_second(plant) if swings else None


def _thin(signal: Single) -> FloatArray:
    step = -(-signal.size // MOST_ROWS)
    kept = signal[: signal.size // step * step].astype(np.float64)
    return np.asarray(kept.reshape(-1, step).mean(axis=1))


def _per_second(plant: MadePlant) -> float:
    """Rows of the thinned signals in a second."""
    return 1.0 / (plant.dt * -(-plant.rows // MOST_ROWS))


def _gone(having: FloatArray, lacking: FloatArray, period: float) -> float:
    """Share of the variance, faster than three periods, that the band of the oscillation has more than without it."""
    window = np.hanning(having.size)
    powers = [np.abs(scipy.fft.rfft((one - one.mean()) * window)) ** 2 for one in (having, lacking)]
    order = np.arange(powers[0].size) * period / having.size
    nearest = np.clip(np.round(order), 1, HARMONICS)
    band = np.abs(order - nearest) <= BAND
    whole = float(powers[0][order > 1.0 / 3.0].sum())
    return float((powers[0][band].sum() - powers[1][band].sum()) / max(whole, 1e-12))
