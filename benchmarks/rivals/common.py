"""What the rivals share: the experiment's orders, one generic start, and a simulation anyone would write."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

NA, NB, DELAY = 3, 2, 3
START_A = (-0.9, 0.0, 0.0)  # a first-order lag of about ten samples,
START_B = (0.05, 0.05, 0.05)  # of gain 1.5,
START_ZONE = (-0.5, 0.5, 0.0)  # behind a dead zone half as wide as the true one, log of the slope ratio 0
Array = np.ndarray


@dataclass(frozen=True)
class Found:
    """What a rival found: the dead zone, and a simulation of y from u."""

    left: float
    right: float
    ratio: float
    simulate: Callable[[Array], Array]


def dead_zone(u: Array, left: float, right: float, log_ratio: float) -> Array:
    """Internal variable with right slope 1."""
    return np.maximum(u - right, 0.0) + np.exp(log_ratio) * np.minimum(u - left, 0.0)


def lag(u: Array, samples: int) -> Array:
    """Values of `samples` samples ago along the first axis, zero before the record."""
    out = np.zeros_like(u)
    out[samples:] = u[: len(u) - samples]
    return out


def hammerstein(a: Array, b: Array, left: float, right: float, log_ratio: float) -> Found:
    """Result of a rival that has the whole model."""

    def simulate(u: Array) -> Array:
        x = dead_zone(u, left, right, log_ratio)
        return lfilter(np.r_[np.zeros(DELAY), b], np.r_[1.0, a], x)

    return Found(float(left), float(right), float(np.exp(log_ratio)), simulate)
