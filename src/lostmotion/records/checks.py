"""Check whether a record is good enough to find lost motion in it."""

from __future__ import annotations

from lostmotion.records.as_record import Column, RecordLike, as_record
from lostmotion.records.findings import about_loop, about_means, about_sampling, about_signal, about_span
from lostmotion.records.loop_facts import describe_loop
from lostmotion.records.pieces import with_own_span
from lostmotion.records.report import RecordReport
from lostmotion.records.sampling import describe_sampling, neighbours
from lostmotion.records.signal_facts import describe_signal

_ORDER = {"error": 0, "warning": 1, "info": 2}


def check(
    record: RecordLike,
    *,
    op: str | None = None,
    pv: str | None = None,
    sp: Column = None,
    time: Column = None,
    dt: float | None = None,
) -> RecordReport:
    """Look at a record before anything is identified from it.

    Parameters
    ----------
    record : LoopRecord, path, data frame or dict of columns
        OP and PV, with spans where they are known; what is no record yet is read by :func:`lostmotion.read_loop`.
    op, pv, sp, time, dt : optional
        Columns of a path, a frame or a dict where they have other names, and the sampling time in seconds where there
        is no column of times: as in :func:`lostmotion.read_loop`, which takes more.

    Returns
    -------
    RecordReport
        Sampling, ranges, resolution, flat and straight stretches, saturation, excitation and mode, with
        findings that say what was found, why it matters and what to do. The thresholds are in
        `lostmotion.records.limits`.

    Examples
    --------
    >>> import numpy as np
    >>> from lostmotion.records import LoopRecord
    >>> t = np.arange(400.0)
    >>> record = LoopRecord(50 + 5 * np.sin(t / 9), np.cos(t / 9), sp=np.zeros(400), dt=1.0, tag="FIC-101")
    >>> report = check(record)
    >>> report.usable, report.loop.mode, report.loop.op_reversals
    (True, 'automatic, SP constant', 14)
    >>> print(check(record.cut(0, 100)).findings[0])
    WARNING Only 100 samples. Below 200 the interval of a dead zone is wide. Use a longer record.
    """
    record = as_record(record, op=op, pv=pv, sp=sp, time=time, dt=dt)
    sampling = describe_sampling(record)
    follows = neighbours(record)
    spans = {"OP": (record.op, record.op_span), "PV": (record.pv, record.pv_span)}
    about_spans = [finding for name, (values, span) in spans.items() for finding in about_span(name, values, span)]
    record = with_own_span(record)
    of_op = describe_signal("OP", record.op, follows, record.op_span)
    of_pv = describe_signal("PV", record.pv, follows, record.pv_span)
    loop = None if of_op is None else describe_loop(record, of_op)
    findings = [
        *about_sampling(sampling),
        *about_signal(of_op, "OP", record.dt),
        *about_signal(of_pv, "PV", record.dt),
        *about_spans,
        *about_means(record.sp),
        *(about_loop(loop, of_op, record.dt) if of_op is not None and loop is not None else ()),
    ]
    findings.sort(key=lambda finding: _ORDER[finding.level])
    return RecordReport(repr(record), sampling, of_op, of_pv, loop, findings, record.notes)
