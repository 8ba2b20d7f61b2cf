"""``lostmotion diagnose``."""

from __future__ import annotations

import json as json_module
import sys
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer
from numpy.linalg import LinAlgError

from lostmotion.cli.options import (
    Dt,
    Force,
    Json,
    Mode,
    NoTime,
    Op,
    OpSpan,
    Pv,
    PvSpan,
    Sp,
    Tag,
    Time,
    refuse_existing,
    show,
)
from lostmotion.diagnose import Diagnosis
from lostmotion.diagnose import diagnose as diagnose_record
from lostmotion.errors import FileAccessError, LostMotionError
from lostmotion.files import read_loop, write_text
from lostmotion.report import diagnosis_line, diagnosis_table

INNOCENT = ("none", "other oscillation")  # verdicts that clear the actuator


class LoopType(StrEnum):
    """What PV measures, as ``diagnose`` knows it."""

    FLOW = "flow"
    PRESSURE = "pressure"
    TEMPERATURE = "temperature"
    LEVEL = "level"
    ANALYSER = "analyser"
    CONCENTRATION = "concentration"
    OTHER = "other"


Files = Annotated[
    list[Path], typer.Argument(metavar="FILE...", help="Records, one file for each loop.", show_default=False)
]
Integrating = Annotated[
    bool | None,
    typer.Option(
        "--integrating/--self-regulating",
        help="Whether the process integrates (a level); default: as identified.",
        show_default=False,
    ),
]
Type = Annotated[
    LoopType | None,
    typer.Option("--loop-type", help="What PV measures: the class of performance depends on it.", show_default=False),
]
Figure = Annotated[
    Path | None,
    typer.Option(
        "--figure", help="Write the figure here (png, pdf or svg); of several files: a folder.", show_default=False
    ),
]
Out = Annotated[
    Path | None, typer.Option("--out", help="Write the result as JSON; of several files: a list.", show_default=False)
]


@dataclass(frozen=True)
class Outcome:
    """A file and what became of it: a diagnosis or an error."""

    file: Path
    found: Diagnosis | None
    error: Exception | None = None

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        if self.found is None:
            return {"file": str(self.file), "error": type(self.error).__name__, "message": str(self.error)}
        return {"file": str(self.file), **self.found.to_dict()}


def diagnose(
    files: Files,
    op: Op = "OP",
    pv: Pv = "PV",
    sp: Sp = "SP",
    time: Time = None,
    dt: Dt = None,
    ignore_time: NoTime = False,
    tag: Tag = None,
    op_span: OpSpan = None,
    pv_span: PvSpan = None,
    mode: Mode = None,
    integrating: Integrating = None,
    loop_type: Type = None,
    figure: Figure = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Say what is wrong with a loop: actuator, tuning, disturbance or sensor, how sure that is, and what to do.

    Example: lostmotion diagnose FIC-101.csv --loop-type flow --figure fic101.png

    Several files give one line each as they are done, then a table with the worst first.

    Exit code 0 where nothing is wrong with the actuator; 1 for a finding, a record that does not tell, or a failure.
    """
    if len(files) > 1 and tag is not None:
        raise typer.BadParameter("it names one loop; leave it out with several files", param_hint="--tag")
    figures = _figures(files, figure)
    for path in (out, *figures.values()):
        refuse_existing(path, force)

    def work(file: Path) -> Diagnosis:
        record = read_loop(
            file, op=op, pv=pv, sp=sp, time=False if ignore_time else time, dt=dt, tag=tag, op_span=op_span,
            pv_span=pv_span, mode=mode,
        )  # fmt: skip
        found = diagnose_record(
            record, integrating=integrating, loop_type=None if loop_type is None else loop_type.value
        )
        if file in figures:
            found.plot().savefig(figures[file], dpi=120)
        return found

    outcomes = _several(files, work, json) if len(files) > 1 else [Outcome(files[0], work(files[0]))]
    data: Any = [outcome.to_dict() for outcome in outcomes] if len(files) > 1 else outcomes[0].to_dict()
    if out is not None:
        write_text(out, json_module.dumps(data, indent=2, allow_nan=False) + "\n", force)
    show(_text(outcomes), data, json)
    innocent = all(outcome.found is not None and outcome.found.verdict in INNOCENT for outcome in outcomes)
    raise typer.Exit(0 if innocent else 1)


def _figures(files: list[Path], figure: Path | None) -> dict[Path, Path]:
    """Where the figure of each file goes."""
    if figure is None:
        return {}
    if len(files) == 1:
        return {files[0]: figure}
    if not figure.is_dir():
        raise FileAccessError(f"expected a folder for the figures of several files, got {figure}; make it first")
    return {file: figure / f"{file.stem}.png" for file in files}


def _several(files: list[Path], work: Callable[[Path], Diagnosis], quiet: bool) -> list[Outcome]:
    """One line a file; an error is a line too."""
    outcomes = []
    for number, file in enumerate(files):
        _progress(f"{number + 1} of {len(files)}: {file}")
        try:
            outcome = Outcome(file, work(file))
        except (LostMotionError, LinAlgError) as error:
            outcome = Outcome(file, None, error)
        _progress("")
        if not quiet:
            typer.echo(diagnosis_line(file.stem, outcome.found, outcome.error))
        outcomes.append(outcome)
    return outcomes


def _progress(text: str) -> None:
    """Replace the last line of a terminal."""
    if sys.stderr.isatty():
        typer.echo(f"\r\x1b[K{text}", err=True, nl=False)


def _text(outcomes: list[Outcome]) -> str:
    if len(outcomes) == 1 and outcomes[0].found is not None:
        return outcomes[0].found.summary()
    return "\n" + diagnosis_table([(outcome.file.stem, outcome.found) for outcome in outcomes])
