"""Loops by differential equations, with nothing of the package in them: friction acts on a mass, the process is curved.

Stiction: air on a diaphragm moves a stem of some mass against a spring, with static and Coulomb friction and Stribeck's
fall between them (Karnopp's rule for the rest). Backlash: a stem without friction drives the plug through a gap with a
damped plug that stays where it was left. Behind it an equal-percentage valve and a tank with an outlet by the root of
its level, or two lags with a gain that depends on the place; a PID with filtered derivative, clamped;
transmitter with a lag, coloured noise and 12 to 16 bits. Integrated at a fiftieth of the sampling time.
"""

from __future__ import annotations

import numpy as np

from lostmotion.evaluate.random_faults import FaultyLoop
from lostmotion.models import Backlash, Stiction

ROWS, SETTLED = 2000, 400
FINE = 50  # steps of the stem in a sample: its mass moves in a tenth of a second
REST = 50.0  # %


class Stem:
    """Mass, spring and friction; position in % of travel, force in % of the signal that balances it."""

    def __init__(self, rng: np.random.Generator, band: float, jump: float, step: float) -> None:
        self.static, self.sliding = 0.5 * (band + jump), 0.5 * (band - jump)
        self.stribeck, self.step = 0.5 * rng.uniform(0.5, 2.0), step
        self.mass, self.damping = rng.uniform(0.01, 0.03), rng.uniform(0.1, 0.3)
        self.place, self.speed = REST, 0.0

    def move(self, command: float) -> float:
        """One step."""
        force = command - self.place
        if self.speed == 0.0 and abs(force) <= self.static:
            return self.place
        way = np.sign(self.speed) or np.sign(force)
        friction = self.sliding + (self.static - self.sliding) * np.exp(-abs(self.speed) / self.stribeck)
        speed = self.speed + self.step * (force - way * friction - self.damping * self.speed) / self.mass
        if speed * way <= 0.0:
            speed = 0.0
        self.speed = speed
        self.place += self.step * speed
        return self.place


class Gap:
    """A plug that is pushed by either flank."""

    def __init__(self, width: float) -> None:
        self.half, self.place = 0.5 * width, REST

    def move(self, command: float) -> float:
        """One step."""
        self.place = min(max(self.place, command - self.half), command + self.half)
        return self.place


def physical_loop(seed: int, kind: str) -> FaultyLoop:
    """Draw a loop of this kind ("backlash" or "stiction")."""
    rng = np.random.default_rng([seed, 5077])
    band = float(np.exp(rng.uniform(np.log(1.0), np.log(8.0))))
    jump = band * rng.uniform(0.2, 0.9)
    lag, turn_down = float(np.exp(rng.uniform(np.log(3.0), np.log(25.0)))), rng.uniform(20.0, 50.0)
    tank, step = bool(rng.random() < 0.4), 1.0 / FINE
    valve = Stem(rng, band, jump, step) if kind == "stiction" else Gap(band)
    flow_at_rest = turn_down ** (0.01 * REST - 1.0)
    slope = 0.01 * np.log(turn_down) * REST * (2.0 if tank else 1.0)  # of PV over the opening, at rest
    pace = rng.uniform(0.8, 2.5) * lag
    kp = (2.0 * lag if tank else lag) / (slope * (pace + 2.0))
    reset, derivative = (2.0 * lag if tank else lag), rng.uniform(0.0, 0.3) * min(lag, 6.0)
    n = ROWS + SETTLED
    sp = REST + _moves(rng, n, band * slope)
    noise = _coloured(rng, n) * band * rng.uniform(0.01, 0.12) / max(kp, 0.3)
    load = _coloured(rng, n, 0.99) * band * slope * rng.uniform(0.01, 0.2)
    grain = 100.0 / 2 ** rng.integers(12, 17)
    op, pv = np.empty(n), np.empty(n)
    level, second, sensor, total, smooth, before, out = REST, REST, REST, REST, REST, REST, REST
    for k in range(n):
        pv[k] = np.round((sensor + noise[k]) / grain) * grain
        slower = smooth + (pv[k] - smooth) / (1.0 + 0.2 * max(derivative, 1.0))
        wanted = kp * (sp[k] - pv[k]) + total - kp * derivative * (slower - smooth)
        smooth, out = slower, float(np.clip(wanted, 0.0, 100.0))
        if out == wanted:
            total += kp / reset * (sp[k] - pv[k])
        op[k] = out
        for _ in range(FINE):
            flow = REST * turn_down ** (0.01 * valve.move(before) - 1.0) / flow_at_rest + load[k]
            if tank:
                level += step * (flow - REST * np.sqrt(max(level, 0.0) / REST)) / lag
            else:
                level += step * (flow - level) / lag
                second += step * (level - second) / (0.15 * lag)
            sensor += step * ((level if tank else second) - sensor) / 0.7
        before = out
    kept = slice(SETTLED, n)
    actuator = Stiction(band, jump) if kind == "stiction" else Backlash(band)
    process = "level" if tank else "temperature"
    return FaultyLoop(kind, process, actuator, band, op[kept], pv[kept], sp[kept], 1.0, float(np.std(noise)) * kp)


def _moves(rng: np.random.Generator, n: int, size: float) -> np.ndarray:
    """Moves of the set point in two loops of three."""
    moves = np.zeros(n)
    if rng.random() < 2.0 / 3.0:
        for row in np.sort(rng.integers(0, n, int(rng.integers(3, 15)))):
            moves[row:] = size * rng.normal()
    return np.clip(moves, -20.0, 20.0)


def _coloured(rng: np.random.Generator, n: int, pole: float | None = None) -> np.ndarray:
    """First-order noise of deviation 1."""
    pole = float(rng.uniform(0.0, 0.7)) if pole is None else pole
    found, grains = np.zeros(n), rng.normal(size=n) * np.sqrt(1.0 - pole**2)
    for k in range(1, n):
        found[k] = pole * found[k - 1] + grains[k]
    return found
