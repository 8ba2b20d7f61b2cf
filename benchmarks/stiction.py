"""Kind, size and intervals of sticking valves and of backlash, in a simulation that shares nothing with the package.

Run: ``.venv/bin/python benchmarks/stiction.py`` (about 5 minutes on two cores); writes docs/stiction.md.
Options: ``--loops N``, ``--workers N``; fewer loops than by default are printed, not written.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported, also in workers

import argparse  # noqa: E402
import time  # noqa: E402
from dataclasses import dataclass  # noqa: E402
from pathlib import Path  # noqa: E402

import numpy as np  # noqa: E402

import lostmotion as lm  # noqa: E402
from lostmotion.evaluate.workers import run_all  # noqa: E402
from pages import publish  # noqa: E402

OUTPUT = Path(__file__).resolve().parent.parent / "docs" / "stiction.md"
DT, ROWS, HOLD = 0.5, 4000, 400
LOOPS, FIRST = 100, 7000  # FIRST: no loop that the search was written with
WRONG = 0.1  # of the band: an answer further off is another needle


@dataclass(frozen=True)
class Loop:
    """A simulated loop: band and jump in units of OP."""

    op: np.ndarray
    pv: np.ndarray
    band: float
    jump: float


@dataclass(frozen=True)
class Row:
    """What was found in one loop."""

    kind: str
    confidence: float
    ratio: float
    inside: bool
    jump_inside: bool
    width: float
    seconds: float


def valve(held: float, command: float, band: float, jump: float) -> float:
    """Stays until the command is (S + J) / 2 away, then goes to (S - J) / 2 behind it."""
    away = command - held
    return command - np.sign(away) * 0.5 * (band - jump) if abs(away) > 0.5 * (band + jump) else held


def simulated(seed: int, sticking: bool) -> Loop:
    """First-order process with dead time, PI, set point moved every 200 s, drift, noise of 0.03."""
    random = np.random.default_rng(seed)
    gain, tau, dead = random.uniform(0.5, 2.0), random.uniform(5.0, 40.0), random.uniform(0.5, 6.0)
    closed = random.uniform(1.0, 2.5) * max(dead, 0.3 * tau)
    kp, ti = tau / (gain * (closed + dead)), min(tau, 4.0 * (closed + dead))
    band = random.uniform(1.5, 6.0)
    jump = band * random.uniform(0.1, 1.0) if sticking else 0.0
    sp = 50.0 + np.repeat(random.uniform(-4.0, 4.0, ROWS // HOLD + 1), HOLD)[:ROWS]
    noise, shocks = 0.03 * random.normal(size=ROWS), 0.02 * random.normal(size=ROWS)
    pole, late = np.exp(-DT / tau), round(dead / DT)
    op, pv, positions = np.zeros(ROWS), np.zeros(ROWS), np.zeros(ROWS)
    state = integral = drift = 0.0
    held = op_zero = 0.0
    for k in range(ROWS):
        state = pole * state + (1.0 - pole) * gain * (positions[k - 1 - late] if k > late else 0.0)
        drift = 0.998 * drift + shocks[k]
        pv[k] = 50.0 + state + drift + noise[k]
        error = sp[k] - pv[k]
        integral += kp * error * DT / ti
        op[k] = kp * error + integral + op_zero
        held = valve(held, op[k], band, jump)
        positions[k] = held
    return Loop(op + 50.0, pv, band, jump)


def sticking(seed: int) -> Row:
    """A loop with stiction."""
    return _row(simulated(seed, sticking=True), "band")


def loose(seed: int) -> Row:
    """A loop with backlash."""
    return _row(simulated(seed, sticking=False), "width")


def _row(loop: Loop, size: str) -> Row:
    begun = time.process_time()
    fit = lm.identify(loop.op, loop.pv, DT, nonlinearity="auto")
    seconds = time.process_time() - begun
    kind, confidence = fit.nonlinearity.kind, 0.0 if fit.kinds is None else fit.kinds.confidence
    if size not in fit.nonlinearity.own:
        return Row(kind, confidence, float("nan"), False, False, float("nan"), seconds)
    low, high = fit.interval(size)
    jump_inside = size == "width"
    if kind == "stiction":
        least, most = fit.interval("jump")
        jump_inside = least <= loop.jump <= most
    inside = low <= loop.band <= high
    return Row(
        kind, confidence, fit.parameters[size] / loop.band, inside, jump_inside, (high - low) / loop.band, seconds
    )


def line(name: str, kind: str, rows: list[Row]) -> str:
    """One row of the table."""
    right = [row for row in rows if row.kind == kind]
    off = np.abs(np.array([row.ratio for row in right]) - 1.0)
    wrong = [row for row in right if abs(row.ratio - 1.0) > WRONG and not row.inside]
    sure = [row for row in wrong if row.confidence > 0.9]
    cells = [
        name,
        f"{len(right)} of {len(rows)}",
        f"{100 * np.mean(off < 0.01):.0f} %",
        f"{100 * np.mean(off < WRONG):.0f} %",
        f"{sum(row.inside for row in right)} of {len(right)}",
        f"{sum(row.jump_inside for row in right)} of {len(right)}" if kind == "stiction" else "",
        f"{100 * float(np.median([row.width for row in right])):.2f} %",
        f"{len(wrong)}, {len(sure)}",
        f"{float(np.median([row.seconds for row in rows])):.1f} s",
    ]
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--loops", type=int, default=LOOPS)
    parser.add_argument("--workers", type=int, default=None)
    given = parser.parse_args()
    sticking(FIRST - 1)  # compiles the kernels, which the workers are then born with
    stuck = run_all(sticking, range(FIRST, FIRST + given.loops), "sticking valves", given.workers)
    play = run_all(loose, range(FIRST, FIRST + given.loops // 2), "backlash", given.workers)
    table = "\n".join([line("stiction", "stiction", stuck), line("backlash", "backlash", play)])
    print(table)
    if given.loops >= LOOPS:
        publish(OUTPUT, PAGE.format(table=table))


PAGE = """# Sticking valves in a simulation of their own

Made by `.venv/bin/python benchmarks/stiction.py`. The loops share no code with the package: first-order process of
gain 0.5 to 2, time constant 5 to 40 s and dead time 0.5 to 6 s; PI; set point moved every 200 s; drift; noise of 0.03;
4,000 samples of 0.5 s. The valve stays until the command is (S + J) / 2 away and then goes to (S - J) / 2 behind it; S
is 1.5 to 6 in units of OP, J 0.1 to 1 of S. `identify` is called with `nonlinearity="auto"` and nothing else.

| fault | kind | within 1 % | within 10 % | held | jump held | width | another needle, sure of it | time |
|---|---|---|---|---|---|---|---|---|
{table}

Kind: named rightly; of these, the size within 1 and 10 % of the true one; its 95 % interval holds it, and that of the
jump; median width of the interval in sizes. "Another needle": more than 10 % off with an interval that does not hold
the true size; sure of it: with a confidence over 0.9. Time: median processor time of the whole call.

How it is done: [method.md](method.md), "Actuators with memory".
"""


if __name__ == "__main__":
    main()
