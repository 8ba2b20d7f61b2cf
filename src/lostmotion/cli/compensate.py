"""``lostmotion compensate``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from lostmotion.cli.options import Dt, File, Force, Json, NoTime, Op, Pv, Time, refuse_existing, show
from lostmotion.compensate import DeadZoneCompensator
from lostmotion.errors import ParameterError
from lostmotion.files import read_loop, write_columns
from lostmotion.identify import read_fit
from lostmotion.models import DeadZone

Fit = Annotated[Path | None, typer.Option("--fit", help="Result of `identify --out`.", show_default=False)]
Left = Annotated[float | None, typer.Option("--left", help="Break point, instead of --fit.", show_default=False)]
Right = Annotated[float | None, typer.Option("--right", help="Break point, instead of --fit.", show_default=False)]
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
Out = Annotated[Path, typer.Option("--out", help="Table to write (csv, txt, parquet).", show_default=False)]


def compensate(
    file: File,
    out: Out,
    fit: Fit = None,
    left: Left = None,
    right: Right = None,
    left_slope: LeftSlope = 1.0,
    right_slope: RightSlope = 1.0,
    centre: Centre = None,
    op: Op = "OP",
    pv: Pv = "PV",
    time: Time = None,
    dt: Dt = None,
    ignore_time: NoTime = False,
    force: Force = False,
    json: Json = False,
) -> None:
    """Apply the plain inverse of a dead zone to the controller output and write it as OP_compensated.

    What goes into a PLC is the block of `lostmotion export`, which keeps limits, noise bands and bumpless switching.

    Example: lostmotion compensate FIC-101.csv --fit fic101.json --out fic101-compensated.csv
    """
    refuse_existing(out, force)
    block = DeadZoneCompensator.from_dead_zone(_zone(fit, left, right, left_slope, right_slope), centre)
    record = read_loop(file, op=op, pv=pv, sp=None, time=False if ignore_time else time, dt=dt)
    command = np.asarray(block(record.op))
    write_columns(out, {"t_s": np.arange(len(record)) * record.dt, "OP": record.op, "OP_compensated": command}, force)
    move = float(np.nanmax(np.abs(command - record.op)))
    zone = block.dead_zone
    text = (
        f"{out}: {len(record)} rows, OP_compensated = inverse of the dead zone {zone.left:.5g} .. "
        f"{zone.right:.5g} "
        f"(slopes {zone.left_slope:.4g}, {zone.right_slope:.4g}) around OP = {block.centre:.5g}; "
        f"largest move {move:.4g}."
    )
    show(text, {"out": str(out), "rows": len(record), "largest_move": move, **block.to_dict()}, json)


def _zone(fit: Path | None, left: float | None, right: float | None, left_slope: float, right_slope: float) -> DeadZone:
    if (fit is None) == (left is None or right is None):
        raise ParameterError.expected("either --fit or both --left and --right", "neither or both", "give one")
    if fit is None:
        assert left is not None  # noqa: S101
        assert right is not None  # noqa: S101
        return DeadZone(left, right, left_slope, right_slope)
    found = read_fit(fit)
    if found.preferred != "dead zone" or not isinstance(found.nonlinearity, DeadZone):
        raise ParameterError.expected(
            "a fit that shows a dead zone",
            f"{found.preferred} (status {found.status.name})",
            "for backlash and stiction `lostmotion simulate` and `export` make the block",
        )
    return found.nonlinearity
