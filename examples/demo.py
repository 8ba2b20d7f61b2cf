"""The main job, end to end and through files, as a user would do it: ``make demo``.

The paper's level tank is simulated into a CSV; then the commands check, identify and compensate work on it, and the
loop is simulated with and without the inverse that came out.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

import lostmotion as lm
from lostmotion.files import write_columns
from lostmotion.simulate.routine import PAPER_PI

FOLDER = Path("demo-output")
SAMPLES = 6000


def command(*words: str) -> None:
    """Run one command of the package and show it."""
    print(f"\n$ lostmotion {' '.join(words)}", flush=True)
    done = subprocess.run([sys.executable, "-m", "lostmotion", *words], check=False)
    if done.returncode != 0:
        sys.exit(done.returncode)


def main() -> None:
    """Simulate, then go through the files."""
    FOLDER.mkdir(exist_ok=True)
    record, fit, figure = FOLDER / "LIC-101.csv", FOLDER / "LIC-101.json", FOLDER / "LIC-101.png"
    print(f"Simulating {SAMPLES / 10:g} s of the level tank in routine operation (dead zone -1 .. 1, slopes 3).")
    loop = lm.routine_operation(SAMPLES, drift="mild", seed=7)
    columns = {"time_s": loop.time, "SP": loop.reference, "PV": loop.measured, "OP": loop.command}
    write_columns(record, {name: np.round(values, 5) for name, values in columns.items()}, force=True)
    gain = f"{lm.platforms.level_tank().linear.gain:.4f}"
    command("check", str(record))
    command("identify", str(record), "--gain", gain, "--out", str(fit), "--figure", str(figure), "--force")
    command("compensate", str(record), "--fit", str(fit), "--out", str(FOLDER / "LIC-101-compensated.csv"), "--force")
    before_and_after(fit)
    print(f"\nFigure: {figure}")


def before_and_after(fit: Path) -> None:
    """The loop under the paper's load, without and with the identified inverse."""
    found = lm.DeadZone.from_dict(json.loads(fit.read_text(encoding="utf-8"))["model"]["nonlinearity"])
    tank = lm.platforms.level_tank()
    reference = np.repeat([0.0, -1.0, 1.0], [200, 400, 400])
    print("\nSet point 0, -1, +1 %, white noise; mean absolute error of the level:")
    ideal = lm.Hammerstein(lm.Identity(), tank.linear)
    cases = (
        ("valve without fault", ideal, None),
        ("dead zone", tank, None),
        ("dead zone, compensated", tank, lm.DeadZoneCompensator.from_dead_zone(found)),
    )
    for name, plant, block in cases:
        loops = [
            lm.simulate_loop(plant, PAPER_PI, reference, compensator=block, noise=0.03, seed=seed) for seed in range(20)
        ]
        error = np.mean([np.mean(np.abs(loop.reference - loop.output)) for loop in loops])
        print(f"  {name:24} {error:.3f}")


if __name__ == "__main__":
    main()
