"""``lostmotion solve``."""

from __future__ import annotations

import datetime as dt
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import lostmotion as lm
from lostmotion.cli.diagnose import Type
from lostmotion.cli.failure import say_error
from lostmotion.cli.gate import Accept
from lostmotion.cli.options import File, Integrating, RecordOptions, number
from lostmotion.cli.origin import saved_block
from lostmotion.cli.output import OutputOptions
from lostmotion.cli.progress import progress
from lostmotion.cli.rough_model import ControllerOptions
from lostmotion.cli.way_out import command_lines, typed
from lostmotion.cli.wording import as_options
from lostmotion.errors import LostMotionError

if TYPE_CHECKING:
    from lostmotion.evaluate import Solution
    from lostmotion.records import LoopRecord

KnownGain = Annotated[float | None, number("--known-gain", "Static gain of the process behind the valve.")]
Retune = Annotated[bool, typer.Option("--retune", help="Retune with the block, where the study asks for both.")]
BlockOut = Annotated[Path | None, number("--out", "Write the block here as JSON, for `export`, where one comes out.")]


def solve(
    file: File,
    out: BlockOut = None,
    known_gain: KnownGain = None,
    loop_type: Type = None,
    integrating: Integrating = None,
    accept: Accept = None,
    retune: Retune = False,
    *,
    pi: ControllerOptions,
    columns: RecordOptions,
    output: OutputOptions,
) -> None:
    """Go the whole way from a record to a compensating block: check, diagnose, identify, simulate, block.

    Example: lostmotion solve FIC-101.csv --out fy101.json

    It stops at the first closed gate, and says what opens it: the command to paste.

    Exit code 0 where a block came out or nothing is wrong with the actuator; 1 where a gate is closed; 2 where the
    file cannot be used.
    """
    output.refuse(out)
    record = _record(file, columns, output.json)
    kind = None if loop_type is None else loop_type.value
    found = lm.solve(
        record, controller=pi.controller, gain=known_gain, span=columns.op_span, loop_type=kind,
        integrating=integrating, accept=accept, retune=retune, progress=_progress,
    )  # fmt: skip
    asked = {
        "kp": pi.kp, "ki": pi.ki, "known_gain": known_gain, "loop_type": kind, "integrating": integrating,
        "retune": retune, "out": out,
    }  # fmt: skip
    lines = _next(found, file, out)
    if found.closed is not None:
        free = partial(lm.identify, record, nonlinearity="none", integrating=integrating)
        lines = command_lines(found, file, columns, asked, lambda: free().facts)
    told = as_options(found.summary()).replace("--span ", "--op-span ")
    text = "\n".join([told, *(f"  {line}" for line in lines)])
    output.show(text, found.to_dict() | {"commands": lines})
    if found.block is not None:
        output.write_json(out, saved_block(found.block, found.fit))
    raise typer.Exit(1 if found.outcome == "closed" else 0)


def _progress(line: str) -> None:
    progress(f"solve: {line} ..")


def _record(file: Path, columns: RecordOptions, as_json: bool) -> LoopRecord:
    """Record of the file; one that cannot be used is wrong usage here, since 1 is a closed gate."""
    try:
        return columns.read(file)
    except LostMotionError as error:
        say_error(error, as_json, ["solve", str(file), *typed(columns)])
        raise typer.Exit(2) from error


def _next(found: Solution, file: Path, out: Path | None) -> list[str]:
    """What to do with the block."""
    if found.block is None:
        return []
    saved: Any = out if out is not None else "BLOCK.json"
    tag = "".join(sign if sign.isalnum() else "_" for sign in file.stem).strip("_") or "FY_1"
    export = f"lostmotion export {saved} --to st --name FY_{tag} --date {dt.date.today()} --out fy"
    return [export] if out is not None else [f"(nothing written; --out BLOCK.json keeps the block, then: {export})"]
