"""``lostmotion solve``."""

from __future__ import annotations

import datetime as dt
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import lostmotion as lm
from lostmotion.cli.diagnose import Type
from lostmotion.cli.gate import Accept
from lostmotion.cli.next_steps import command_lines, flags, line, typed
from lostmotion.cli.options import File, Integrating, RecordOptions, number
from lostmotion.cli.origin import saved_block
from lostmotion.cli.output import OutputOptions
from lostmotion.cli.progress import progress
from lostmotion.cli.rough_model import ControllerOptions
from lostmotion.cli.wording import as_options

if TYPE_CHECKING:
    from lostmotion.evaluate import Solution

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

    Exit code 0 where a block came out or nothing is wrong with the actuator; 1 where a gate is closed.
    """
    output.refuse(out)
    record = columns.read(file)
    kind = None if loop_type is None else loop_type.value
    found = lm.solve(
        record, controller=pi.controller, gain=known_gain, span=columns.op_span, loop_type=kind,
        integrating=integrating, accept=accept, retune=retune, progress=_progress,
    )  # fmt: skip
    asked = {
        "kp": pi.kp, "ki": pi.ki, "known_gain": known_gain, "loop_type": kind, "integrating": integrating,
        "retune": retune, "out": out, "accept": accept,
    }  # fmt: skip
    lines = _after_block(found, file, columns, asked)
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


def _after_block(found: Solution, file: Path, columns: RecordOptions, asked: dict[str, Any]) -> list[str]:
    """Commands that write the block, where it is not written, and its code."""
    if found.block is None:
        return []
    out = asked["out"] or f"{file.stem}.block.json"
    tag = "".join(sign if sign.isascii() and sign.isalnum() else "_" for sign in file.stem).strip("_") or "1"
    today = str(dt.date.today())
    export = line("export", str(out), "--to", "st", "--name", f"FY_{tag}", "--date", today, "--out", f"{file.stem}.st")
    write = line("solve", str(file), *typed(columns), *flags(asked | {"out": out}))
    return [export] if asked["out"] is not None else [write, export]
