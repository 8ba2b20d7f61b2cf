"""Records of one loop, one after another -> one record with gaps between them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError
from lostmotion.records.record import LoopRecord, StringArray
from lostmotion.records.when import elapsed_seconds

SAME = 1e-6  # of a sampling time: two that differ less are one
SHOWN = 3  # records in a note
VALUES = 1e-6  # of a value: what is written with seven digits is the same
AGREE = 0.9  # of the rows that two records have in common
FEWEST = 2  # rows of a record


def pooled(records: Sequence[LoopRecord]) -> LoopRecord:
    """One record of several of the same loop.

    Parameters
    ----------
    records : sequence of LoopRecord
        Dated, of different times.

    Raises
    ------
    DataError
        One does not say when it began, or two are of the same time and differ.

    Notes
    -----
    Rows that two records have in common count once. Only records of the most frequent sampling time are used, and of
    those with the same values only the first: what is left out is said in the notes.

    Examples
    --------
    >>> days = [LoopRecord([1.0, 2.0], [k, 3.0], dt=1.0, start=f"2026-03-0{k} 06:00") for k in (1, 2)]
    >>> whole = pooled(days)
    >>> whole.gaps, whole.gap_seconds, len(whole)
    ((2,), (86398.0,), 4)
    """
    if len(records) == 1:
        return records[0]
    undated = next((one.source for one in records if one.start is None), None)
    if undated is not None:
        remedy = "name each record as a loop of its own in a loop list (tag, file)"
        raise DataError.expected("records of one loop with dates", f"none in {undated!r}", remedy)
    kept, notes = _of_one_rate(sorted(records, key=_began))
    kept, again = _different(kept)
    kept = _without_overlap(kept)
    first = kept[0]
    own = tuple(dict.fromkeys(note for one in kept for note in one.notes))
    gaps, lost = _gaps(kept, [_elapsed(first, one) for one in kept])
    return replace(
        first,
        op=np.concatenate([one.op for one in kept]),
        pv=np.concatenate([one.pv for one in kept]),
        sp=_signal([one.sp for one in kept], kept),
        position=_signal([one.position for one in kept], kept),
        mode=_modes(kept),
        gaps=gaps,
        gap_seconds=lost,
        notes=(f"Joined from {len(kept)} records of different times.", *own, *notes, *again),
        made_up=_made_up(kept),
        source=f"{first.source} and {len(kept) - 1} more" if len(kept) > 1 else first.source,
    )


def _began(record: LoopRecord) -> tuple[bool, float]:
    start = record.start
    return (True, 0.0) if start is None else (start.tzinfo is None, start.timestamp())


def _of_one_rate(records: Sequence[LoopRecord]) -> tuple[list[LoopRecord], tuple[str, ...]]:
    rates = Counter(one.dt for one in records)
    usual = max(rates, key=lambda dt: rates[dt])
    kept = [one for one in records if abs(one.dt - usual) <= SAME * usual]
    others = [f"{one.source} (every {one.dt:g} s)" for one in records if abs(one.dt - usual) > SAME * usual]
    return kept, (_left_out(others, f"other records are sampled every {usual:g} s"),) if others else ()


def _different(records: Sequence[LoopRecord]) -> tuple[list[LoopRecord], tuple[str, ...]]:
    first: dict[str, LoopRecord] = {}
    again = [one.source for one in records if first.setdefault(one.fingerprint, one) is not one]
    said = (_left_out(again, "the values are those of another record"),) if again else ()
    return list(first.values()), said


def _without_overlap(records: Sequence[LoopRecord]) -> list[LoopRecord]:
    """Records of which none begins before the one before it has ended.

    Raises
    ------
    DataError
        Where two are of the same time their values differ.
    """
    kept = [records[0]]
    for one in records[1:]:
        before = kept[-1]
        common = round((_elapsed(records[0], before) + _seconds(before) - _elapsed(records[0], one)) / one.dt)
        if common <= 0:
            kept.append(one)
            continue
        rows = min(common, len(one), len(before))
        begin = len(before) - common
        same = begin >= 0 and all(
            _alike(getattr(before, name)[begin : begin + rows], getattr(one, name)[:rows]) for name in ("op", "pv")
        )
        if not same:
            got = f"other values in {one.source!r} than in {before.source!r} from {one.start} on"
            remedy = "leave one out, or name each as a loop of its own in a loop list (tag, file)"
            raise DataError.expected("one record of a loop at a time", got, remedy)
        if len(one) - common >= FEWEST:
            kept.append(one[common:])
    return kept


def _alike(one: FloatArray, other: FloatArray) -> bool:
    """Whether nearly all values are the same: averages over a scan differ at the ends of an export."""
    return bool(np.isclose(one, other, rtol=VALUES, equal_nan=True).mean() >= AGREE)


def _elapsed(first: LoopRecord, one: LoopRecord) -> float:
    """Seconds from the start of one record to that of another."""
    return 0.0 if first.start is None or one.start is None else elapsed_seconds(first.start, one.start)


def _seconds(record: LoopRecord) -> float:
    """From its first row to one step behind its last."""
    return len(record) * record.dt + sum(record.gap_seconds)


def _left_out(names: Sequence[str], why: str) -> str:
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return f"Left out: {', '.join(names[:SHOWN])}{more}; {why}."


def _gaps(records: Sequence[LoopRecord], offsets: Sequence[float]) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Rows behind gaps and the seconds missing there; of a record whose gaps have no length none has."""
    gaps: list[int] = []
    lost: list[float] = []
    rows, end = 0, 0.0
    for one, begin in zip(records, offsets, strict=True):
        missing = begin - end
        if rows and missing > 0.5 * one.dt:
            gaps.append(rows)
            lost.append(round(missing, 4))
        gaps += [rows + gap for gap in one.gaps]
        lost += one.gap_seconds or [np.nan] * len(one.gaps)
        rows += len(one)
        end = begin + _seconds(one)
    return tuple(gaps), () if np.isnan(lost).any() else tuple(lost)


def _signal(each: Sequence[FloatArray | None], records: Sequence[LoopRecord]) -> FloatArray | None:
    if all(one is None for one in each):
        return None
    return np.concatenate(
        [np.full(len(record), np.nan) if one is None else one for one, record in zip(each, records, strict=True)]
    )


def _modes(records: Sequence[LoopRecord]) -> StringArray | None:
    if all(one.mode is None for one in records):
        return None
    words: list[npt.NDArray[np.str_]] = [
        np.full(len(one), "", dtype=np.str_) if one.mode is None else one.mode for one in records
    ]
    return np.concatenate(words)


def _made_up(records: Sequence[LoopRecord]) -> tuple[float, float]:
    rows = np.array([len(one) for one in records], dtype=np.float64)
    shares = np.array([one.made_up for one in records])
    op, pv = (rows @ shares / rows.sum()).tolist()
    return op, pv
