"""Loops that swing, each with its period and its spectrum, and which of them swing together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.store.rows import AssessmentRow, SpectrumRow

LEAST_REGULAR = 1.0  # as published: below, zero crossings of the autocorrelation come as they like
LEAST_POWER = 0.1  # of the variance: a smaller swing is nobody's reason to look
SAME_PERIOD = 0.05  # relative
LEAST_LIKE = 0.6  # cosine of the spectra about the oscillation; see docs/audit-groups.md
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
    """

    tag: str
    rows: tuple[AssessmentRow, ...]
    spectra: tuple[SpectrumRow, ...]

    @property
    def period(self) -> float:
        """Seconds, median of the windows."""
        return float(np.median([row.period or 0.0 for row in self.rows]))

    @property
    def power(self) -> float:
        """Share of the variance, mean of the windows."""
        return float(np.mean([row.power or 0.0 for row in self.rows]))

    @property
    def times(self) -> tuple[tuple[datetime, datetime], ...]:
        """Begin and end of each window."""
        return tuple((row.window_start, row.window_end) for row in self.rows)

    def form(self, period: float) -> FloatArray:
        """Power in bands about a frequency, of length 1; shape (24,)."""
        bands = np.mean([_bands(one, period) for one in self.spectra], axis=0)
        smooth = np.convolve(bands, SMOOTH, "same")
        return np.asarray(smooth / max(float(np.linalg.norm(smooth)), 1e-300))


def swinging(spectra: Sequence[SpectrumRow], rows: Sequence[AssessmentRow]) -> list[Swinging]:
    """Loops that swing; windows of one loop with the same period are one."""
    known = {(one.tag, one.window_start): one for one in spectra}
    found: dict[str, list[Swinging]] = {}
    for row in sorted(rows, key=lambda row: (row.tag, row.window_start)):
        spectrum = known.get((row.tag, row.window_start))
        if spectrum is not None and _swings(row):
            _add(found.setdefault(row.tag, []), Swinging(row.tag, (row,), (spectrum,)))
    return [one for mine in found.values() for one in mine]


def together(loops: Sequence[Swinging]) -> Iterator[tuple[float, list[tuple[Swinging, float]]]]:
    """Period of each group, and its loops with their likeness; the one that swings most is the first of its group.

    A leader takes all that are like it; then the mean of these takes its place once, so that who was first does not
    decide who belongs.
    """
    left = sorted(loops, key=lambda one: (-one.power * len(one.rows), one.tag))
    while left:
        leader = left[0]
        period, members = leader.period, _like(leader.form(leader.period), leader.period, leader, left)
        if len(members) > 1:
            period = float(np.median([one.period for one, _ in members]))
            middle = np.mean([one.form(period) for one, _ in members], axis=0)
            again = _like(middle / np.linalg.norm(middle), period, leader, left)
            members = again if any(one is leader for one, _ in again) else members
        taken = {id(one) for one, _ in members} | {id(leader)}
        left = [one for one in left if id(one) not in taken]
        if len({one.tag for one, _ in members}) > 1:
            yield period, members


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


def _like(form: FloatArray, period: float, leader: Swinging, loops: Sequence[Swinging]) -> list[tuple[Swinging, float]]:
    """Those of the same period, like form, and time in common with the leader."""
    near = [one for one in loops if abs(np.log(one.period / period)) <= SAME_PERIOD]
    likeness = [(one, float(np.clip(form @ one.form(period), 0.0, 1.0))) for one in near]
    return [(one, like) for one, like in likeness if like >= LEAST_LIKE and overlap(leader, one) >= LEAST_OVERLAP]


def overlap(first: Swinging, second: Swinging) -> float:
    """Time in common, as a share of the shorter of both."""
    seconds = sum(
        max((min(a[1], b[1]) - max(a[0], b[0])).total_seconds(), 0.0) for a in first.times for b in second.times
    )
    lengths = [sum((end - start).total_seconds() for start, end in one.times) for one in (first, second)]
    return seconds / max(min(lengths), 1e-9)


def _bands(row: SpectrumRow, period: float) -> FloatArray:
    """Share of the power in bands from half to six times the frequency; shape (24,)."""
    power = np.frombuffer(row.power, dtype="<f4").astype(np.float64)
    edges = np.geomspace(row.low, row.high, power.size + 1)
    wanted = np.geomspace(BELOW / period, ABOVE / period, BANDS + 1)
    return np.diff(np.interp(np.log(wanted), np.log(edges), np.r_[0.0, np.cumsum(power)]))


def by_place(spectra: Sequence[SpectrumRow]) -> Mapping[tuple[str, datetime], SpectrumRow]:
    """Rows by loop and window."""
    return {(one.tag, one.window_start): one for one in spectra}
