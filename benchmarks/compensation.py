"""What the compensating blocks reach in simulated loops.

Run: ``.venv/bin/python benchmarks/compensation.py`` (about 2 minutes on one core); writes docs/compensation.md.
Option: ``--seeds N`` for a shorter run, which writes nothing.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np

import lostmotion as lm
from lostmotion.compensate import DeadZoneCompensator, block_from_model
from lostmotion.paper.control import CONTROLLER, DT, NOISE_VARIANCE, disturbance, reference
from lostmotion.records.movement import reversals, travel
from pages import publish

ROOT = Path(__file__).resolve().parent.parent
OUTPUT = ROOT / "docs" / "compensation.md"
TANK = lm.platforms.level_tank()
ZONE = TANK.nonlinearity
SPAN = (-200.0, 200.0)
NOISE = CONTROLLER.kp * NOISE_VARIANCE**0.5  # of OP
BEYOND = 3.0 * NOISE
PROCESS = 0.3 + 1.0 / 0.9  # dead time and slowest time constant in seconds
KNOWN = {"span": SPAN, "op_noise": NOISE, "process_time": PROCESS}

VARIANTS: dict[str, dict[str, Any]] = {
    "jump, in the block": {"shape": 0.0},
    **{f"smooth, +-{m} deviations": {"shape": 1.0, "zone": m * NOISE} for m in (1, 2, 3, 6)},
    **{f"hold, {m} deviations": {"shape": 2.0, "zone": m * NOISE} for m in (1, 2, 3, 6)},
    **{f"jump, quiet +-{m}": {"shape": 0.0, "quiet": m * NOISE} for m in (0.5, 1, 2)},
    **{f"hold 3, quiet +-{m}": {"shape": 2.0, "zone": 3 * NOISE, "quiet": m * NOISE} for m in (0.5, 1, 2)},
}


def respond(plant: lm.Hammerstein, block: Any, noise: Any) -> lm.LoopResponse:
    load, path = disturbance()
    return lm.simulate_loop(plant, CONTROLLER, reference(), DT, block, load, noise, disturbance_path=path)


def indices(loop: lm.LoopResponse) -> list[float]:
    counts = [float(reversals(loop.command, band)) for band in (0.0, BEYOND, 1.0)]
    return [float(np.mean(np.abs(loop.reference - loop.measured))), *counts, travel(loop.command)]


def tank_table(seeds: int) -> tuple[str, dict[str, np.ndarray]]:
    """Every variant over the same noise."""
    linear = lm.Hammerstein(lm.Identity(), TANK.linear)
    blocks = {name: block_from_model(ZONE, DT, **KNOWN, **own) for name, own in VARIANTS.items()}
    rows: dict[str, list[list[float]]] = {}
    for seed in range(seeds):
        noise = np.random.default_rng(seed).normal(scale=NOISE_VARIANCE**0.5, size=reference().size)
        rows.setdefault("no dead zone", []).append(indices(respond(linear, None, noise)))
        rows.setdefault("dead zone, no compensation", []).append(indices(respond(TANK, None, noise)))
        rows.setdefault("plain inverse", []).append(indices(respond(TANK, DeadZoneCompensator(ZONE), noise)))
        for name, block in blocks.items():
            rows.setdefault(name, []).append(indices(respond(TANK, block, noise)))
    mean = {name: np.mean(values, axis=0) for name, values in rows.items()}
    ideal, plain = mean["no dead zone"], mean["plain inverse"]
    lines = []
    for name, row in mean.items():
        shown = f"**{name}** (default)" if name == "hold, 3 deviations" else name
        lines.append(
            f"| {shown} | {row[0]:.4f} | {row[0] / ideal[0]:.3f} | {row[1]:.0f} | {row[2]:.1f} | "
            f"{row[2] / plain[2]:.3f} | {row[3]:.1f} | {row[4]:.0f} |"
        )
    return "\n".join(lines), mean


def wrong_table() -> str:
    """Half the swing of the level in the steady state without noise; its standard deviation with."""
    fit = tank_fit()
    width, error = fit.parameters["width"], fit.standard_errors["width"]
    lines = []
    cases = {f"-2 standard errors ({-200 * error / width:+.1f} %)": 1 - 2 * error / width, "exact": 1.0}
    cases |= {f"+2 standard errors ({200 * error / width:+.1f} %)": 1 + 2 * error / width}
    cases |= {f"{100 * share:+.0f} %": 1 + share for share in (-0.5, -0.2, -0.1, 0.1, 0.2, 0.5)}
    for name, factor in {"no compensation": None, **dict(sorted(cases.items(), key=lambda pair: pair[1]))}.items():
        cells = [name]
        for variance in (0.0, NOISE_VARIANCE):
            for own in ({"shape": 0.0, "hunt_scans": 0.0}, {"hunt_scans": 0.0}, {}):
                block = None if factor is None else block_from_model(ZONE, DT, factor=factor, **KNOWN, **own)
                cells.append(swing(block, variance))
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def errors_table(seeds: int) -> str:
    """IAE of the control experiment with a wrong factor, without and with the guard."""
    lines = []
    linear, sums = lm.Hammerstein(lm.Identity(), TANK.linear), {}
    factors = (0.5, 0.8, 0.9, 0.98, 1.0, 1.02, 1.1, 1.2, 1.5)
    for seed in range(seeds):
        noise = np.random.default_rng(seed).normal(scale=NOISE_VARIANCE**0.5, size=reference().size)
        cases: dict[Any, Any] = {"ideal": (linear, None)}
        for factor in factors:
            for name, own in (("free", {"hunt_scans": 0.0}), ("guard", {})):
                cases[factor, name] = TANK, block_from_model(ZONE, DT, factor=factor, **KNOWN, **own)
        for key, (plant, block) in cases.items():
            sums[key] = sums.get(key, 0.0) + indices(respond(plant, block, noise))[0]
    for factor in factors:
        cells = [f"{100 * (factor - 1):+.0f} %", *(f"{sums[factor, n] / sums['ideal']:.3f}" for n in ("free", "guard"))]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def tank_fit() -> lm.HammersteinFit:
    u = lm.signals.prs(2000, -5, 5, hold=10, seed=1)
    y = TANK.simulate(u) + np.random.default_rng(1).normal(scale=NOISE_VARIANCE**0.5, size=2000)
    return lm.identify(u, y, dt=DT, orders=(3, 2, 3), gain=TANK.linear.gain, nonlinearity="dead zone")


def swing(block: Any, variance: float) -> str:
    r = np.repeat([0.0, 1.0, 0.2], [200, 800, 2000])
    runs = [lm.simulate_loop(TANK, CONTROLLER, r, DT, block, noise=variance, seed=seed) for seed in range(8)]
    if variance == 0.0:
        return f"{0.5 * np.ptp(runs[0].output[-1500:]):.3f}"
    return f"{np.mean([np.std(loop.output[-1500:]) for loop in runs]):.3f}"


BACKLASH_LOOPS = {
    "lag 10 s, dead time 2 s": (lm.LinearModel.from_continuous([1.0], [10.0, 1.0], 2.0, 0.1), lm.PI(2.0, 0.5)),
    "level": (lm.LinearModel.from_continuous([0.05], [1.0, 0.0], 0.5, 0.1), lm.PI(3.0, 0.15)),
    "level behind a lag of 1 s": (lm.LinearModel.from_continuous([0.05], [1.0, 1.0, 0.0], 0.2, 0.1), lm.PI(4.0, 0.2)),
}


def backlash_table() -> str:
    gear = lm.Backlash(2.0)
    lines = []
    for name, (process, pi) in BACKLASH_LOOPS.items():
        for deviation in (0.0, 0.02, 0.05):
            cells = [name, f"{deviation}"]
            options = {"noise": deviation**2, "seed": 1, "allow_unstable": True}
            blocks: dict[str, Any] = {"none": None, "plain": lm.BacklashCompensator(gear)}
            for factor in (1.0, 0.8, 1.2):
                made = block_from_model(gear, 0.1, span=(-50, 50), op_noise=pi.kp * deviation, factor=factor)
                blocks[f"{factor}"] = made
            base = 0.0
            for key, block in blocks.items():
                loop = lm.simulate_loop(lm.Hammerstein(gear, process), pi, np.ones(6000), 0.1, block, **options)
                size = 0.5 * float(np.ptp(loop.output[3000:]))
                base = size if key == "none" else base
                turns = reversals(loop.command[3000:], 1.0)
                cells.append(f"{size:.3f} ({turns})" if key == "none" else f"{size / base:.2f} ({turns})")
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


STICTION_LOOPS = {
    "lag 20 s, dead time 3 s": (lm.LinearModel.from_continuous([1.0], [20.0, 1.0], 3.0, 1.0), lm.PI(1.5, 0.075)),
    "level, dead time 2 s": (lm.LinearModel.from_continuous([0.05], [1.0, 0.0], 2.0, 1.0), lm.PI(2.0, 0.05)),
}


def stiction_table() -> str:
    lines = []
    for name, (process, pi) in STICTION_LOOPS.items():
        for band, jump, model in ((2.0, 2.0, "kano"), (2.0, 2.0, "he"), (3.0, 1.0, "kano")):
            valve = lm.Stiction(band, jump, model)
            cells = [name, f"S {band:g}, J {jump:g}, {model}"]
            for method in (None, "knocker", "two moves"):
                block = None
                if method is not None:
                    block = block_from_model(valve, 1.0, span=(-50, 50), op_noise=0.05 * pi.kp, method=method)
                plant = lm.Hammerstein(valve, process)
                loop = lm.simulate_loop(plant, pi, np.ones(4000), 1.0, block, noise=0.0025, seed=1, allow_unstable=True)
                error = float(np.mean(np.abs(loop.output - 1.0)[2000:]))
                cells.append(f"{error:.3f} ({travel(loop.command[2000:]):.0f})")
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=200)
    given = parser.parse_args()
    table, mean = tank_table(given.seeds)
    ideal, plain, chosen = (mean[name] for name in ("no dead zone", "plain inverse", "hold, 3 deviations"))
    template = (Path(__file__).parent / "compensation.md").read_text(encoding="utf-8")
    parts = {
        "SEEDS": str(given.seeds), "TANK": table, "WRONG": wrong_table(), "ERRORS": errors_table(given.seeds // 4),
        "BACKLASH": backlash_table(),
        "STICTION": stiction_table(), "BEYOND": f"{BEYOND:.2f}", "NOISE": f"{NOISE:.3f}",
        "IAE": f"{100 * (chosen[0] / ideal[0] - 1):.1f} %", "PLAIN": f"{100 * (chosen[0] / plain[0] - 1):.1f} %",
        "TURNS": f"{chosen[2] / plain[2]:.2f}", "TRAVEL": f"{chosen[4] / plain[4]:.2f}",
        "RAW": f"{chosen[1] / plain[1]:.2f}",
    }  # fmt: skip
    for name, text in parts.items():
        template = template.replace("{" + name + "}", text)
    print(table)
    if given.seeds == parser.get_default("seeds"):
        publish(OUTPUT, template)


if __name__ == "__main__":
    main()
