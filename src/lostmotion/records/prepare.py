"""prepare: from a record as a plant has it to the stretches that identification may use, each step told."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from lostmotion.records import limits
from lostmotion.records.as_record import RecordLike, as_record
from lostmotion.records.clipping import clipped
from lostmotion.records.compression import compression, made_up, scan_factor
from lostmotion.records.findings_words import (
    about_bridged,
    about_compression,
    about_drift,
    about_limits,
    about_operation,
    refusal,
)
from lostmotion.records.late_pv import moved, rows_late
from lostmotion.records.missing import bridge_missing
from lostmotion.records.modes import rows_of
from lostmotion.records.outliers import wild
from lostmotion.records.pieces import Rows, bridge, clip_to_span, longest_side, pieces
from lostmotion.records.prepared import LeftOut, Prepared, sentences
from lostmotion.records.quantum import quantum
from lostmotion.records.record import LoopRecord
from lostmotion.records.resample import pick
from lostmotion.records.sampling import runs
from lostmotion.records.splices import splices
from lostmotion.records.standstill import held_op, stopped, stuck

Kinds = npt.NDArray[np.str_]


def prepare(record: RecordLike, *, shortest: int = 60, words: Mapping[str, str] | None = None) -> Prepared:
    """Find the stretches of a record that identification may use, and say why the rest is left out.

    Left out are longer runs of missing rows, stretches in which the recording had stopped, PV stuck or was at the end
    of its range, OP was held for long or did not reach the actuator (mode column), single wild samples of PV, another
    recording glued on, and pieces too short. Set-point moves, manual moves and OP at its limits stay: they are what
    happened. Scattered missing samples, at most five in a row, get their most likely values
    (`lostmotion.records.missing`); nothing else is interpolated. PV that was plainly recorded some rows later than the
    controller saw it is moved there (`lostmotion.records.late_pv`).

    Parameters
    ----------
    record : LoopRecord, path, data frame or dict of columns
        As it was read, or to be read by :func:`lostmotion.read_loop`.
    shortest : int
        Rows that a piece must have.
    words : mapping, optional
        Further words of the mode column with what they mean, e.g. ``{"1": "automatic", "0": "manual"}``;
        meanings are "automatic", "manual" and "detached".

    Returns
    -------
    Prepared
        Stretches, rows left out, notes; or the reason of a refusal. The thresholds are in
        `lostmotion.records.limits`, the measurements behind them in docs/records.md.

    Examples
    --------
    >>> random = np.random.default_rng(0)
    >>> op, pv = random.normal(size=(2, 500))
    >>> op[300:350] = op[300]
    >>> pv[300:350] = pv[300]
    >>> prepared = prepare(LoopRecord(op, pv, dt=1.0))
    >>> prepared.rows, [(part.start, part.stop, part.kind) for part in prepared.left_out]
    (((0, 301), (350, 500)), [(301, 350, 'stopped')])
    """
    record = as_record(record)
    factor, phase = scan_factor(record)
    if factor > 1:
        return _of_slower_scan(record, factor, phase, shortest, words)
    found = _as_recorded(record, shortest, words)
    late, told = rows_late(found.stretches)
    if late == 0:
        return found
    again = _as_recorded(moved(record, late), shortest, words)
    return replace(again, record=record, notes=(told, *again.notes)) if again.usable else found


def _as_recorded(record: LoopRecord, shortest: int, words: Mapping[str, str] | None) -> Prepared:
    """Prepare the rows as they are."""
    mended, said = bridge(record)
    mended, more = clip_to_span(mended)
    kinds, joints = _reasons(mended, words)
    kinds, spared = _leave_out_wild(mended, kinds)
    bridged, filled = bridge_missing(mended, kinds == "", kinds == "missing")
    kinds[filled] = ""
    used = kinds == ""
    rows = pieces(used, mended.gaps + joints, shortest)
    for start, stop in rows:
        used[start:stop] = False  # what is still true afterwards is in pieces too short
    kinds[used] = "short"
    left_out = _parts(kinds)
    told = sentences(left_out, record)
    left = _without(mended, kinds)  # without the bridged samples: nobody may take them for a historian's
    seen = made_up(left)
    shares = {"op": compression(left, "op"), "pv": seen.pv}
    why = refusal(bridged, rows, shares, shortest, told)
    notes = [*said, *more, *about_bridged(filled), *told, *spared]
    if why is None:
        notes += [*about_operation(bridged, words), *about_limits(bridged)]
        notes += [*about_drift(bridged, rows), *about_compression(shares)]
    else:
        rows = []
    return Prepared(
        record,
        _stretches(bridged, rows),
        tuple(rows),
        left_out,
        tuple(notes),
        why,
        quantum(mended.op),
        quantum(mended.pv),
        seen,
    )


def _reasons(record: LoopRecord, words: Mapping[str, str] | None) -> tuple[Kinds, tuple[int, ...]]:
    """Kind of reason for which each row is left out, "" where it is used; and rows where recordings were joined."""
    kinds = np.full(len(record), "", dtype="<U12")
    joints = splices(record)
    detached = rows_of("detached", record.mode, words)
    found = {
        "splice": longest_side(len(record), joints),
        "mode": np.zeros(len(record), dtype=np.bool_) if detached is None else detached,
        "stopped": stopped(record),
        "held OP": held_op(record),
        "clipped PV": clipped(record.pv, record.pv_span),
        "stuck PV": stuck(record),
        "missing": record.missing,
    }
    for kind, rows in found.items():
        kinds[rows & (kinds == "")] = kind
    return _merged(kinds), joints


def _leave_out_wild(record: LoopRecord, kinds: Kinds) -> tuple[Kinds, list[str]]:
    """Mark wild samples of PV, unless there are so many that they are the nature of the signal."""
    far = wild(np.where(kinds == "", record.pv, np.nan))
    if np.mean(far) <= limits.OUTLIER_SHARE:
        return np.where(far, "outlier", kinds), []
    return kinds, [
        f"PV jumps away from its neighbours and back in {int(far.sum())} rows ({100 * np.mean(far):.2g} %): too many "
        "to be single wild samples, so none was left out. Check the transmitter."
    ]


def _merged(kinds: Kinds) -> Kinds:
    """Call PV that stands still a few rows longer than OP by the halt of the recording that it belongs to."""
    for start, length in zip(*runs(kinds == "stuck PV"), strict=True):
        beside = {kinds[max(start - 1, 0)], kinds[min(start + length, len(kinds) - 1)]}
        if "stopped" in beside:
            kinds[start : start + length] = "stopped"
    return kinds


def _parts(kinds: Kinds) -> tuple[LeftOut, ...]:
    """Runs of one kind."""
    edges = np.flatnonzero(np.r_[True, kinds[1:] != kinds[:-1], True])
    return tuple(
        LeftOut(int(start), int(stop), str(kinds[start])) for start, stop in pairwise(edges.tolist()) if kinds[start]
    )


def _without(record: LoopRecord, kinds: Kinds) -> LoopRecord:
    """Record in which the rows left out are missing."""
    if not np.any(kinds != ""):
        return record
    return replace(record, op=np.where(kinds == "", record.op, np.nan), pv=np.where(kinds == "", record.pv, np.nan))


def _stretches(record: LoopRecord, rows: Rows) -> tuple[LoopRecord, ...]:
    """Pieces as records of their own; the record itself where it is used whole."""
    if rows == [(0, len(record))] and not record.gaps:
        return (record,)
    return tuple(record.cut(start, stop) for start, stop in rows)


def _of_slower_scan(
    record: LoopRecord, factor: int, phase: int, shortest: int, words: Mapping[str, str] | None
) -> Prepared:
    """Prepare the scans that the record repeats."""
    slower = pick(record, factor, phase)
    prepared = prepare(slower, shortest=shortest, words=words)
    said = (
        f"The record repeats or interpolates a slower scan: only every {factor}th row, from row {phase + 1} on, is a "
        f"measurement. These {len(slower)} rows, {slower.dt:g} s apart, were taken; row numbers count them."
    )
    return replace(prepared, notes=(said, *prepared.notes), origin=record.fingerprint)
