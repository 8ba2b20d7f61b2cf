"""Test vectors: inputs of some hundred scans and the outputs that the block must give, for a test in the real PLC."""

from __future__ import annotations

import numpy as np

from lostmotion.export.replay import expected
from lostmotion.export.scenarios import Stretch, scenario
from lostmotion.export.source import Source, real_text

ROWS = 500
SEED = 7


def vectors(source: Source) -> str:
    """CSV: scan, inputs, expected outputs; from a cold start, with the exported settings, flags as 0 and 1."""
    specification = source.specification
    stretches = scenario(specification, source.parameters, ROWS, SEED, tame=True)
    inputs = np.concatenate([_in_order(source, stretch) for stretch in stretches])
    outputs = expected(source, [Stretch(source.parameters, inputs, cold=True)])
    shown = [*specification.section("input"), *specification.section("output")]
    lines = [",".join(["scan", *(variable.name.lower() for variable in shown)])]
    for k, row in enumerate(np.hstack([inputs.astype(np.float64), outputs])):
        values = [
            real_text(value, source.real) if variable.kind == "real" else str(int(value))
            for variable, value in zip(shown, row, strict=True)
        ]
        lines.append(",".join([str(k), *values]))
    return "\n".join(lines) + "\n"


def _in_order(source: Source, stretch: Stretch) -> np.ndarray:
    """Inputs rounded to what a person can type, in the arithmetic of the block."""
    kinds = [variable.kind for variable in source.specification.section("input")]
    rounded = np.where(
        [kind == "real" for kind in kinds], np.round(stretch.inputs.astype(np.float64), 4), stretch.inputs
    )
    return np.asarray(rounded, dtype=source.dtype)
