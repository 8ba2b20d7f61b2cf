"""``lostmotion paper``."""

from __future__ import annotations

import json as json_module
from pathlib import Path
from typing import Annotated

import typer

from lostmotion.cli.closed_output import say
from lostmotion.cli.options import number
from lostmotion.cli.output import OutputOptions
from lostmotion.errors import ParameterError

METHODS = ("riv", "rls", "els", "voros", "ml")  # those of lostmotion.paper, which is loaded when it is asked to work

Seeds = Annotated[int, typer.Option("--seeds", min=1, max=100_000, help="Runs of each estimation method.")]
Samples = Annotated[int, typer.Option("--samples", min=1000, max=10**8, help="Samples of a run; the paper has 200000.")]
Method = Annotated[list[str] | None, number("--method", f"One of {', '.join(METHODS)}; may be repeated. Default: all.")]
ControlSeeds = Annotated[int, typer.Option("--control-seeds", min=2, max=100_000, help="Noise sequences for table 2.")]
Out = Annotated[Path, typer.Option("--out", help="HTML page to write; the JSON goes beside it.")]


def paper(
    out: Out = Path("paper.html"),
    seeds: Seeds = 20,
    samples: Samples = 200_000,
    method: Method = None,
    control_seeds: ControlSeeds = 200,
    *,
    output: OutputOptions,
) -> None:
    """Make the tables and figures of the ICINCO 2010 paper again, beside the published values.

    Example: lostmotion paper --seeds 5 --samples 20000 --out paper.html
    """
    from lostmotion.paper import study_control, study_estimation, to_dict, write_page

    if not out.name:
        raise ParameterError.expected("--out with the name of a file", repr(str(out)), "give one")
    beside = out.with_suffix(".json")
    output.refuse(out, beside)
    estimation = study_estimation(seeds, samples, tuple(method) if method else METHODS)
    control = study_control(control_seeds)
    data = to_dict(estimation, control)
    text = json_module.dumps(data, indent=2, allow_nan=False)
    lines = []
    for name in estimation.runs:
        found = estimation.summary(name)
        zone = ", ".join(f"{key} {found['rmse'][key]:.4f}" for key in ("left", "right", "left_slope", "right_slope"))
        lines.append(f"{name:6} converged {found['converged']} of {found['seeds']}; RMSE {zone}")
    output.show("\n".join(lines), data)
    output.write_text(beside, text + "\n")
    output.write_text(out, write_page(estimation, control))
    if not output.json:
        say(f"Page: {out}, numbers: {beside}")
