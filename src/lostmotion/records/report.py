"""RecordReport: the facts about a record, what they mean, and what to do."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Literal

from lostmotion import _verbs
from lostmotion.brief import Brief, counted
from lostmotion.records.loop_facts import LoopFacts
from lostmotion.records.sampling import Sampling
from lostmotion.records.signal_facts import SignalFacts
from lostmotion.summary import Summary

Level = Literal["info", "warning", "error"]
_MARKS = {"error": "ERROR  ", "warning": "WARNING", "info": "info   "}


@dataclass(frozen=True)
class Finding:
    """One thing that was found: what, why it matters, what to do.

    Examples
    --------
    >>> print(Finding("error", "OP is constant.", "Nothing moved the valve.", "Record automatic operation."))
    ERROR   OP is constant. Nothing moved the valve. Record automatic operation.
    """

    level: Level
    what: str
    why: str
    remedy: str

    def __str__(self) -> str:
        text = " ".join(part for part in (self.what, self.why, self.remedy) if part)
        return f"{_MARKS[self.level]} {text}"


@dataclass(frozen=True, repr=False)
class RecordReport(Brief):
    """Facts and findings about a record.

    Parameters
    ----------
    title : str
        The record in one line.
    sampling : Sampling
        Rows, gaps, missing samples.
    op, pv : SignalFacts, optional
        The signals; None where every sample is missing.
    loop : LoopFacts, optional
        Mode, excitation and saturation; None without OP.
    findings : list of Finding
        Errors first, then warnings, then information.
    notes : tuple of str
        What was assumed when the record was read.
    """

    title: str
    sampling: Sampling
    op: SignalFacts | None
    pv: SignalFacts | None
    loop: LoopFacts | None
    findings: list[Finding]
    notes: tuple[str, ...] = ()

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        levels = [finding.level for finding in self.findings]
        counts = (counted(levels.count(level), level) for level in ("error", "warning"))
        return "usable" if self.usable else "NOT USABLE", f"{self.sampling.samples} samples", *counts

    @property
    def usable(self) -> bool:
        """True where no finding is an error: an identification can be tried."""
        return not any(finding.level == "error" for finding in self.findings)

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain dictionaries, lists and numbers, ready for JSON."""
        plain = asdict(self) | {"usable": self.usable, "notes": list(self.notes)}
        for name in ("op", "pv"):
            if plain[name] is not None:
                plain[name]["spikes"] = list(plain[name]["spikes"])
        return plain

    def summary(self) -> Summary:
        """Several lines of text: the record, its signals, the findings."""
        lines = [self.title, f"  {_sampling_line(self.sampling)}"]
        if self.loop is not None:
            lines.append(f"  {self.loop.mode}; OP turned round {self.loop.op_reversals} times")
        lines.extend(f"  {_signal_line(facts)}" for facts in (self.op, self.pv) if facts is not None)
        lines.extend(f"  note    {note}" for note in self.notes)
        lines.extend(f"  {finding}" for finding in self.findings)
        lines.append("  usable" if self.usable else "  not usable for identification")
        return Summary("\n".join(lines), self)

    def __str__(self) -> str:
        return self.summary()

    def _repr_html_(self) -> str:
        """What was found, worst first, for notebooks."""
        return _verbs.panel(self).html()


def _sampling_line(sampling: Sampling) -> str:
    return (
        f"{sampling.samples} samples every {sampling.dt:g} s ({sampling.seconds:g} s), "
        f"gaps: {sampling.gaps}, "
        f"rows missing: {sampling.missing} ({100 * sampling.missing_share:.2g} %)"
    )


def _signal_line(facts: SignalFacts) -> str:
    of_span = ""
    if facts.amplitude_of_span is not None:
        of_span = f" = {100 * facts.amplitude_of_span:.3g} % of span"
    return (
        f"{facts.name}: {facts.low:.5g} to {facts.high:.5g}, mean {facts.mean:.5g}, std {facts.std:.3g}, "
        f"5-95 % amplitude {facts.amplitude:.3g}{of_span}; "
        f"{facts.levels} levels, smallest step {facts.step:.3g}"
    )
