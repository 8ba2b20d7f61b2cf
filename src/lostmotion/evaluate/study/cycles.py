"""Limit cycle of a loop with or without a block: simulated without noise, and by the describing function."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Any, ClassVar

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.compensate import CompensatorBlock
from lostmotion.evaluate.limit_cycle import LimitCycle, measure_limit_cycle, predict_limit_cycles
from lostmotion.evaluate.study.study_plant import StudyPlant
from lostmotion.models import Nonlinearity
from lostmotion.simulate import PI

AMPLITUDES = 40  # over REACH: 22 % apart
REACH = (0.02, 50.0)  # amplitudes of OP that are looked at, in widths
SAMPLES_A_PERIOD, PERIODS = 200, 2
PERIODS_A_RUN, MOST_SAMPLES = 18.0, 60_000
TIMED = ("stiction knocker", "stiction two moves")  # they go by the clock, so a sine says nothing about them
SMALL = 0.1  # second kick: a loop with memory may rest after one and cycle after another
NOTHING = 1e-3  # of the kick: what rounding may leave


@dataclass(frozen=True)
class CycleTest:
    """How cycles are sought.

    Attributes
    ----------
    levels : ndarray
        Set points at which the loop is left alone.
    kick : float
        Step of the set point that sets it swinging, in units of PV: as large as operation has them.
    samples : int
        Length of a run; its last third is looked at.
    floor : float
        Amplitude of PV that does not count.
    """

    levels: FloatArray
    kick: float
    samples: int
    floor: float


def simulated_cycle(
    plant: StudyPlant,
    controller: PI,
    block: CompensatorBlock | None,
    test: CycleTest,
    predicted: LimitCycle | None = None,
) -> LimitCycle:
    """The largest cycle over all levels, without noise, after a third of the run at another set point.

    The run is made long enough for the predicted cycle.
    """
    samples = test.samples
    if predicted is not None and predicted.amplitude:
        samples = int(min(max(samples, PERIODS_A_RUN * predicted.period / plant.model.linear.dt), MOST_SAMPLES))
    zero = np.zeros(samples)
    worst = LimitCycle()
    kicks = (test.kick,) if plant.fault.static else (test.kick, SMALL * test.kick)
    for level, kick in product(test.levels, kicks):
        reference = np.full(samples, level)
        reference[1 : samples // 3] += kick
        loop = plant.run(controller, block, reference, zero)
        floor = max(test.floor, NOTHING * abs(test.kick))
        found = measure_limit_cycle(loop.output, loop.control, loop.dt, floor)
        if found.amplitude > worst.amplitude:
            worst = found
    return worst


def predicted_cycle(plant: StudyPlant, controller: PI, block: CompensatorBlock | None) -> LimitCycle | None:
    """The largest stable cycle by the describing function of what is left of the actuator behind the block.

    Around the middle of the lost motion (dead zone), else around 0. None where a sine says nothing: the blocks for
    stiction go by the clock.
    """
    if block is not None and block.kind in TIMED:
        return None
    valve, fault = plant.valve, plant.fault
    bias = block.settings["centre"] if block is not None and block.kind == "dead zone" else fault.middle
    left: Nonlinearity = valve if block is None else LeftOver(valve, _unhurried(block))
    size = max(fault.lost_motion, 1e-9)

    def gain(amplitude: float) -> complex:
        return _gain_in_motion(left, amplitude, bias, size)

    amplitudes = np.geomspace(REACH[0] * size, REACH[1] * size, AMPLITUDES)
    cycles = predict_limit_cycles(gain, amplitudes, plant.model.linear, controller)
    return cycles[-1] if cycles else LimitCycle()


def _gain_in_motion(actuator: Nonlinearity, amplitude: float, bias: float, size: float) -> complex:
    """Describing function of an actuator that a larger sine has set in motion: from rest a sticking valve may stay."""
    angle = 2.0 * np.pi / SAMPLES_A_PERIOD * np.arange(SAMPLES_A_PERIOD)
    sines = np.concatenate([(amplitude + 2.0 * size) * np.sin(angle), *[amplitude * np.sin(angle)] * PERIODS])
    last = np.asarray(actuator(bias + sines))[-SAMPLES_A_PERIOD:]
    return complex(2.0 / SAMPLES_A_PERIOD * (last @ (np.sin(angle) + 1j * np.cos(angle))) / amplitude)


@dataclass
class LeftOver:
    """What is left of an actuator behind a block, as an actuator."""

    valve: Nonlinearity
    block: CompensatorBlock
    kind: ClassVar[str] = "left over"

    def __call__(self, u: Any) -> Any:
        """Internal variable for the controller output u."""
        return self.valve(self.block.run(u).op_out)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        return {"kind": self.kind, "valve": self.valve.to_dict(), "block": self.block.to_dict()}


def _unhurried(block: CompensatorBlock) -> CompensatorBlock:
    """The block without clamps and ramp: a sine of any amplitude, from the first scan on."""
    wide = 1e9
    limits = {"low": -wide, "high": wide, "safe": 0.0, "ramp_step": wide, "rate": wide, "cap": wide}
    return block.with_settings(**limits)


def cycle_test(
    plant: StudyPlant, controller: PI, reference: FloatArray, deviation: float, samples: int, span: tuple[float, float]
) -> CycleTest:
    """Levels over the range of the set point and what the noise adds to it, those in the lost motion included.

    Parameters
    ----------
    plant : StudyPlant
    controller : PI
    reference : ndarray
        Set point.
    deviation : float
        Of the noise of PV.
    samples : int
        Length of a run.
    span : (float, float)
        Of OP: levels that it cannot hold are left out.
    """
    linear, fault = plant.model.linear, plant.fault
    low, high = float(reference.min()) - 2.0 * deviation, float(reference.max()) + 2.0 * deviation
    levels = [float(np.median(reference))]
    if fault.static and not linear.integrates():
        levels += np.linspace(low, high, 5).tolist()
        edge = fault.inside * abs(linear.gain)
        centre = plant.model.offset
        levels += [level for level in (centre - edge, centre, centre + edge) if low <= level <= high]
    held = [level for level in dict.fromkeys(levels) if span[0] <= plant.rest(level)[0] <= span[1]]
    kick = max(3.0 * deviation, 0.5 * float(np.ptp(reference)))
    if kick == 0.0:
        reach = abs(linear.gain) if not linear.integrates() else 1.0 / max(abs(controller.kp), 1e-300)
        kick = 0.5 * fault.lost_motion * reach
    return CycleTest(np.array(held or levels[:1]), kick, samples, 0.1 * deviation)
