"""The loop that is studied: an identified plant at rest where the record was, with controller, load and noise."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter

from lostmotion.arrays import FloatArray
from lostmotion.compensate import CompensatorBlock
from lostmotion.errors import ParameterError
from lostmotion.evaluate.study.faults import Fault, fault_of
from lostmotion.models import Hammerstein, NoiseModel, Nonlinearity
from lostmotion.simulate import PI, LoopResponse, simulate_loop

MOST_MEMORY = 5000  # samples for which the noise runs before it counts
# a root of the noise is kept within this: a drift that was fitted as a random walk, or by rounding as a little more,
# forgets within a record
MOST_ROOT = 1.0 - 1.0 / MOST_MEMORY
DRIFTS = 1.02  # a root beyond this is no drift


@dataclass(frozen=True)
class StudyPlant:
    """A plant with what it rests against.

    Attributes
    ----------
    model : Hammerstein
    load : float
        Of an integrating process, in units of x: what the actuator must balance.
    """

    model: Hammerstein
    load: float = 0.0

    @property
    def valve(self) -> Nonlinearity:
        """Actuator."""
        return self.model.nonlinearity

    @property
    def fault(self) -> Fault:
        """What the study needs to know of the actuator."""
        return fault_of(self.valve)

    def with_valve(self, valve: Nonlinearity) -> StudyPlant:
        """The same process behind another actuator."""
        return replace(self, model=Hammerstein(valve, self.model.linear, self.model.offset))

    def rest(self, set_point: float) -> tuple[float, float]:
        """Command and internal variable at rest at a set point."""
        linear = self.model.linear
        x = -self.load if linear.integrates() else (set_point - self.model.offset) / linear.gain
        return self.fault.command_at(x), x

    def set_point_at(self, command: float) -> float:
        """Set point that needs this command at rest; an integrating process rests anywhere."""
        linear = self.model.linear
        if linear.integrates():
            return self.model.offset
        return self.model.offset + linear.gain * float(self.valve(command))

    def run(
        self, controller: PI, block: CompensatorBlock | None, reference: FloatArray, noise: FloatArray
    ) -> LoopResponse:
        """Loop from rest at the first set point; what rests is taken out of the recursion as a disturbance."""
        linear, n = self.model.linear, reference.size
        command, x = self.rest(float(reference[0]))
        command = min(max(command, controller.low), controller.high)
        level = reference[0] - self.model.offset - linear.simulate(np.full(n, x))
        start = replace(controller, bias=command)
        return simulate_loop(
            self.model, start, reference, compensator=block, disturbance=level, noise=noise, allow_unstable=True
        )


def noise_samples(noise: NoiseModel, n: int, seed: int) -> FloatArray:
    """Samples of the output noise, in its steady state.

    Raises
    ------
    ParameterError
        Noise that grows.
    """
    if noise.variance == 0.0:
        return np.zeros(n)
    roots = np.roots([1.0, *noise.d])
    radius = float(np.max(np.abs(roots), initial=0.0))
    if radius >= DRIFTS:
        raise ParameterError.expected("stationary noise", f"a pole of modulus {radius:.4f}", "check the fit")
    d = np.array([1.0, *noise.d])
    if radius > MOST_ROOT:
        d = np.real(np.poly(roots / np.maximum(np.abs(roots) / MOST_ROOT, 1.0)))
        radius = MOST_ROOT
    before = 0 if radius == 0.0 else min(int(10.0 / -np.log(radius)) + 1, MOST_MEMORY)
    shocks = np.random.default_rng(seed).normal(scale=np.sqrt(noise.variance), size=n + before)
    return np.asarray(lfilter(noise.numerator, d, shocks), dtype=np.float64)[before:]
