"""The control experiment: table 2 and figures 10 to 13."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from lostmotion.arguments import whole
from lostmotion.arrays import FloatArray
from lostmotion.compensate import DeadZoneCompensator
from lostmotion.evaluate import control_variance, mean_absolute_error
from lostmotion.models import DeadZone, Hammerstein, Identity, LinearModel
from lostmotion.paper.published import TABLE_1
from lostmotion.simulate import PI, LoopResponse, platforms, simulate_loop
from lostmotion.simulate.platforms.level_tank import DT, NOISE_VARIANCE

SAMPLES = 1000
TRACKS = {1: slice(0, 600), 2: slice(600, 800), 3: slice(800, 1000)}
CONTROLLER = PI(kp=0.5, ki=0.7)
LEVEL_AT_ZERO = 50.0  # % of the level for a control of zero
TABLE_1_ZONE = DeadZone(*(TABLE_1[name][0] for name in ("left", "right", "left_slope", "right_slope")))
CASES = ("ideal", "without", "with")


@dataclass(frozen=True)
class ControlStudy:
    """Indices of all seeds, and the responses of the first.

    Attributes
    ----------
    indices : dict
        (case, track) -> ndarray (seeds, 2) of eps1, eps2; cases "ideal" (no dead zone), "without" and "with"
        compensation.
    responses : dict
        Case -> LoopResponse of seed 0.
    limit_cycle : dict
        (case, track) -> largest distance of output and reference in the second half of tracks 2 and 3, without
        noise.
    zone : DeadZone
        What the compensator undoes.
    """

    indices: dict[tuple[str, int], FloatArray]
    responses: dict[str, LoopResponse]
    limit_cycle: dict[tuple[str, int], float]
    zone: DeadZone

    def mean(self, case: str, track: int) -> tuple[float, float]:
        """Means of eps1 and eps2 over the seeds."""
        eps1, eps2 = self.indices[case, track].mean(axis=0)
        return float(eps1), float(eps2)

    def spread(self, case: str, track: int) -> tuple[float, float]:
        """Standard deviations of eps1 and eps2 from seed to seed."""
        eps1, eps2 = self.indices[case, track].std(axis=0)
        return float(eps1), float(eps2)

    def iae(self, case: str) -> float:
        """eps2 over all tracks together, mean over the seeds."""
        weights = {track: rows.stop - rows.start for track, rows in TRACKS.items()}
        return sum(weights[track] * self.mean(case, track)[1] for track in TRACKS) / SAMPLES


def reference() -> FloatArray:
    """50 % for 60 s, 49 % for 20 s, 51 % for 20 s, in deviations."""
    return np.repeat([0.0, -1.0, 1.0], [600, 200, 200])


@functools.cache
def disturbance() -> tuple[FloatArray, LinearModel]:
    """-10 from 10 s to 40 s, and its path, the lag of the tank at unit gain."""
    time = np.arange(SAMPLES) * DT
    return np.where((time >= 10) & (time < 40), -10.0, 0.0), LinearModel.from_continuous([0.9], [1.0, 0.9], 0.0, DT)


def respond(case: str, seed: int | None, zone: DeadZone) -> LoopResponse:
    """One run of one case; seed None: without noise."""
    tank = platforms.level_tank()
    if case == "ideal":
        tank = Hammerstein(Identity(), tank.linear)
    block = DeadZoneCompensator(zone) if case == "with" else None
    load, path = disturbance()
    noise = None if seed is None else NOISE_VARIANCE
    return simulate_loop(tank, CONTROLLER, reference(), DT, block, load, noise, seed, disturbance_path=path)


def study_control(seeds: int = 200, zone: DeadZone = TABLE_1_ZONE) -> ControlStudy:
    """Repeat the paper's control experiment.

    Parameters
    ----------
    seeds : int
        Noise sequences.
    zone : DeadZone
        Estimated dead zone that the compensator undoes; default the paper's table 1.
    """
    indices: dict[tuple[str, int], list[tuple[float, float]]] = {}
    responses: dict[str, LoopResponse] = {}
    cycles: dict[tuple[str, int], float] = {}
    for case in CASES:
        quiet = respond(case, None, zone)
        for track, rows in list(TRACKS.items())[1:]:
            half = slice((rows.start + rows.stop) // 2, rows.stop)
            cycles[case, track] = float(np.max(np.abs(quiet.output[half] - quiet.reference[half])))
        for seed in range(whole("seeds", seeds, 1)):
            loop = respond(case, seed, zone)
            responses.setdefault(case, loop)
            for track, rows in TRACKS.items():
                pair = (
                    control_variance(loop.command[rows]),
                    mean_absolute_error(loop.reference[rows], loop.measured[rows]),
                )
                indices.setdefault((case, track), []).append(pair)
    return ControlStudy({key: np.array(value) for key, value in indices.items()}, responses, cycles, zone)
