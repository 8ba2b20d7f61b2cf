"""PooledDiagnosis: what many records of one valve say together."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lostmotion.brief import counted
from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.diagnose.pooled.trend_of_size import SizeTrend

SPEAKS = 1.0  # of log-likelihood, for or against: a record that adds less told nothing


@dataclass(frozen=True)
class RecordShare:
    """What one record added.

    Attributes
    ----------
    name : str
    place : float
        Start in days where it is known, else its number.
    rows : int
        Used; 0 where the record was left out.
    alone : str
        Verdict of this record by itself, "" where it was left out.
    gain : float
        Log-likelihood of the pooled kind at the common size over a linear process; a single record counts up to 3.
    size : float
        Most likely size in this record alone if it is of the pooled kind, units of OP; NaN where it does not show one.
    interval : (float, float)
        95 % interval of it.
    note : str
        Why the record, or a part of it, was left out.
    """

    name: str
    place: float
    rows: int
    alone: str = ""
    gain: float = 0.0
    size: float = float("nan")
    interval: tuple[float, float] = (float("nan"), float("nan"))
    note: str = ""

    @property
    def said(self) -> str:
        """One of "for", "against", "nothing", "left out"."""
        if not self.rows:
            return "left out"
        if abs(self.gain) < SPEAKS:
            return "nothing"
        return "for" if self.gain > 0.0 else "against"

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        known = bool(np.isfinite([self.size, *self.interval]).all())
        return {
            "name": self.name,
            "place": self.place,
            "rows": self.rows,
            "alone": self.alone,
            "said": self.said,
            "gain": self.gain,
            "size": self.size if known else None,
            "interval_95": list(self.interval) if known else [None, None],
            "note": self.note,
        }


@dataclass(frozen=True, eq=False, repr=False)
class PooledDiagnosis(Diagnosis):
    """Diagnosis from many records of one valve.

    What a :class:`Diagnosis` says of the loop beside its verdict (fit, indices, performance) is that of the record that
    tells most, `record`.

    Attributes
    ----------
    shares : tuple of RecordShare
        What each record added, in the order given.
    totals : dict of float
        Log-likelihood of every kind over a linear process, all records together; "none" is 0.
    kind_confidence : float
        Probability of the kind among the kinds, where a fault is named.
    scatter : float
        Relative deviation of the size from record to record.
    trend : SizeTrend
        Of the size over the records.
    carried_by : str
        Record without which the verdict would be another; "" where there is none.
    diagnoses : tuple of Diagnosis
        Of each record that was heard, by itself.
    origin : str
        Fingerprint of all that was given.
    """

    shares: tuple[RecordShare, ...] = ()
    totals: dict[str, float] = field(default_factory=dict)
    kind_confidence: float = float("nan")
    scatter: float = float("nan")
    trend: SizeTrend = field(default_factory=lambda: SizeTrend(np.nan, (np.nan, np.nan), "record", np.nan, 0))
    carried_by: str = ""
    diagnoses: tuple[Diagnosis, ...] = field(default=(), repr=False)
    origin: str = ""

    @property
    def fingerprint(self) -> str:
        """Of all records together."""
        return self.origin or super().fingerprint

    @property
    def single(self) -> str:
        """The one record that could be used, whose diagnosis this is; "" where there are several."""
        heard = [share.name for share in self.shares if share.rows]
        return heard[0] if len(heard) == 1 else ""

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return *super().repr_parts(), counted(len(self.shares), "record")

    def counted(self, said: str) -> int:
        """Records that said so: "for", "against", "nothing", "left out"."""
        return sum(share.said == said for share in self.shares)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: everything but the signals. Unknown numbers become None."""
        return {
            **super().to_dict(),
            "pooled": {
                "records": [share.to_dict() for share in self.shares],
                "log_likelihoods": dict(self.totals),
                "kind_confidence": self.kind_confidence if np.isfinite(self.kind_confidence) else None,
                "scatter": self.scatter if np.isfinite(self.scatter) else None,
                "trend": self.trend.to_dict(),
                "carried_by": self.carried_by,
            },
        }
