"""``lostmotion design``."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import lostmotion as lm
from lostmotion.cli.gate import GateOptions
from lostmotion.cli.options import ColumnOptions, number
from lostmotion.cli.output import Figure, OutputOptions
from lostmotion.cli.progress import progress
from lostmotion.cli.rough_model import ControllerOptions, RoughModel
from lostmotion.errors import ParameterError
from lostmotion.files import write_columns

if TYPE_CHECKING:
    from lostmotion.identify import FitFacts
    from lostmotion.models import DeadZone, Hammerstein, LinearModel, NoiseModel

Pair = tuple[float, float]

Fit = Annotated[Path | None, number("--fit", "Result of `identify --out`; or the numbers of a rough model below.")]
Left = Annotated[float | None, number("--left", "Guess of the left break point, in units of OP.")]
Right = Annotated[float | None, number("--right", "Guess of the right break point.")]
Ratio = Annotated[float, typer.Option("--slope-ratio", help="Slope on the left over slope on the right.")]
PvNow = Annotated[float | None, number("--pv-now", "PV at rest before the test; default: 0, or that of the fit.")]
OpNow = Annotated[float | None, number("--op-now", "OP at rest before the test; default: said in the result.")]
OpLimits = Annotated[Pair | None, number("--op-limits", "What OP must not leave, e.g. 40 60.")]
PvLimits = Annotated[Pair | None, number("--pv-limits", "What PV must not leave.")]
SpLimits = Annotated[Pair | None, number("--sp-limits", "Range of SP, in closed loop.")]
Rate = Annotated[float | None, number("--rate-limit", "Fastest move, units per second.")]
Hold = Annotated[float | None, number("--hold", "Shortest time in seconds for which a level is kept.")]
Duration = Annotated[float | None, number("--duration", "Seconds; with a wanted interval the most.")]
Interval = Annotated[float | None, number("--interval", "Wanted half-width of the 95 % interval, in units of OP.")]
Target = Annotated[str, typer.Option("--target", help='Of what: "width" or "break points".')]
Loop = Annotated[str, typer.Option("--loop", help='"open" (steps of OP) or "closed" (steps of SP).')]
Spread = Annotated[float, typer.Option("--spread", help="Roughness of the numbers of a model, 0.3 is 30 %.")]
Seed = Annotated[int, typer.Option("--seed", help="Of the search; the same seed, the same test.")]
At = Annotated[Path | None, number("--achievable", "Say what this record can at best give, instead of a test.")]
Out = Annotated[Path | None, number("--out", "Write time and OP (or SP) here (csv, txt, parquet).")]
Steps = Annotated[bool, typer.Option("--steps", help="With --out: one row a move, not one a sample.")]


@dataclass(frozen=True)
class GuessOptions:
    """What is thought of the valve, and where the loop rests."""

    left: Left = None
    right: Right = None
    slope_ratio: Ratio = 1.0
    pv_now: PvNow = None
    op_now: OpNow = None


@dataclass(frozen=True)
class LimitOptions:
    """What the operator allows."""

    op_limits: OpLimits = None
    pv_limits: PvLimits = None
    sp_limits: SpLimits = None
    rate_limit: Rate = None
    hold: Hold = None
    duration: Duration = None

    def given(self) -> dict[str, Any]:
        """Arguments of :func:`lostmotion.design`."""
        limits = asdict(self)
        return limits | {"shortest_hold": limits.pop("hold")}


@dataclass(frozen=True)
class GoalOptions:
    """What the test is for, and how it is sought."""

    interval: Interval = None
    target: Target = "width"
    loop: Loop = "open"
    spread: Spread = 0.3
    seed: Seed = 0

    def given(self) -> dict[str, Any]:
        """Arguments of :func:`lostmotion.design`."""
        from lostmotion.design.request import TARGETS

        goal = asdict(self)
        interval = goal.pop("interval")
        parameters = TARGETS.get(self.target, ("width",))
        return goal | {"wanted": None if interval is None else dict.fromkeys(parameters, interval)}


@dataclass(frozen=True)
class WrittenOptions:
    """Files to write."""

    out: Out = None
    steps: Steps = False
    figure: Figure = None


def design(
    fit: Fit = None,
    achievable: At = None,
    *,
    written: WrittenOptions,
    guess: GuessOptions,
    rough: RoughModel,
    pi: ControllerOptions,
    limits: LimitOptions,
    goal: GoalOptions,
    gate: GateOptions,
    columns: ColumnOptions,
    output: OutputOptions,
) -> None:
    """Design the test that tells most about the dead zone, or say what a record can at best tell.

    Example: lostmotion design --left 48 --right 52 --gain 1.5 --time-constant 30 --dead-time 4 --dt 1
    --noise-deviation 0.2 --op-limits 40 60 --hold 20 --interval 0.2 --out test.csv --figure test.png

    Example: lostmotion design --model loop.toml --op-limits 40 60 --hold 20 --interval 0.2

    Example: lostmotion design --fit fic101.json --achievable FIC-101.csv

    Exit code 1 where the wanted interval cannot be reached, the record cannot tell a dead zone from none, or the fit
    does not show one (give your guess with --left and --right, or --accept REASON). A process that integrates needs
    --pv-limits.
    """
    output.refuse(figures=(written.figure,), table=written.out)
    opened = gate.given()
    if fit is not None:
        model, noise = _from_fit(fit, guess, opened["accept"])
    else:
        model, noise = _of_numbers(guess, rough)
    if achievable is not None:
        answer = lm.achievable(columns.read(achievable), model, noise, spread=goal.spread, seed=goal.seed, **opened)
        output.show(answer.summary(), answer.to_dict())
        raise typer.Exit(0 if answer.sees else 1)
    test = lm.design(
        model, noise, op_now=guess.op_now, pv_now=guess.pv_now, controller=pi.controller, progress=_progress,
        **limits.given(), **goal.given(), **opened,
    )  # fmt: skip
    output.show(test.summary(), test.to_dict())
    if written.out is not None:
        write_columns(written.out, test.columns(every_sample=not written.steps), output.force)
    output.write_figure(written.figure, test)
    raise typer.Exit(0 if test.reached else 1)


def _progress(line: str) -> None:
    progress(f"design: {line} ..")


def _of_numbers(guess: GuessOptions, rough: RoughModel) -> tuple[Hammerstein, NoiseModel]:
    model = _model(rough.process, guess.left, guess.right, guess.slope_ratio, guess.op_now, guess.pv_now or 0.0)
    return model, rough.noise


def _from_fit(path: Path, guess: GuessOptions, accept: str | None) -> tuple[FitFacts | Hammerstein, NoiseModel | None]:
    """The fit itself, or its process with break points that were guessed."""
    from lostmotion.compensate.gate import pass_process

    found = lm.read_fit(path)
    if guess.left is None and guess.right is None:
        return found, None
    pass_process(found, accept)
    zone = _zone(guess.left, guess.right, guess.slope_ratio)
    offset = found.model.offset
    if not found.linear.integrates():  # PV at rest stays that of the fit, whose x is not 0 inside the guess
        op = 0.5 * (zone.left + zone.right) if guess.op_now is None else guess.op_now
        x = op if found.kind.sticks else float(found.model.nonlinearity(op))
        offset += found.linear.gain * (x - float(zone(op)))
    return lm.Hammerstein(zone, found.linear, offset), found.noise


def _zone(left: float | None, right: float | None, slope_ratio: float) -> DeadZone:
    if left is None or right is None:
        raise ParameterError.expected("--left and --right", f"{left} and {right}", "give your guess, or --fit")
    return lm.DeadZone(left, right, left_slope=slope_ratio)


def _model(
    process: LinearModel, left: float | None, right: float | None, slope_ratio: float, op_now: float | None, pv: float
) -> Hammerstein:
    """Offset such that PV is `pv` at rest at `op_now` (unknown: inside the dead zone)."""
    zone = _zone(left, right, slope_ratio)
    x = 0.0 if op_now is None else float(zone(op_now))
    return lm.Hammerstein(zone, process, pv - (process.gain * x if x else 0.0))
