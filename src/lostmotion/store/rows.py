"""Rows of the store: what an audit and a watch write, whatever the database."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from enum import StrEnum

UNDATED = datetime(1970, 1, 1, tzinfo=UTC)  # first row of a record that does not say when it began
FAULTS = ("dead zone", "backlash", "stiction", "saturation")  # verdicts that name a fault of the actuator
MEASUREMENT = ("frozen measurement", "noisy measurement")  # rules of the audit by which it is at fault
FINDINGS = (*FAULTS, *MEASUREMENT, "ringing", "wear by travel")  # of what is said of a loop, what is wrong with it
DENIED = ("none", "other oscillation")  # verdicts that name none; whether it is cleared is another question
USUAL_TOLERANCE = 1.0  # % of span, of a row that does not say which


class Stage(StrEnum):
    """How far an assessment is."""

    SCREENED = "screened"  # looked at in milliseconds, not diagnosed: `reason` says why
    ASSESSED = "assessed"
    FAILED = "failed"  # `error` says why


def diagnosed(stage: Stage, verdict: str) -> str:
    """Verdict of an assessed loop, else how far it came."""
    if stage is Stage.ASSESSED:
        return verdict
    return "failed" if stage is Stage.FAILED else "not assessed"


@dataclass(frozen=True)
class AssessmentRow:
    """What one run says of one loop in one window. Key: loop, window_start (and the run).

    Attributes
    ----------
    tag : str
        Of the loop.
    window_start, window_end : datetime
        UTC; counted from UNDATED where the record has no dates.
    fingerprint : str
        Of the data in the window.
    stamp : str
        Of the source, as :class:`lostmotion.plant.PlantLoop` has it.
    settings, code : str
        Digest of the settings of the audit, and version of the code that decides.
    definition : str
        Digest of what the loop list says about the loop (columns, spans, type): another one, another result.
    stage : Stage
    reason : str
        Why it was assessed, or why it was only screened, in words.
    status : str
        Name of the :class:`lostmotion.Status` of the fit; empty: no fit.
    verdict : str
        As :class:`lostmotion.Diagnosis` has it; "cannot tell" where only screened.
    kind : str
        Where it comes from: "actuator", "tuning", "disturbance", "set point", "sensor", "unknown", "none".
    size, low, high, size_percent : float, optional
        Lost motion in units of OP with its 95 % interval, and in % of span.
    excluded_dead_zone, excluded_backlash, excluded_stiction : float, optional
        Largest sizes that the data do not exclude, units of OP.
    excluded_percent : float, optional
        The largest of them in % of span.
    confidence, probability : float, optional
        Of the verdict; of a fault of the actuator.
    severity : str
        "none", "low", "moderate", "high", "severe", "unknown".
    performance : str
        Class of the loop: excellent, acceptable, fair, poor, open loop, unknown.
    label : str
        NE 107: "failure", "function check", "out of specification", "maintenance required", "normal"; empty: cannot
        tell.
    split : str
        "sensor", "actuator", "tuning", "process", "none" or "cannot tell".
    priority : float, optional
        0 to 100; None: not ranked.
    priority_reason : str
        In words.
    rule : str
        Of the audit, by name (:mod:`lostmotion.audit.rules`), where one decides the priority and what is said; empty:
        the diagnosis does.
    rows : int
    dt : float, optional
        Samples in the window, and seconds between them.
    manual, limited, missing : float, optional
        Share of time not in automatic, with OP at a limit, without good values.
    travel, reversals, variability, harris : float, optional
        Travel in % of span and turns of OP per hour, standard deviation of the error of control in % of the span of PV
        (of its own range where no span is known), Harris index.
    period, regularity, power : float, optional
        Of the oscillation of the error of control: period in seconds, regularity (above 1: regular), share of variance.
    health : tuple of str
        What is wrong with the data, one short sentence each ("stale for 31 % of the time").
    fit_for_use : bool
        Whether the data allow a judgement at all.
    value : float
        What an assessment is worth, for the order in which they are made: 0 (nothing to be told) to 1.
    why : str
        Why it cannot be told.
    advice : tuple of str
    evidence : tuple of (str, float, float)
        Name, value and weight of each line.
    indices : mapping of str to float
        Further numbers.
    seconds : float
        Processor time that it took.
    error : str
        One line; empty: none.
    """

    tag: str
    window_start: datetime
    window_end: datetime
    fingerprint: str = ""
    stamp: str = ""
    settings: str = ""
    code: str = ""
    definition: str = ""
    stage: Stage = Stage.SCREENED
    reason: str = ""
    status: str = ""
    verdict: str = "cannot tell"
    kind: str = "unknown"
    size: float | None = None
    low: float | None = None
    high: float | None = None
    size_percent: float | None = None
    excluded_dead_zone: float | None = None
    excluded_backlash: float | None = None
    excluded_stiction: float | None = None
    excluded_percent: float | None = None
    confidence: float | None = None
    probability: float | None = None
    severity: str = "unknown"
    performance: str = "unknown"
    label: str = ""
    split: str = "cannot tell"
    priority: float | None = None
    priority_reason: str = ""
    rule: str = ""
    rows: int = 0
    dt: float | None = None
    manual: float | None = None
    limited: float | None = None
    missing: float | None = None
    travel: float | None = None
    reversals: float | None = None
    variability: float | None = None
    harris: float | None = None
    period: float | None = None
    regularity: float | None = None
    power: float | None = None
    health: tuple[str, ...] = ()
    fit_for_use: bool = True
    value: float = 0.0
    why: str = ""
    advice: tuple[str, ...] = ()
    evidence: tuple[tuple[str, float, float], ...] = ()
    indices: Mapping[str, float] = field(default_factory=dict)
    seconds: float = 0.0
    error: str = ""

    @property
    def diagnosed(self) -> str:
        """Verdict of an assessed loop, else how far it came."""
        return diagnosed(self.stage, self.verdict)

    @property
    def said(self) -> str:
        """What is said of the loop: by the rule that decides, else by its diagnosis.

        Examples
        --------
        >>> row = AssessmentRow("FIC-1", UNDATED, UNDATED, priority=36.0, rule="ringing")
        >>> row.said, row.diagnosed, row.is_finding
        ('ringing', 'not assessed', True)
        """
        return self.rule or self.diagnosed

    @property
    def is_finding(self) -> bool:
        """Whether something is wrong with the loop itself, be it its valve, its measurement or its tuning."""
        return self.said in FINDINGS

    @property
    def cleared(self) -> bool:
        """Whether no lost motion over the tolerance is left open; "none" is said only where that is so.

        Nothing is cleared by a measurement that is at fault.

        Examples
        --------
        >>> from dataclasses import replace
        >>> swings = AssessmentRow("FIC-1", UNDATED, UNDATED, verdict="other oscillation", excluded_percent=2.5)
        >>> swings.cleared, replace(swings, excluded_percent=0.5).cleared, replace(swings, verdict="none").cleared
        (False, True, True)
        """
        tolerance, span = self.indices.get("tolerance", math.nan), self.indices.get("op_span", math.nan)
        limit = 100.0 * tolerance / span if span > 0.0 else math.nan
        left = math.inf if self.excluded_percent is None else self.excluded_percent
        within = left <= (limit if math.isfinite(limit) else USUAL_TOLERANCE)
        cleared = self.verdict == "none" or (self.verdict in DENIED and within)
        return cleared and self.rule not in MEASUREMENT


@dataclass(frozen=True)
class SpectrumRow:
    """Power of the error of control over frequency, for what swings together. 96 bins.

    Attributes
    ----------
    tag : str
    window_start : datetime
        As in the assessment.
    low, high : float
        Hz: the bins are equal in the logarithm of the frequency between them.
    power : bytes
        96 little-endian float32: share of the power in each bin; they add up to 1. Behind them, in rows of a screen,
        what phases the power has (:func:`lostmotion.audit.screen.lines.lines_of`).
    nonlinearity : float, optional
        Strength of what a Gaussian linear process cannot make (Thornhill 2005: surrogate statistic of PV).
    op_nonlinearity : float, optional
        The same of OP.
    harmonics : float, optional
        Power at twice to five times the frequency of the oscillation over that at it.
    phase : float, optional
        Radians of PV at the frequency of the oscillation, counted from the start of the window's clock.
    """

    tag: str
    window_start: datetime
    low: float
    high: float
    power: bytes
    nonlinearity: float | None = None
    op_nonlinearity: float | None = None
    harmonics: float | None = None
    phase: float | None = None


@dataclass(frozen=True)
class TraceRow:
    """A picture of the most telling stretch of an assessed window, for pages without the raw data.

    Attributes
    ----------
    tag : str
    window_start : datetime
        As in the assessment.
    start, seconds : float
        Of the stretch: from the start of the window, and its length.
    sp, pv, op : bytes
        Little-endian float32, up to 1,200 each; of a longer stretch smallest and largest by turns, in the order in
        which they came. `sp` is empty where there is none.
    model : str
        JSON of the fitted actuator with its interval, for the PV-OP picture; empty: none.
    """

    tag: str
    window_start: datetime
    start: float
    seconds: float
    sp: bytes
    pv: bytes
    op: bytes
    model: str = ""


@dataclass(frozen=True)
class GroupRow:
    """Loops that swing together.

    Attributes
    ----------
    number : int
        From 1, by power.
    period : float
        Seconds, median of the members.
    source : str
        Tag of the likely source; empty: cannot tell.
    confidence : float, optional
    why : str
        What speaks for the source, or why it cannot be told.
    members : tuple of (str, datetime, float, float)
        Tag, start of the window, likeness of the spectrum to the group's (0 to 1), score as a source.
    """

    number: int
    period: float
    source: str
    confidence: float | None
    why: str
    members: tuple[tuple[str, datetime, float, float], ...]


@dataclass(frozen=True)
class EstimateRow:
    """What the recursive estimator of a watched loop says at one moment. Key: watch, loop, at.

    Attributes
    ----------
    tag : str
    at : datetime
        UTC: stamp of the last sample.
    sample : int
        How many it has taken by then.
    status : str
        Name of the :class:`lostmotion.Status`.
    width : float
        Of the dead zone, units of OP.
    low, high, standard_error : float, optional
        95 % interval and standard error of the width; None: open, not known.
    left, right : float, optional
        Break points, units of OP.
    """

    tag: str
    at: datetime
    sample: int
    status: str
    width: float
    low: float | None = None
    high: float | None = None
    standard_error: float | None = None
    left: float | None = None
    right: float | None = None
