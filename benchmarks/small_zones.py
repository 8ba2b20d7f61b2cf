"""Do the intervals hold where OP is quantised so that only a few of its levels lie inside the dead zone?

Run: ``.venv/bin/python benchmarks/small_zones.py`` (about five minutes); prints a table.
Options: ``--seeds N``.
"""

from __future__ import annotations

import argparse

import numpy as np

import lostmotion as lm

STEP = 0.5  # of OP, whose range is 20 steps
SAMPLES = 2000
TANK = lm.platforms.level_tank()
LEVELS = (1, 2, 3, 6)


def record(levels: int, seed: int) -> tuple[np.ndarray, np.ndarray, lm.DeadZone]:
    """Quantised OP, and PV behind a dead zone that lies anywhere and holds so many levels of OP."""
    random = np.random.default_rng(seed)
    u = np.round(lm.signals.prs(SAMPLES, -5, 5, hold=10, seed=seed) / STEP) * STEP
    first = STEP * random.integers(-4, 3)
    left = first - STEP * random.uniform(0.02, 0.98)
    right = first + STEP * (levels - 1 + random.uniform(0.02, 0.98))
    zone = lm.DeadZone(left, right, 3.0, 3.0)
    y = lm.Hammerstein(zone, TANK.linear).simulate(u) + random.normal(scale=0.03**0.5, size=SAMPLES)
    return u, y, zone


def row(levels: int, seeds: int) -> str:
    """Coverage of both break points and of the width, statuses that can be used."""
    held, usable, widths = [], 0, []
    for seed in range(seeds):
        u, y, zone = record(levels, seed)
        fit = lm.identify(u, y, 0.1, orders=(3, 2, 3), nonlinearity="dead zone")
        if not fit.status.ok:
            continue
        usable += 1
        true = {"left": zone.left, "right": zone.right, "width": zone.width}
        ends = {name: fit.interval(name) for name in true}
        held.append([ends[name][0] <= true[name] <= ends[name][1] for name in true])
        widths.append(ends["width"][1] - ends["width"][0])
    cover = " / ".join(f"{100 * share:.0f}" for share in np.mean(held, axis=0)) if held else "-"
    return f"| {levels} | {usable}/{seeds} | {cover} | {np.median(widths) / STEP if widths else np.nan:.2f} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=200)
    arguments = parser.parse_args()
    print("| levels of OP inside | usable | coverage of left / right / width, % | interval of the width, steps of OP |")
    print("|---|---|---|---|")
    for levels in LEVELS:
        print(row(levels, arguments.seeds), flush=True)


if __name__ == "__main__":
    main()
