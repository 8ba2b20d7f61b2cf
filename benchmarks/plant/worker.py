"""Run the plant once: ``python worker.py OUT.npz HOURS SEED [IDV ..]``, inside the environment of tep-studio.

OUT gets op, pv, sp, position and held, each (n, loops), and names (loops,). Row k: what the controller saw and set at
that instant, the position of the stem at that instant, and the command that the valve took over for the step that
follows (`held`: the command itself where the valve does not stick).
"""

from __future__ import annotations

import sys

import numpy as np
from tep_studio.control.controller import RickerMultiLoopController
from tep_studio.control.registry import RICKER_MODE1 as STRATEGY
from tep_studio.simulation.core import TennesseeEastmanProcess
from tep_studio.simulation.schema import TEP_SCHEMA

INTERVAL = STRATEGY.nominal.ts_base  # hours: step of the plant and of its controllers
# Seconds, first-order lag of each valve (Downs and Vogel's VTAU); the package does not publish them.
LAGS = np.array([8.0, 8, 6, 9, 7, 5, 5, 5, 120, 5, 5, 5])
TEMPERATURES = (STRATEGY.reactor_temperature, STRATEGY.separator_temperature)
NAMES = [loop.name for loop in (*STRATEGY.feed_loops, *TEMPERATURES)]
VALVES = [loop.mv for loop in STRATEGY.feed_loops] + [loop.drives for loop in TEMPERATURES]
MEASURED = [loop.pv for loop in (*STRATEGY.feed_loops, *TEMPERATURES)]


def set_points(controller: RickerMultiLoopController, diagnostics) -> list[float]:
    flows = [diagnostics.ratios[loop.ratio_key] * diagnostics.fp for loop in STRATEGY.feed_loops]
    return [*flows, controller.setpoints.reactor_temperature, diagnostics.setpoints["separator_temperature"]]


def taken_over(position: np.ndarray, lags: np.ndarray) -> np.ndarray:
    """What the stems moved to in each step: their lag inverted, as the fourth-order Runge-Kutta step has it."""
    r = 3600.0 * INTERVAL / lags
    kept = 1.0 - r + r**2 / 2.0 - r**3 / 6.0 + r**4 / 24.0
    return (position[1:] - kept * position[:-1]) / (1.0 - kept)


def main(target: str, hours: str, seed: str, *disturbances: str) -> None:
    plant, controller = TennesseeEastmanProcess(), RickerMultiLoopController()
    valves = [TEP_SCHEMA.index("manipulated_variables", name) for name in VALVES]
    measured = [TEP_SCHEMA.index("measurements", name) for name in MEASURED]
    active = np.zeros(28)
    active[[int(number) - 1 for number in disturbances]] = 1.0
    seen, _ = plant.reset(seed=float(seed))
    controller.reset(seen, time=0.0)
    op, pv, sp, position = [], [], [], [plant.state[38:50][valves]]
    for _ in range(round(float(hours) / INTERVAL)):
        action, diagnostics = controller.compute_action(seen, time=plant.time)
        op.append(action[valves])
        pv.append(seen[measured])
        sp.append(set_points(controller, diagnostics))
        step = plant.advance(action, control_interval=INTERVAL, disturbances=active)
        if step.shutdown_status["terminated"]:
            sys.exit(f"the plant shut down after {plant.time:.2f} h: {step.shutdown_status['message']}")
        position.append(step.state[38:50][valves])
        seen = step.measurements
    stems = np.array(position)
    held = taken_over(stems, LAGS[valves])
    np.savez(
        target, op=op, pv=pv, sp=sp, position=stems[:-1], held=held, names=NAMES, valves=VALVES, dt=3600.0 * INTERVAL
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
