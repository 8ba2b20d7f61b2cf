"""Loops that swing, each with its period and its spectrum, and which of them swing together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from functools import cached_property

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.audit.groups.shared import Shared, shared
from lostmotion.audit.screen.lines import Lines, bands_in
from lostmotion.diagnose.control_error.spectrum import BINS
from lostmotion.plant.loop import PlantLoop
from lostmotion.store.rows import UNDATED, AssessmentRow, SpectrumRow

LEAST_REGULAR = 1.0  # as published: below, zero crossings of the autocorrelation come as they like
LEAST_POWER = 0.1  # of the variance: a smaller swing is nobody's reason to look
SAME_PERIOD = 0.05  # relative, of windows of one loop
NEAR_PERIOD = 0.2  # relative, of loops that may swing together: estimates of one swing lie up to 17 % apart
LEAST_SHARED = 0.4  # coherence: with less two loops have other swings beside the one they share
LEVEL = 0.05  # share of chance among members; a coherence besides: under 1 % of pairs of different plants have both
POWER = 4 * BINS  # bytes of the spectrum; behind them are its lines
LEAST_OVERLAP = 0.5  # of the shorter of two times
BELOW, ABOVE, BANDS = 0.5, 6.0, 24  # of the frequency: what is compared, in bands as wide as a bin of 96
SMOOTH = (0.25, 0.5, 0.25)  # periods that differ by less than a band fall into neighbours


@dataclass(frozen=True, eq=False)
class Swinging:
    """One loop that swings with one period, in one window or many.

    Attributes
    ----------
    tag : str
    rows : tuple of AssessmentRow
        One a window.
    spectra : tuple of SpectrumRow
        Of the same windows.
    clock : str
        Times of two loops can be compared where it is the same.
    """

    tag: str
    rows: tuple[AssessmentRow, ...]
    spectra: tuple[SpectrumRow, ...]
    clock: str = ""

    @cached_property
    def period(self) -> float:
        """Seconds, median of the windows."""
        return float(np.median([row.period or 0.0 for row in self.rows]))

    @cached_property
    def power(self) -> float:
        """Share of the variance, mean of the windows."""
        return float(np.mean([row.power or 0.0 for row in self.rows]))

    @property
    def spread(self) -> float | None:
        """Deviation of its amplitude over the mean, mean of the windows; None: too few cycles in each."""
        known = [row.indices["amplitude_spread"] for row in self.rows if "amplitude_spread" in row.indices]
        return float(np.mean(known)) if known else None

    @property
    def cycles(self) -> float:
        """Periods in all windows; 0 where it has none of its own."""
        return self.seconds / self.period if self.period else 0.0

    @property
    def seconds(self) -> float:
        """Length of all windows."""
        return sum((end - start).total_seconds() for start, end in self.times)

    @property
    def times(self) -> tuple[tuple[datetime, datetime], ...]:
        """Begin and end of each window."""
        return tuple((row.window_start, row.window_end) for row in self.rows)

    @cached_property
    def windows(self) -> tuple[tuple[datetime, dict[int, Lines]], ...]:
        """Beginning of each window and its lines."""
        return tuple((one.window_start, bands_in(one.power[POWER:])) for one in self.spectra)

    def shared(self, other: Swinging, period: float) -> Shared:
        """What two loops have in common about a period."""
        return shared(self.windows, other.windows, period)

    def form(self, period: float) -> FloatArray:
        """Power in bands about a frequency, of length 1; shape (24,)."""
        bands = np.mean([_bands(one, period) for one in self.spectra], axis=0)
        smooth = np.convolve(bands, SMOOTH, "same")
        return np.asarray(smooth / max(float(np.linalg.norm(smooth)), 1e-300))


def unsteady(
    spectra: Sequence[SpectrumRow],
    rows: Sequence[AssessmentRow],
    known: Sequence[Swinging],
    loops: Mapping[str, PlantLoop],
) -> list[Swinging]:
    """Loops that swing with no period of their own, but may be carried along by another's."""
    mine = {one.tag for one in known}
    spectrum = {(one.tag, one.window_start): one for one in spectra if any(one.power[:POWER])}
    return [
        Swinging(row.tag, (row,), (spectrum[row.tag, row.window_start],), _clock(row, loops))
        for row in sorted(rows, key=lambda row: (row.tag, row.window_start))
        if row.tag not in mine and row.fit_for_use and (row.tag, row.window_start) in spectrum
    ]


def swinging(
    spectra: Sequence[SpectrumRow], rows: Sequence[AssessmentRow], loops: Mapping[str, PlantLoop]
) -> list[Swinging]:
    """Loops that swing; windows of one loop with the same period are one."""
    known = {(one.tag, one.window_start): one for one in spectra if any(one.power[:POWER])}
    found: dict[str, list[Swinging]] = {}
    for row in sorted(rows, key=lambda row: (row.tag, row.window_start)):
        spectrum = known.get((row.tag, row.window_start))
        if spectrum is not None and _swings(row):
            _add(found.setdefault(row.tag, []), Swinging(row.tag, (row,), (spectrum,), _clock(row, loops)))
    return [one for mine in found.values() for one in mine]


