"""Sentences about a prepared record: what to know when reading a result, and why a record is refused."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.records import limits
from lostmotion.records.compression import Compression
from lostmotion.records.loop_facts import saturation, sp_moves
from lostmotion.records.modes import rows_of, unknown_words
from lostmotion.records.pieces import Rows
from lostmotion.records.record import LoopRecord
from lostmotion.records.sampling import Bools, neighbours, runs
from lostmotion.records.signal_facts import describe_signal

RAW = "or take the record as it is with raw=True"


def about_bridged(rows: Bools) -> list[str]:
    """Missing samples that were given their most likely values.

    Examples
    --------
    >>> about_bridged(np.arange(6000) % 50 == 7)[0][:64]
    '120 missing samples (2 %) bridged, at most 1 in a row: each has '
    """
    if not rows.any():
        return []
    count, longest = int(rows.sum()), int(runs(rows)[1].max())
    return [
        f"{count} missing sample{'s' if count > 1 else ''} ({100 * count / len(rows):.2g} %) bridged, at most "
        f"{longest} in a row: each has its most likely value given the rows before and after, and cuts nothing."
    ]


def about_operation(record: LoopRecord, words: Mapping[str, str] | None = None) -> list[str]:
    """Gaps, mode of the controller and set-point moves."""
    said = []
    if record.gaps:
        places = f"{len(record.gaps)} place{'s' if len(record.gaps) > 1 else ''}"
        said.append(f"Time is missing in {places}; the model is not carried across.")
    manual = rows_of("manual", record.mode, words)
    if manual is not None and manual.any():
        said.append(f"Manual in {int(manual.sum())} rows; moves of OP by hand stay in, they tell as much as any.")
    strange = unknown_words(record.mode, words)
    if strange:
        shown = ", ".join(repr(word) for word in strange[:3]) + (" .." if len(strange) > 3 else "")
        said.append(
            f"Modes {shown} are not known here; their rows were used. Say which means automatic: automatic=(..)."
        )
    moves = sp_moves(record.sp)
    if moves and moves <= limits.MOVING_SHARE * len(record):
        said.append(f"SP moved in {moves} row{'s' if moves > 1 else ''}; that excites the loop and stays in.")
    return said


def about_limits(record: LoopRecord) -> list[str]:
    """OP that stands at its limits."""
    facts = describe_signal("OP", record.op, neighbours(record), record.op_span)
    if facts is None or facts.constant:
        return []
    said = []
    for share, name, value in zip(saturation(record, facts), ("lower", "upper"), (facts.low, facts.high), strict=True):
        if share > limits.SATURATED_SHARE:
            said.append(
                f"OP stands at its {name} limit ({value:g}) in {100 * share:.2g} % of the rows. It was recorded behind "
                "the limit, as the actuator received it, and stays in; a dead zone beyond the limit is not seen."
            )
    return said


def about_drift(record: LoopRecord, rows: Rows) -> list[str]:
    """Disturbances slower than the record is long: in OP at constant SP, in the control error at a moving one."""
    moves = sp_moves(record.sp)
    if record.sp is None or moves is None:
        return []  # without SP, a slow move may be wanted
    start, stop = max(rows, key=lambda pair: pair[1] - pair[0])
    name, values = ("PV - SP", record.pv - record.sp) if moves else ("OP", record.op)
    share = slow_share(values[start:stop])
    if share <= limits.DRIFT_SHARE:
        return []
    return [
        f"{name} drifts: {100 * share:.0f} % of its variance is slower than the record is long. "
        "Slow disturbances are left to the noise model."
    ]


def slow_share(values: FloatArray) -> float:
    """Share of variance in half a period to one and a half over the whole record.

    Examples
    --------
    >>> round(slow_share(np.arange(100.0)), 2), round(slow_share(np.sin(np.arange(1000.0) / 20)), 2)
    (1.0, 0.01)
    """
    from scipy.fft import dct  # noqa: PLC0415  only records with a set point wait for it

    known = values[~np.isnan(values)]
    power = dct(known - known.mean(), norm="ortho") ** 2 if len(known) > 3 else np.zeros(1)
    return float(power[:4].sum() / max(power.sum(), 1e-300))


def about_compression(made_up: Mapping[str, Compression]) -> list[str]:
    """Shares of rows that a historian made up, where they matter and are not refused."""
    said = []
    for name, found in made_up.items():
        if found.share > limits.COMPRESSED_TOLD:
            narrow = (
                "intervals are too narrow, up to twice" if found.share > limits.COMPRESSED_WARN else "it hides noise"
            )
            said.append(f"{_made_up(name, found)}: {narrow}. Export raw values, with compression off.")
    return said


def refusal(
    record: LoopRecord, rows: Rows, made_up: Mapping[str, Compression], shortest: int, left: list[str]
) -> str | None:
    """Why a record is not to be used: "expected .., got ..; do .."; None where it may be."""
    for name in ("op", "pv"):
        known = getattr(record, name)[~np.isnan(getattr(record, name))]
        if not len(known):
            return f"expected {name.upper()}, got only missing samples; check the column and its export"
        if known.min() == known.max():
            got = f"the constant {known[0]:g}"
            return f"expected {name.upper()} that moves, got {got}; use a record in which the loop works, or a test"
    for name, found in made_up.items():
        if found.share >= limits.COMPRESSED_REFUSE:
            remedy = f"export raw values, with compression off, {RAW}"
            return f"expected measured values of {name.upper()}, got: {_made_up(name, found)}; {remedy}"
    if not rows:
        because = " ".join(left)
        return f"expected a stretch of {shortest} rows, got none. {because} Use a longer record, {RAW}"
    for name in ("op", "pv"):
        if all(np.ptp(getattr(record, name)[start:stop]) == 0 for start, stop in rows):
            return (
                f"expected {name.upper()} that moves, got one that stands still in all that is left. {' '.join(left)} "
                f"Use a record in which the loop works, {RAW}"
            )
    return None


def _made_up(name: str, found: Compression) -> str:
    kinds = []
    if found.straight > 0.01:
        kinds.append(f"{100 * found.straight:.0f} % on exact straight lines")
    if found.held > 0.01:
        kinds.append(f"{100 * found.held:.0f} % repeat the value before")
    return f"{100 * found.share:.0f} % of the rows of {name.upper()} were made up by the historian ({', '.join(kinds)})"
