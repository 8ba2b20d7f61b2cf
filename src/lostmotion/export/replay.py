"""Proof at the moment of export: what was written is executed, and agrees with the simulated block."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.export.dialects import restore
from lostmotion.export.reader import Program
from lostmotion.export.scenarios import Stretch, scenario
from lostmotion.export.source import Source

TOLERANCE = {"lreal": 1e-12, "real": 1e-5}


@dataclass(frozen=True)
class Replay:
    """Outcome of a comparison.

    Attributes
    ----------
    rows : int
        Scans.
    worst : float
        Largest relative difference of a real output; inf where one is finite and the other is not.
    different_flags : int
        Flags and whole numbers that differ, over all scans.
    first : str or None
        The first scan and output that differ by more than is allowed.
    tolerance : float
    """

    rows: int
    worst: float
    different_flags: int
    first: str | None
    tolerance: float

    @property
    def agrees(self) -> bool:
        """Reals within the tolerance, flags and whole numbers identical."""
        return self.different_flags == 0 and self.worst <= self.tolerance

    def summary(self) -> str:
        """One line."""
        if self.agrees:
            return (
                f"agrees with the simulated block in {self.rows} scans: largest relative difference "
                f"{self.worst:.2g} (allowed {self.tolerance:g}), all flags identical"
            )
        return (
            f"DIFFERS from the simulated block: {self.first}; largest relative difference {self.worst:.2g} "
            f"(allowed {self.tolerance:g}), {self.different_flags} flags differ in {self.rows} scans"
        )

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            "agrees": self.agrees,
            "scans": self.rows,
            "largest_relative_difference": self.worst if np.isfinite(self.worst) else None,
            "allowed": self.tolerance,
            "different_flags": self.different_flags,
            "first_difference": self.first,
        }


def replay(files: dict[str, str], source: Source, rows: int = 10_000, seed: int = 0) -> Replay:
    """Execute exported text in plain Python over random and adversarial scans and compare it with the kernel.

    Parameters
    ----------
    files : dict
        What one exporter wrote, by file name.
    source : Source
    rows, seed : int
        Scans, and the seed of the scenario.
    """
    program = Program(restore(files))
    stretches = scenario(source.specification, source.parameters, rows, seed)
    wanted = [variable.name.lower() for variable in source.specification.section("output")]
    columns = [variable.name.lower() for variable in source.specification.section("input")]
    settings = [variable.name.lower() for variable in source.specification.section("parameter")]
    parts = []
    for stretch in stretches:
        if stretch.cold:
            program.reset()
        values = dict(zip(settings, stretch.parameters.tolist(), strict=True))
        parts.append(program.run(values, columns, stretch.inputs, wanted))
    return compare(source, expected(source, stretches), np.concatenate(parts))


def expected(source: Source, stretches: Sequence[Stretch]) -> FloatArray:
    """Outputs of the kernel over the stretches, (n, n_outputs)."""
    specification = source.specification
    state = specification.state(source.dtype)
    parts = []
    for stretch in stretches:
        if stretch.cold:
            state = specification.state(source.dtype)
        outputs = specification.outputs(len(stretch.inputs), source.dtype)
        specification.run(stretch.parameters, state, stretch.inputs, outputs)
        parts.append(outputs.astype(np.float64))
    return np.concatenate(parts)


def compare(source: Source, kernel: FloatArray, block: FloatArray) -> Replay:
    """Kernel against block, both (n, n_outputs)."""
    outputs = source.specification.section("output")
    real = np.array([variable.kind == "real" for variable in outputs])
    with np.errstate(all="ignore"):
        scale = np.maximum(np.abs(kernel), np.abs(block))
        difference = np.where(kernel == block, 0.0, np.abs(kernel - block) / scale)
    difference[np.isnan(kernel) & np.isnan(block)] = 0.0
    difference[~np.isfinite(difference)] = np.inf
    tolerance = TOLERANCE[source.real]
    wrong = np.where(real, difference > tolerance, difference > 0.0)
    first = None
    if wrong.any():
        k, j = (int(index) for index in np.argwhere(wrong)[0])
        first = f"scan {k}, {outputs[j].name}: {block[k, j]:.9g} instead of {kernel[k, j]:.9g}"
    return Replay(
        len(kernel), float(difference[:, real].max(initial=0.0)), int(wrong[:, ~real].sum()), first, tolerance
    )
