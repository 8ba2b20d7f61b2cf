"""``lostmotion simulate``."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from lostmotion.cli.options import (
    Dt,
    Force,
    Json,
    Mode,
    NoTime,
    Op,
    OpSpan,
    Pv,
    Sp,
    Tag,
    Time,
    refuse_existing,
    show,
)
from lostmotion.cli.rough_model import (
    Constants,
    DeadTime,
    Deviation,
    Gain,
    Integrating,
    Memory,
    controller_of_numbers,
    noise_of_numbers,
    number,
    process_of,
)
from lostmotion.compensate import read_block
from lostmotion.errors import ParameterError
from lostmotion.evaluate import CompensationStudy, compensation_study
from lostmotion.files import read_loop, write_json
from lostmotion.identify import identify, read_fit
from lostmotion.models import Backlash, DeadZone, Hammerstein, NoiseModel, Nonlinearity, Stiction
from lostmotion.records import LoopRecord

Source = Annotated[
    Path | None,
    typer.Argument(
        metavar="[FILE]",
        help="Result of `identify --out`, or a record, which is identified first; neither: the numbers of a model.",
        show_default=False,
    ),
]
Record = Annotated[Path | None, number("--record", "Record of the loop, beside a result: gives set point, controller.")]
Kind = Annotated[str, typer.Option("--nonlinearity", help='Of a record: "auto", "dead zone", "backlash", "stiction".')]
KnownGain = Annotated[float | None, number("--known-gain", "Of a record: static gain of the process behind the valve.")]
Left = Annotated[float | None, number("--left", "Left break point of a dead zone, instead of a file.")]
Right = Annotated[float | None, number("--right", "Right break point of it.")]
Width = Annotated[float | None, number("--width", "Full width of a backlash, instead of a file.")]
Band = Annotated[float | None, number("--band", "S of a stiction, instead of a file.")]
Jump = Annotated[float | None, number("--jump", "J of a stiction; default: S.")]
Kp = Annotated[float | None, number("--kp", "Gain of the PI controller; default: from the record, where it tells.")]
Ki = Annotated[float | None, number("--ki", "Integral gain of it, units of OP per unit of PV and second.")]
Step = Annotated[float | None, number("--sp-step", "Steps of the set point of this size, instead of the record's.")]
Hold = Annotated[float | None, number("--hold", "Seconds for which each step is held; default: a tenth of the run.")]
OpNow = Annotated[float | None, number("--op-now", "OP at rest, where the set point is constant.")]
Factor = Annotated[float | None, number("--factor", "Share to compensate; default: from the interval of the fit.")]
Method = Annotated[str, typer.Option("--method", help='Stiction: "knocker" or "two moves".')]
Block = Annotated[Path | None, number("--block", "Block as JSON, instead of the one that the rules make.")]
BlockOut = Annotated[Path | None, number("--block-out", "Write the block here as JSON, for `export`.")]
Samples = Annotated[int, typer.Option("--samples", help="Length of a run, where no record gives it.")]
Runs = Annotated[int, typer.Option("--runs", help="Runs with other noise.")]
Draws = Annotated[int, typer.Option("--draws", help="Plants drawn from the uncertainty of the fit.")]
Seed = Annotated[int, typer.Option("--seed", help="Of noise and plants; the same seed, the same result.")]
Figure = Annotated[Path | None, number("--figure", "Write the figure here (png, pdf or svg).")]
Out = Annotated[Path | None, number("--out", "Write the result as JSON.")]


@dataclass(frozen=True)
class _Asked:
    """What is to be studied."""

    model: Any
    record: LoopRecord | None = None
    noise: NoiseModel | None = None


def simulate(
    file: Source = None,
    record: Record = None,
    op: Op = "OP",
    pv: Pv = "PV",
    sp: Sp = "SP",
    time: Time = None,
    dt: Dt = None,
    ignore_time: NoTime = False,
    tag: Tag = None,
    op_span: OpSpan = None,
    mode: Mode = None,
    nonlinearity: Kind = "auto",
    known_gain: KnownGain = None,
    left: Left = None,
    right: Right = None,
    width: Width = None,
    band: Band = None,
    jump: Jump = None,
    gain: Gain = None,
    time_constant: Constants = None,
    integrating: Integrating = False,
    dead_time: DeadTime = 0.0,
    noise_deviation: Deviation = None,
    noise_time: Memory = 0.0,
    kp: Kp = None,
    ki: Ki = None,
    sp_step: Step = None,
    hold: Hold = None,
    op_now: OpNow = None,
    factor: Factor = None,
    method: Method = "knocker",
    block: Block = None,
    samples: Samples = 4000,
    runs: Runs = 10,
    draws: Draws = 20,
    seed: Seed = 0,
    block_out: BlockOut = None,
    figure: Figure = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Simulate the loop without, with and with mis-estimated compensation, before anything is downloaded.

    Example: lostmotion simulate FIC-101.csv --figure fic101.png --block-out fy101.json

    Example: lostmotion simulate fic101.json --kp 0.8 --ki 0.05 --sp-step 2

    Example: lostmotion simulate --width 2 --gain 1.5 --time-constant 30 --dead-time 4 --dt 1 --noise-deviation 0.1
    --kp 1 --ki 0.03

    Exit code 1 where the block is not safe with the present controller: on some plant within the uncertainty the loop
    gets worse, or its limit cycle larger, than without.
    """
    for path in (block_out, figure, out):
        refuse_existing(path, force)

    def read(path: Path) -> LoopRecord:
        return read_loop(
            path, op=op, pv=pv, sp=sp, time=False if ignore_time else time, dt=dt, tag=tag, op_span=op_span, mode=mode
        )

    if file is None:
        valve = _valve(left, right, width, band, jump)
        process = process_of(gain, time_constant or [], integrating, dead_time, dt)
        noise = noise_of_numbers(noise_deviation, noise_time, process.dt)
        asked = _Asked(Hammerstein(valve, process, _offset(valve, process.gain, op_now)), noise=noise)
    elif file.suffix.lower() == ".json":
        asked = _Asked(read_fit(file), None if record is None else read(record))
    else:
        loop = read(file)
        _progress(f"identifying {file}")
        asked = _Asked(identify(loop, nonlinearity=nonlinearity, gain=known_gain), loop)
    _progress("simulating")
    options: dict[str, Any] = {} if factor is None else {"factor": factor}
    study = compensation_study(
        asked.model, controller_of_numbers(kp, ki), record=asked.record, noise=asked.noise,
        block=None if block is None else read_block(block), sp_step=sp_step, hold=hold, op_now=op_now, span=op_span,
        samples=samples, runs=runs, draws=draws, seed=seed, method=method, **options,
    )  # fmt: skip
    _write(study, block_out, figure, out, force)
    show(study.summary(), study.to_dict(), json)
    raise typer.Exit(0 if study.safe else 1)


