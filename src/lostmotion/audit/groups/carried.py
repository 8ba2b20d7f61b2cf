"""Loops without a period of their own that are carried along by a group."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.audit.groups.swinging import LEAST_OVERLAP, POWER, Swinging, likeness, overlap, sharing
from lostmotion.diagnose.control_error.spectrum import BINS

PEAK, BESIDE = 1.08, 1.6  # a peak is so far up and down in frequency; what it stands out of, up to so far
GUARD = 1.18  # between both: the Hann window and the wandering of a period smear a peak
PEAK_WIDTH, WINDOW = 0.15, 1.5  # of a peak, in frequencies; lines that the Hann window makes of one
STANDS_OUT, DEVIATIONS = 1.5, 3.0  # ratio and deviations of a peak


class Peaks:
    """Spectra of loops of one window each, all at once: a plant has thousands of them beside every group."""

    def __init__(self, loops: Sequence[Swinging]) -> None:
        self.loops = tuple(loops)
        spectra = [one.spectra[0] for one in loops]
        power = np.zeros((len(spectra), BINS + 1))
        for place, row in enumerate(spectra):
            power[place, 1:] = np.frombuffer(row.power[:POWER], dtype="<f4")
        self._cumulative = np.cumsum(power, axis=1)
        self._low = np.log([row.low for row in spectra])
        self._bins = BINS / (np.log([row.high for row in spectra]) - self._low)
        self._seconds = np.array([one.seconds for one in loops])

    def at(self, period: float) -> list[Swinging]:
        """Those with a peak at a period (s)."""
        if not self.loops:
            return []
        inside = self._between(1.0 / (PEAK * period), PEAK / period)
        beside = self._between(1.0 / (BESIDE * period), 1.0 / (GUARD * period))
        beside += self._between(GUARD / period, BESIDE / period)
        usual = beside * np.log(PEAK) / np.log(BESIDE / GUARD)
        ratio = inside / np.maximum(usual, 1e-300)
        deviation = np.sqrt(WINDOW * period / np.maximum(PEAK_WIDTH * self._seconds, 1e-9))
        return [
            self.loops[place]
            for place in np.flatnonzero((ratio >= STANDS_OUT) & (ratio - 1.0 >= DEVIATIONS * deviation))
        ]

    def _between(self, low: float, high: float) -> FloatArray:
        """Power between two frequencies, shape (n,)."""
        return self._below(high) - self._below(low)

    def _below(self, frequency: float) -> FloatArray:
        place = np.clip((np.log(frequency) - self._low) * self._bins, 0.0, BINS)
        whole = np.minimum(place.astype(np.int64), BINS - 1)
        rows, part = np.arange(place.size), place - whole
        return np.asarray(self._cumulative[rows, whole] * (1.0 - part) + self._cumulative[rows, whole + 1] * part)


def carried(leader: Swinging, period: float, others: Peaks) -> list[tuple[Swinging, float]]:
    """Loops that have a peak at the period of a group and share the swing of its leader, with their likeness."""
    near = [one for one in others.at(period) if overlap(leader, one) >= LEAST_OVERLAP]
    form = leader.form(period)
    return [(one, likeness(form, one, period)) for one in sharing(leader, period, near)]
