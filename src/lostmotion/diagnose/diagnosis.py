"""Diagnosis: what is wrong with a loop, how sure that is, why, and what to do."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lostmotion import _verbs
from lostmotion.actuator import ActuatorResponse
from lostmotion.brief import Brief, between
from lostmotion.diagnose.control_error.amplitude import ErrorOscillation
from lostmotion.diagnose.features import Measured
from lostmotion.diagnose.loop_stability import LoopStability
from lostmotion.diagnose.performance import Performance
from lostmotion.identify import HammersteinFit
from lostmotion.identify.actuators.kind import kind_names
from lostmotion.records import LoopRecord
from lostmotion.summary import Summary

OTHERS = ("other oscillation", "cannot tell")


def verdicts() -> tuple[str, ...]:
    """All that a diagnosis can say: "none", a kind of fault, or one of OTHERS."""
    return (*kind_names(), *OTHERS)


@dataclass(frozen=True)
class Item:
    """One piece of evidence.

    Attributes
    ----------
    name : str
    value : float
        As measured.
    weight : float
        What it adds to the log-odds of the verdict against no actuator fault; 0: only shown.
    meaning : str
        In words.
    """

    name: str
    value: float
    weight: float
    meaning: str


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis(Brief):
    """Result of :func:`diagnose`. Frozen; prints, draws and writes itself.

    Attributes
    ----------
    verdict : str
        Of `verdicts()`.
    kind : str
        Where it comes from: "actuator", "tuning", "disturbance", "set point", "sensor", "unknown", or "none".
    severity : str
        "none", "low" (up to 1 % of span), "moderate" (2 %), "high" (4 %), "severe", or "unknown".
    size : float
        Width or band of the lost motion in units of OP; NaN where there is none or it is not known.
    interval : (float, float)
        95 % interval of it, ``fit.size_interval``: of a valve that sticks it counts what friction is and the model
        is not.
    size_percent : float
        Of the OP span.
    confidence : float
        Probability of a fault of the actuator, or of none, as the verdict says; calibrated on simulated and real
        loops (docs/diagnosis.md).
    probabilities : dict of float
        Of "none" and "actuator", a fault of the actuator.
    evidence : tuple of Item
        What speaks for and against, strongest first.
    advice : tuple of str
        What to do.
    notes : tuple of str
        What was assumed or left out.
    excluded : dict of float
        Where no fault of the actuator is named: the largest dead zone, backlash and stiction that the record does not
        exclude (95 %), in units of OP; inf where a valve that never moves would look the same.
    tolerance : float
        Lost motion that does not matter, in units of OP: "none" is said only where all of `excluded` is smaller.
    why : str
        Why it cannot be told, in words.
    error_oscillation : ErrorOscillation or None
        Of the error of control in all of the record; None where nothing oscillates.
    source : str
        Where it comes from, in words, where the amplitude of the oscillation or a PV that stood still tells; else "".
    actuator : ActuatorResponse or None
        What the actuator does, from OP and its measured position; None where the record has no position.
    """

    verdict: str
    kind: str
    severity: str
    size: float
    interval: tuple[float, float]
    size_percent: float
    confidence: float
    probabilities: dict[str, float]
    evidence: tuple[Item, ...]
    advice: tuple[str, ...]
    notes: tuple[str, ...]
    measured: Measured
    stability: LoopStability | None
    performance: Performance
    fit: HammersteinFit = field(repr=False)
    record: LoopRecord = field(repr=False)
    excluded: dict[str, float] = field(default_factory=dict)
    tolerance: float = float("nan")
    why: str = ""
    error_oscillation: ErrorOscillation | None = None
    source: str = ""
    actuator: ActuatorResponse | None = field(default=None, repr=False)

    @property
    def fingerprint(self) -> str:
        """Of the record as it was given, see ``LoopRecord.fingerprint``."""
        return self.record.fingerprint

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        size = f" {between(*self.interval)}" if np.isfinite(self.interval).all() else ""
        return f"{self.verdict}{size}", f"severity {self.severity}", f"confidence {100.0 * self.confidence:.0f} %"

    @property
    def cleared(self) -> bool:
        """Whether no lost motion that matters is left open: `excluded` is known and all of it within `tolerance`."""
        named = self.verdict in ("none", "other oscillation")
        return named and bool(self.excluded) and max(self.excluded.values()) <= self.tolerance

    def summary(self) -> Summary:
        """Report as text: verdict, evidence, advice."""
        return Summary(_verbs.text(self), self)

    def plot(self, **options: Any) -> Any:
        """Figure: trend, PV over OP, evidence, verdict.

        ``figure=`` draws into a matplotlib Figure or SubFigure instead of a new one, ``ax=`` the trend alone into an
        Axes, OP on a scale at its right; ``title=`` replaces the heading. Needs the extra ``lostmotion[plot]``; returns
        the matplotlib Figure.

        Raises
        ------
        ParameterError
            Both `figure` and `ax`.
        """
        return _verbs.plot(self, **options)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: everything but the signals. Unknown numbers become None."""
        return {
            "fingerprint": self.fingerprint,
            "verdict": self.verdict,
            "kind": self.kind,
            "severity": self.severity,
            "size": _finite(self.size),
            "interval_95": [_finite(end) for end in self.interval],
            "size_percent": _finite(self.size_percent),
            "confidence": self.confidence,
            "probabilities": dict(self.probabilities),
            "evidence": [{**vars(item), "value": _finite(item.value)} for item in self.evidence],
            "advice": list(self.advice),
            "notes": list(self.notes),
            "excluded": {kind: _finite(size) for kind, size in self.excluded.items()},
            "tolerance": _finite(self.tolerance),
            "why": self.why,
            "source": self.source,
            "error_oscillation": None
            if self.error_oscillation is None
            else {name: _finite(value) for name, value in vars(self.error_oscillation).items()},
            "oscillation": {
                name: {key: _finite(value) for key, value in vars(one).items()}
                for name, one in (("op", self.measured.op), ("pv", self.measured.pv))
            },
            "indices": dict(self.measured.indices),
            "integrating": self.measured.integrating,
            "stability": None
            if self.stability is None
            else {name: _finite(value) for name, value in vars(self.stability).items()},
            "performance": self.performance.to_dict(),
            "actuator": None if self.actuator is None else self.actuator.to_dict(),
            "fit": self.fit.to_dict(),
        }

    def _repr_html_(self) -> str:
        """Headline and a small table, for notebooks."""
        return _verbs.panel(self).html()

    def __str__(self) -> str:
        return self.summary()


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
