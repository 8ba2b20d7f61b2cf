"""Check whether a record is good enough to find lost motion in it."""

from __future__ import annotations

from lostmotion.records.findings import about_loop, about_means, about_sampling, about_signal, about_span
from lostmotion.records.loop_facts import describe_loop
from lostmotion.records.pieces import with_own_span
from lostmotion.records.record import LoopRecord
from lostmotion.records.report import RecordReport
from lostmotion.records.sampling import describe_sampling, neighbours
from lostmotion.records.signal_facts import describe_signal

_ORDER = {"error": 0, "warning": 1, "info": 2}


def check(record: LoopRecord) -> RecordReport:
    """Look at a record before anything is identified from it.

    Parameters
    ----------
    record : LoopRecord
        OP and PV, with spans where they are known.

    Returns
    -------
    RecordReport
        Sampling, ranges, resolution, flat and straight stretches, saturation, excitation and mode, with
        findings that say what was found, why it matters and what to do. The thresholds are in
        `lostmotion.records.limits`.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(400.0)
    >>> record = LoopRecord(50 + 5 * np.sin(t / 9), np.cos(t / 9), sp=np.zeros(400), dt=1.0, tag="FIC-101")
    >>> report = check(record)
    >>> report.usable, report.loop.mode, report.loop.op_reversals
    (True, 'automatic, SP constant', 14)
    >>> print(check(record.cut(0, 100)).findings[0])
    WARNING Only 100 samples. Below 200 the interval of a dead zone is wide. Use a longer record.
    """
    sampling = describe_sampling(record)
    follows = neighbours(record)
    spans = {"OP": (record.op, record.op_span), "PV": (record.pv, record.pv_span)}
    named = [finding for name, (values, span) in spans.items() for finding in about_span(name, values, span)]
    record = with_own_span(record)
    op = describe_signal("OP", record.op, follows, record.op_span)
    pv = describe_signal("PV", record.pv, follows, record.pv_span)
    loop = None if op is None else describe_loop(record, op)
    findings = [
        *about_sampling(sampling),
        *about_signal(op, "OP", record.dt),
        *about_signal(pv, "PV", record.dt),
        *named,
        *about_means(record.sp),
        *(about_loop(loop, op, record.dt) if op is not None and loop is not None else ()),
    ]
    findings.sort(key=lambda finding: _ORDER[finding.level])
    return RecordReport(repr(record), sampling, op, pv, loop, findings, record.notes)
