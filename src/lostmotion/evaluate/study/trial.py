"""What a block does: to the loop as identified, and to loops that the estimate leaves open."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.compensate import CompensatorBlock
from lostmotion.evaluate.limit_cycle import LimitCycle
from lostmotion.evaluate.study.cycles import (
    MOST_SAMPLES,
    PERIODS_A_RUN,
    CycleTest,
    predicted_cycle,
    simulated_cycle,
)
from lostmotion.evaluate.study.mistakes import Mistake
from lostmotion.evaluate.study.retuning import FEW_RUNS, retuned
from lostmotion.evaluate.study.scenario import NAMES, Scenario
from lostmotion.evaluate.study.study_plant import StudyPlant
from lostmotion.evaluate.study.study_result import LoopCase, MistakeCase
from lostmotion.evaluate.study.worth import Decision, decide
from lostmotion.simulate import PI, LoopResponse

FEWEST_SETTLE, MOST_SETTLE = 600, 4000
PERIODS = 4.0  # of a limit cycle until it has set in
SHARES = (0.8, 0.6)  # of what the interval allows: over-compensation by the fifth that a valve changes makes cycles


@dataclass(frozen=True)
class Trial:
    """One block, what it was tried on, and what came of it.

    Attributes
    ----------
    block : CompensatorBlock
    cases : mapping of str to LoopCase
    responses : mapping of str to LoopResponse
    wrong, wrong_retuned : tuple of MistakeCase
        With the present and with the retuned controller.
    decision : Decision
    """

    block: CompensatorBlock
    cases: Mapping[str, LoopCase]
    responses: Mapping[str, LoopResponse]
    wrong: tuple[MistakeCase, ...]
    wrong_retuned: tuple[MistakeCase, ...]
    decision: Decision
    again: Callable[[CompensatorBlock], Trial]

    def or_safer(self, made: Callable[[float], CompensatorBlock]) -> Trial:
        """Where it helps but is not safe, the block of the largest share that is, and still helps; else this one.

        `made` gives the block of a share of the lost motion. Where none is safe, this one says so.
        """
        if self.decision.safe or not self.decision.useful:
            return self
        whole = self.block.settings["factor"]
        for share in SHARES:
            other = self.again(made(share * whole))
            if other.decision.safe and other.decision.useful:
                said = (
                    f"The block compensates {100.0 * share * whole:.0f} % of the lost motion: one of"
                    f" {100.0 * whole:.0f} %, which the interval allows, would not be safe."
                )
                note = f"factor {share * whole:.3f}: a larger share was not safe in the study"
                block = replace(other.block, notes=(*other.block.notes, note))
                return replace(other, block=block, decision=other.decision.adding(said))
        tried = " and ".join(f"{100.0 * share * whole:.0f} %" for share in SHARES)
        return replace(self, decision=self.decision.adding(f"Of {tried} of the lost motion none is safe and helps."))


def trial(
    plant: StudyPlant,
    controller: PI,
    block: CompensatorBlock,
    scenario: Scenario,
    test: CycleTest,
    plants: Sequence[Mistake],
    noise: float,
) -> Trial:
    """Try a block on the loop, and on the plants that could stand behind the estimate.

    Parameters
    ----------
    plant, controller, block, scenario, test
        Of the study.
    plants : sequence of Mistake
    noise : float
        Deviation of that of PV.
    """
    cases, responses = _cases(plant, controller, block, scenario, test)
    controllers = controller, cases["with, retuned"].controller
    slow = _long_enough(test, cases, plant.model.linear.dt)
    pairs = [_mistakes(group, what, one, controllers, block, scenario, slow) for group, what, one in plants]
    wrong, wrong_retuned = (tuple(pair[number] for pair in pairs) for number in (0, 1))
    decision = decide(cases, wrong, wrong_retuned, block, noise)

    def again(other: CompensatorBlock) -> Trial:
        return trial(plant, controller, other, scenario, test, plants, noise)

    return Trial(block, cases, responses, wrong, wrong_retuned, decision, again)


def settling_rows(block: CompensatorBlock, period: float) -> int:
    """Rows until the offset is in force and a limit cycle has set in."""
    scans = block.settings["cap"] / max(block.settings["ramp_step"], 1e-12)
    periods = PERIODS * period if np.isfinite(period) else 0.0
    return int(min(max(2.0 * scans, periods, FEWEST_SETTLE), MOST_SETTLE))


def _cases(
    plant: StudyPlant, controller: PI, block: CompensatorBlock, scenario: Scenario, test: CycleTest
) -> tuple[dict[str, LoopCase], dict[str, LoopResponse]]:
    repaired = plant.with_valve(plant.fault.repaired(block))
    loops = {
        "without": (plant, controller, None),
        "with": (plant, controller, block),
        "retuned": (plant, retuned(plant, controller, None, scenario, test), None),
        "with, retuned": (plant, retuned(plant, controller, block, scenario, test), block),
        "no fault": (repaired, controller, None),
    }
    cases, responses, now = {}, {}, None
    for name, (one, pi, inverse) in loops.items():
        figures, responses[name] = scenario.run(one, pi, inverse)
        now = figures if now is None else now
        predicted = predicted_cycle(one, pi, inverse)
        cycle = simulated_cycle(one, pi, inverse, test, predicted)
        cases[name] = _case(figures, now, cycle, predicted, pi)
    return cases, responses


def _case(
    figures: FloatArray, now: FloatArray, cycle: LimitCycle, predicted: LimitCycle | None, controller: PI
) -> LoopCase:
    iae = NAMES.index("iae")
    ratios = figures[:, iae] / np.maximum(now[:, iae], 1e-300)
    error = float(np.std(ratios, ddof=1) / np.sqrt(ratios.size)) if ratios.size > 1 else 0.0
    ratio = float(figures[:, iae].mean() / max(now[:, iae].mean(), 1e-300))
    means = dict(zip(NAMES, figures.mean(axis=0).tolist(), strict=True))
    return LoopCase(**means, ratio=ratio, ratio_error=error, cycle=cycle, predicted=predicted, controller=controller)


def _long_enough(test: CycleTest, cases: Mapping[str, LoopCase], dt: float) -> CycleTest:
    """Runs that hold the slowest cycle of the estimated plant, with some room for others."""
    swings = [cycle for case in cases.values() for cycle in (case.cycle, case.predicted) if cycle is not None]
    slowest = max((cycle.period for cycle in swings if cycle.amplitude), default=0.0)
    return replace(test, samples=int(min(max(test.samples, 1.5 * PERIODS_A_RUN * slowest / dt), MOST_SAMPLES)))


def _mistakes(
    group: str, what: str, plant: StudyPlant, controllers: tuple[PI, PI], block: CompensatorBlock, scenario: Scenario,
    test: CycleTest,
) -> tuple[MistakeCase, MistakeCase]:  # fmt: skip
    """The block on one plant with the present controller, and with the retuned one."""
    iae, travel = NAMES.index("iae"), NAMES.index("travel")
    before = np.maximum(scenario.run(plant, controllers[0], None, FEW_RUNS)[0].mean(axis=0), 1e-300)
    cycle = simulated_cycle(plant, controllers[0], None, test)
    made = []
    for controller in controllers:
        after = scenario.run(plant, controller, block, FEW_RUNS)[0].mean(axis=0) / before
        swing = simulated_cycle(plant, controller, block, test)
        made.append(MistakeCase(group, what, float(after[iae]), float(after[travel]), cycle, swing, test.floor))
    return made[0], made[1]