def together(loops: Sequence[Swinging]) -> Iterator[tuple[float, list[tuple[Swinging, float]]]]:
    """Period of each group, and its loops with their likeness, the one that swings most first; some stand alone.

    A leader takes all that share its swing; then come those that share the swing of most of these, so that who was
    first does not decide who belongs.
    """
    left = sorted(loops, key=lambda one: (-one.power * len(one.rows), one.tag))
    while left:
        leader = left[0]
        members = [leader, *sharing(leader, leader.period, _near(leader, leader.period, left))]
        period = float(np.median([one.period for one in members]))
        if len(members) > 1:
            members += [one for one in _near(leader, period, left, members) if _with_most(one, members)]
            period = float(np.median([one.period for one in members]))
        taken = {id(one) for one in members}
        left = [one for one in left if id(one) not in taken]
        middle = np.mean([one.form(period) for one in members], axis=0)
        yield period, [(one, likeness(middle, one, period)) for one in members]


def sharing(leader: Swinging, period: float, others: Sequence[Swinging]) -> list[Swinging]:
    """Those that share more of the leader's swing than chance makes, in their order.

    Of the ones that are taken, a share of LEVEL is chance (Benjamini and Hochberg 1995): many that are nearly sure
    speak for each other.
    """
    found = [(leader.shared(one, period), one) for one in others]
    chances = np.sort([one.chance for one, _ in found])
    below = np.flatnonzero(chances <= LEVEL * np.arange(1, chances.size + 1) / max(chances.size, 1))
    most = float(chances[below[-1]]) if below.size else -1.0
    return [one for each, one in found if each.chance <= most and each.coherence >= LEAST_SHARED]


def _near(leader: Swinging, period: float, loops: Sequence[Swinging], but: Sequence[Swinging] = ()) -> list[Swinging]:
    """Those of about this period, with time in common with the leader."""
    known = {id(leader), *map(id, but)}
    near = [one for one in loops if abs(np.log(one.period / period)) <= NEAR_PERIOD and id(one) not in known]
    return [one for one in near if overlap(leader, one) >= LEAST_OVERLAP]


def _with_most(one: Swinging, members: Sequence[Swinging]) -> bool:
    found = [one.shared(member, member.period) for member in members]
    return sum(each.chance <= LEVEL and each.coherence >= LEAST_SHARED for each in found) > 0.5 * len(members)


def likeness(form: FloatArray, one: Swinging, period: float) -> float:
    """Cosine of the spectrum about a period to a form, 0 to 1."""
    length = max(float(np.linalg.norm(form)), 1e-300)
    return float(np.clip(form @ one.form(period) / length, 0.0, 1.0))


def _clock(row: AssessmentRow, loops: Mapping[str, PlantLoop]) -> str:
    """Dates are one clock; rows without them share that of their file, in memory with records as long as they are."""
    if row.window_start.year > UNDATED.year:
        return ""
    loop = loops.get(row.tag)
    return loop.where if loop and loop.op else f"{(row.window_end - row.window_start).total_seconds()} {row.dt}"


def _swings(row: AssessmentRow) -> bool:
    regular = row.regularity is not None and row.regularity > LEAST_REGULAR
    strong = row.power is not None and row.power >= LEAST_POWER
    return bool(row.period and regular and strong and row.fit_for_use)


def _add(mine: list[Swinging], new: Swinging) -> None:
    for place, one in enumerate(mine):
        if abs(np.log(new.period / one.period)) <= SAME_PERIOD:
            mine[place] = replace(one, rows=one.rows + new.rows, spectra=one.spectra + new.spectra)
            return
    mine.append(new)


def overlap(first: Swinging, second: Swinging) -> float:
    """Time in common, as a share of the shorter of both; 0 where it cannot be known."""
    if first.clock != second.clock:
        return 0.0
    seconds = sum(
        max((min(a[1], b[1]) - max(a[0], b[0])).total_seconds(), 0.0) for a in first.times for b in second.times
    )
    lengths = [sum((end - start).total_seconds() for start, end in one.times) for one in (first, second)]
    return seconds / max(min(lengths), 1e-9)


def _bands(row: SpectrumRow, period: float) -> FloatArray:
    """Share of the power in bands from half to six times the frequency; shape (24,)."""
    return np.diff(_cumulative(row, np.geomspace(BELOW / period, ABOVE / period, BANDS + 1)))


def _cumulative(row: SpectrumRow, frequencies: FloatArray) -> FloatArray:
    power = np.frombuffer(row.power[:POWER], dtype="<f4").astype(np.float64)
    edges = np.linspace(np.log(row.low), np.log(row.high), power.size + 1)
    return np.asarray(np.interp(np.log(frequencies), edges, np.r_[0.0, np.cumsum(power)]))
