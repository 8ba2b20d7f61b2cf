"""``lostmotion compensate``."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import lostmotion as lm
from lostmotion.cli.gate import GateOptions
from lostmotion.cli.options import ColumnOptions, File, number
from lostmotion.cli.output import OutputOptions
from lostmotion.errors import GateError, ParameterError
from lostmotion.files import write_columns

if TYPE_CHECKING:
    from lostmotion.models import DeadZone

Fit = Annotated[Path | None, number("--fit", "Result of `identify --out`.")]
Left = Annotated[float | None, number("--left", "Break point, instead of --fit.")]
Right = Annotated[float | None, number("--right", "Break point, instead of --fit.")]
LeftSlope = Annotated[float, typer.Option("--left-slope", help="With --left and --right.")]
RightSlope = Annotated[float, typer.Option("--right-slope", help="With --left and --right.")]
Centre = Annotated[
    float | None,
    typer.Option(
        "--centre",
        help="OP at which the actuator rests. Default: 0 where the dead zone holds it, else its middle.",
        show_default=False,
    ),
]
Out = Annotated[Path, number("--out", "Table to write (csv, txt, parquet).")]


@dataclass(frozen=True)
class ZoneOptions:
    """Dead zone, from a fit or from its numbers."""

    fit: Fit = None
    left: Left = None
    right: Right = None
    left_slope: LeftSlope = 1.0
    right_slope: RightSlope = 1.0


def compensate(
    file: File,
    out: Out,
    centre: Centre = None,
    *,
    zone: ZoneOptions,
    gate: GateOptions,
    columns: ColumnOptions,
    output: OutputOptions,
) -> None:
    """Apply the plain inverse of a dead zone to the controller output and write it as OP_compensated.

    What goes into a PLC is the block of `lostmotion export`, which keeps limits, noise bands and bumpless switching.

    Example: lostmotion compensate FIC-101.csv --fit fic101.json --out fic101-compensated.csv
    """
    import numpy as np

    output.refuse(table=out)
    valve, accepted = _zone(**asdict(zone), gate=gate)
    block = lm.DeadZoneCompensator.from_dead_zone(valve, centre)
    record = columns.read(file, sp=None)
    command = np.asarray(block(record.op))
    table = {"t_s": np.arange(len(record)) * record.dt, "OP": record.op, "OP_compensated": command}
    write_columns(out, table, output.force)
    move = float(np.nanmax(np.abs(command - record.op)))
    undone = block.dead_zone
    text = (
        f"{out}: {len(record)} rows, OP_compensated = inverse of the dead zone {undone.left:.5g} .. "
        f"{undone.right:.5g} "
        f"(slopes {undone.left_slope:.4g}, {undone.right_slope:.4g}) around OP = {block.centre:.5g}; "
        f"largest move {move:.4g}."
    )
    text += f"\nACCEPTED behind a closed gate: {accepted}." if accepted else ""
    told = {"accepted": accepted} if accepted else {}
    output.show(text, {"out": str(out), "rows": len(record), "largest_move": move, **block.to_dict(), **told})


def _zone(
    fit: Path | None,
    left: float | None,
    right: float | None,
    left_slope: float,
    right_slope: float,
    gate: GateOptions,
) -> tuple[DeadZone, str]:
    """Dead zone, and what was accepted to get it."""
    from lostmotion.compensate.gate import pass_gate
    from lostmotion.compensate.slopes import compensated_valve

    if (fit is None) == (left is None or right is None):
        raise ParameterError.expected("either --fit or both --left and --right", "neither or both", "give one")
    if fit is None:
        assert left is not None  # noqa: S101
        assert right is not None  # noqa: S101
        return lm.DeadZone(left, right, left_slope, right_slope), ""
    found = lm.read_fit(fit)
    if found.kind.name != "dead zone":
        raise GateError.expected(
            "a fit that shows a dead zone",
            f"{found.preferred} (status {found.status.name})",
            "for backlash and stiction `lostmotion simulate` and `export` make the block",
        )
    accepted = pass_gate(found, **gate.given())
    valve = compensated_valve(found)
    assert isinstance(valve, lm.DeadZone)  # noqa: S101  it is of this kind
    return valve, accepted
