"""Solution: how far a record came on the way to a compensating block, and what opens the gate it stopped at."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from lostmotion import _verbs
from lostmotion.brief import Brief
from lostmotion.compensate import CompensatorBlock
from lostmotion.diagnose import Diagnosis
from lostmotion.evaluate.study import CompensationStudy
from lostmotion.identify import HammersteinFit
from lostmotion.summary import Summary

STEPS = ("check", "diagnose", "identify", "simulate", "block")
OUTCOMES = ("block", "nothing wrong", "closed")


@dataclass(frozen=True)
class Step:
    """One step of the way.

    Attributes
    ----------
    name : str
        Of STEPS.
    passed : bool
        Whether the way goes on behind it.
    said : str
        What was found, one sentence.
    remedy : str
        Where it is closed: what opens it.
    settings : dict
        Where other arguments of ``solve`` open it: these.
    acceptable : bool
        Whether a reason opens it as well.
    """

    name: str
    passed: bool
    said: str
    remedy: str = ""
    settings: Mapping[str, Any] = field(default_factory=dict)
    acceptable: bool = False

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            "name": self.name,
            "passed": self.passed,
            "said": self.said,
            "remedy": self.remedy,
            "settings": dict(self.settings),
            "acceptable": self.acceptable,
        }


@dataclass(frozen=True, eq=False, repr=False)
class Solution(Brief):
    """Result of :func:`solve`. Frozen; prints and writes itself.

    Attributes
    ----------
    outcome : {"block", "nothing wrong", "closed"}
        A block came out, none is needed, or a gate is closed.
    steps : tuple of Step
        As far as the way went; of a closed one the last says what opens it.
    diagnosis, fit, study, block
        What was found; None where the way did not come so far.
    """

    outcome: str
    steps: tuple[Step, ...]
    diagnosis: Diagnosis | None = field(default=None, repr=False)
    fit: HammersteinFit | None = field(default=None, repr=False)
    study: CompensationStudy | None = field(default=None, repr=False)
    block: CompensatorBlock | None = None

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        where = f"closed at {self.closed.name}" if self.closed else self.outcome
        return where, "" if self.block is None else f"{self.block.kind}"

    @property
    def closed(self) -> Step | None:
        """The gate at which the way ended; None where it did not."""
        return self.steps[-1] if self.outcome == "closed" else None

    def summary(self) -> Summary:
        """Report as text."""
        return Summary(_verbs.text(self), self)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: everything but the signals."""
        found = {"diagnosis": self.diagnosis, "fit": self.fit, "study": self.study, "block": self.block}
        return {
            "outcome": self.outcome,
            "steps": [step.to_dict() for step in self.steps],
            **{name: None if one is None else one.to_dict() for name, one in found.items()},
        }

    def _repr_html_(self) -> str:
        """Headline and a small table, for notebooks."""
        return _verbs.panel(self).html()

    def __str__(self) -> str:
        return self.summary()