def _write(study: CompensationStudy, block: Path | None, figure: Path | None, out: Path | None, force: bool) -> None:
    if figure is not None:
        study.plot().savefig(figure, dpi=120)
    for path, data in ((block, study.block.to_dict()), (out, study.to_dict())):
        if path is not None:
            write_json(path, data, force)


def _progress(line: str) -> None:
    if sys.stderr.isatty():
        typer.echo(f"simulate: {line} ..", err=True)


def _valve(
    left: float | None, right: float | None, width: float | None, band: float | None, jump: float | None
) -> Nonlinearity:
    given = [left is not None and right is not None, width is not None, band is not None]
    if sum(given) != 1:
        remedy = "give the fault once, or a file"
        raise ParameterError.expected("a file, or --left and --right, or --width, or --band", "none or several", remedy)
    if left is not None and right is not None:
        return DeadZone(left, right)
    if width is not None:
        return Backlash(width)
    assert band is not None  # noqa: S101
    return Stiction(band, band if jump is None else jump)


def _offset(valve: Nonlinearity, gain: float, op_now: float | None) -> float:
    """PV counts from where it rests with OP in the middle of its lost motion, or at `op_now`."""
    return 0.0 if isinstance(valve, DeadZone) or op_now is None or abs(gain) == float("inf") else -gain * op_now
