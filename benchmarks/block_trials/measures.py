"""What is measured of a run, and of a loop with a block beside the same loop without."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from block_trials.closed_loop import SETTLING, Block, Run, simulated
from block_trials.draw import Loop
from block_trials.signals import in_operation, left_alone
from block_trials.valves import Valve

ROWS, SEED = 10_000, 2000  # of the runs that are compared; the record is of another seed
REST_ROWS, LOOKED_AT = 5000, 3000  # of a run without noise, and the last of them
LOADS = (0.0, -0.4, 0.7)  # %: a limit cycle depends on where the valve is to rest
INNER = (0.01, 0.99)  # quantiles between which PV swings
LITTLE = 1e-9  # %: less is no travel
CYCLE_NOISE, CYCLE_GROWTH = 2.0, 1.1  # deviations of the noise, and times the amplitude without a block


@dataclass(frozen=True)
class Compared:
    """Error and travel of the stem, with the block over without."""

    error: float
    travel: float


@dataclass(frozen=True)
class Cycle:
    """Amplitude of PV without noise, in deviations of the noise, without and with the block."""

    without: float
    compensated: float

    @property
    def begun(self) -> bool:
        """Whether the block begins a limit cycle, or makes one larger."""
        return self.compensated > max(CYCLE_NOISE, CYCLE_GROWTH * self.without)


def in_use(loop: Loop, block: Block | None = None, valve: Valve | None = None) -> Run:
    """The loop at work for `ROWS` rows, each time with the same set point, load and noise."""
    return simulated(loop, in_operation(loop, ROWS + SETTLING, SEED), block, valve).after(SETTLING)


def error_of(run: Run) -> float:
    """Mean absolute error of PV."""
    return float(np.mean(np.abs(run.set_point - run.pv)))


def travel_of(run: Run) -> float:
    """Of the stem, %."""
    return float(np.sum(run.travel))


def compared(compensated: Run, without: Run) -> Compared:
    """Both over those without the block."""
    travel = travel_of(compensated) / max(travel_of(without), LITTLE)
    return Compared(error_of(compensated) / error_of(without), travel)


def swing_of(loop: Loop, block: Block | None, valve: Valve) -> float:
    """Largest amplitude of PV that is left without noise, over all `LOADS`."""
    return max(_swing(simulated(loop, left_alone(loop, REST_ROWS, load), block, valve)) for load in LOADS)


def _swing(run: Run) -> float:
    low, high = np.quantile((run.set_point - run.true_pv)[-LOOKED_AT:], INNER)
    return float(high - low) / 2


def cycle_of(loop: Loop, block: Block, valve: Valve) -> Cycle:
    """With and without the block."""
    noise = loop.instrument.noise
    return Cycle(swing_of(loop, None, valve) / noise, swing_of(loop, block, valve) / noise)
