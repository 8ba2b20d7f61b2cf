"""Runs of the Tennessee Eastman plant as LoopRecords, one for each loop that drives a valve."""

from __future__ import annotations

import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import lostmotion as lm
from suite.environment import ROOT, interpreter, settings
from suite.experiment import Array

PLACE = ROOT / ".venv-tep"
CONSTRAINTS = ROOT / "benchmarks" / "tep-constraints.txt"
WORKER = ROOT / "benchmarks" / "plant" / "worker.py"
START = 1.0  # hours left out: the plant settles, the sticking valves come to their cycle
# Loops whose valve sticks under each disturbance; 19 also has the recycle and the steam valve, which no loop moves.
STICKING = {14: ("Reactor temperature",), 15: ("Separator temperature",), 19: ("Sep flow", "Strip flow")}


@dataclass(frozen=True)
class Loop:
    """One loop of one run.

    Attributes
    ----------
    held : ndarray, shape (n,)
        Command that the valve took over.
    sticks : bool
        Whether the disturbance of the run is one of this valve.
    """

    run: str
    record: lm.LoopRecord
    held: Array
    sticks: bool

    @property
    def gap(self) -> float:
        """Largest distance between the command and what the valve took over."""
        return float(np.abs(self.record.op - self.held).max())


def loops(disturbance: int | None, hours: float, seed: int) -> list[Loop]:
    """Run the plant under one disturbance (None: none)."""
    name = "normal" if disturbance is None else f"IDV({disturbance})"
    python = interpreter(PLACE, CONSTRAINTS, ("tep-studio",), "the plant")
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "run.npz"
        numbers = [] if disturbance is None else [str(disturbance)]
        command = [str(python), str(WORKER), str(target), str(START + hours), str(seed), *numbers]
        subprocess.run(command, check=True, env=settings())
        with np.load(target) as data:
            return _split(name, STICKING.get(disturbance or 0, ()), dict(data))


def _split(name: str, sticking: tuple[str, ...], data: dict[str, Array]) -> list[Loop]:
    dt = float(data["dt"])
    rows = slice(round(3600.0 * START / dt), None)
    found = []
    for index, loop in enumerate(data["names"].tolist()):
        op, pv, sp = (data[key][rows, index] for key in ("op", "pv", "sp"))
        record = lm.LoopRecord(op, pv, sp, dt=dt, op_span=(0.0, 100.0), tag=loop, source=name)
        found.append(Loop(name, record, data["held"][rows, index], loop in sticking))
    return found
