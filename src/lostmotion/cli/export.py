"""``lostmotion export``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import lostmotion as lm
from lostmotion.cli.gate import GateOptions
from lostmotion.cli.options import number
from lostmotion.cli.output import OutputOptions
from lostmotion.errors import ParameterError

if TYPE_CHECKING:
    from lostmotion.compensate import CompensatorBlock
    from lostmotion.identify import FitFacts

Saved = Annotated[
    Path, typer.Argument(help="Result of `identify --out`, or a block saved as JSON.", show_default=False)
]
To = Annotated[str, typer.Option("--to", help="st, plcopen, tcpou, scl, l5x or c.")]
Name = Annotated[str, number("--name", "Name of the function block, e.g. FY_101.")]
Date = Annotated[str, number("--date", "Day for the header, YYYY-MM-DD.")]
Out = Annotated[Path, number("--out", "Folder for the files; made if need be.")]
Real = Annotated[str, typer.Option("--real", help="lreal (64 bits) or real (32 bits).")]
Scan = Annotated[float | None, number("--scan-time", "Seconds; default: that of the record.")]
Span = Annotated[
    tuple[float, float] | None,
    typer.Option("--span", help="Smallest and largest OP: the clamps; otherwise the span of the record, else 0 100."),
]
Factor = Annotated[
    float | None,
    number("--factor", "Share to compensate; default: from the interval."),
]
Noise = Annotated[float | None, number("--op-noise", "Deviation of the noise in OP; default: that of the record.")]
Ramp = Annotated[float | None, number("--ramp", "Units of OP a second while switching.")]
Centre = Annotated[float | None, number("--centre", "Dead zone: OP at which the valve rests.")]
Method = Annotated[str, typer.Option("--method", help='Stiction: "knocker" or "two moves".')]
Settings = Annotated[list[str] | None, number("--set", "Any setting, e.g. --set band=0.2; repeat it.")]
MOST_SCANS = 10_000_000  # an hour of work
Scans = Annotated[
    int, typer.Option("--replay", max=MOST_SCANS, help="Scans of the replay that proves the code; 0: none.")
]


Supervised = Annotated[
    bool, typer.Option("--supervised", help="Compensate only with what an operator has accepted: docs/supervised.md.")
]
Supervision = Annotated[
    list[str] | None, number("--supervise", "A setting of the supervision, e.g. --supervise timeout=20; repeat it.")
]


@dataclass(frozen=True)
class SupervisionOptions:
    """Whether a supervisor may ask for widths, and its settings."""

    supervised: Supervised = False
    supervise: Supervision = None

    def given(self) -> bool | dict[str, float]:
        """For ``export``."""
        named = _settings(self.supervise or [])
        if named and not self.supervised:
            raise ParameterError.expected("--supervise with --supervised", "no --supervised", "give both, or none")
        return named or self.supervised


@dataclass(frozen=True)
class BlockOptions:
    """Settings of the block, instead of those that follow from the fit."""

    scan_time: Scan = None
    span: Span = None
    factor: Factor = None
    op_noise: Noise = None
    ramp: Ramp = None
    centre: Centre = None
    method: Method = "knocker"
    settings: Settings = None

    def block(self, source: FitFacts | CompensatorBlock, gate: Mapping[str, Any]) -> CompensatorBlock:
        """Block of a saved fit, or a saved block with other settings."""
        extra = _settings(self.settings or [])
        named = ("op_noise", "ramp", "centre", "factor")
        options: dict[str, Any] = {**{name: getattr(self, name) for name in named}, **extra}
        given = {key: value for key, value in options.items() if value is not None}
        if not isinstance(source, lm.CompensatorBlock):
            made: CompensatorBlock = source.block(
                span=self.span, scan_time=self.scan_time, method=self.method, **given, **gate
            )
            return made
        return source.changed(self.scan_time, **given)


def export(
    saved: Saved,
    name: Name,
    date: Date,
    out: Out,
    to: To = "st",
    real: Real = "lreal",
    replay: Scans = 10_000,
    *,
    asked: BlockOptions,
    supervision: SupervisionOptions,
    gate: GateOptions,
    output: OutputOptions,
) -> None:
    """Write the compensating block as code for a PLC, with test vectors and a page for commissioning.

    Example: lostmotion export fic101.json --to scl --name FY_101 --date 2026-01-31 --scan-time 0.5 --out fy101

    The written code is executed over random and adversarial scans and compared with the simulated block. Exit code 1,
    and nothing is written, where they differ, or where the fit does not show the lost motion that the block is for;
    --accept REASON goes on, and the reason stands in every file. No file has been verified in a vendor's tool.
    """
    from lostmotion.compensate.saved_block import read_origin

    source = lm.compensate.read_fit_or_block(saved)
    opened = gate.given()
    block = asked.block(source, opened)
    fit = None if isinstance(source, lm.CompensatorBlock) else source
    origin = {} if fit is not None else read_origin(saved)
    under = supervision.given()
    done = lm.export.export(
        block, to, name=name, date=date, real=real, fit=fit, supervised=under, origin=origin, **opened
    )
    done.refuse(out, output.force)
    made = done.source.block
    proof = done.replay(replay) if replay > 0 else None
    if proof is not None and not proof.agrees:
        output.show(f"Nothing written: the code {proof.summary()}", {"written": [], "replay": proof.to_dict()})
        raise typer.Exit(1)
    paths = [str(path) for path in done.write(out, output.force)]
    notes = "; ".join(made.notes)
    said = "not replayed" if proof is None else f"the code {proof.summary()}"
    text = f"{', '.join(paths)}: {made.kind} block for {to}, {real.upper()}; {said}.\nSettings: {notes}."
    text += "\nSupervised: passive until an operator accepts what a supervisor asks for." if under else ""
    text += f"\nACCEPTED behind a closed gate: {made.accepted}." if made.accepted else ""
    replayed = None if proof is None else proof.to_dict()
    output.show(text, {"written": paths, "to": to, "real": real, "block": made.to_dict(), "replay": replayed})


def _settings(words: list[str]) -> dict[str, float]:
    """Settings from name=value."""
    from lostmotion.arguments import finite

    result = {}
    for word in words:
        name, _, value = word.partition("=")
        try:
            result[name.strip()] = finite(name.strip(), float(value))
        except ParameterError:
            raise
        except ValueError as error:
            raise ParameterError.expected("--set name=number", word, "e.g. --set band=0.2") from error
    return result
