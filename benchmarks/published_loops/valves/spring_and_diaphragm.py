"""The pneumatic valve of Kayihan and Doyle 2000, which Garcia 2008 compares friction models on.

Mass, spring and diaphragm in SI units; force and stem are told in % of full pressure and of the travel that it makes,
so that a spring without friction is where OP is.
"""

from __future__ import annotations

MASS = 1.36  # kg
SPRING = 52_538.0  # N/m
FULL_FORCE = 0.06452 * 68_950.0  # N: area of the diaphragm times full pressure
TRAVEL = FULL_FORCE / SPRING  # m
DAMPING = 612.9  # N s/m
STRIBECK_SPEED = 2.54e-4  # m/s
PRESSURE_LAG = 0.3  # s


def force_of(percent: float) -> float:
    """In N, of a share of full pressure in %."""
    return percent / 100 * FULL_FORCE


def travel_of(percent: float) -> float:
    """In m."""
    return percent / 100 * TRAVEL
