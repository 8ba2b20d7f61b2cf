"""A closed loop with a compensating block that can be stopped, changed and continued."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.compensate import CompensatorBlock
from lostmotion.errors import ParameterError
from lostmotion.kernels import actuator as kernel
from lostmotion.kernels.blocks import loop as blocks
from lostmotion.models import Hammerstein, KernelActuator, Nonlinearity
from lostmotion.simulate.controllers import PI
from lostmotion.simulate.response import LoopResponse


class BlockLoop:
    """Closed loop with a compensating block, simulated piece by piece; valve and settings may change in between.

    Parameters
    ----------
    plant : Hammerstein
        Process, and actuator at the start; the kind of actuator stays.
    controller : PI
    reference, disturbance, noise : ndarray, shape (n,)
        Set point; what is added to the output; measurement noise.
    block : CompensatorBlock
        At the start, before its first scan; its kind stays.
    """

    def __init__(
        self,
        plant: Hammerstein,
        controller: PI,
        reference: FloatArray,
        disturbance: FloatArray,
        noise: FloatArray,
        block: CompensatorBlock,
    ) -> None:
        linear = plant.linear
        self.plant, self.controller, self.block, self.enabled = plant, controller, block, True
        self.done = 0
        self._given = reference, disturbance, noise
        self._a, self._b = np.array(linear.a), np.array(linear.b)
        self._before = max(linear.delay + self._b.size, self._a.size)
        self._x, self._z = np.zeros((2, self._before + reference.size))
        self._signals = np.zeros((4, reference.size))
        self._kind, self._parameters = actuator_code(plant.nonlinearity)
        self._valve_state = kernel.init(controller.bias)
        self._carry = np.array([controller.bias])
        self._settings, self._memory = block.parameters(), block.specification.state()

    def set_valve(self, valve: Nonlinearity) -> None:
        """Go on with another actuator of the same kind."""
        kind, self._parameters = actuator_code(valve)
        if kind != self._kind:
            raise ParameterError.expected("an actuator of the same kind", valve.kind, "start another loop")

    def set_block(self, block: CompensatorBlock, enabled: bool = True) -> None:
        """Go on with other settings of the block, or with it off; the offset ramps there."""
        if block.kind != self.block.kind:
            raise ParameterError.expected(f"a block of kind {self.block.kind!r}", block.kind, "start another loop")
        self.block, self.enabled, self._settings = block, enabled, block.parameters()

    def advance(self, samples: int) -> None:
        """Simulate so many more samples, as far as the signals go."""
        reference, disturbance, noise = self._given
        start, stop = self.done, min(self.done + samples, reference.size)
        linear, pi = self.plant.linear, self.controller
        blocks.loop_with_block(
            self._a, self._b, linear.delay, self.plant.offset, self._kind, self._parameters, self._valve_state,
            self.block.specification.number, self._settings, self._memory, self.enabled, pi.kp, pi.ki * linear.dt,
            pi.low, pi.high, self._carry, reference, disturbance, noise, self._x, self._z, self._signals, start, stop,
        )  # fmt: skip
        self.done = stop

    @property
    def signals(self) -> FloatArray:
        """Rows of what has been simulated, without a copy: controller output, command, true output, measured."""
        return self._signals[:, : self.done]

    @property
    def response(self) -> LoopResponse:
        """Signals of what has been simulated."""
        n, dt = self.done, self.plant.linear.dt
        control, command, clean, measured = (row.copy() for row in self.signals)
        x = self._x[self._before : self._before + n].copy()
        return LoopResponse(
            np.arange(n, dtype=np.float64) * dt, self._given[0][:n], clean, measured, control, command, x, dt
        )


def actuator_code(valve: Nonlinearity) -> tuple[int, FloatArray]:
    """Number and parameters of an actuator, as ``kernels.actuator`` knows it."""
    if not isinstance(valve, KernelActuator):
        known = "a DeadZone, Backlash, Stiction, Saturation or Identity"
        raise ParameterError.expected(known, type(valve).__name__, "see lostmotion.models")
    return valve.kernel_code, valve.kernel_parameters()
