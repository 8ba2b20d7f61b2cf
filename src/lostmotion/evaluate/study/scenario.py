"""What the loop goes through in the study, and what is measured on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.compensate import CompensatorBlock
from lostmotion.evaluate.indices import control_variance, mean_absolute_error
from lostmotion.evaluate.study.study_plant import StudyPlant
from lostmotion.records.movement import reversals_per_hour, travel_per_hour
from lostmotion.simulate import PI, LoopResponse

NAMES = ("variance", "iae", "op_variance", "travel", "reversals")


@dataclass(frozen=True)
class Scenario:
    """Set point and noise of a study.

    Attributes
    ----------
    reference : ndarray, shape (settle + n,)
        Set point; the first `settle` rows do not count.
    noises : tuple of ndarray
        Noise of PV, one for each run.
    settle : int
    span : (float, float)
        Of OP.
    band : float
        Moves of OP up to this are noise and no reversal.
    described : str
        In words.
    """

    reference: FloatArray
    noises: tuple[FloatArray, ...]
    settle: int
    span: tuple[float, float]
    band: float
    described: str

    def run(
        self, plant: StudyPlant, controller: PI, block: CompensatorBlock | None, runs: int | None = None
    ) -> tuple[FloatArray, LoopResponse]:
        """Indices of each run, shape (runs, len(NAMES)), and the signals of the first."""
        loops = [plant.run(controller, block, self.reference, noise) for noise in self.noises[:runs]]
        return np.array([self.indices(loop) for loop in loops]), loops[0]

    def indices(self, loop: LoopResponse) -> tuple[float, ...]:
        """Figures in the order of NAMES.

        Variance of PV about SP, mean absolute error, variance of OP, travel in % of span and reversals an hour.
        """
        rows = slice(self.settle, None)
        reference, pv, command = loop.reference[rows], loop.measured[rows], loop.command[rows]
        return (
            float(np.mean((pv - reference) ** 2)),
            mean_absolute_error(reference, pv),
            control_variance(command),
            travel_per_hour(command, loop.dt, self.span),
            reversals_per_hour(command, loop.dt, self.band),
        )


def steps(level: float, size: float, n: int, hold: int) -> FloatArray:
    """Set point at `level`, up by `size`, back, down by `size`, back, and again.

    Examples
    --------
    >>> steps(1.0, 0.5, 6, 1).tolist()
    [1.0, 1.5, 1.0, 0.5, 1.0, 1.5]
    """
    pattern = level + size * np.array([0.0, 1.0, 0.0, -1.0])
    return np.asarray(np.repeat(np.resize(pattern, -(-n // hold)), hold)[:n], dtype=np.float64)


def started_in_cycle(reference: FloatArray, settle: int, kick: float) -> FloatArray:
    """Set point with rows before it, and a kick in them: the loop is in its cycle when the counting begins."""
    whole_reference = np.concatenate([np.full(settle, reference[0]), reference])
    whole_reference[1 : settle // 3] += kick
    return whole_reference
