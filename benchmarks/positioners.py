"""Positioners with truth, simulated apart from the package: does the interval of the dead band hold, is the kind right?

Finer in time than the record, with the controller, the process and the actuator of its own: nothing of the package is
used but ``lm.actuator_response``.

    python benchmarks/positioners.py 200
"""

from __future__ import annotations

import math
import sys
import time
from dataclasses import dataclass

import numpy as np

import lostmotion as lm


@dataclass(frozen=True)
class Positioner:
    """One case: what it is, and its record."""

    kind: str
    band: float
    lag: float
    rate: float
    noise: float
    step: float
    closed: bool
    source: str
    order: str
    dt: float
    op: np.ndarray
    position: np.ndarray


def _open_loop(rng: np.random.Generator, source: str, seconds: float, fine: float, dt: float) -> np.ndarray:
    n = round(seconds / fine)
    t = fine * np.arange(n)
    if source == "sine":
        period = rng.uniform(0.05, 0.25) * seconds
        return 50.0 + rng.uniform(4.0, 20.0) * np.sin(2 * np.pi * t / period)
    if source == "ramp":
        period = rng.uniform(0.08, 0.3) * seconds
        return 50.0 + rng.uniform(4.0, 20.0) * (2 * np.abs(2 * ((t / period) % 1.0) - 1.0) - 1.0)
    hold = rng.uniform(4.0, 15.0) * dt
    steps = int(seconds / hold) + 1
    size = rng.uniform(0.3, 2.0)
    if rng.random() < 0.5:  # up and down a staircase
        length = rng.integers(6, 20)
        level = np.abs((np.arange(steps) % (2 * length)) - length) * size
    else:
        level = np.clip(np.cumsum(rng.choice([-1, 1], steps) * rng.uniform(0.2, 2.0, steps) * size), -30, 30)
    return 50.0 + level[np.minimum((t / hold).astype(int), steps - 1)]


def positioner(seed: int) -> Positioner:  # noqa: PLR0915  one place for all that is drawn
    """Case of this number."""
    rng = np.random.default_rng(seed)
    dt = float(np.exp(rng.uniform(np.log(0.1), np.log(10.0))))
    n = int(rng.integers(400, 2500))
    per = max(4, math.ceil(dt / 0.25))
    fine = dt / per
    kind = str(rng.choice(["none", "backlash", "stiction"], p=[0.25, 0.375, 0.375]))
    band = 0.0 if kind == "none" else float(np.exp(rng.uniform(np.log(0.2), np.log(5.0))))
    lag = 0.0 if rng.random() < 0.25 else float(rng.uniform(0.1, 5.0))
    rate = math.inf if rng.random() < 0.4 else float(np.exp(rng.uniform(np.log(1.0), np.log(30.0))))
    noise = 0.0 if rng.random() < 0.3 else float(np.exp(rng.uniform(np.log(0.01), np.log(0.2))))
    step = float(rng.choice([0.0, 0.01, 0.025, 0.1]))
    catch = float(rng.uniform(0.0, 0.3))  # of the half band, left behind by one that catches up
    order = str(rng.choice(["lag first", "lag last"], p=[0.7, 0.3]))
    closed = bool(seed % 2)
    offset = float(rng.normal(0, 0.3))
    source = "PI" if closed else str(rng.choice(["staircase", "sine", "ramp"]))
    total = n * per
    planned = None if closed else _open_loop(rng, source, n * dt, fine, dt)
    tau, gain = float(rng.uniform(3, 20)) * dt, float(rng.uniform(0.5, 2.0))
    kp = float(rng.uniform(0.3, 1.2)) / gain
    ki = kp / tau
    shocks = rng.normal(size=n) * rng.uniform(0.1, 1.0)
    pole = math.exp(-1.0 / rng.uniform(5, 100))
    pv_noise = rng.uniform(0.0, 0.2)
    set_points = 50.0 + np.repeat(rng.normal(0, rng.uniform(0.5, 5.0), n // 50 + 1), 50)[:n]
    v = x = y = 50.0
    integral, pv, load, u = 50.0, 50.0 * gain, 0.0, 50.0
    op, pos = np.empty(n), np.empty(n)
    half = 0.5 * band
    for i in range(total):
        k, part = divmod(i, per)
        if part == 0:
            if closed:
                load = pole * load + math.sqrt(1 - pole**2) * shocks[k] * 3.0
                error = gain * set_points[k] - (pv + load + rng.normal() * pv_noise)
                integral += ki * dt * error
                u = min(max(kp * error + integral, 0.0), 100.0)
            else:
                u = planned[i]
            op[k] = u
            measured = y + offset + rng.normal() * noise
            pos[k] = step * round(measured / step) if step else measured
        elif not closed:
            u = planned[i]
        lagged_first = order == "lag first"
        v = v + (u - v) * (1 - math.exp(-fine / lag)) if lag and lagged_first else u
        if kind == "backlash":
            x = min(max(x, v - half), v + half)
        elif kind == "stiction":
            if abs(v - x) > half:
                x = v - math.copysign(catch * half, v - x)
        else:
            x = v
        to = y + (x - y) * (1 - math.exp(-fine / lag)) if lag and not lagged_first else x
        y += min(max(to - y, -rate * fine), rate * fine)
        pv += (gain * y - pv) * fine / tau
    return Positioner(kind, band, lag, rate, noise, step, closed, source, order, dt, op, pos)


def main(count: int = 200, first: int = 0) -> None:
    """Print the score of the cases first to first + count."""
    rows, began = [], time.perf_counter()
    for seed in range(first, first + count):
        case = positioner(seed)
        found = lm.actuator_response(op=case.op, position=case.position, dt=case.dt)
        low, high = found.interval
        inside = low <= case.band <= high
        named = found.kind != "cannot tell"
        right = found.kind == case.kind
        rows.append((named, right, inside))
        mark = ("" if inside else " OUTSIDE") + ("" if right or not named else " WRONG") + ("" if named else " open")
        print(
            f"{seed:4d} {case.source:9s} {case.kind:9s} {case.band:6.3f} dt {case.dt:5.2f} n {len(case.op):4d} "
            f"T {case.lag:4.1f} {case.order[4:]:5s} R {case.rate:5.1f} s {case.noise:5.3f} q {case.step:5.3f} "
            f"range {np.ptp(case.op):5.1f} -> {found.kind:11s} {found.dead_band:6.3f} ({low:.3f}..{high:.3f}) "
            f"lag {found.lag:.1f} R {found.rate_limit:.1f}{mark}",
            flush=True,
        )
    table = np.array(rows)
    named = table[:, 0]
    print(
        f"{count} cases: interval holds {100 * table[:, 2].mean():.1f} % (of the named "
        f"{100 * table[named, 2].mean():.1f} %), named {100 * named.mean():.1f} %, kind right in "
        f"{100 * table[named, 1].mean():.1f} % of these; {(time.perf_counter() - began) / count:.2f} s a case"
    )


if __name__ == "__main__":
    main(*(int(one) for one in sys.argv[1:]))
