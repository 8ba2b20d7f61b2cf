"""The sample loops of ``lostmotion.datasets``: simulated here, written as a DCS exports them, with their truth.

Run: ``.venv/bin/python benchmarks/sample_loops.py``; writes src/lostmotion/datasets/*.csv.gz and truth.json.
"""

from __future__ import annotations

import gzip
import json
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np

import lostmotion as lm
from lostmotion.evaluate.random_faults import near_the_limit

FOLDER = Path(__file__).resolve().parent.parent / "src" / "lostmotion" / "datasets"
ROWS, BEFORE = 2000, 500  # written, and simulated before the record begins: the loop has forgotten how it started
START = datetime(2026, 3, 2, 6)


@dataclass(frozen=True)
class Loop:
    """A loop: actuator in % of OP around `op`, process, tuning, what moves it, and what is written of it.

    Attributes
    ----------
    verdict, size : str and float
        Of the diagnosis that is right, and the size of the lost motion in % of OP; 0: none.
    gain, lag, dead_time : float
        Units of PV per % of OP, and seconds; an infinite lag: the process integrates, and the gain is a second's.
    kp, ti : float
        Controller in % of OP per unit of PV, and seconds.
    moves : tuple of float
        Set points one after the other, in units of PV.
    noise, load : float
        Deviations of the noise in units of PV, and of a slow load in % of OP.
    """

    tag: str
    about: str
    verdict: str
    actuator: Any
    size: float
    unit: str
    gain: float
    lag: float
    dead_time: float
    kp: float
    ti: float
    moves: tuple[float, ...]
    op: float
    noise: float
    load: float
    seed: int
    dt: float = 1.0
    digits: int = 2


LOOPS = (
    Loop("FIC-101", "flow, valve that sticks", "stiction", lm.Stiction(3.0, 2.0), 3.0, "m3/h",
         0.8, 4.0, 1.0, 0.35, 5.0, (42.0,), 46.0, 0.05, 0.3, 1),
    Loop("FIC-102", "flow, healthy", "none", lm.Identity(), 0.0, "m3/h",
         1.1, 5.0, 1.0, 0.3, 6.0, (60.0, 64.0, 58.0, 61.0, 66.0, 60.0), 52.0, 0.08, 0.5, 2),
    Loop("TIC-201", "temperature, split range whose heating and cooling valves do not meet", "dead zone",
         lm.DeadZone(-2.5, 2.0), 4.5, "degC", 0.9, 60.0, 12.0, 1.6, 60.0,
         (70.0, 74.0, 66.0, 71.0, 67.0, 72.5), 50.0, 0.04, 4.0, 3, 4.0),
    Loop("LIC-301", "level, worn linkage", "backlash", lm.Backlash(2.4), 2.4, "%",
         0.004, np.inf, 4.0, 3.0, 150.0, (55.0, 58.0, 52.0, 56.0), 44.0, 0.03, 0.5, 4, 2.0),
    Loop("PIC-401", "pressure, valve that moves from 51 to 61 % only", "saturation", lm.Saturation(-4.0, 6.0), 0.0,
         "bar", 0.12, 15.0, 3.0, 6.0, 15.0,
         (6.0, 6.5, 5.6, 6.9, 6.2, 5.5, 6.8, 5.9, 6.4, 5.7), 55.0, 0.01, 1.0, 5, 2.0, 3),
    Loop("FIC-103", "flow, tuned too tightly", "other oscillation", lm.Identity(), 0.0, "m3/h",
         1.5, 6.0, 3.0, 1.0, 7.0, (30.0, 33.0, 29.0), 38.0, 0.1, 1.0, 6),
)  # fmt: skip


def simulated(loop: Loop) -> dict[str, Any]:
    """Columns of a loop, rounded as they are written."""
    rng = np.random.default_rng([loop.seed, 52])
    n, integrates = ROWS + BEFORE, bool(np.isinf(loop.lag))
    den = [1.0, 0.0] if integrates else [loop.lag, 1.0]
    linear = lm.LinearModel.from_continuous([loop.gain], den, loop.dead_time, loop.dt)
    kp, ki = loop.kp, loop.kp / loop.ti
    if loop.verdict == "other oscillation":
        kp, ki = near_the_limit(linear, kp, ki, 0.985)
    steps = np.array(loop.moves)[np.arange(ROWS) * len(loop.moves) // ROWS] - loop.moves[0]
    reference = np.concatenate([np.zeros(BEFORE), steps])
    pole = np.exp(-loop.dt / (8.0 * (loop.dead_time + (20.0 if integrates else loop.lag))))
    load = lm.LinearModel([-pole], [1.0], 1, loop.dt).simulate(
        rng.normal(scale=loop.load * np.sqrt(1.0 - pole**2), size=n)
    )
    response = lm.simulate_loop(
        lm.Hammerstein(loop.actuator, linear), lm.PI(kp, ki, -loop.op, 100.0 - loop.op), reference,
        disturbance=linear.simulate(load), noise=rng.normal(scale=loop.noise, size=n), allow_unstable=True,
    )  # fmt: skip
    seconds = np.arange(ROWS) * loop.dt
    return {
        "Time": [(START + timedelta(seconds=float(one))).isoformat(sep=" ") for one in seconds],
        f"{loop.tag}.SP": (loop.moves[0] + response.reference[BEFORE:]).round(loop.digits),
        f"{loop.tag}.PV": (loop.moves[0] + response.measured[BEFORE:]).round(loop.digits),
        f"{loop.tag}.OP": (loop.op + response.control[BEFORE:]).round(2),
    }


def text(loop: Loop) -> str:
    """The file, unpacked."""
    columns = simulated(loop)
    units = ["", f" [{loop.unit}]", f" [{loop.unit}]", " [%]"]
    head = ",".join(name + unit for name, unit in zip(columns, units, strict=True))
    numbers = (
        ",".join([row[0], *(f"{value:.{loop.digits}f}" for value in row[1:3]), f"{row[3]:.2f}"])
        for row in zip(*columns.values(), strict=True)
    )
    return "\n".join([head, *numbers, ""])


def truth(loop: Loop) -> dict[str, Any]:
    """What is true of it."""
    settings = {name: value for name, value in loop.actuator.to_dict().items() if name != "kind"}
    return {
        "about": loop.about,
        "verdict": loop.verdict,
        "size": loop.size or None,
        "actuator": {"kind": loop.actuator.kind, **settings},
        "op_at_rest": loop.op,
    }


def main() -> None:
    for loop in LOOPS:
        path = FOLDER / f"{loop.tag}.csv.gz"
        path.write_bytes(gzip.compress(text(loop).encode(), 9, mtime=0))
        print(path.name, path.stat().st_size)
    facts = {loop.tag: truth(loop) for loop in LOOPS}
    (FOLDER / "truth.json").write_text(json.dumps(facts, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
