"""How each of several records is to be diagnosed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

from lostmotion.diagnose.audit_class import LEAST_INDEX
from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.diagnose.one_record import diagnose
from lostmotion.records import LoopRecord
from lostmotion.records.loop_type import surely_integrates


@dataclass(frozen=True)
class DiagnosisSettings:
    """How each record is to be diagnosed; as in :func:`lostmotion.diagnose`."""

    integrating: bool | None
    loop_type: str | None
    tolerance: float

    def of(self, records: Sequence[LoopRecord]) -> DiagnosisSettings:
        """With the type of the loop that most tags say, where none was given: a loop has one, a file may not tell."""
        types = Counter(record.loop_type for record in records if record.loop_type in LEAST_INDEX)
        if self.loop_type is not None or not types:
            return self
        return replace(self, loop_type=types.most_common(1)[0][0])

    @property
    def integrates(self) -> bool | None:
        """Whether the process integrates, where that is known."""
        return surely_integrates(self.loop_type or "") if self.integrating is None else self.integrating

    def diagnosis(self, record: LoopRecord) -> Diagnosis:
        """Of one record by itself."""
        return diagnose(record, integrating=self.integrating, loop_type=self.loop_type, tolerance=self.tolerance)
