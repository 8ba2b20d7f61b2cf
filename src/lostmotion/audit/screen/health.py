"""Health of the data of a window: what is wrong with them, and whether they allow a judgement."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.audit.screen.scatter import MOST_DT
from lostmotion.diagnose.control_error.rows import ScreenRows
from lostmotion.records import LoopRecord, limits
from lostmotion.records.compression import compression
from lostmotion.records.quantum import quantum
from lostmotion.records.sampling import neighbours
from lostmotion.records.span import beyond

EXCERPT, EXCERPTS = 2048, 3  # rows from which archive and resolution are told, at places all over the window
TOLD = 0.005  # share of time from which on a standstill is told
UNFIT = 0.5  # share of time without live data from which on the window is not judged
SAME = 1e-6  # of the range: signals nearer than this are one


@dataclass(frozen=True)
class Health:
    """Health of a window's data.

    Attributes
    ----------
    findings : tuple of str
        What is wrong, one short sentence each.
    fit : bool
        Whether a judgement is possible.
    missing, stale : float
        Shares of time.
    problem : str
        The finding for which no judgement is possible; empty where it is.
    """

    findings: tuple[str, ...]
    fit: bool
    missing: float
    stale: float
    problem: str = ""


def health_of(rows: ScreenRows) -> Health:
    """What is wrong with the data of a window."""
    record = rows.record
    missing, stale = missing_share(record), rows.share(rows.standing & rows.known)
    live = int(rows.known.sum() - (rows.standing & rows.known).sum())
    stopping = list(_stopping(rows, live, missing, stale))
    parts = (_about_sp(rows), _about_archive(record), _about_op(rows), _about_scatter(record), _about_dates(record))
    rest = [] if _nothing(record) else [found for part in parts for found in part]
    told = [*_about_missing(missing, stale), *(one for one, _ in rest)]
    grave = [*stopping, *(one for one, stops in rest if stops)]
    return Health((*stopping, *told), not grave, missing, stale, grave[0] if grave else "")


def missing_share(record: LoopRecord) -> float:
    """Share of time without OP or PV, what gaps left out among it."""
    lost = float(sum(record.gap_seconds)) / record.dt
    return float((record.missing.sum() + lost) / (len(record) + lost))


def _nothing(record: LoopRecord) -> bool:
    return bool(np.isnan(record.op).all() or np.isnan(record.pv).all())


def _stopping(rows: ScreenRows, live: int, missing: float, stale: float) -> Iterator[str]:
    """What allows no judgement."""
    record = rows.record
    for name, values in (("OP", record.op), ("PV", record.pv)):
        known = values[np.isfinite(values)]
        if not known.size:
            yield f"{name} is missing all the time"
        elif name == "PV" and float(np.ptp(known)) == 0.0:
            yield f"PV is constant ({known[0]:g})"
    if not _nothing(record) and _same(record.op, record.pv):
        yield "OP and PV are the same signal"
    elif live < limits.SHORT:
        yield f"only {live} rows of live data, {limits.SHORT} are needed"
    elif missing + stale > UNFIT:
        yield f"no live data for {_percent(missing + stale)} of the time"


def _about_missing(missing: float, stale: float) -> Iterator[str]:
    if missing > TOLD:
        yield f"bad or missing for {_percent(missing)} of the time"
    if stale > TOLD:
        yield f"stale for {_percent(stale)} of the time"


def _about_sp(rows: ScreenRows) -> Iterator[tuple[str, bool]]:
    record = rows.record
    if record.sp is None:
        yield "no SP recorded", False
        return
    if rows.sp_apart:
        pv, sp = float(np.nanmedian(record.pv)), float(np.nanmedian(record.sp))
        yield f"SP ({sp:.4g}) and PV ({pv:.4g}) never come near each other: other units, or overridden", False
    elif _same(record.sp, record.pv):
        yield "SP and PV are the same signal (SP tracks PV)", False


def _about_archive(record: LoopRecord) -> Iterator[tuple[str, bool]]:
    """Compression, rate and resolution, from excerpts."""
    parts = excerpts(record)
    share = float(np.median([compression(part, "pv").share for part in parts]))
    share = max(share, record.made_up[1])
    if share > limits.COMPRESSED_TOLD:
        yield f"compressed: {_percent(share)} of PV is interpolated or held", share >= limits.COMPRESSED_REFUSE
    refresh = float(np.median([_refresh(part) for part in parts]))
    if refresh > limits.REFRESH_ROWS:
        yield f"PV and OP change every {refresh * record.dt:.3g} s, rows are {record.dt:g} s apart", False
    seen = record.pv[:: max(len(record) // (4 * EXCERPT), 1)]
    amplitude = float(np.subtract(*np.nanquantile(seen, [0.95, 0.05]))) if np.isfinite(seen).any() else 0.0
    step = float(np.median([quantum(part.pv) for part in parts]))
    if amplitude > 0.0 and step > limits.COARSE_STEP * amplitude:
        yield f"PV is coarse: steps of {step:.3g} in a range of {amplitude:.3g}", False


def _about_op(rows: ScreenRows) -> Iterator[tuple[str, bool]]:
    record = rows.record
    outside = float(np.mean(beyond(record.op, record.op_span)))
    if record.op_span is not None and outside > TOLD:
        low, high = record.op_span
        yield f"OP is outside its span {low:g} .. {high:g} for {_percent(outside)} of the time", False
    if record.op_span is None and rows.span is not None and not rows.span.known:
        of_what = (
            rows.span.words if rows.span.others else f"of the range seen, {rows.span.low:.4g} .. {rows.span.high:.4g}"
        )
        yield f"span of OP unknown: % are {of_what}", False
    if not rows.modes_known and rows.share(rows.manual) > TOLD:
        yield f"no mode recorded: OP held for {_percent(rows.share(rows.manual))} of the time counts as manual", False


def _about_scatter(record: LoopRecord) -> Iterator[tuple[str, bool]]:
    """Why a noisy measurement would not be seen."""
    if record.pv_span is None:
        yield "span of PV unknown: a noisy measurement cannot be told, % of PV are of the range seen", False
    elif record.dt > MOST_DT:
        yield f"rows are {record.dt:g} s apart: a noisy measurement cannot be told, {MOST_DT:g} s is the most", False


def _about_dates(record: LoopRecord) -> Iterator[tuple[str, bool]]:
    if record.start is None:
        yield "no dates: whether loops of other files swing at the same time cannot be told", False


def excerpts(record: LoopRecord) -> list[LoopRecord]:
    """Short parts from all over a long record, itself where it is short; those with nothing in them are left out."""
    if len(record) <= EXCERPT * EXCERPTS:
        return [replace(record, gaps=record.gaps)]
    places = np.linspace(0, len(record) - EXCERPT, EXCERPTS).astype(np.int64).tolist()
    parts = [record.cut(place, place + EXCERPT) for place in places]
    return [part for part in parts if not part.missing.all()] or parts[:1]


def _refresh(record: LoopRecord) -> float:
    """Rows per row in which OP or PV changes."""
    moved = ((np.diff(record.op) != 0) | (np.diff(record.pv) != 0)) & neighbours(record)
    return len(record) / max(int(moved.sum()), 1)


def _same(first: FloatArray, second: FloatArray) -> bool:
    """Whether two signals are one, as far as both are known."""
    thin = max(len(first) // EXCERPT, 1)
    return _agree(first[::thin], second[::thin]) and _agree(first, second)


def _agree(first: FloatArray, second: FloatArray) -> bool:
    both = np.isfinite(first) & np.isfinite(second)
    if int(both.sum()) < limits.SHORTEST:
        return False
    a, b = first[both], second[both]
    reach = float(np.ptp(a))
    return bool(reach > 0.0 and np.abs(a - b).max() <= SAME * reach)


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %" if share >= 0.1 else f"{100.0 * share:.2g} %"
