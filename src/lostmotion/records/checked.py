"""CheckedRecord: what a record holds and what of it would be used; of several, a line each and a table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from lostmotion import _verbs
from lostmotion.brief import Brief
from lostmotion.records.checks import check
from lostmotion.records.prepare import prepare
from lostmotion.records.prepared import Prepared
from lostmotion.records.record import LoopRecord
from lostmotion.records.report import RecordReport
from lostmotion.summary import Summary
from lostmotion.text_table import text_table

NAME = 20
HEAD = ("loop", "usable", "samples", "dt, s", "used, %", "errors", "warnings")
WIDTHS = (NAME, 8, 9, 9, 9, 8, 8)


@dataclass(frozen=True, eq=False, repr=False)
class CheckedRecord(Brief):
    """Report and preparation of one record.

    Attributes
    ----------
    report : RecordReport
        The facts and what they mean.
    prepared : Prepared
        What an identification would use.
    """

    report: RecordReport
    prepared: Prepared

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return (
            "usable" if self.usable else "NOT USABLE",
            f"{100.0 * self.share:.3g} % of {len(self.prepared.record)} rows",
        )

    @classmethod
    def of(cls, record: LoopRecord) -> CheckedRecord:
        """Check and prepare a record."""
        return cls(check(record), prepare(record))

    @property
    def usable(self) -> bool:
        """Whether an identification can be tried."""
        return self.report.usable and self.prepared.usable

    @property
    def share(self) -> float:
        """Share of the rows that would be used."""
        return self.prepared.share if self.usable else 0.0

    def count(self, level: str) -> int:
        """Number of findings of a level."""
        return sum(finding.level == level for finding in self.report.findings)

    def summary(self) -> Summary:
        """Both reports."""
        return Summary(f"{self.report.summary()}\n{self.prepared.summary()}", self)

    def __str__(self) -> str:
        return self.summary()

    def _repr_html_(self) -> str:
        """What was found, worst first, for notebooks."""
        return _verbs.panel(self).html()

    def to_dict(self) -> dict[str, Any]:
        """Both as plain dictionaries, ready for JSON."""
        return self.report.to_dict() | {"prepared": self.prepared.to_dict()}


def checked_line(name: str, found: CheckedRecord | None, error: str | None = None) -> str:
    """Whether one record is usable, and the worst that was found; or why it could not be checked."""
    if found is None:
        return f"{name:{NAME}} error: {error}"
    worst = [finding.what for finding in found.report.findings if finding.level != "info"]
    said = found.prepared.refusal or (worst[0] if worst else "nothing found")
    return f"{name:{NAME}} {'usable' if found.usable else 'NOT USABLE'}: {said}"


def checked_table(rows: Sequence[tuple[str, CheckedRecord | None]]) -> str:
    """Table of several records, worst first, and how many are usable.

    Parameters
    ----------
    rows : sequence of (name, CheckedRecord or None)
        None where the record could not be checked.
    """
    done = [(name, found) for name, found in rows if found is not None]
    worst_first = sorted(done, key=lambda row: row[1].share)
    lines = text_table(HEAD, WIDTHS, [_cells(name, found) for name, found in worst_first])
    usable = sum(found.usable for _, found in done)
    said = {"usable": usable, "not usable": len(done) - usable, "without a result": len(rows) - len(done)}
    counts = ", ".join(f"{count} {what}" for what, count in said.items() if count)
    return "\n".join([*lines, f"{len(rows)} loops: {counts}."])


def _cells(name: str, found: CheckedRecord) -> tuple[str, ...]:
    sampling = found.report.sampling
    return (
        name,
        "yes" if found.usable else "NO",
        f"{sampling.samples}",
        f"{sampling.dt:g}",
        f"{100 * found.share:.3g}",
        f"{found.count('error')}",
        f"{found.count('warning')}",
    )
