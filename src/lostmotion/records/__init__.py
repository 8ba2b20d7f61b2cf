"""Loop records: what was measured, checked, prepared and cut."""

from lostmotion.records.as_record import RecordLike, as_record
from lostmotion.records.checks import check
from lostmotion.records.prepare import prepare
from lostmotion.records.prepared import LeftOut, Prepared
from lostmotion.records.record import LoopRecord
from lostmotion.records.report import Finding, RecordReport
from lostmotion.records.resample import resample

__all__ = [
    "Finding",
    "LeftOut",
    "LoopRecord",
    "Prepared",
    "RecordLike",
    "RecordReport",
    "as_record",
    "check",
    "prepare",
    "resample",
]
