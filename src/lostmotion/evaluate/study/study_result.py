"""CompensationStudy: what the simulated loop does without, with and with mis-estimated compensation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from lostmotion import _verbs
from lostmotion.brief import Brief
from lostmotion.compensate import CompensatorBlock
from lostmotion.evaluate.limit_cycle import LimitCycle
from lostmotion.evaluate.study.reproduced import Reproduction
from lostmotion.models import Hammerstein
from lostmotion.simulate import PI, LoopResponse
from lostmotion.summary import Summary

CYCLE_TOLERANCE = 1.1  # times the cycle without compensation: what two runs of an irregular swing may differ by


@dataclass(frozen=True)
class LoopCase:
    """One loop, averaged over the runs.

    Attributes
    ----------
    variance : float
        Of PV about SP, units of PV squared.
    iae : float
        Integral absolute error per sample, units of PV (``mean_absolute_error``).
    op_variance : float
        Of the command, units of OP squared.
    travel, reversals : float
        Of the command: % of span an hour, turns beyond the noise of OP an hour.
    ratio, ratio_error : float
        IAE over that of the loop as it is, paired run by run, and its standard error.
    cycle : LimitCycle
        Simulated without noise.
    predicted : LimitCycle or None
        By the describing function; None where it does not apply.
    controller : PI
    """

    variance: float
    iae: float
    op_variance: float
    travel: float
    reversals: float
    ratio: float
    ratio_error: float
    cycle: LimitCycle
    predicted: LimitCycle | None
    controller: PI

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            **{name: getattr(self, name) for name in ("variance", "iae", "op_variance", "travel", "reversals")},
            "iae_ratio": self.ratio,
            "iae_ratio_error": self.ratio_error if np.isfinite(self.ratio_error) else None,
            "limit_cycle": self.cycle.to_dict(),
            "predicted_limit_cycle": None if self.predicted is None else self.predicted.to_dict(),
            "kp": self.controller.kp,
            "ki": self.controller.ki,
        }


@dataclass(frozen=True)
class MistakeCase:
    """The block as designed on a plant that is not the estimated one.

    Attributes
    ----------
    group, what : str
        Where the plant comes from, and what the estimate is then wrong by.
    ratio : float
        IAE with over IAE without the block, on this plant.
    travel_ratio : float
        The same of the travel.
    without, compensated : LimitCycle
        Simulated without noise.
    floor : float
        Amplitude that does not count.
    """

    group: str
    what: str
    ratio: float
    travel_ratio: float
    without: LimitCycle
    compensated: LimitCycle
    floor: float

    @property
    def larger_cycle(self) -> bool:
        """Whether the block makes a limit cycle larger than without it."""
        return self.compensated.amplitude > max(CYCLE_TOLERANCE * self.without.amplitude, self.floor)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        cycles = {"without": self.without.to_dict(), "compensated": self.compensated.to_dict()}
        return {**asdict(self), **cycles, "larger_cycle": self.larger_cycle}


@dataclass(frozen=True, eq=False, repr=False)
class CompensationStudy(Brief):
    """Result of :func:`compensation_study`. Frozen; prints, draws and writes itself.

    Attributes
    ----------
    recommendation : {"compensate", "retune", "compensate and retune", "maintain", "leave"}
    reasons : tuple of str
        Sentences behind it, with figures.
    brief : tuple of str
        Those of them that are about the block with the present controller.
    useful : bool
        Whether the block lessens the error, or calms the loop, with the present controller.
    safe : bool
        With the present controller the block does no harm on any plant that was tried: no limit cycle clearly larger
        than without it that less error does not outweigh, and no worse error (bounds: docs/compensation-study.md).
    cases : dict of LoopCase
        "without", "with", "retuned", "with, retuned", "no fault" (a perfect inverse).
    mistakes, mistakes_retuned : tuple of MistakeCase
        The block on plants within the uncertainty of the fit, and with the fault off by 20 %; with the present and
        with the retuned controller.
    block : CompensatorBlock
        What was tried, and what to export.
    controller, controller_source : PI and str
    model, model_source : Hammerstein and str
    described : str
        Set point, noise and length of the runs in words.
    responses : dict of LoopResponse
        First run of each case; the first `settle` rows do not count.
    reproduction : Reproduction or None
        How the identified loop compares with the record, where there is one.
    """

    recommendation: str
    reasons: tuple[str, ...]
    brief: tuple[str, ...]
    useful: bool
    safe: bool
    cases: Mapping[str, LoopCase]
    mistakes: tuple[MistakeCase, ...]
    mistakes_retuned: tuple[MistakeCase, ...]
    block: CompensatorBlock
    controller: PI
    controller_source: str
    model: Hammerstein
    model_source: str
    described: str
    settle: int
    responses: Mapping[str, LoopResponse] = field(repr=False)
    settings: Mapping[str, Any] = field(default_factory=dict)
    reproduction: Reproduction | None = None

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        ratio = f"IAE {self.cases['with'].ratio:.2f} times that of today" if "with" in self.cases else ""
        return self.recommendation, f"{self.block.kind} block", ratio

    @property
    def worst(self) -> MistakeCase | None:
        """The plant on which the block does worst, by IAE."""
        return max(self.mistakes, key=lambda case: case.ratio, default=None)

    def summary(self) -> Summary:
        """Report as text."""
        return Summary(_verbs.text(self), self)

    def plot(self, **options: Any) -> Any:
        """Figure: trend before and after, and the spread over the uncertainty (needs ``lostmotion[plot]``).

        ``figure=`` draws into a matplotlib Figure or SubFigure, ``title=`` replaces the heading.
        """
        return _verbs.plot(self, **options)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: everything but the signals."""
        return {
            "recommendation": self.recommendation,
            "reasons": list(self.reasons),
            "safe": self.safe,
            "cases": {name: case.to_dict() for name, case in self.cases.items()},
            "mistakes": [case.to_dict() for case in self.mistakes],
            "mistakes_retuned": [case.to_dict() for case in self.mistakes_retuned],
            "block": self.block.to_dict(),
            "controller": {"kp": self.controller.kp, "ki": self.controller.ki, "source": self.controller_source},
            "model": self.model.to_dict(),
            "model_source": self.model_source,
            "scenario": self.described,
            "settings": dict(self.settings),
            "reproduction": None if self.reproduction is None else self.reproduction.to_dict(),
        }

    def _repr_html_(self) -> str:
        """Headline and a small table, for notebooks."""
        return _verbs.panel(self).html()

    def __str__(self) -> str:
        return self.summary()
