"""What comes from outside: drifting and stepping loads, noise of sensors, a swing from beyond the plant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from lostmotion.arrays import FloatArray
from lostmotion.evaluate.plants.made_loop import MadeLoop

DRIFT_PACE = (3.0, 40.0)  # paces of the closed loop
STEPPED = 0.25  # of the loops get loads that step: pumps and batches elsewhere
STEPS = (0.5, 4.0)  # %
STEPS_EVERY = (3600.0, 28_800.0)  # seconds
COLOURED = 0.3  # of the sensors have noise that is not white
JITTER = 0.02  # of a row of the clock of a swing, a random walk: nothing swings like a clock
SHAPES = ("sine", "sine", "square", "pulses")


@dataclass(frozen=True)
class Swing:
    """An oscillation from outside, as load on one loop.

    Attributes
    ----------
    loop : int
    period, size, phase : float
        Seconds, % of OP, radians.
    shape : str
        "sine", "square" (of somebody else's switch, behind a lag), "pulses" (of a batch that draws now and then).
    seed : int
        Of its wandering clock: the same for all loops that it reaches.
    """

    loop: int
    period: float
    size: float
    phase: float
    shape: str
    seed: int


@dataclass
class Sources:
    """Random signals of one loop, block after block; what is drawn for one does not change another.

    Attributes
    ----------
    loop : MadeLoop
    rng : Generator
    dt, seconds : float
        Seconds of a row and of the whole.
    """

    loop: MadeLoop
    rng: np.random.Generator
    dt: float
    seconds: float

    def __post_init__(self) -> None:
        draw = self.rng
        pace = max(self.loop.pace, 5.0) * draw.uniform(*DRIFT_PACE)
        self._pole = float(np.exp(-self.dt / pace))
        self._colour = draw.uniform(0.3, 0.9) if draw.random() < COLOURED else 0.0
        self._levels, self._times = self._steps(draw)
        self._memory = np.zeros(1), np.zeros(1)

    def _steps(self, draw: np.random.Generator) -> tuple[FloatArray, FloatArray]:
        if draw.random() >= STEPPED:
            return np.zeros(1), np.empty(0)
        count = draw.poisson(self.seconds / draw.uniform(*STEPS_EVERY))
        levels = draw.normal(scale=draw.uniform(*STEPS), size=count)
        return np.r_[0.0, levels], np.sort(draw.uniform(0.0, self.seconds, size=count))

    def block(self, begin: int, rows: int) -> tuple[FloatArray, FloatArray]:
        """Load and noise of the next rows."""
        white = self.rng.normal(size=(2, rows))
        fresh = np.sqrt(1.0 - self._pole**2)
        drift, first = lfilter([fresh], [1.0, -self._pole], white[0], zi=self._memory[0])
        calm = np.sqrt(1.0 - self._colour**2)
        noise, second = lfilter([calm], [1.0, -self._colour], white[1], zi=self._memory[1])
        self._memory = first, second
        times = (begin + np.arange(rows)) * self.dt
        steps = self._levels[np.searchsorted(self._times, times, side="right")]
        return self.loop.drift * drift + steps, self.loop.noise * noise


def swinging(swing: Swing, rows: int, dt: float) -> FloatArray:
    """Load of an outside swing over all rows; shape (rows,)."""
    random = np.random.default_rng([swing.seed, 3])
    clock = np.arange(rows) * dt + np.cumsum(random.normal(scale=JITTER * np.sqrt(dt * swing.period), size=rows))
    angle = 2.0 * np.pi * clock / swing.period + swing.phase
    wave = np.sin(angle)
    if swing.shape == "square":
        wave = _smoothed(np.sign(wave), 0.12 * swing.period / dt)
    elif swing.shape == "pulses":
        wave = _smoothed(2.0 * (wave > 0.7) - 0.5, 0.08 * swing.period / dt)
    return np.asarray(swing.size * wave)


def _smoothed(wave: FloatArray, lag: float) -> FloatArray:
    pole = float(np.exp(-1.0 / max(lag, 0.1)))
    return np.asarray(lfilter([1.0 - pole], [1.0, -pole], wave))
