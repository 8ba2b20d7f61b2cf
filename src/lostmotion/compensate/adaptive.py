"""Adaptive compensation of a dead zone: an online estimator sets the block, a supervisor may switch it off.

Every `every` samples the estimate is looked at. It is taken where its interval is narrow, within limits, no faster than
`step` a look, at the inner end of its interval; the block goes to the new settings on its ramp. Where the loop has got
worse than it was without compensation, FACTOR goes to 0 until it may try again: the block then passes OP through (but
keeps slopes other than 1, because the controller is tuned with them).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from lostmotion.arguments import finite, positive, whole
from lostmotion.arrays import FloatArray
from lostmotion.compensate.block import CompensatorBlock
from lostmotion.errors import ParameterError
from lostmotion.identify import RecursiveEstimate, RecursiveEstimator

QUANTILE = 1.96  # standard errors in the half-width of a 95 % interval


@dataclass(frozen=True)
class Supervisor:
    """When to fall back, and when to try again.

    The index of a window is its mean absolute control error. The reference is the mean index of the windows in which
    nothing was compensated; before there is one, `patience` windows are spent so.

    Parameters
    ----------
    worse : float
        Fall back where the index exceeds this many times the reference.
    patience : int
        Windows in a row that must say so, and windows of the first spell without compensation.
    longest : int
        A fall-back lasts `patience` windows the first time, twice as many each time after, at most this many; a spell
        of `longest` good windows forgets the earlier ones.
    """

    worse: float = 1.3
    patience: int = 2
    longest: int = 32

    def __post_init__(self) -> None:
        positive("worse", self.worse)
        if whole("patience", self.patience, 1) > whole("longest", self.longest, 1):
            raise ParameterError.expected("longest >= patience", self.longest, "give windows")


@dataclass
class _Watch:
    """Memory of the supervisor."""

    reference: float | None = None
    passed: list[float] = field(default_factory=list)
    bad: int = 0
    good: int = 0
    rest: int = 0
    falls: int = 0


class AdaptiveCompensator:
    """Settings of a dead-zone block that follow an estimator; look by look.

    Parameters
    ----------
    block : CompensatorBlock
        Of kind "dead zone": start settings, safeguards.
    estimator : RecursiveEstimator
        It is given the commands behind the block and PV.
    every : int
        Samples between two looks; also the window of the supervisor.
    widest : float
        Largest dead zone that is believed, in units of OP.
    precision : float
        Taken only where 1.96 standard errors of each break point are below this share of the width (or of `floor`).
    step : float
        Largest change of a break point at one look, as a share of the width in use (or of `floor`).
    dead_band : float
        No new settings for less than this share of that width: each goes through the ramp, with the side held.
    floor : float
        Width below which shares are taken of this instead, in units of OP.
    supervisor : Supervisor
        Rules of the fall-back.

    Attributes
    ----------
    block : CompensatorBlock
        Settings while compensating.
    compensating : bool
        False before the first reference and while fallen back.
    taken, refused, falls : int
        Estimates taken and refused, fall-backs.
    """

    def __init__(
        self,
        block: CompensatorBlock,
        estimator: RecursiveEstimator,
        *,
        every: int = 500,
        widest: float = 10.0,
        precision: float = 0.15,
        step: float = 0.25,
        dead_band: float = 0.02,
        floor: float = 0.2,
        supervisor: Supervisor | None = None,
    ) -> None:
        if block.kind != "dead zone":
            raise ParameterError.expected("a block of kind 'dead zone'", repr(block.kind), "others do not adapt yet")
        self.block, self.estimator, self.compensating = block, estimator, False
        self.every = whole("every", every, 2)
        self.widest, self.precision = positive("widest", widest), positive("precision", precision)
        self.dead_band = positive("dead_band", dead_band)
        self.step, self.floor = positive("step", step), positive("floor", floor)
        self.supervisor = Supervisor() if supervisor is None else supervisor
        self.taken, self.refused, self.falls = 0, 0, 0
        self._watch = _Watch(rest=self.supervisor.patience)

    @property
    def running(self) -> CompensatorBlock:
        """What to run until the next look."""
        return self.block if self.compensating else self.block.with_settings(factor=0.0)

    def look(self, command: FloatArray, pv: FloatArray, sp: FloatArray) -> CompensatorBlock:
        """Take the samples since the last look; what to run until the next one.

        Parameters
        ----------
        command, pv, sp : ndarray, shape (n,)
            Command behind the block, measurement, set point; NaN (or infinite) where missing.
        """
        self._learn(command, pv)
        finite_rows = np.isfinite(pv) & np.isfinite(sp)
        index = float(np.mean(np.abs(sp - pv)[finite_rows])) if finite_rows.any() else np.nan
        self._adapt()
        self._supervise(index)
        return self.running

    def _learn(self, command: FloatArray, pv: FloatArray) -> None:
        """Give the samples to the estimator; one that knows no missing ones gets the others."""
        known = np.isfinite(command) & np.isfinite(pv)
        if known.all():
            self.estimator.run(command, pv)
        elif hasattr(self.estimator, "period"):  # a WatchingEstimator
            finite_command, finite_pv = (np.where(np.isfinite(row), row, np.nan) for row in (command, pv))
            self.estimator.run(finite_command, finite_pv)
        else:
            self.estimator.run(command[known], pv[known])

    def _adapt(self) -> None:
        """Move the break points towards the lower end of the estimate, if it is good enough."""
        estimate = self.estimator.estimate
        wanted = self._wanted(estimate)
        if wanted is None:
            self.refused += 1
            return
        self.taken += 1
        settings = self.block.settings
        size = max(settings["right_break"] - settings["left_break"], self.floor)
        moved = {}
        for name, value in wanted.items():
            reach = self.step * size
            moved[name] = settings[name] + min(max(value - settings[name], -reach), reach)
        if any(abs(moved[name] - settings[name]) > self.dead_band * size for name in moved):
            self.block = self.block.with_settings(**moved)

    def _wanted(self, estimate: RecursiveEstimate) -> dict[str, float] | None:
        """Break points at the inner end of their intervals; None where the estimate cannot be used."""
        centre, errors = self.block.settings["centre"], estimate.standard_errors
        left, right = estimate.parameters["left"], estimate.parameters["right"]
        reach = [QUANTILE * errors[name] for name in ("left", "right")]
        if not np.isfinite([left, right, *reach]).all() or right - left > self.widest:
            return None
        if max(reach) > self.precision * max(right - left, self.floor):
            return None
        return {
            "left_break": min(finite("left", left + reach[0]), centre),
            "right_break": max(finite("right", right - reach[1]), centre),
        }

    def _supervise(self, index: float) -> None:
        """Fall back, stay, or try again."""
        watch, rules = self._watch, self.supervisor
        if not np.isfinite(index):
            return
        if not self.compensating:
            watch.passed.append(index)
            watch.rest -= 1
            if watch.rest <= 0:
                watch.reference = float(np.mean(watch.passed[-rules.patience :]))
                watch.passed, watch.bad, watch.good = [], 0, 0
                self.compensating = self.taken > 0
                watch.rest = 0 if self.compensating else 1
            return
        assert watch.reference is not None  # noqa: S101  it was passed through before
        worse = index > rules.worse * watch.reference
        watch.bad = watch.bad + 1 if worse else 0
        watch.good = 0 if worse else watch.good + 1
        if watch.good >= rules.longest:
            watch.falls = 0
        if watch.bad >= rules.patience:
            self.compensating = False
            self.falls += 1
            watch.falls += 1
            watch.rest = min(rules.patience * 2 ** (watch.falls - 1), rules.longest)
