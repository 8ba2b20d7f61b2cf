"""Does a valve that never moves seem to answer, and does a sound one? Printed, by lags and acts of a controller a row.

Run: ``.venv/bin/python benchmarks/answered.py`` (about 2 minutes).
"""

from __future__ import annotations

import argparse

import numpy as np
from scipy.signal import lfilter

import lostmotion as lm
from lostmotion.arrays import FloatArray
from lostmotion.identify import answered

SCANS = (1, 2, 4, 20)
LAGS = (0, 2, 4, 8)


def standing_still(seed: int) -> tuple[int, FloatArray, FloatArray]:
    """Acts a row, OP and PV of a loop whose OP reaches nothing: load of four forms, PID, filter, steps."""
    rng = np.random.default_rng([seed, 17])
    scans, rows = SCANS[seed % len(SCANS)], int(rng.choice([500, 1000, 2000]))
    n = (rows + 200) * scans
    pv = load_of(rng, n, scans) + rng.choice([0.0, 0.02, 0.1, 0.5]) * rng.normal(size=n)
    if rng.random() < 0.3:
        pole = np.exp(-1.0 / (rng.uniform(0.5, 4.0) * scans))
        pv = lfilter([1.0 - pole], [1.0, -pole], pv)
    if rng.random() < 0.3:
        pv = np.round(pv / 0.05) * 0.05
    gain, reset = np.exp(rng.uniform(np.log([0.1, 3.0]), np.log([3.0, 200.0])))
    rate = rng.choice([0.0, 0.0, 2.0]) * scans
    op = -gain * (pv + np.cumsum(pv) / (reset * scans) + rate * np.diff(pv, prepend=pv[0]))
    if rng.random() < 0.3:
        op = np.round(op / (0.01 * op.std())) * 0.01 * op.std()
    kept = slice(200 * scans + scans - 1, None, scans)
    return scans, op[kept], pv[kept]


def load_of(rng: np.random.Generator, n: int, scans: int) -> FloatArray:
    """A lag, a resonance, a walk or two lags, of deviation 1."""
    slow = float(np.exp(rng.uniform(np.log(2.0), np.log(200.0)))) * scans
    pole, second = np.exp(-1.0 / slow), np.exp(-3.0 / slow)
    damp = 0.98 ** (1.0 / scans)
    ways = (
        [1.0, -pole], [1.0, -2.0 * damp * np.cos(2.0 * np.pi / (3.0 * slow)), damp**2], [1.0, -1.0],
        np.polymul([1.0, -pole], [1.0, -second]),
    )  # fmt: skip
    load = lfilter([1.0], ways[int(rng.integers(len(ways)))], rng.normal(size=n))
    return np.asarray(load / load.std())


def sound(seed: int, moves: float) -> bool:
    """Whether a valve without a fault is seen to answer, SP moving by so many deviations of the load."""
    rng = np.random.default_rng([seed, 18])
    lag = float(rng.uniform(3.0, 40.0))
    process = lm.LinearModel.from_continuous([1.0], [lag, 1.0], float(rng.uniform(0.0, 3.0)), 1.0)
    sp = moves * np.repeat(rng.normal(size=20), 100)
    loop = lm.simulate_loop(
        lm.Hammerstein(lm.Identity(), process), lm.PI(0.5, 0.5 / lag), sp, disturbance=load_of(rng, 2000, 1),
        noise=0.1 * rng.normal(size=2000),
    )  # fmt: skip
    return answered.pv_answers(loop.control, loop.measured, np.array([[0, 2000]]), loop.reference)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--loops", type=int, default=600)
    given = parser.parse_args()
    seems: dict[tuple[int, int], list[bool]] = {}
    for seed in range(given.loops):
        scans, op, pv = standing_still(seed)
        spans = [(0, op.size)]
        u, y = ((x - x.mean()) / x.std() for x in (op, pv))
        news = answered._news(u, y, spans, answered.OF_CONTROLLER)
        for own in LAGS:
            seems.setdefault((scans, own), []).append(answered._chance(news, y, spans, own) < answered.LEVEL)
    print("| acts a row | loops | " + " | ".join(f"beyond lag {own}" for own in LAGS) + " |")
    print("|" + "---|" * (2 + len(LAGS)))
    for scans in SCANS:
        shares = " | ".join(f"{100.0 * np.mean(seems[scans, own]):.0f} %" for own in LAGS)
        print(f"| {scans} | {len(seems[scans, 0])} | {shares} |")
    for moves in (1.0, 2.0, 4.0):
        hits = [sound(seed, moves) for seed in range(given.loops // 6)]
        print(f"Sound, SP moves by {moves:g} deviations of the load: {sum(hits)} of {len(hits)} answered.")


if __name__ == "__main__":
    main()
