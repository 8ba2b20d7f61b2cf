"""From arrays or records to the scaled segments that the estimators work on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import positive, signal
from lostmotion.arrays import FloatArray, IntArray
from lostmotion.errors import DataError, ParameterError
from lostmotion.identify.answered import pv_answers
from lostmotion.identify.controller_rows import of_past_rows
from lostmotion.identify.direction import against_pv
from lostmotion.identify.foreknown import Foretold, foretold
from lostmotion.identify.recording import Recording
from lostmotion.identify.unseen_moves import Unseen, unseen_moves
from lostmotion.records import LoopRecord, Prepared, prepare
from lostmotion.records.compression import MadeUp, made_up, made_up_of
from lostmotion.records.quantum import quantum
from lostmotion.records.record import LARGEST, fingerprint_of
from lostmotion.records.white_noise import noise_of

SMALLEST = 1e-100  # a range, whatever its unit: squares of smaller ones are 0
FEWEST_SAMPLES = 60  # below this a dead zone and first-order dynamics cannot be told from noise


@dataclass(frozen=True)
class IdentificationData:
    """Segments in engineering units and what is known about them.

    Attributes
    ----------
    u, y : ndarray, shape (n,)
        Command and output, segments one after the other.
    segments : ndarray, shape (s, 2)
        Start and stop rows.
    dt : float
        Sampling time in seconds.
    notes : tuple of str
        What was assumed, left out or changed.
    made_up : MadeUp or None
        Shares of the rows that a historian made up, as far as it is seen or told; None where arrays were given.
    plain : bool
        Whether arrays were given, not records.
    sp : ndarray, shape (n,), or None
        Set point, where it is known in every row.
    recording : Recording or None
        What more rows than these have told of how the loop was recorded.
    starts : tuple of datetime or None
        When the first row of each segment was recorded; None where it is not known, empty for arrays.
    origin : str
        Fingerprint of the records as they were given, before rows were left out; "" where arrays were given.
    """

    u: FloatArray
    y: FloatArray
    segments: IntArray
    dt: float
    tag: str = ""
    source: str = ""
    op_span: tuple[float, float] | None = None
    notes: tuple[str, ...] = ()
    pv_span: tuple[float, float] | None = None
    op_unit: str = ""
    pv_unit: str = ""
    made_up: MadeUp | None = None
    plain: bool = False
    sp: FloatArray | None = None
    recording: Recording | None = None
    starts: tuple[datetime | None, ...] = ()
    origin: str = ""

    @property
    def drawn(self) -> MadeUp | None:
        """What a historian made up; of arrays it is looked at when it is asked for: it takes as long as a short fit."""
        return made_up(LoopRecord(self.u, self.y, dt=self.dt)) if self.plain else self.made_up

    @cached_property
    def u_step(self) -> float:
        """Step in which u was stored; 0 where none is visible."""
        return quantum(self.u)

    @cached_property
    def y_step(self) -> float:
        """Step in which y was stored; 0 where none is visible."""
        return quantum(self.y)

    @cached_property
    def u_noise(self) -> float:
        """Standard deviation of the white noise in u; 0 where u is held."""
        return noise_of(self.u)

    @cached_property
    def answered(self) -> bool:
        """Whether PV answers what is new in OP, see ``pv_answers``."""
        return pv_answers(self.u, self.y, self.segments, self.sp)

    @cached_property
    def foretold(self) -> Foretold:
        """What OP says of PV beyond its past, see ``foretold``."""
        return foretold(self.u, self.y, self.segments, self.sp) if self.recording is None else self.recording.foretold

    @cached_property
    def unseen(self) -> Unseen:
        """What OP does between the rows, see ``unseen_moves``."""
        return unseen_moves(self) if self.recording is None else self.recording.unseen

    @cached_property
    def of_past_rows(self) -> bool:
        """Whether OP is a function of PV of the rows before, see ``of_past_rows``."""
        return of_past_rows(self)

    @cached_property
    def against_pv(self) -> float:
        """Standard errors of OP against PV by moves of the set point, see ``against_pv``."""
        return against_pv(self.u, self.segments, self.sp)

    @property
    def u_centre(self) -> float:
        """Median of u."""
        return float(np.median(self.u))

    @property
    def u_scale(self) -> float:
        """Standard deviation of u."""
        return float(np.std(self.u))

    @property
    def y_centre(self) -> float:
        """Mean of y."""
        return float(np.mean(self.y))

    @property
    def y_scale(self) -> float:
        """Standard deviation of y."""
        return float(np.std(self.y))

    @property
    def shortest(self) -> int:
        """Samples of the shortest segment."""
        return int((self.segments[:, 1] - self.segments[:, 0]).min())

    @property
    def fingerprint(self) -> str:
        """That of the record as it was given, see ``LoopRecord.fingerprint``: one record has one in every report."""
        return self.origin or LoopRecord(self.u, self.y, dt=self.dt).fingerprint


def collect(
    first: npt.ArrayLike | LoopRecord | Prepared | Sequence[LoopRecord | Prepared],
    y: npt.ArrayLike | None,
    dt: float | None,
    raw: bool = False,
    shortest: int = FEWEST_SAMPLES,
) -> IdentificationData:
    """Check what was handed to ``identify`` and make one data set of it.

    Records are prepared (see :func:`lostmotion.records.prepare`) unless `raw`; arrays are taken as they are.

    Raises
    ------
    DataError
        Lengths differ, too short, constant u or y, missing or infinite values in arrays or raw records (named by row
        and time), or a record that is refused.
    ParameterError
        No dt with arrays, a dt beside records, or records with different dt.
    """
    records = [first] if isinstance(first, LoopRecord | Prepared) else first
    kinds = (LoopRecord, Prepared)
    if isinstance(records, list | tuple) and records and all(isinstance(item, kinds) for item in records):
        if y is not None:
            raise ParameterError.expected("records alone", "records and y", "pass identify(record)")
        pieces, notes, seen = _stretches(records, raw, shortest)
        data = replace(_from_records(pieces, notes, dt), made_up=seen, origin=_origin(records))
    else:
        data = replace(_from_arrays(first, y, dt), plain=True)
    _check_moves(data)
    return data


def _origin(records: Sequence[LoopRecord | Prepared]) -> str:
    """Fingerprint of one record, or of several together."""
    return fingerprint_of([item.fingerprint for item in records])


def _stretches(
    records: Sequence[LoopRecord | Prepared], raw: bool, shortest: int
) -> tuple[list[LoopRecord], tuple[str, ...], MadeUp | None]:
    """Pieces that may be used, what to tell about them, what of them was made up; refused ones are left out."""
    pieces: list[LoopRecord] = []
    seen: list[tuple[MadeUp, int]] = []
    notes: list[str] = []
    refused: list[Prepared] = []
    for index, item in enumerate(records, 1):
        if isinstance(item, LoopRecord) and (raw or _short_piece(item, records)):
            pieces.append(item)
            notes += item.notes
            seen.append((made_up(item), len(item)))
            continue
        prepared = item if isinstance(item, Prepared) else prepare(item, shortest=shortest)
        name = f"{prepared.record.tag or 'record'} ({index}): " if len(records) > 1 else ""
        notes += [*prepared.record.notes, *(name + note for note in prepared.notes)]
        pieces += prepared.stretches
        if not prepared.usable:
            refused.append(prepared)
            notes.append(f"{name}left out. {prepared.refusal}.")
        elif prepared.made_up is not None:
            seen.append((prepared.made_up, sum(map(len, prepared.stretches))))
    if not pieces:
        refused[0].require()
    return pieces, tuple(dict.fromkeys(notes)), made_up_of(seen)


def _short_piece(record: LoopRecord, records: Sequence[LoopRecord | Prepared]) -> bool:
    """Whether a record is one of several and too short to prepare; such pieces are counted, not explained."""
    return len(records) > 1 and len(record) < FEWEST_SAMPLES and not (record.missing.any() or record.gaps)


def _from_arrays(u: Any, y: npt.ArrayLike | None, dt: float | None) -> IdentificationData:
    if y is None:
        raise ParameterError.expected("u and y, or a LoopRecord", "one array", "pass identify(u, y, dt=..)")
    if dt is None:
        raise ParameterError.expected("dt in seconds", None, "pass identify(u, y, dt=..)")
    arrays = []
    for name, value in (("u", u), ("y", y)):
        arrays.append(signal(name, value))
    if arrays[0].size != arrays[1].size:
        raise DataError.expected(
            "u and y of one length", f"{arrays[0].size} and {arrays[1].size}", "cut both to the same rows"
        )
    dt = positive("dt", dt)
    for name, array in zip("uy", arrays, strict=True):
        _refuse_missing(name, array, dt, "split the record there: identify takes a list of LoopRecords")
    segments = np.array([[0, arrays[0].size]])
    _check_length(segments)
    return IdentificationData(arrays[0], arrays[1], segments, dt)


def _from_records(records: Sequence[LoopRecord], notes: tuple[str, ...], dt: float | None) -> IdentificationData:
    times = sorted({record.dt for record in records})
    if len(times) > 1:
        raise ParameterError.expected("records with one dt", times, "resample them to one first")
    if dt is not None and abs(dt - times[0]) > 1e-9 * times[0]:
        raise ParameterError.expected(f"dt={times[0]} as in the record", dt, "leave dt out")
    for record in records:
        _refuse_holes(record)
    least = min(FEWEST_SAMPLES, sum(len(record) for record in records))
    kept = [record for record in records if len(record) >= least]
    dropped = len(records) - len(kept)
    if dropped:
        what = "1 piece" if dropped == 1 else f"{dropped} pieces"
        notes += (f"{what} shorter than {FEWEST_SAMPLES} samples {'was' if dropped == 1 else 'were'} left out.",)
    if not kept:
        raise DataError.expected(f"a piece of {FEWEST_SAMPLES} samples", "shorter ones only", "use a longer record")
    stops = np.cumsum([len(record) for record in kept])
    segments = np.column_stack([np.concatenate([[0], stops[:-1]]), stops]).astype(np.int64)
    _check_length(segments)
    return IdentificationData(
        np.concatenate([record.op for record in kept]),
        np.concatenate([record.pv for record in kept]),
        segments,
        times[0],
        records[0].tag,
        records[0].source,
        records[0].op_span,
        notes,
        records[0].pv_span,
        records[0].op_unit,
        records[0].pv_unit,
        sp=_set_point(kept),
        starts=tuple(record.start for record in kept),
    )


def _set_point(records: Sequence[LoopRecord]) -> FloatArray | None:
    parts = [record.sp for record in records if record.sp is not None]
    sp = np.concatenate(parts) if len(parts) == len(records) else None
    return sp if sp is not None and bool(np.isfinite(sp).all()) else None


def _refuse_holes(record: LoopRecord) -> None:
    split = "leave out raw=True, or fit its pieces: record.split()"
    _refuse_missing("OP", record.op, record.dt, split)
    _refuse_missing("PV", record.pv, record.dt, split)
    if record.gaps:
        row = record.gaps[0]
        raise DataError.expected("samples without gaps", f"a gap before row {row} (t = {row * record.dt:g} s)", split)


def _refuse_missing(name: str, array: FloatArray, dt: float, remedy: str) -> None:
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        row = int(bad[0])
        raise DataError.expected(
            f"finite {name}", f"{array[row]} in row {row} (t = {row * dt:g} s), {bad.size} such rows", remedy
        )


def _check_length(segments: IntArray) -> None:
    n = int((segments[:, 1] - segments[:, 0]).sum())
    if n < FEWEST_SAMPLES:
        raise DataError.expected(f"at least {FEWEST_SAMPLES} samples", n, "use a longer record")


def _check_moves(data: IdentificationData) -> None:
    for name, array in (("OP (u)", data.u), ("PV (y)", data.y)):
        spread, largest = float(np.ptp(array)), float(np.abs(array).max())
        if largest > LARGEST:
            raise DataError.expected(f"{name} below {LARGEST:g}", f"{largest:g}", "use other units")
        if spread <= max(1e-12 * largest, SMALLEST):
            raise DataError.expected(
                f"{name} that moves", f"the constant {array[0]:g}", "use a record in which the loop works"
            )
