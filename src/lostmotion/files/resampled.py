"""Values with stamps of their own -> samples of one rate: OP and SP held, PV on a line, and how much was made up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.files.rates import JITTER, Rate, rounded, scattered, tidy, uniform

LONGEST_HOLE = 20  # usual steps between stored values: over a longer hole nothing is made up
LEAST_SCAN = 1e-9  # of the longest step: less is no scan, and no number of them can be counted
SCAN_SHARE = 0.1  # of the steps are one scan long, at least, where the scan is told from the stamps
SPREAD = 3.0  # scans: the longest tenth of the steps, at least, where a historian left values out
OWN_SHARE = 0.5  # of the rows hold OP and PV both, at most, where each tag has stamps of its own
EITHER_SHARE = 0.9  # of the rows hold OP or PV, at least; a third tag may have stamps of its own too
APART = 0.25  # sampling times between OP and PV, at most, where each has stamps of its own, or OP counts as made up
SLOWEST, FASTEST = 2.0, 0.05  # a dt that is asked for, in usual steps between stored values
FEWEST_STEPS = 20  # by which a scan is told
FEWEST_TOGETHER = 7.0  # rows without OP and PV that chance would make: none is then one case in a thousand
MOST_SAMPLES = 20_000_000  # of a record: years of seconds; more is a wrong rate


@dataclass(frozen=True, eq=False)
class Resampled:
    """Samples at one rate.

    Attributes
    ----------
    dt : float
        Sampling time in seconds.
    signals : dict of ndarray, shape (n,)
        By role; NaN in holes.
    rows : ndarray of int, shape (n,)
        Row at or before each sample, from 0.
    note : str
        What was done, and the shares that were made up.
    made_up : (float, float)
        These shares, of OP and PV.
    first : float
        Time of the first sample, as the rows have theirs.
    """

    dt: float
    signals: dict[str, FloatArray]
    rows: IntArray
    note: str
    made_up: tuple[float, float]
    first: float


def resampled(
    seconds: FloatArray, signals: Mapping[str, FloatArray], dt: float | None = None, own_times: bool = False
) -> Resampled | None:
    """Samples of values that a historian stored only when they had moved, or each tag at times of its own.

    Parameters
    ----------
    seconds : ndarray, shape (n,)
        Times of the rows, rising.
    signals : mapping of ndarray, shape (n,)
        By role; NaN where a row holds no value of it.
    dt : float, optional
        Sampling time that was asked for; None: the scan of which the stamps are multiples.
    own_times : bool
        Signals are known to have times of their own. Otherwise only irregular stamps tell so: an empty cell on regular
        ones is a missing value.

    Returns
    -------
    Resampled or None
        None where the rows are samples already, or no rate can be told.

    Notes
    -----
    OP, SP and the position are held until the next value, as a controller does; PV is taken on a straight line between
    stored values. Over a hole of more than 20 usual steps nothing is made up: its samples are missing.

    Examples
    --------
    >>> seconds = np.array([0.0, 1.0, 5.0, 6.0, 9.0, 10.0])
    >>> op, pv = np.arange(1.0, 7.0), seconds.copy()
    >>> found = resampled(seconds, {"op": op, "pv": pv}, dt=1.0)
    >>> found.dt, found.signals["op"][:6], found.signals["pv"][:6]
    (1.0, array([1., 2., 2., 2., 2., 3.]), array([0., 1., 2., 3., 4., 5.]))
    """
    filled = np.any([~np.isnan(values) for values in signals.values()], axis=0) if own_times else np.isfinite(seconds)
    if np.isnan(seconds).any() or filled.sum() < 3 or not (np.diff(seconds) > 0).all():
        return None
    seconds, signals = seconds[filled], {role: values[filled] for role, values in signals.items()}
    steps = np.diff(seconds)
    regular = uniform(steps) or rounded(seconds, steps) or scattered(steps)
    apart = regular is not None and _stored_apart(signals, seconds, regular)
    own = apart or (_own_stamps(signals, own_times) and (own_times or regular is None))
    if regular is not None and not own:
        return None
    lead = seconds[~np.isnan(signals["pv"])] if own else seconds
    rate = _rate(lead, steps, own, dt)
    if rate is None and apart and regular is not None and dt is None:
        rate = regular.step
    if rate is None or np.ptp(seconds) / rate > MOST_SAMPLES:
        return None
    grid = lead[0] + rate * np.arange(int((seconds[-1] - lead[0]) / rate * (1 + 1e-12)) + 1)
    hole = _in_hole(grid, seconds)
    made = {role: _values(role, grid, seconds, values, hole) for role, values in signals.items()}
    near = (APART if own else 0.5) * rate
    op, pv = (_made_up(grid, seconds[~np.isnan(signals[role])], near) for role in ("op", "pv"))
    missing = f"; {int(hole.sum())} samples in holes are missing" if hole.any() else ""
    note = (
        f"Values stand at irregular times and were resampled to {rate:g} s, OP held and PV on lines between them: "
        f"{100 * op:.0f} % of OP, {100 * pv:.0f} % of PV made up{missing}."
    )
    rows = np.flatnonzero(filled)[np.clip(np.searchsorted(seconds, grid + 1e-9 * rate, side="right") - 1, 0, None)]
    return Resampled(rate, made, rows, note, (op, pv), float(grid[0]))


def _own_stamps(signals: Mapping[str, FloatArray], known: bool) -> bool:
    """Whether few rows hold OP and PV both, and many one of them."""
    op, pv = (~np.isnan(signals[role]) for role in ("op", "pv"))
    if min(op.sum(), pv.sum()) < FEWEST_STEPS:
        return False
    return float(np.mean(op & pv)) < OWN_SHARE and (known or float(np.mean(op | pv)) > EITHER_SHARE)


def _stored_apart(signals: Mapping[str, FloatArray], seconds: FloatArray, regular: Rate) -> bool:
    """Whether empty cells at regular stamps hold no new value rather than a missing one, beyond chance.

    Either no row holds OP and PV both; or there are rows without OP and rows without PV, none without both, and what
    chance would have made of these is absent from the stamps: rows in which nothing had moved were not stored.
    """
    op, pv = (~np.isnan(signals[role]) for role in ("op", "pv"))
    if min(op.sum(), pv.sum()) < FEWEST_STEPS or not (op | pv).all():
        return False
    if not (op & pv).any():
        return True
    expected = len(seconds) * float(np.mean(~op)) * float(np.mean(~pv))
    absent = round(float(np.ptp(seconds)) / regular.step) + 1 - len(seconds)
    return expected >= FEWEST_TOGETHER and absent >= 0.5 * expected


def _rate(lead: FloatArray, steps: FloatArray, own: bool, dt: float | None) -> float | None:
    """Sampling time: as it was asked for, that of PV, or the scan of which the steps are multiples."""
    leading = np.diff(lead)
    usual = float(np.median(leading))
    if dt is not None:
        return dt if FASTEST * usual <= dt <= SLOWEST * usual else None
    regular = uniform(leading) if own else None
    if regular is not None:
        return regular.step
    scan = float(steps.min())
    if scan < LEAST_SCAN * float(steps.max()):
        return None
    multiples = steps / scan
    whole = np.abs(multiples - np.round(multiples)) <= JITTER * np.maximum(multiples, 1.0)
    once = np.round(multiples) == 1
    spread = float(np.quantile(multiples, 0.9)) >= SPREAD
    if not (len(steps) >= FEWEST_STEPS and whole.all() and once.mean() >= SCAN_SHARE and spread):
        return None
    return tidy(float(steps[once].mean()), 1e-6 * scan)


def usual_step(steps: FloatArray) -> float:
    """Round number near the median step, for advice.

    Examples
    --------
    >>> usual_step(np.array([2.9, 3.1, 3.14, 9.0]))
    3.1
    """
    return float(f"{np.median(steps):.2g}")


def _in_hole(grid: FloatArray, seconds: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    steps = np.diff(seconds)
    long = np.flatnonzero(steps > LONGEST_HOLE * np.median(steps))
    hole = np.zeros(len(grid), dtype=np.bool_)
    for row in long.tolist():
        hole[np.searchsorted(grid, seconds[row], side="right") : np.searchsorted(grid, seconds[row + 1])] = True
    return hole


def _values(
    role: str,
    grid: FloatArray,
    seconds: FloatArray,
    values: FloatArray,
    hole: np.ndarray[tuple[int], np.dtype[np.bool_]],
) -> FloatArray:
    known = ~np.isnan(values)
    if not known.any():
        return np.full(len(grid), np.nan)
    times, stored = seconds[known], values[known]
    if role == "pv":
        made = np.interp(grid, times, stored, left=np.nan, right=np.nan)
    else:
        place = np.searchsorted(times, grid * (1 + 1e-12), side="right") - 1
        made = np.where(place >= 0, stored[np.maximum(place, 0)], np.nan)
    return np.where(hole, np.nan, made)


def _made_up(grid: FloatArray, times: FloatArray, near: float) -> float:
    """Share of the samples without a stored value so near, in seconds."""
    if not len(times):
        return 1.0
    place = np.searchsorted(times, grid)
    before, after = times[np.maximum(place - 1, 0)], times[np.minimum(place, len(times) - 1)]
    known = np.minimum(np.abs(grid - before), np.abs(after - grid)) <= near * (1 + 1e-9)
    return 1.0 - float(known.mean())
