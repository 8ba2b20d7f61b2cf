"""The paper's level tank in service: PI loop, manual stretches, a valve that wears; block after block."""

from __future__ import annotations

import numpy as np
from numba import njit

import lostmotion as lm
from lostmotion.kernels.dead_zone import forward
from lostmotion.kernels.loop import pi_step
from lostmotion.simulate.routine import DRIFT, DRIFT_POLE, PAPER_PI

AUTO, HELD, HAND = range(3)  # loop closed; OP held and recorded; valve moved by hand, OP in the record is stale
TANK = lm.platforms.level_tank()
A, B = np.array(TANK.linear.a), np.array(TANK.linear.b)
SLOPE = TANK.nonlinearity.right_slope
KP, KI_DT, LIMIT = PAPER_PI.kp, PAPER_PI.ki * TANK.linear.dt, PAPER_PI.high
SHOCK = DRIFT["mild"] * (1.0 - DRIFT_POLE**2) ** 0.5
NOISE = 0.03**0.5
Array = np.ndarray


@njit
def serve(
    a: Array, b: Array, delay: int, slope: float, kp: float, ki_dt: float, limit: float, pole: float,
    reference: Array, mode: Array, hand: Array, left: Array, right: Array, shocks: Array, noise: Array,
    past_x: Array, past_z: Array, memory: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Recorded OP and measured PV of one block. `memory`: [integral, drift, recorded OP]; the past newest first."""
    n = reference.size
    recorded, measured = np.empty(n), np.empty(n)
    for k in range(n):
        z = 0.0
        for i in range(b.size):
            z += b[i] * past_x[delay - 1 + i]
        for i in range(a.size):
            z -= a[i] * past_z[i]
        for i in range(a.size - 1, 0, -1):
            past_z[i] = past_z[i - 1]
        past_z[0] = z
        memory[1] = pole * memory[1] + shocks[k]
        measured[k] = z + memory[1] + noise[k]
        error = reference[k] - measured[k]
        if mode[k] == AUTO:
            memory[2], memory[0] = pi_step(error, memory[0], kp, ki_dt, -limit, limit)
        else:
            memory[0] = memory[2] - kp * error  # back to automatic without a bump
        recorded[k] = memory[2]
        command = hand[k] if mode[k] == HAND else memory[2]
        for i in range(past_x.size - 1, 0, -1):
            past_x[i] = past_x[i - 1]
        past_x[0] = forward(command, left[k], right[k], slope, slope)
    return recorded, measured


class Plant:
    """The loop with its state between blocks."""

    def __init__(self) -> None:
        self._past_x, self._past_z = np.zeros(TANK.linear.delay + B.size - 1), np.zeros(A.size)
        self._memory = np.zeros(3)

    def run(
        self, reference: Array, mode: Array, hand: Array, left: Array, right: Array, random: np.random.Generator
    ) -> tuple[Array, Array]:
        """Recorded OP and PV of the next block; all arrays (n,)."""
        shocks = random.normal(scale=SHOCK, size=reference.size)
        noise = random.normal(scale=NOISE, size=reference.size)
        return serve(
            A, B, TANK.linear.delay, SLOPE, KP, KI_DT, LIMIT, DRIFT_POLE, reference, mode, hand, left, right, shocks,
            noise, self._past_x, self._past_z, self._memory,
        )  # fmt: skip
