"""LongDiagnosis: what the most informative stretches of a long record say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from lostmotion.diagnose.diagnosis import Diagnosis


@dataclass(frozen=True, eq=False, repr=False)
class LongDiagnosis(Diagnosis):
    """Diagnosis of a long record from looks at its most informative stretches.

    What a :class:`Diagnosis` says of the loop beside its verdict and size (fit, indices, performance) is that of the
    look that is believed, `record`.

    Attributes
    ----------
    looks : tuple of Diagnosis
        Each at two stretches, joined; the most informative first.
    diagnosed_rows : int
        Of all looks, after thinning.
    of_rows : int
        Of the record.
    shown : (int, int)
        First row of the record that shows the verdict best, and the row behind the last.
    origin : str
        Fingerprint of the record.
    """

    looks: tuple[Diagnosis, ...] = ()
    diagnosed_rows: int = 0
    of_rows: int = 0
    shown: tuple[int, int] = (0, 0)
    origin: str = ""

    @property
    def fingerprint(self) -> str:
        """Of the record as it was given, see ``LoopRecord.fingerprint``."""
        return self.origin

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: everything but the signals. Unknown numbers become None."""
        keys = ("verdict", "size", "interval_95", "confidence")
        looks = [{key: one.to_dict()[key] for key in keys} for one in self.looks]
        about = {"rows": self.of_rows, "diagnosed_rows": self.diagnosed_rows, "looks": looks}
        return {**super().to_dict(), "long_record": about}
