"""Loads that come from another loop, whose valve sticks."""

from __future__ import annotations

import numpy as np

from published_loops.closed_loop import BEFORE, REST, Driven, Recorded, closed_loop
from published_loops.plants import PLANTS
from published_loops.signals import Array, Setting, Signal
from published_loops.valves import Valve

NOISE = 0.01  # % of PV


def pv_of(plant: str, valve: Valve, gain: float) -> Signal:
    """So many times the PV of a loop."""
    return lambda setting: gain * (_run(plant, valve, setting).pv - REST)


def stem_of(plant: str, valve: Valve) -> Signal:
    """The flow through the valve of a loop: steps and stairs."""
    return lambda setting: _run(plant, valve, setting).stem - REST


def _run(plant: str, valve: Valve, setting: Setting) -> Recorded:
    still: Array = np.zeros(setting.rows)
    noise = NOISE * setting.rng.standard_normal(BEFORE + setting.rows)
    return closed_loop(PLANTS[plant], valve, Driven(still, still, noise))
