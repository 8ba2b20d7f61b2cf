"""``lostmotion simulate``."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import lostmotion as lm
from lostmotion.cli.gate import GateOptions
from lostmotion.cli.options import RecordOptions, number
from lostmotion.cli.origin import saved_block
from lostmotion.cli.output import Figure, Out, OutputOptions
from lostmotion.cli.progress import progress
from lostmotion.cli.rough_model import ControllerOptions, RoughModel
from lostmotion.errors import ParameterError

if TYPE_CHECKING:
    from lostmotion.models import NoiseModel, Nonlinearity
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
Step = Annotated[float | None, number("--sp-step", "Steps of the set point of this size, instead of the record's.")]
Hold = Annotated[float | None, number("--hold", "Seconds for which each step is held; default: a tenth of the run.")]
OpNow = Annotated[float | None, number("--op-now", "OP at rest, where the set point is constant.")]
Factor = Annotated[float | None, number("--factor", "Share to compensate; default: from the interval of the fit.")]
Method = Annotated[str, typer.Option("--method", help='Stiction: "knocker" or "two moves".')]
Block = Annotated[Path | None, number("--block", "Block as JSON, instead of the one that the rules make.")]
BlockOut = Annotated[Path | None, number("--block-out", "Write the block here as JSON, for `export`.")]
Samples = Annotated[int, typer.Option("--samples", max=10_000_000, help="Length of a run, where no record gives it.")]
Runs = Annotated[int, typer.Option("--runs", max=10_000, help="Runs with other noise.")]
Draws = Annotated[int, typer.Option("--draws", max=10_000, help="Plants drawn from the uncertainty of the fit.")]
Seed = Annotated[int, typer.Option("--seed", help="Of noise and plants; the same seed, the same result.")]


@dataclass(frozen=True)
class SoughtOptions:
    """What is sought in a record, and what is known of it."""

    nonlinearity: Kind = "auto"
    known_gain: KnownGain = None


@dataclass(frozen=True)
class FaultOptions:
    """Fault of a valve, from its numbers."""

    left: Left = None
    right: Right = None
    width: Width = None
    band: Band = None
    jump: Jump = None


@dataclass(frozen=True)
class StudyOptions:
    """What is simulated, and how often."""

    sp_step: Step = None
    hold: Hold = None
    op_now: OpNow = None
    factor: Factor = None
    method: Method = "knocker"
    samples: Samples = 4000
    runs: Runs = 10
    draws: Draws = 20
    seed: Seed = 0

    def given(self) -> dict[str, Any]:
        """Arguments of :func:`lostmotion.compensation_study`."""
        return {name: value for name, value in asdict(self).items() if name != "factor" or value is not None}


@dataclass(frozen=True)
class WrittenOptions:
    """Files to write."""

    block_out: BlockOut = None
    figure: Figure = None
    out: Out = None


@dataclass(frozen=True)
class _Asked:
    """What is to be studied."""

    model: Any
    record: LoopRecord | None = None
    noise: NoiseModel | None = None


def simulate(
    file: Source = None,
    record: Record = None,
    block: Block = None,
    *,
    rough: RoughModel,
    fault: FaultOptions,
    pi: ControllerOptions,
    columns: RecordOptions,
    sought: SoughtOptions,
    study: StudyOptions,
    gate: GateOptions,
    written: WrittenOptions,
    output: OutputOptions,
) -> None:
    """Simulate the loop without, with and with mis-estimated compensation, before anything is downloaded.

    Example: lostmotion simulate FIC-101.csv --figure fic101.png --block-out fy101.json

    Example: lostmotion simulate fic101.json --kp 0.8 --ki 0.05 --sp-step 2

    Example: lostmotion simulate --width 2 --gain 1.5 --time-constant 30 --dead-time 4 --dt 1 --noise-deviation 0.1
    --kp 1 --ki 0.03; or with these numbers in a file: lostmotion simulate --model loop.toml

    Exit code 1 where the block is not safe with the present controller: on some plant within the uncertainty the error
    gets larger than without, or the limit cycle does and a clearly smaller error does not outweigh it (a somewhat
    larger cycle, or a valve that travels little more); and where the fit does not show the lost motion, the diagnosis
    says something else, or the model does not reproduce the record, unless --accept REASON says why to go on.
    """
    output.refuse(written.block_out, written.out, figures=(written.figure,))
    if file is None:
        asked = _of_numbers(fault, rough, study.op_now)
    elif file.suffix.lower() == ".json":
        asked = _Asked(lm.read_fit(file), None if record is None else columns.read(record))
    else:
        loop = columns.read(file)
        progress(f"simulate: identifying {file} ..")
        asked = _Asked(lm.identify(loop, nonlinearity=sought.nonlinearity, gain=sought.known_gain), loop)
    progress("simulate: simulating ..")
    answer = lm.compensation_study(
        asked.model, pi.controller, record=asked.record, noise=asked.noise, span=columns.op_span,
        block=None if block is None else lm.read_block(block), **study.given(), **gate.given(),
    )  # fmt: skip
    output.show(answer.summary(), answer.to_dict())
    fit = asked.model if block is None and file is not None else None
    output.write_json(written.block_out, saved_block(answer.block, fit, block))
    output.write_json(written.out, answer.to_dict())
    output.write_figure(written.figure, answer)
    raise typer.Exit(0 if answer.safe else 1)


def _of_numbers(fault: FaultOptions, rough: RoughModel, op_now: float | None) -> _Asked:
    valve = _valve(**asdict(fault))
    process = rough.process
    return _Asked(lm.Hammerstein(valve, process, _offset(valve, process.gain, op_now)), noise=rough.noise)


def _valve(
    left: float | None, right: float | None, width: float | None, band: float | None, jump: float | None
) -> Nonlinearity:
    given = [left is not None and right is not None, width is not None, band is not None]
    if sum(given) != 1:
        remedy = "give the fault once, or a file"
        raise ParameterError.expected("a file, or --left and --right, or --width, or --band", "none or several", remedy)
    if left is not None and right is not None:
        return lm.DeadZone(left, right)
    if width is not None:
        return lm.Backlash(width)
    assert band is not None  # noqa: S101
    return lm.Stiction(band, band if jump is None else jump)


def _offset(valve: Nonlinearity, gain: float, op_now: float | None) -> float:
    """PV counts from where it rests with OP in the middle of its lost motion, or at `op_now`."""
    return 0.0 if isinstance(valve, lm.DeadZone) or op_now is None or abs(gain) == float("inf") else -gain * op_now
