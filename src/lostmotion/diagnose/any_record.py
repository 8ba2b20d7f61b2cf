"""``diagnose`` for whatever there is of a loop: one record, many, or one that is long."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar, overload

from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.diagnose.frozen import judged_by_measurement
from lostmotion.diagnose.long_record.any_length import diagnose_valve
from lostmotion.diagnose.op_span import TOLERANCE
from lostmotion.diagnose.pooled.settings import DiagnosisSettings
from lostmotion.diagnose.pooled.together import diagnose_together
from lostmotion.diagnose.position import judged_by_position
from lostmotion.diagnose.ringing import judged_by_amplitude
from lostmotion.diagnose.sampling import sampling_advice
from lostmotion.errors import ParameterError
from lostmotion.records import LoopRecord, RecordLike
from lostmotion.records.as_record import Column, as_record, as_records

Found = TypeVar("Found", bound=Diagnosis)


@overload
def diagnose(
    record: RecordLike,
    *,
    integrating: bool | None = None,
    loop_type: str | None = None,
    tolerance: float = TOLERANCE,
    progress: Callable[[str], None] | None = None,
    op: str | None = None,
    pv: str | None = None,
    sp: Column = None,
    time: Column = None,
    dt: float | None = None,
) -> Diagnosis: ...


@overload
def diagnose(
    record: Sequence[RecordLike],
    *,
    integrating: bool | None = None,
    loop_type: str | None = None,
    tolerance: float = TOLERANCE,
    starts: Sequence[float] | None = None,
    progress: Callable[[str], None] | None = None,
    op: str | None = None,
    pv: str | None = None,
    sp: Column = None,
    time: Column = None,
    dt: float | None = None,
) -> Diagnosis: ...


def diagnose(
    record: RecordLike | Sequence[RecordLike],
    *,
    integrating: bool | None = None,
    loop_type: str | None = None,
    tolerance: float = TOLERANCE,
    starts: Sequence[float] | None = None,
    progress: Callable[[str], None] | None = None,
    op: str | None = None,
    pv: str | None = None,
    sp: Column = None,
    time: Column = None,
    dt: float | None = None,
) -> Diagnosis:
    """Say what is wrong with a loop, from its routine record or from many records of it.

    Main evidence is how well each kind of actuator predicts what it was not fitted to; the field's indices of shape
    are weighed in by log-odds that were calibrated (docs/diagnosis.md). Many records have one valve, each with a
    process and noise of its own: what each says of every size is added up (:mod:`lostmotion.diagnose.pooled.evidence`).
    A record of more than 50,000 rows is read by looks at its most informative stretches, as in an audit.

    Parameters
    ----------
    record : LoopRecord, path, data frame or dict of columns, or a sequence of them
        OP and PV, with SP where known; what is no record yet is read by :func:`lostmotion.read_loop`. Each is prepared
        first (:func:`lostmotion.records.prepare`).
    integrating : bool, optional
        Whether the process integrates (a level); `identify` looks at no other. None: as identified, but for a flow,
        which does not.
    loop_type : {"flow", "pressure", "temperature", "level", "analyser", "concentration", "other"}, optional
        What PV measures: the classes of performance depend on it. None: as the tag of the record says.
    tolerance : float
        Lost motion that does not matter, as a share of the span of OP. The actuator is cleared only where the records
        exclude larger ones.
    starts : sequence of float, optional
        Of many records: when each begins, in seconds, for the trend of the size. None: only their order is known.
    progress : callable, optional
        Told in words how far a diagnosis of many records or a long one is.
    op, pv, sp, time, dt : optional
        Columns of a path, a frame or a dict where they have other names, and the sampling time in seconds where there
        is no column of times: as in :func:`lostmotion.read_loop`, which takes more.

    Returns
    -------
    Diagnosis
        A PooledDiagnosis where there were many records, a LongDiagnosis of a long one; a list of one is that record.

    Raises
    ------
    DataError
        The record is refused, with the reason; of many: all of them.
    ParameterError
        Unknown loop type, a tolerance outside (0, 1), start times of another number than records, or records with OP
        in different units.

    Examples
    --------
    >>> import lostmotion as lm
    >>> lm.diagnose(lm.datasets.load("FIC-101")).verdict
    'stiction'
    >>> lm.diagnose(lm.datasets.path("FIC-101")).verdict
    'stiction'
    """
    read: LoopRecord | list[LoopRecord] = as_records(record, op=op, pv=pv, sp=sp, time=time, dt=dt)
    if not isinstance(read, list | tuple):
        read = as_record(read)
    asked = DiagnosisSettings(integrating, loop_type, tolerance)
    if isinstance(read, list | tuple) and len(read) != 1:
        pooled = diagnose_together([as_record(one) for one in read], asked, starts, progress)
        return judged_by_position(_with_sampling(pooled), pooled.record)
    if isinstance(read, list | tuple):
        _check_single(starts)
        read, starts = as_record(read), None
    if starts is not None:
        raise ParameterError.expected("start times of many records only", "one record", "leave starts out")
    found = diagnose_valve(read, progress, integrating=integrating, loop_type=loop_type, tolerance=tolerance)
    judged = judged_by_measurement(judged_by_amplitude(found, read), read)
    return judged_by_position(_with_sampling(judged), read)


def _with_sampling(found: Found) -> Found:
    """With the advice to record faster before all other, where nothing was found in a record that is too slow."""
    slow = sampling_advice(found) if found.verdict in ("cannot tell", "other oscillation") else ""
    return replace(found, advice=(slow, *found.advice)) if slow else found


def _check_single(starts: Sequence[float] | None) -> None:
    """Check the start times of a list of one record, whose size has no trend."""
    if starts is not None and len(starts) != 1:
        raise ParameterError.expected("1 start times", len(starts), "give one for each record")
