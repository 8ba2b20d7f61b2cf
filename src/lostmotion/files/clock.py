"""Times of the rows -> sampling time and gaps, or an error that says what the times look like."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import TimeError
from lostmotion.files.rates import (
    GAP_SHARE,
    GIVEN_TOLERANCE,
    JITTER,
    NEAR_SHARE,
    Rate,
    coarse,
    evenly_spread,
    near,
    rounded,
    scattered,
    tidy,
    uniform,
)
from lostmotion.files.resampled import usual_step
from lostmotion.files.times import Stamps

COARSE_SHARE = 0.1  # more repeated stamps than this mean stamps too coarse for the sampling, not faults


@dataclass(frozen=True)
class Clock:
    """Sampling time in seconds, rows (from 0) before which time is missing, and what was assumed."""

    dt: float
    gaps: tuple[int, ...] = ()
    notes: tuple[str, ...] = ()


def find_clock(stamps: Stamps | None, dt: float | None = None, ts: float | None = None, whole: bool = True) -> Clock:
    """Decide the sampling time.

    Parameters
    ----------
    stamps : Stamps, optional
        Time column; None where there is none.
    dt : float, optional
        Sampling time in seconds that the user gave. It wins over a column that counts samples.
    ts : float, optional
        Value of a column that holds the sampling time.
    whole : bool
        All rows are there. False, of the first ones of a growing file: a mean of coarse or scattered stamps is not
        used unless `dt` is given.

    Raises
    ------
    TimeError
        Unsorted, repeated, irregular or too coarse times, sources that contradict each other, or none at all.

    Examples
    --------
    >>> find_clock(None, ts=4.0)
    Clock(dt=4.0, gaps=(), notes=('dt = 4 s was taken from the column of sampling times.',))
    """
    if stamps is None:
        return _without_times(dt, ts)
    seconds, notes = _filled(stamps, dt)
    steps = np.diff(seconds)
    _refuse_unsorted(stamps, steps)
    if counts_samples(stamps, steps):
        return _counted(stamps, steps, dt, ts)
    still = float(np.mean(steps == 0)) if len(steps) else 0.0
    if still >= COARSE_SHARE:
        rate = _coarse(stamps, steps, dt, ts, whole)
    elif still:
        raise _repeated(stamps, steps)
    else:
        rate = uniform(steps) or rounded(seconds, steps) or _irregular(stamps, seconds, steps, dt, whole)
    return _settle(stamps, rate, dt, ts, notes)


def _without_times(dt: float | None, ts: float | None) -> Clock:
    if dt is not None:
        return Clock(dt, (), _disagreement(dt, ts))
    if ts is not None:
        return Clock(ts, (), (f"dt = {ts:g} s was taken from the column of sampling times.",))
    raise TimeError.expected("a time column or dt", "neither", "give the sampling time, dt=<seconds>")


def _disagreement(dt: float, ts: float | None) -> tuple[str, ...]:
    if ts is None or np.isclose(ts, dt, rtol=JITTER):
        return ()
    return (f"dt = {dt:g} s was used; the column of sampling times says {ts:g} s.",)


def _filled(stamps: Stamps, dt: float | None) -> tuple[FloatArray, tuple[str, ...]]:
    missing = np.isnan(stamps.seconds)
    if not missing.any():
        return stamps.seconds, stamps.notes
    first = int(np.flatnonzero(missing)[0])
    if dt is None:
        raise TimeError.expected(
            f"a time in every row of column {stamps.name!r}",
            f"none in {stamps.table.where(first)}",
            "repair the cell, or give dt=<seconds>",
        )
    rows = np.arange(len(missing), dtype=np.float64)
    known = ~missing
    filled = np.interp(rows, rows[known], stamps.seconds[known])
    before, after = rows < rows[known][0], rows > rows[known][-1]
    filled[before] -= (rows[known][0] - rows[before]) * dt
    filled[after] += (rows[after] - rows[known][-1]) * dt
    note = f"{int(missing.sum())} rows have no time in {stamps.name!r}; dt = {dt:g} s was used for them."
    return filled, (*stamps.notes, note)


def _refuse_unsorted(stamps: Stamps, steps: FloatArray) -> None:
    back = steps < 0
    if not back.any():
        return
    row = int(np.flatnonzero(back)[0]) + 1
    remedy = (
        "sort the rows by time, oldest first: ignoring the times would turn the record round"
        if np.mean(back) > np.mean(steps > 0)
        else "sort the rows by time (at a change to winter time, export in UTC), or, if they stand as they were "
        "recorded, pass dt=<seconds> and time=False to ignore the column"
    )
    expected = f"times in ascending order in column {stamps.name!r}"
    raise TimeError.expected(expected, f"{stamps.at(row)} after {stamps.at(row - 1)}", remedy)


def _repeated(stamps: Stamps, steps: FloatArray) -> TimeError:
    row = int(np.flatnonzero(steps == 0)[0]) + 1
    return TimeError.expected(
        f"each time once in column {stamps.name!r}",
        f"{stamps.at(row)} as in the row before ({int((steps == 0).sum())} such rows)",
        "drop the repeated rows, or pass dt=<seconds> and time=False to ignore the column",
    )


def counts_samples(stamps: Stamps, steps: FloatArray) -> bool:
    """Recognise plain numbers 0, 1, 2.. or 1, 2, 3.. with few rows left out."""
    if not stamps.plain or stamps.seconds[0] not in (0.0, 1.0) or not len(steps):
        return False
    whole = bool((steps == np.round(steps)).all()) and bool((steps >= 1).all())
    return whole and float(np.mean(steps > 1)) <= GAP_SHARE


def _counted(stamps: Stamps, steps: FloatArray, dt: float | None, ts: float | None) -> Clock:
    gaps = Rate(1.0, steps > 1, JITTER).rows
    if dt is None and ts is not None and not np.isclose(ts, 1.0, rtol=JITTER):
        note = (
            f"{stamps.name!r} counts the rows; dt = {ts:g} s was taken from the column of sampling times. "
            f"If {stamps.name!r} is in seconds, give dt=1."
        )
        return Clock(ts, gaps, (*stamps.notes, note))
    if dt is None and ts is None:
        note = f"{stamps.name!r} counts 0, 1, 2 or 1, 2, 3; it was taken as seconds, dt = 1 s."
        return Clock(1.0, gaps, (*stamps.notes, note))
    used = 1.0 if dt is None else dt
    notes = (*stamps.notes, *_disagreement(used, ts))
    if used != 1.0:
        notes = (*notes, f"{stamps.name!r} counts samples; dt = {used:g} s was given.")
    return Clock(used, gaps, notes)


def _coarse(stamps: Stamps, steps: FloatArray, dt: float | None, ts: float | None, whole: bool) -> Rate:
    """Spread the rows that carry one stamp evenly over it, where the stamps have nearly as many each or dt is given."""
    if not steps.any():
        raise _coarse_error(stamps, "the same time in every row", None, ts)
    rate, error = coarse(steps)
    if rate.gaps.mean() > GAP_SHARE:
        raise _irregular_error(stamps, steps)
    if dt is not None:
        return replace(rate, note=f"{rate.note}; dt = {dt:g} s was given")
    if not (whole and evenly_spread(steps)):
        raise _coarse_error(stamps, rate.note, tidy(rate.step, error), ts)
    step = tidy(rate.step, error)
    return replace(rate, step=step, note=f"{rate.note}; they were spread evenly, {step:g} s apart")


def _coarse_error(stamps: Stamps, got: str, hint: float | None, ts: float | None) -> TimeError:
    ignore = "pass dt=<seconds> and time=False to ignore the column, if rows are equally spaced"
    remedy = ignore if hint is None else f"give dt={hint:g} if rows are equally spaced"
    also = "" if ts is None else f" (the column of sampling times says {ts:g} s)"
    error = TimeError.expected(f"a time for each row in column {stamps.name!r}", got, remedy + also)
    return error if hint is None else error.leads_on({"dt": hint})


def _irregular(stamps: Stamps, seconds: FloatArray, steps: FloatArray, dt: float | None, whole: bool) -> Rate:
    """Rows whose stamps scatter about the scan, or about the dt that is given; else refuse."""
    if dt is None:
        rate = scattered(steps) if whole else None
        if rate is None:
            raise _irregular_error(stamps, steps, dt, whole)
        return rate
    rate, share = near(seconds, steps, dt)
    if abs(rate.step - dt) > GIVEN_TOLERANCE * dt:
        raise _given_contradicts(stamps, rate.step, dt)
    if share < NEAR_SHARE:
        raise _irregular_error(stamps, steps)
    return replace(rate, note=f"{rate.note}; dt = {dt:g} s was given")


def _irregular_error(stamps: Stamps, steps: FloatArray, dt: float | None = None, whole: bool = False) -> TimeError:
    middle = float(np.median(steps))
    off = int(np.argmax(np.abs(steps - middle))) + 1
    step = usual_step(steps)
    even = whole and dt is None and bool((steps > 0).all())
    also = f", or give dt={step:g} to resample them" if even else ""
    error = TimeError.expected(
        f"equally spaced times in column {stamps.name!r}",
        f"steps from {steps.min():g} to {steps.max():g} s (mean {steps.mean():.4g} s), "
        f"such as {stamps.at(off)} after {stamps.at(off - 1)}",
        f"export raw values at a fixed interval{also}, or, if rows are equally spaced in truth, "
        "pass dt=<seconds> and time=False to ignore the column",
    )
    return error.leads_on({"dt": step}) if even else error


def _settle(stamps: Stamps, rate: Rate, dt: float | None, ts: float | None, notes: tuple[str, ...]) -> Clock:
    if rate.note:
        notes = (*notes, f"In {stamps.name!r} {rate.note}.")
    if dt is None:
        if ts is not None and abs(ts - rate.step) > rate.tolerance * rate.step:
            raise _contradiction(stamps, rate.step, ts)
        nominal = ts is not None and abs(ts - rate.step) <= JITTER * rate.step
        used = ts if ts is not None and nominal else rate.step
        return Clock(used, rate.rows, (*notes, *_disagreement(used, ts)))
    if abs(dt - rate.step) > rate.tolerance * rate.step:
        raise _given_contradicts(stamps, rate.step, dt)
    return Clock(dt, rate.rows, (*notes, *_disagreement(dt, ts)))


def _contradiction(stamps: Stamps, step: float, ts: float) -> TimeError:
    got = f"{step:.6g} s from column {stamps.name!r} and {ts:g} s from the column of sampling times"
    remedy = f"give the true one: dt={step:.6g}, or dt={ts:g} and time=False to ignore the times"
    error = TimeError.expected("one sampling time", got, remedy)
    return error.leads_on({"dt": float(f"{step:.6g}")}, {"dt": ts, "time": False})


def _given_contradicts(stamps: Stamps, step: float, dt: float) -> TimeError:
    error = TimeError.expected(
        f"dt = {step:.6g} s as in column {stamps.name!r}",
        f"dt = {dt:g} s",
        "give the right one, or pass time=False as well to ignore the column",
    )
    return error.leads_on({"dt": float(f"{step:.6g}")}, {"dt": dt, "time": False})
