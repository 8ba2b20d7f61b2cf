"""Set points, loads and noise of the loops.

A signal is a function of its `Setting` and gives one value a row, in %; set points and loads are told as what they add
to rest. Sizes are in %, periods in seconds.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter, sawtooth

Array = np.ndarray
Rng = np.random.Generator

LEVELS = np.array([0.0, 1.0, -0.5, 0.7, -1.0, 0.3])  # of a set point that goes in six steps
PERIODS, PHASE = 1.7, 0.4  # of a slow load, in the record


class Setting(NamedTuple):
    """What a signal may depend on."""

    rows: int
    seconds: float  # of a row
    rng: Rng
    size: float  # S of the valve
    gain: float  # of the process; NaN where it integrates
    swing: float  # of PV while nothing moves the loop

    @property
    def times(self) -> Array:
        return np.arange(self.rows) * self.seconds


Signal = Callable[[Setting], Array]


def levels(setting: Setting) -> Array:
    """Six levels of the same length."""
    return LEVELS[np.arange(setting.rows) * len(LEVELS) // setting.rows]


def steps(size: float) -> Signal:
    return lambda setting: size * levels(setting)


def steps_by_size(setting: Setting) -> Array:
    """Steps that move OP by 1.5 sizes of the fault; of a level by three swings."""
    swing = 3 * max(setting.swing, 0.3 * setting.size)
    return levels(setting) * (swing if np.isnan(setting.gain) else 1.5 * setting.size * abs(setting.gain))


def large_steps(setting: Setting) -> Array:
    return levels(setting) * 2 * setting.size * (0.4 if np.isnan(setting.gain) else abs(setting.gain))


def slow_load(setting: Setting) -> Array:
    """A slow sine larger than the fault, and a little of a walk."""
    along = np.arange(setting.rows) / setting.rows
    walked = np.cumsum(setting.rng.standard_normal(setting.rows)) * 0.02 / np.sqrt(setting.rows / 500)
    return np.asarray(setting.size * (1.6 * np.sin(2 * np.pi * PERIODS * along + PHASE) + walked))


def walk(size: float) -> Signal:
    """By so much in a row."""
    return lambda setting: size * np.cumsum(setting.rng.standard_normal(setting.rows))


def smooth_walk(setting: Setting) -> Array:
    """As a master controller moves a set point."""
    return np.asarray(lfilter([0.1], [1.0, -0.9], walk(0.15)(setting)))


def white(size: float) -> Signal:
    return lambda setting: size * setting.rng.standard_normal(setting.rows)


def coloured(size: float, pole: float) -> Signal:
    """First-order autoregression of this deviation."""
    scale = size * np.sqrt(1 - pole * pole)
    return lambda setting: np.asarray(lfilter([scale], [1.0, -pole], setting.rng.standard_normal(setting.rows)))


def sine(size: float, period: float) -> Signal:
    return lambda setting: size * np.sin(2 * np.pi * setting.times / period)


def square(size: float, period: float) -> Signal:
    return lambda setting: size * np.sign(np.sin(2 * np.pi * setting.times / period))


def triangle(size: float, period: float) -> Signal:
    return lambda setting: size * np.asarray(sawtooth(2 * np.pi * setting.times / period, 0.5))


def saw(size: float, period: float) -> Signal:
    return lambda setting: size * np.asarray(sawtooth(2 * np.pi * setting.times / period))


def telegraph(size: float, chance: float) -> Signal:
    """Plus or minus, turning with this chance in a row."""
    return lambda setting: size * np.cumprod(np.where(setting.rng.random(setting.rows) < chance, -1.0, 1.0))


def pulses(size: float, every: int, length: int) -> Signal:
    """In rows."""
    return lambda setting: size * (np.arange(setting.rows) % every < length)


def on_and_off(size: float, rows: int) -> Signal:
    return lambda setting: size * (np.arange(setting.rows) // rows % 2)


def together(*signals: Signal) -> Signal:
    return lambda setting: np.sum([one(setting) for one in signals], axis=0)


def rounded(unit: float) -> Callable[[float], float]:
    """A sensor that tells multiples of a unit."""
    return lambda value: round(value / unit) * unit


def clipped(low: float, high: float) -> Callable[[float], float]:
    """A sensor whose range ends."""
    return lambda value: min(max(value, low), high)
