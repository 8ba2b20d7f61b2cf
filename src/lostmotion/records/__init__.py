"""Loop records: what was measured, checked and cut."""

from lostmotion.records.record import LoopRecord

__all__ = ["LoopRecord"]
