"""Tennessee Eastman plant with sticking valves: is the valve found, and its lost motion, and nothing in a normal run?

Run: ``.venv/bin/python benchmarks/eastman.py`` (about 15 minutes on one thread); writes docs/eastman.md. The plant,
``tep-studio`` from PyPI, is installed into ``.venv-tep`` on the first run and compiled there: it needs a C compiler.
Option: ``--quick`` for one seed of 2 hours, which writes nothing.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported

import argparse  # noqa: E402
import platform  # noqa: E402
import time  # noqa: E402
from collections.abc import Iterator  # noqa: E402
from dataclasses import dataclass, replace  # noqa: E402
from pathlib import Path  # noqa: E402

import numpy as np  # noqa: E402

import lostmotion as lm  # noqa: E402
from pages import publish  # noqa: E402
from plant import page  # noqa: E402
from plant.runs import STICKING, Loop, loops  # noqa: E402
from suite.experiment import Array  # noqa: E402

OUTPUT = Path(__file__).parent.parent / "docs" / "eastman.md"
DISTURBANCES = (None, *STICKING)
HOURS, SEEDS = 8.0, 5
TRUE_GAP = 2.0  # % of the valve's range: the code's VST, equal for all valves
NEAR = 0.25
SIZES = {"stiction": "band", "backlash": "width", "dead zone": "width"}
FAULTS = ("dead zone", "backlash", "stiction", "saturation")
COARSER = (3, 5, 10)  # steps of the plant for one row
THRESHOLDS = (1.9, 1.98, 2.0, 2.02, 2.1)


@dataclass(frozen=True)
class Found:
    """What became of one record."""

    loop: Loop
    diagnosis: lm.Diagnosis
    seconds: float

    @property
    def kind(self) -> str:
        """Kind of the fit that `diagnose` rests on."""
        return self.diagnosis.fit.nonlinearity.kind if self.diagnosis.fit.preferred != "none" else "none"

    @property
    def size(self) -> float:
        """Band or width of it, whatever the verdict; NaN where the kind has none."""
        return self.diagnosis.fit.parameters[SIZES[self.kind]] if self.kind in SIZES else np.nan

    @property
    def gap(self) -> float:
        """Distance between command and position at which the valve found breaks away; NaN for other kinds."""
        if not self.sticks:
            return np.nan
        return 0.5 * (self.size + self.diagnosis.fit.parameters.get("jump", 0.0))

    @property
    def sticks(self) -> bool:
        """Whether the likelihood says that the valve sticks."""
        return self.kind in ("stiction", "backlash")

    @property
    def near(self) -> bool:
        """Whether it does and the size is within 25 % of the true gap."""
        return self.sticks and abs(self.size / TRUE_GAP - 1.0) <= NEAR


def diagnosed(loop: Loop) -> Found:
    begin = time.process_time()
    diagnosis = lm.diagnose(loop.record)
    return Found(loop, diagnosis, time.process_time() - begin)


def cells(found: Found) -> list[str]:
    """Verdict, kind, size, its ratio to the truth, gap of the actuator found, seconds."""
    fit, size = found.diagnosis.fit, "-"
    if np.isfinite(found.size):
        low, high = fit.interval(SIZES[found.kind])
        size = f"{found.size:.2f} ({low:.2f} .. {high:.2f})"
    ratio, gap = (f"{value:.2f}" if np.isfinite(value) else "-" for value in (found.size / TRUE_GAP, found.gap))
    kind = f"{found.kind} ({fit.nonlinearity.model})" if found.kind == "stiction" else found.kind
    return [found.diagnosis.verdict, kind, size, ratio, gap, f"{found.seconds:.1f}"]


def line(head: list[str], found: Found) -> str:
    text = "| " + " | ".join([*head, *cells(found)]) + " |"
    print(text, flush=True)
    return text


def every_loop(hours: float) -> Iterator[Found]:
    """All loops of all runs with the first seed."""
    for disturbance in DISTURBANCES:
        for loop in loops(disturbance, hours, 1):
            yield diagnosed(loop)


def other_seeds(hours: float, seeds: int) -> Iterator[tuple[int, Found]]:
    """The loops with a sticking valve again, with other measurement noise."""
    for disturbance in STICKING:
        for seed in range(2, seeds + 1):
            for loop in loops(disturbance, hours, seed):
                if loop.sticks:
                    yield seed, diagnosed(loop)


def coarser(loop: Loop, every: int) -> Loop:
    """The same record as a historian with a longer interval has it."""
    record = loop.record
    op, pv, sp = (signal[::every] for signal in (record.op, record.pv, record.sp) if signal is not None)
    return replace(loop, record=replace(record, op=op, pv=pv, sp=sp, dt=every * record.dt), held=loop.held[::every])


def log_likelihood(x: Array, record: lm.LoopRecord) -> float:
    """Of a linear model behind the position x, up to a constant; NaN where the valve never moves."""
    if np.ptp(x) == 0.0:
        return np.nan
    fit = lm.identify(x, record.pv, dt=record.dt, nonlinearity="none")
    return -0.5 * record.pv.size * float(np.log(fit.noise.variance))


def truth_line(loop: Loop) -> str:
    """How much better the true valve explains PV than none, and valves that stick nearly as much."""
    record, start = loop.record, float(loop.held[0])
    linear = log_likelihood(record.op, record)
    tries = [np.asarray(lm.Stiction(d, d, model="he").run(record.op, start)) for d in THRESHOLDS]
    tries.append(np.asarray(lm.Stiction(TRUE_GAP, TRUE_GAP, model="kano").run(record.op, start)))
    same = float(np.abs(tries[THRESHOLDS.index(TRUE_GAP)] - loop.held).max())
    gains = ["never moves" if np.isnan(g) else f"{g - linear:.0f}" for g in (log_likelihood(x, record) for x in tries)]
    text = "| " + " | ".join([loop.run, record.tag, f"{same:.1g}", *gains]) + " |"
    print(text, flush=True)
    return text


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    quick, begin = parser.parse_args().quick, time.perf_counter()
    hours, seeds = (2.0, 1) if quick else (HOURS, SEEDS)
    lm.diagnose(loops(None, 0.5, 1)[0].record)  # compiles
    every, first = [], []
    for found in every_loop(hours):
        every.append(found)
        loop = found.loop
        sticks = f"{loop.gap:.2f}" if loop.sticks else "no"
        first.append(line([loop.run, loop.record.tag, sticks], found))
    stuck = [found for found in every if found.loop.sticks]
    again = list(other_seeds(hours, seeds))
    more = [line([found.loop.run, found.loop.record.tag, str(seed)], found) for seed, found in again]
    sampling = []
    for found in stuck:
        for step in COARSER:
            loop = coarser(found.loop, step)
            sampling.append(line([loop.run, loop.record.tag, f"{loop.record.dt:g}"], diagnosed(loop)))
    truth = [truth_line(found.loop) for found in stuck]
    scores = summary(every, stuck + [found for _, found in again])
    print(scores)
    if not quick:
        tables = {"every": first, "seeds": more, "sampling": sampling, "truth": truth}
        facts = {"machine": platform.machine(), "hours": HOURS, "rows": stuck[0].loop.record.op.size}
        facts |= {"minutes": (time.perf_counter() - begin) / 60.0, "scores": scores}
        text = page.PAGE.format(**facts, **{name: "\n".join(lines) for name, lines in tables.items()})
        publish(OUTPUT, text)


def summary(every: list[Found], stuck: list[Found]) -> str:
    """The score, loop by loop."""
    free = [found for found in every if not found.loop.sticks]
    normal = [found for found in free if found.loop.run == "normal"]
    lines = []
    for run, tag in dict.fromkeys((found.loop.run, found.loop.record.tag) for found in stuck):
        group = [found for found in stuck if (found.loop.run, found.loop.record.tag) == (run, tag)]
        said = sum(found.diagnosis.verdict in ("stiction", "backlash") for found in group)
        sizes = " ".join(f"{found.size:.2f}" if found.sticks else found.kind for found in group)
        counts = [said, sum(found.sticks for found in group), sum(found.near for found in group)]
        lines.append("| " + " | ".join([run, tag, *(f"{n}/{len(group)}" for n in counts), sizes]) + " |")
    for name, group in (("normal", normal), ("19, 14, 15: valves that do not stick", free[len(normal) :])):
        said = sum(found.diagnosis.verdict in FAULTS for found in group)
        kinds = sum(found.kind != "none" for found in group)
        lines.append(f"| {name} | {len(group)} loops | {said}/{len(group)} | {kinds}/{len(group)} | - | - |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
