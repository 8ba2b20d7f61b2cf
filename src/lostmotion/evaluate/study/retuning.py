"""The controller that a loop would be retuned to: SIMC, of the slowness that does best without harm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.compensate import CompensatorBlock
from lostmotion.evaluate.study.cycles import CycleTest, predicted_cycle, simulated_cycle
from lostmotion.evaluate.study.faults import fault_of
from lostmotion.evaluate.study.scenario import NAMES, Scenario
from lostmotion.evaluate.study.study_plant import StudyPlant
from lostmotion.evaluate.tuning import simc
from lostmotion.simulate import PI

SLOWNESS = (1.0, 2.0, 4.0, 8.0)  # of the controllers tried, in dead times
MOST_TRAVEL = 2.0  # times the present: a retuned loop must not work the valve harder
MOST_CHANGE = 10.0  # times the present gains, either way: SIMC of a pole near 1 switched a controller off
FEW_RUNS = 2  # on each controller, and on each plant that the estimate may be wrong about
# times the cycle without block: a retuned loop may not cycle more, but for the reading of the amplitude
TOLERANCE = 1.02


def retuned(
    plant: StudyPlant, controller: PI, block: CompensatorBlock | None, scenario: Scenario, test: CycleTest
) -> PI:
    """The SIMC controller that does best, of those that neither cycle more than now nor wear the valve."""
    iae, travel = NAMES.index("iae"), NAMES.index("travel")
    now = scenario.run(plant, controller, None, FEW_RUNS)[0].mean(axis=0)
    cycle = simulated_cycle(plant, controller, None, test, predicted_cycle(plant, controller, None)).amplitude
    best, least = controller, np.inf
    linear = plant.model.linear
    slope = (plant.fault if block is None else fault_of(plant.fault.repaired(block))).slope
    for slowness in SLOWNESS:
        rule = simc(linear.scaled(slope), slowness)
        tried = replace(controller, kp=rule.kp, ki=rule.ki)
        if not _like(tried, controller):
            continue
        figures = scenario.run(plant, tried, block, FEW_RUNS)[0].mean(axis=0)
        if not figures[iae] < least or figures[travel] > MOST_TRAVEL * now[travel]:
            continue
        swing = simulated_cycle(plant, tried, block, test, predicted_cycle(plant, tried, block))
        if swing.amplitude <= max(TOLERANCE * cycle, test.floor):
            best, least = tried, figures[iae]
    return best


def _like(tried: PI, controller: PI) -> bool:
    """Whether it is a retuned controller, and not another or none.

    One that hardly acts looks good here, where the plant rests at its set point and few disturbances come.
    """
    gains = ((tried.kp, controller.kp), (tried.ki, controller.ki))
    return all(abs(now) <= MOST_CHANGE * abs(new) <= MOST_CHANGE**2 * abs(now) for new, now in gains if now != 0.0)
