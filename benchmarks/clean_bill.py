"""Do the sizes that a record excludes hold, and is the actuator cleared only where nothing hides?

Run: ``.venv/bin/python benchmarks/clean_bill.py`` (about 5 minutes on two cores); prints tables.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported, also in workers

import argparse  # noqa: E402
from collections.abc import Sequence  # noqa: E402
from dataclasses import dataclass  # noqa: E402
from typing import Any  # noqa: E402

import numpy as np  # noqa: E402

import lostmotion as lm  # noqa: E402
from lostmotion.evaluate import random_faulty_loop  # noqa: E402
from lostmotion.evaluate.workers import run_all  # noqa: E402
from verdicts.second_family import CELLS, second_family  # noqa: E402

SMALL = 180  # loops with a fault too small to be seen, a third of each kind
FAMILY = 80  # of each family
SEEDS = 90_000
SPAN = (0.0, 100.0)
KINDS = ("dead zone", "backlash", "stiction")


@dataclass(frozen=True)
class Told:
    """What was said of a loop."""

    kind: str
    size: float
    moves: bool
    excluded: dict[str, float]
    verdict: str


def small(seed: int) -> Told:
    """A loop whose lost motion is 0.05 to 1.5 times the noise in OP; two thirds with moves of the set point."""
    rng = np.random.default_rng(seed)
    kind, n, dt = KINDS[seed % 3], 2000, 1.0
    gain, lag, dead = rng.uniform(0.5, 2.0), rng.uniform(5.0, 40.0), rng.uniform(1.0, 6.0)
    noise = float(np.exp(rng.uniform(np.log(0.02), np.log(0.5))))
    pace = rng.uniform(0.5, 2.0) * (lag / 2.0 + dead)
    pi = lm.PI(lag / (gain * (pace + dead)), 1.0 / (gain * (pace + dead)))
    size = noise * max(pi.kp, 0.3) * float(np.exp(rng.uniform(np.log(0.05), np.log(1.5))))
    valve = {
        "dead zone": lm.DeadZone(-0.5 * size, 0.5 * size),
        "backlash": lm.Backlash(size),
        "stiction": lm.Stiction(size, size * rng.uniform(0.2, 1.0)),
    }[kind]
    plant = lm.Hammerstein(valve, lm.LinearModel.from_continuous([gain], [lag, 1.0], dead, dt))
    moves = bool(rng.random() < 2.0 / 3.0)
    sp = np.repeat(rng.normal(size=n // 100 + 5), 100)[: n + 400] * (3.0 * moves)
    drift = 0.2 * noise * np.cumsum(rng.normal(size=n + 400)) / np.sqrt(lag)
    loop = lm.simulate_loop(plant, pi, sp, noise=noise * rng.normal(size=n + 400), disturbance=drift)
    kept = slice(400, None)
    record = lm.LoopRecord(50 + loop.control[kept], 50 + loop.measured[kept], 50 + sp[kept], dt=dt, op_span=SPAN)
    return told(kind, size, moves, record)


def first(seed: int) -> Told:
    """A loop of the first family, every second one rough."""
    loop = random_faulty_loop(seed, rough=bool(seed % 2))
    return told_of(loop)


def second(cell: int) -> Told:
    """A loop of the second family."""
    return told_of(second_family(cell))


def told_of(loop: Any) -> Told:
    """Diagnose a loop of a family."""
    record = lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=loop.dt, op_span=SPAN)
    kind = loop.actuator.kind if loop.cause in KINDS else "none" if loop.cause != "saturation" else "saturation"
    return told(kind, loop.width if kind in KINDS else 0.0, bool(np.ptp(loop.sp) > 0), record)


def told(kind: str, size: float, moves: bool, record: lm.LoopRecord) -> Told:
    """Diagnose."""
    try:
        found = lm.diagnose(record)
    except lm.InputError:
        return Told(kind, size, moves, {}, "refused")
    return Told(kind, size, moves, found.excluded, found.verdict)


def share(hits: Sequence[bool]) -> str:
    """Number and per cent."""
    return f"{sum(hits)} of {len(hits)}" + (f", {100.0 * np.mean(hits):.1f} %" if hits else "")


def held(rows: list[Told], kind: str = "") -> list[bool]:
    """Whether the true size lies below what is not excluded, where a size was said."""
    return [one.size <= one.excluded[one.kind] for one in rows if one.kind in one.excluded and kind in ("", one.kind)]


def hiding(rows: list[Told]) -> list[bool]:
    """Of the verdicts "none": whether a lost motion larger than the size said excluded is there."""
    return [one.size > one.excluded.get(one.kind, np.inf) for one in rows if one.verdict == "none"]


def cleared(rows: list[Told], moves: bool) -> list[bool]:
    """Of the sound loops with or without moves of the set point: whether the actuator is cleared."""
    sound = [one for one in rows if one.kind == "none" and one.moves is moves]
    return [one.verdict in ("none", "other oscillation") for one in sound]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--small", type=int, default=SMALL)
    parser.add_argument("--family", type=int, default=FAMILY)
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    unseen = run_all(small, range(SEEDS, SEEDS + given.small), "small faults", given.workers)
    one = run_all(first, range(SEEDS, SEEDS + given.family), "first family", given.workers)
    two = run_all(second, range(0, CELLS, max(CELLS // max(given.family, 1), 1)), "second family", given.workers)
    lines = [
        "# What a record excludes, and whether that may be relied upon",
        "",
        "Made by `.venv/bin/python benchmarks/clean_bill.py`.",
        "",
        f"{len(unseen)} simulated loops with a dead zone, backlash or stiction of 0.05 to 1.5 times the noise in OP, "
        "2,000 samples, drift, two thirds with moves of the set point. Where no fault is named the diagnosis says the "
        "largest size of each kind that the record does not exclude (95 %): the true size should lie below it.",
        "",
        "| true kind | size below the bound | bar |",
        "|---|---|---|",
        *(f"| {kind} | {share(held(unseen, kind))} | 93 to 97 % |" for kind in KINDS),
        f"| all | {share(held(unseen))} | 93 to 97 % |",
        "",
        "Both families of [diagnosis.md](diagnosis.md), other seeds, every second loop of the first one rough:",
        "",
        "| what | first family | second family | bar |",
        "|---|---|---|---|",
        f'| "none" that hides a lost motion larger than the size said excluded | {share(hiding(one))} | '
        f"{share(hiding(two))} | at most 5 % |",
        f"| sound actuators cleared, set point moves | {share(cleared(one, True))} | {share(cleared(two, True))} | "
        "60 % or more |",
        f"| the same, set point at rest | {share(cleared(one, False))} | {share(cleared(two, False))} | - |",
        f"| true size below the bound | {share(held(one))} | {share(held(two))} | - |",
        "",
    ]
    print("\n".join(lines))


if __name__ == "__main__":
    main()
