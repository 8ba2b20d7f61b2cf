"""What is checked after every stretch of service, and the sums of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from service.days import DAY, WORK, Array, Block

SIDES = ("left", "right")
TIMES = ("working hours", "night", "after a repair")
AFTER = 20_000  # samples after a repair within which its event is looked for, and apart from which coverage is told
AFTER_STUCK = 1000
LARGEST_MEMORY = 1_000_000  # bytes that the saved state may grow by: a hundred stored events


class DivergedError(RuntimeError):
    """A hard check failed."""


def expect(good: bool | np.bool_, what: str, sample: int) -> None:
    """Raise unless `good`."""
    if not good:
        raise DivergedError(f"{what} at sample {sample:,}")


@dataclass
class Ledger:
    """Sums over the run; of constant size but for events and repairs."""

    repairs: Array
    checks: int = 0
    restarts: int = 0
    told: dict[str, int] = field(default_factory=lambda: dict.fromkeys(TIMES, 0))
    covered: dict[tuple[str, str], int] = field(default_factory=lambda: {(t, s): 0 for t in TIMES for s in SIDES})
    misses: dict[str, list[float]] = field(default_factory=lambda: {side: [] for side in SIDES})
    events: list[tuple[Any, str]] = field(default_factory=list)
    stuck: list[int] = field(default_factory=list)
    first_size: int = 0
    last_size: int = 0

    def check(self, estimator: Any, trajectory: Any, block: Block, at: slice, span: tuple[float, float]) -> None:
        """Check estimator and trajectory after the samples `at` of a block."""
        sample = block.first + at.stop
        estimate = estimator.estimate
        self.checks += 1
        values = np.array(list(estimate.parameters.values()))
        expect(bool(np.isfinite(values).all()), "an estimate is not finite", sample)
        expect(all(np.isfinite(rows).all() for rows in trajectory.values.values()), "the way there is", sample)
        seen = np.isfinite(block.u[at]) & np.isfinite(block.y[at]) & block.use[at]
        errors = trajectory.errors
        expect(not np.isinf(errors).any(), "a prediction error is infinite", sample)
        expect(seen.sum() < seen.size / 2 or np.isfinite(errors[seen]).mean() > 0.5, "prediction errors lack", sample)
        expect(bool(estimate.linear.is_stable), "A is unstable", sample)
        left, right = (estimate.parameters[side] for side in SIDES)
        expect(span[0] <= left <= right <= span[1], f"break points {left:.3g}, {right:.3g} outside {span}", sample)
        self._cover(estimate, {"left": block.left[at][-1], "right": block.right[at][-1]}, sample)

    def _cover(self, estimate: Any, truth: dict[str, float], sample: int) -> None:
        since = sample - self.repairs[self.repairs < sample]
        repaired = bool(since.size and since.min() < AFTER)
        part = TIMES[2] if repaired else TIMES[sample % DAY > WORK]
        self.told[part] += 1
        for side in SIDES:
            low, high = estimate.interval(side)
            self.covered[part, side] += bool(low <= truth[side] <= high)
            if not repaired:
                self.misses[side].append(abs(estimate.parameters[side] - truth[side]))

    def note_events(self, events: list[Any]) -> None:
        """Sort new events by what came before them."""
        for event in events:
            self.events.append((event, self._cause(event.sample)))

    def _cause(self, sample: int) -> str:
        for name, starts, reach in (("repair", self.repairs, AFTER), ("stuck", np.array(self.stuck), AFTER_STUCK)):
            since = sample - starts
            if np.any((since >= 0) & (since < reach)):
                return name
        return "nothing"

    def delays(self, side: str) -> list[int]:
        """Samples from each repair to its event of this side; none where there was none."""
        found = []
        for repair in self.repairs:
            since = [event.sample - repair for event, _ in self.events if event.name == side]
            found += [min(value for value in since if value >= 0)] if any(0 <= s < AFTER for s in since) else []
        return found

    def restart(self, estimator: Any) -> Any:
        """Estimator of the saved bytes; saving it again gives the same."""
        saved = estimator.to_bytes()
        self.first_size = self.first_size or len(saved)
        self.last_size = len(saved)
        expect(len(saved) - self.first_size < LARGEST_MEMORY, "the state grows", estimator.samples)
        return type(estimator).from_bytes(saved)

    def same(self, one: Any, other: Any) -> None:
        """Two estimators that went on from one state stand at the same bits."""
        expect(one.to_bytes() == other.to_bytes(), "a restored estimator went another way", one.samples)
        self.restarts += 1
