"""RecursiveML where an assumption does not hold: what it says then, beside the same record where it does."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.signal import lfilter

import lostmotion as lm
from suite.experiment import DT, GAIN, ORDERS, TANK, VARIANCE, Array, record

SAMPLES = 20_000
GLITCH, CODE = slice(7_000, 7_005), 1e29  # five rows of a code for a failure
Case = Callable[[int], tuple[Array, Array]]


def glitch(op: bool, pv: bool) -> Case:
    def made(seed: int) -> tuple[Array, Array]:
        u, y = (signal.copy() for signal in record(SAMPLES, seed))
        for signal, hit in ((u, op), (y, pv)):
            signal[GLITCH] = CODE if hit else signal[GLITCH]
        return u, y

    return made


def rounded(step: float) -> Case:
    """OP is rounded in the record; the valve gets what it was."""

    def made(seed: int) -> tuple[Array, Array]:
        u, y = record(SAMPLES, seed)
        return np.round(u / step) * step, y

    return made


def coloured(seed: int) -> tuple[Array, Array]:
    """Noise of order 2 with poles 0.9 and 0.5, of the variance of the white one."""
    u = record(SAMPLES, seed)[0]
    noise = lfilter([1.0], [1.0, -1.4, 0.45], np.random.default_rng(seed + 10_000).normal(size=SAMPLES))
    return u, TANK.simulate(u) + VARIANCE**0.5 * noise / noise.std()


CASES: dict[str, tuple[Case, dict[str, Any]]] = {
    "nothing": (lambda seed: record(SAMPLES, seed), {}),
    "five PV of 1e29": (glitch(False, True), {}),
    "five OP of 1e29": (glitch(True, False), {}),
    "five of both": (glitch(True, True), {}),
    "OP rounded to 0.5": (rounded(0.5), {}),
    "OP rounded to whole numbers": (rounded(1.0), {}),
    "noise of order 2": (coloured, {}),
    "noise of order 2, told `noise=1`": (coloured, {"noise": 1}),
    'noise of order 2, told `noise="white"`': (coloured, {"noise": "white"}),
}


def row(name: str, seeds: int) -> str:
    """One line: error of the break points, their standard error, coverage, events, statuses."""
    case, options = CASES[name]
    misses, spreads, events, statuses = [], [], [], []
    for seed in range(seeds):
        estimator = lm.RecursiveML(*ORDERS, GAIN, dt=DT, **options)
        u, y = case(seed)
        estimator.run(u, y, every=u.size)
        estimate = estimator.estimate
        misses += [estimate.parameters["left"] + 1.0, estimate.parameters["right"] - 1.0]
        spreads += [estimate.standard_errors["left"], estimate.standard_errors["right"]]
        events.append(len(estimator.events))
        statuses.append(estimate.status.name)
    off, spread = np.abs(misses), np.array(spreads)
    said = ", ".join(f"{word} {statuses.count(word)}" for word in sorted(set(statuses)))
    cells = [
        name, f"{np.median(off):.4f}", f"{off.max():.4f}", f"{np.median(spread):.4f}",
        f"{100 * np.mean(off < 1.96 * spread):.0f}", f"{sum(events)}", said,
    ]  # fmt: skip
    return "| " + " | ".join(cells) + " |"


def rows(seeds: int) -> str:
    """All lines."""
    lines = []
    for name in CASES:
        lines.append(row(name, seeds))
        print(lines[-1], flush=True)
    return "\n".join(lines)
