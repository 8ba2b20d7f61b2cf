"""``lostmotion export``."""

from __future__ import annotations

import json as json_module
from pathlib import Path
from typing import Annotated, Any

import typer

from lostmotion.cli.options import Force, Json, show
from lostmotion.compensate.saved import block_from_saved
from lostmotion.errors import DataError, FileAccessError, ParameterError
from lostmotion.export import TARGETS
from lostmotion.export import export as export_block

Saved = Annotated[
    Path, typer.Argument(help="Result of `identify --out`, or a block saved as JSON.", show_default=False)
]
To = Annotated[str, typer.Option("--to", help=f"{', '.join([*TARGETS][:-1])} or {[*TARGETS][-1]}.")]
Name = Annotated[str, typer.Option("--name", help="Name of the function block, e.g. FY_101.", show_default=False)]
Date = Annotated[str, typer.Option("--date", help="Day for the header, YYYY-MM-DD.", show_default=False)]
Out = Annotated[Path, typer.Option("--out", help="Folder for the files; made if need be.", show_default=False)]
Real = Annotated[str, typer.Option("--real", help="lreal (64 bits) or real (32 bits).")]
Scan = Annotated[
    float | None, typer.Option("--scan-time", help="Seconds; default: that of the record.", show_default=False)
]
Span = Annotated[tuple[float, float], typer.Option("--span", help="Smallest and largest OP: the clamps.")]
Factor = Annotated[
    float | None,
    typer.Option("--factor", help="Share to compensate; default: from the interval.", show_default=False),
]
Noise = Annotated[
    float | None, typer.Option("--op-noise", help="Standard deviation of the noise in OP.", show_default=False)
]
Ramp = Annotated[float | None, typer.Option("--ramp", help="Units of OP a second while switching.", show_default=False)]
Centre = Annotated[
    float | None, typer.Option("--centre", help="Dead zone: OP at which the valve rests.", show_default=False)
]
Method = Annotated[str, typer.Option("--method", help='Stiction: "knocker" or "two moves".')]
Settings = Annotated[
    list[str] | None, typer.Option("--set", help="Any setting, e.g. --set band=0.2; repeat it.", show_default=False)
]
Scans = Annotated[int, typer.Option("--replay", help="Scans of the replay that proves the code; 0: none.")]


def export(
    saved: Saved,
    name: Name,
    date: Date,
    out: Out,
    to: To = "st",
    real: Real = "lreal",
    scan_time: Scan = None,
    span: Span = (0.0, 100.0),
    factor: Factor = None,
    op_noise: Noise = None,
    ramp: Ramp = None,
    centre: Centre = None,
    method: Method = "knocker",
    settings: Settings = None,
    replay: Scans = 10_000,
    force: Force = False,
    json: Json = False,
) -> None:
    """Write the compensating block as code for a PLC, with test vectors and a page for commissioning.

    Example: lostmotion export fic101.json --to scl --name FY_101 --date 2026-01-31 --scan-time 0.5 --out fy101

    The written code is executed over random and adversarial scans and compared with the simulated block. Exit code 1,
    and nothing is written, where they differ. No file has been verified in a vendor's tool.
    """
    data, extra = _read(saved), _settings(settings or [])
    options: dict[str, Any] = {"op_noise": op_noise, "ramp": ramp, "centre": centre, **extra}
    given = {key: value for key, value in options.items() if value is not None}
    if "model" in data:
        given["method"] = method
    block = block_from_saved(data, span=span, scan_time=scan_time, factor=factor, **given)
    done = export_block(block, to, name=name, date=date, real=real, fit=data if "model" in data else None)
    proof = done.replay(replay) if replay > 0 else None
    if proof is not None and not proof.agrees:
        show(f"Nothing written: the code {proof.summary()}", {"written": [], "replay": proof.to_dict()}, json)
        raise typer.Exit(1)
    paths = [str(path) for path in done.write(out, force)]
    notes = "; ".join(block.notes)
    said = "not replayed" if proof is None else f"the code {proof.summary()}"
    text = f"{', '.join(paths)}: {block.kind} block for {to}, {real.upper()}; {said}.\nSettings: {notes}."
    replayed = None if proof is None else proof.to_dict()
    show(text, {"written": paths, "to": to, "real": real, "block": block.to_dict(), "replay": replayed}, json)


def _read(path: Path) -> dict[str, Any]:
    """JSON of a fit or of a block."""
    try:
        data = json_module.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise FileAccessError(f"expected a readable {path}, got {error.strerror}; check the path") from error
    except ValueError as error:
        raise DataError.expected("the JSON of a fit or a block", f"{path}: {error}", "use identify --out") from error
    if not isinstance(data, dict):
        raise DataError.expected("the JSON of a fit or a block", f"other JSON in {path}", "use identify --out")
    return data


def _settings(words: list[str]) -> dict[str, float]:
    """Settings from name=value."""
    result = {}
    for word in words:
        name, _, value = word.partition("=")
        try:
            result[name.strip()] = float(value)
        except ValueError as error:
            raise ParameterError.expected("--set name=number", word, "e.g. --set band=0.2") from error
    return result
