"""Loop records: what was measured, checked and cut."""

from lostmotion.records.checks import check
from lostmotion.records.record import LoopRecord
from lostmotion.records.report import Finding, RecordReport

__all__ = ["Finding", "LoopRecord", "RecordReport", "check"]
