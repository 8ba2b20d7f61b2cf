"""Options that several commands share, and how they print."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from lostmotion.errors import FileAccessError

File = Annotated[
    Path, typer.Argument(help="CSV, text, Parquet or MAT file with the record of one loop.", show_default=False)
]
Op = Annotated[str, typer.Option("--op", help="Column of the controller output (also found as CO, MV, OUT ..).")]
Pv = Annotated[str, typer.Option("--pv", help="Column of the measurement.")]
Sp = Annotated[str, typer.Option("--sp", help="Column of the set point; not needed.")]
Dt = Annotated[
    float | None,
    typer.Option("--dt", help="Sampling time in seconds; default: from the time column.", show_default=False),
]
Time = Annotated[str | None, typer.Option("--time", help="Time column, if it has an unusual name.", show_default=False)]
NoTime = Annotated[bool, typer.Option("--ignore-time", help="Rows are equally spaced in truth; needs --dt.")]
Tag = Annotated[
    str | None, typer.Option("--tag", help="Name of the loop; default: name of the file.", show_default=False)
]
OpSpan = Annotated[
    tuple[float, float] | None,
    typer.Option(
        "--op-span",
        help="Limits of OP in its units, for results in % of span, e.g. 0 100.",
        show_default=False,
    ),
]
PvSpan = Annotated[
    tuple[float, float] | None,
    typer.Option("--pv-span", help="Range of the transmitter in units of PV, e.g. 0 250.", show_default=False),
]
Mode = Annotated[str | None, typer.Option("--mode", help="Column with the mode of the controller.", show_default=False)]
Json = Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")]
Force = Annotated[bool, typer.Option("--force", help="Replace files that are already there.")]


def show(text: str, data: dict[str, Any] | list[dict[str, Any]], as_json: bool) -> None:
    """Print a result as text or as JSON."""
    typer.echo(json.dumps(data, indent=2, allow_nan=False) if as_json else text)


def refuse_existing(path: Path | None, force: bool) -> None:
    """Raise before any work is done where an output would overwrite a file."""
    if path is not None and path.exists() and not force:
        raise FileAccessError(f"expected a new file, got {path} which exists; use --force to replace it")
    if path is not None and not path.parent.is_dir():
        raise FileAccessError(f"expected a folder {path.parent}, got none; make it first")
