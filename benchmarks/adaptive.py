"""Adaptive compensation in simulated loops: growing, wrong and vanishing dead zones, and 200 random loops.

Run: ``.venv/bin/python benchmarks/adaptive.py`` (about 15 minutes on one core); writes docs/adaptive.md.
Options: ``--samples N``, ``--seeds N``, ``--cases N`` for another run, which writes nothing.
Started again, it goes on after the last case that was finished.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import lfilter

import lostmotion as lm
from lostmotion.compensate import AdaptiveCompensator, block_from_model
from lostmotion.simulate import BlockLoop, simulate_adaptive
from pages import kept, publish

ROOT = Path(__file__).resolve().parent.parent
OUTPUT = ROOT / "docs" / "adaptive.md"
TANK = lm.platforms.level_tank().linear
CONTROLLER = lm.PI(0.5, 0.7, low=-50, high=50)
NOISE = 0.03**0.5
DAYS = 30
EVERY = 1000

Half = Callable[[float], float]  # half-width against the share of the month


def zone(half: float) -> lm.DeadZone:
    return lm.DeadZone(-half, half, 3.0, 3.0)


def signals(n: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Routine operation: set point moves every 30 s, mild drift, noise."""
    rng = np.random.default_rng(seed)
    reference = np.repeat(rng.choice([-1.0, 0.0, 1.0], n // 300 + 1), 300)[:n]
    drift = lfilter([1.0], [1.0, -0.99], rng.normal(scale=0.3 * np.sqrt(1 - 0.99**2), size=n))
    return reference, drift, rng.normal(scale=NOISE, size=n)


def block_for(half: float) -> lm.CompensatorBlock:
    return block_from_model(zone(half), 0.1, span=(-50, 50), op_noise=0.5 * NOISE, process_time=1.4)


def followed(half: Half, given: Any, known: bool) -> np.ndarray:
    """Absolute control errors with the block set to the true dead zone, or without (slopes only)."""
    reference, drift, noise = given
    n = reference.size
    plant = lm.Hammerstein(zone(half(0.0)), TANK)
    loop = BlockLoop(plant, CONTROLLER, reference, drift, noise, block_for(half(0.0)))
    while loop.done < n:
        now = half(loop.done / n)
        loop.set_valve(zone(now))
        block = block_for(now)
        loop.set_block(block if known else block.with_settings(factor=0.0))
        loop.advance(EVERY)
    return np.abs(reference - loop.signals[3])


def adapted(half: Half, given: Any, start: float) -> tuple[np.ndarray, AdaptiveCompensator, Any]:
    reference, drift, noise = given
    n = reference.size
    estimator = lm.RecursiveML(3, 2, 3, gain=TANK.gain, forgetting=0.9998, dt=0.1, offset="zero")
    adaptive = AdaptiveCompensator(block_for(start), estimator, every=EVERY)
    plant = lm.Hammerstein(zone(half(0.0)), TANK)
    loop, history = simulate_adaptive(plant, CONTROLLER, reference, adaptive, lambda k: zone(half(k / n)), drift, noise)
    return np.abs(reference - loop.measured), adaptive, history


CASES: dict[str, tuple[Half, float]] = {
    "width 1 growing to 3": (lambda t: 0.5 + t, 0.5),
    "half-width 1 growing to 3": (lambda t: 1.0 + 2.0 * t, 1.0),
    "width 2 for ever, block starts at 4 (wrong)": (lambda _: 1.0, 2.0),
    "width 2 for ever, block starts at 0.4 (wrong)": (lambda _: 1.0, 0.2),
    "width 2 shrinking to 0 at mid-month": (lambda t: max(1.0 - 2.0 * t, 0.0), 1.0),
    "width 2, mended to 0 at once on day 15": (lambda t: 1.0 if t < 0.5 else 0.0, 1.0),
    "width 1, 3 from one moment to the next on day 15": (lambda t: 0.5 if t < 0.5 else 1.5, 0.5),
}


def month_row(name: str, n: int, seeds: int) -> tuple[str, float]:
    half, start = CASES[name]
    ratios, bare, falls, refused = [], [], 0, 0
    for seed in range(seeds):
        given = signals(n, seed)
        known = daily(followed(half, given, known=True))
        errors, adaptive, _ = adapted(half, given, start)
        ratios.append(daily(errors) / known)
        bare.append(daily(followed(half, given, known=False)) / known)
        falls, refused = falls + adaptive.falls, refused + adaptive.refused
    days, none = np.array(ratios), np.array(bare)
    later = days[:, 1:]
    cells = [
        name, f"{days[:, 0].mean():.3f}", f"{later.mean():.3f}", f"{later.max():.3f}",
        f"{none[:, 1:].mean():.3f}", str(falls),
    ]  # fmt: skip
    print(" | ".join(cells), flush=True)
    return "| " + " | ".join(cells) + " |", float(later.max())


def daily(errors: np.ndarray) -> np.ndarray:
    day = errors.size // DAYS
    return errors[: DAYS * day].reshape(DAYS, day).mean(axis=1)


def random_case(seed: int, n: int = 20_000) -> tuple[float, float, int, str]:
    """Ratios of adaptive to no compensation: IAE and largest error of the second half; falls; kind of change."""
    rng = np.random.default_rng([7, seed])
    dt, slow, fast = 1.0, 10 ** rng.uniform(0.7, 1.5), 10 ** rng.uniform(0.0, 0.7)
    dead, gain = rng.integers(0, 6), 10 ** rng.uniform(-0.3, 0.5)
    den = np.polymul([slow, 1.0], [fast, 1.0]) if rng.random() < 0.5 else [slow, 1.0]
    process = lm.LinearModel.from_continuous([gain], den, float(dead), dt)
    closed = rng.uniform(0.7, 2.5) * (dead + 1.0 + (fast if len(den) == 3 else 0.0))
    kp = slow / (gain * (closed + dead + 1.0))
    pi = lm.PI(kp, kp / min(slow, 4.0 * (closed + dead + 1.0)), low=-60, high=60)
    sp = np.repeat(rng.choice([-1.0, 0.0, 1.0], n // 200 + 1), 200)[:n] * gain
    noise = rng.normal(scale=rng.uniform(0.01, 0.08) * gain, size=n)
    drift = lfilter([1.0], [1.0, -0.99], rng.normal(scale=rng.uniform(0, 0.3) * gain * np.sqrt(1 - 0.99**2), size=n))
    half, kind = rng.uniform(0.2, 1.5), str(rng.choice(["grows", "vanishes", "jumps", "stays"]))
    now = {
        "grows": lambda t: half * (1 + 2 * t), "vanishes": lambda t: half * max(1 - 1.5 * t, 0.0),
        "jumps": lambda t: half if t < 0.4 else 2.5 * half, "stays": lambda _: half,
    }[kind]  # fmt: skip
    valve = lambda t: lm.DeadZone(-now(t), now(t))  # noqa: E731
    begin = half * rng.uniform(0.2, 2.5)
    made = {"op_noise": abs(kp) * float(noise.std()), "process_time": dead + 1.0 + slow}
    block = block_from_model(lm.DeadZone(-begin, begin), dt, span=(-60, 60), **made)
    order = len(den) - 1
    estimator = lm.RecursiveML(order, order - 1, process.delay, forgetting=0.9995, dt=dt, offset="zero")
    adaptive = AdaptiveCompensator(block, estimator, every=500)
    plant = lm.Hammerstein(valve(0.0), process)
    loop, _ = simulate_adaptive(plant, pi, sp, adaptive, lambda k: valve(k / n), drift, noise)
    bare = BlockLoop(plant, pi, sp, drift, noise, block)
    while bare.done < n:
        bare.set_valve(valve(bare.done / n))
        bare.set_block(block.with_settings(factor=0.0))
        bare.advance(500)
    late = slice(n // 2, None)
    ours, theirs = (np.abs(loop_sp - y)[late] for loop_sp, y in ((sp, loop.measured), (sp, bare.signals[3])))
    return float(ours.mean() / theirs.mean()), float(ours.max() / theirs.max()), adaptive.falls, kind


def grown(seed: int, start: float) -> tuple[float, float, float, int]:
    """Half-width 0.5 growing to 1.5 in 150,000 samples: largest error at the end, of estimate and block; z; events."""
    n = 150_000
    reference, drift, noise = signals(n, seed)
    rml = lm.RecursiveML(3, 2, 3, gain=TANK.gain, forgetting=0.9998, dt=0.1, offset="zero")
    adaptive = AdaptiveCompensator(block_for(start), rml, every=EVERY)
    plant = lm.Hammerstein(zone(0.5), TANK)
    _, history = simulate_adaptive(plant, CONTROLLER, reference, adaptive, lambda k: zone(0.5 + k / n), drift, noise)
    estimate, truth = rml.estimate, {"left": -1.5, "right": 1.5}
    off = {name: abs(estimate.parameters[name] - true) for name, true in truth.items()}
    z = max(off[name] / estimate.standard_errors[name] for name in truth)
    block = max(abs(history.left[-1] + 1.5), abs(history.right[-1] - 1.5))
    return max(off.values()), block, z, len(rml.events)


def grown_rows(seeds: int) -> str:
    """Lines of the table of growing dead zones."""
    lines = []
    for start in (0.5, 1.5):
        found = np.array([grown(seed, start) for seed in range(seeds)])
        off, block, z, events = found.T
        cells = [
            f"{start}", f"{np.median(off):.3f}", f"{off.max():.3f}", f"{(off <= 0.1).sum()}/{seeds}", f"{z.max():.1f}",
            f"{block.max():.3f}", f"{events.sum():.0f}",
        ]  # fmt: skip
        lines.append("| " + " | ".join(cells) + " |")
        print(lines[-1], flush=True)
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=300_000)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--grown", type=int, default=20, help="seeds of the growing dead zone")
    given = parser.parse_args()
    size = f"{given.samples} samples {given.seeds} seeds"
    rows = [kept("adaptive", f"{n} {size}", lambda n=n: month_row(n, given.samples, given.seeds)) for n in CASES]
    growing = grown_rows(given.grown)
    found = []
    for seed in range(given.cases):
        found.append(kept("adaptive", f"random {seed}", lambda s=seed: random_case(s)))
        print(seed, *found[-1], flush=True)
    iae = np.array([row[0] for row in found])
    worst = np.array([row[1] for row in found])
    lines = []
    for kind in ("stays", "grows", "jumps", "vanishes"):
        part = np.array([row[3] == kind for row in found])
        if not part.any():
            continue
        falls = sum(row[2] for row in found if row[3] == kind)
        lines.append(
            f"| {kind} | {part.sum()} | {np.median(iae[part]):.2f} | {iae[part].max():.2f} | "
            f"{np.median(worst[part]):.2f} | {worst[part].max():.2f} | {falls} |"
        )
    template = (Path(__file__).parent / "adaptive.md").read_text(encoding="utf-8")
    parts = {
        "GROWN": growing, "GROWN_SEEDS": str(given.grown),
        "MONTH": "\n".join(row for row, _ in rows), "RANDOM": "\n".join(lines), "SAMPLES": f"{given.samples:,}",
        "SEEDS": str(given.seeds), "CASES": str(given.cases), "WORSE": str(int((iae > 1.1).sum())),
        "WORST": f"{iae.max():.2f}", "PEAK": f"{worst.max():.2f}", "GROWING": f"{100 * (rows[0][1] - 1):.1f} %",
    }  # fmt: skip
    for name, text in parts.items():
        template = template.replace("{" + name + "}", text)
    if given == parser.parse_args([]):
        publish(OUTPUT, template)


if __name__ == "__main__":
    main()
