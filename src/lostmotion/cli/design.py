"""``lostmotion design``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from lostmotion.cli.options import Force, Json, NoTime, Op, Pv, Time, refuse_existing, show
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
from lostmotion.design import achievable as achievable_of
from lostmotion.design import design as design_test
from lostmotion.design.asked import TARGETS
from lostmotion.errors import ParameterError
from lostmotion.files import read_loop, write_columns
from lostmotion.identify import FitFacts, read_fit
from lostmotion.models import DeadZone, Hammerstein, LinearModel, NoiseModel

Pair = tuple[float, float]


Fit = Annotated[Path | None, number("--fit", "Result of `identify --out`; or the numbers of a rough model below.")]
Left = Annotated[float | None, number("--left", "Guess of the left break point, in units of OP.")]
Right = Annotated[float | None, number("--right", "Guess of the right break point.")]
Ratio = Annotated[float, typer.Option("--slope-ratio", help="Slope on the left over slope on the right.")]
Dt = Annotated[float | None, number("--dt", "Sampling time in seconds, beside the numbers of a model.")]
PvNow = Annotated[float, typer.Option("--pv-now", help="PV at rest before the test, beside the numbers of a model.")]
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
Kp = Annotated[float | None, number("--kp", "Gain of the PI controller, in closed loop.")]
Ki = Annotated[float | None, number("--ki", "Integral gain of it, units of OP per unit of PV and second.")]
Spread = Annotated[float, typer.Option("--spread", help="Roughness of the numbers of a model, 0.3 is 30 %.")]
Seed = Annotated[int, typer.Option("--seed", help="Of the search; the same seed, the same test.")]
At = Annotated[Path | None, number("--achievable", "Say what this record can at best give, instead of a test.")]
Out = Annotated[Path | None, number("--out", "Write time and OP (or SP) here (csv, txt, parquet).")]
Steps = Annotated[bool, typer.Option("--steps", help="With --out: one row a move, not one a sample.")]
Figure = Annotated[Path | None, number("--figure", "Write the figure here (png, pdf or svg).")]


def design(
    fit: Fit = None,
    left: Left = None,
    right: Right = None,
    slope_ratio: Ratio = 1.0,
    gain: Gain = None,
    time_constant: Constants = None,
    integrating: Integrating = False,
    dead_time: DeadTime = 0.0,
    dt: Dt = None,
    noise_deviation: Deviation = None,
    noise_time: Memory = 0.0,
    pv_now: PvNow = 0.0,
    op_now: OpNow = None,
    op_limits: OpLimits = None,
    pv_limits: PvLimits = None,
    sp_limits: SpLimits = None,
    rate_limit: Rate = None,
    hold: Hold = None,
    duration: Duration = None,
    interval: Interval = None,
    target: Target = "width",
    loop: Loop = "open",
    kp: Kp = None,
    ki: Ki = None,
    spread: Spread = 0.3,
    seed: Seed = 0,
    achievable: At = None,
    op: Op = "OP",
    pv: Pv = "PV",
    time: Time = None,
    ignore_time: NoTime = False,
    out: Out = None,
    steps: Steps = False,
    figure: Figure = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Design the test that tells most about the dead zone, or say what a record can at best tell.

    Example: lostmotion design --left 48 --right 52 --gain 1.5 --time-constant 30 --dead-time 4 --dt 1
    --noise-deviation 0.2 --op-limits 40 60 --hold 20 --interval 0.2 --out test.csv --figure test.png

    Example: lostmotion design --fit fic101.json --achievable FIC-101.csv

    Exit code 1 where the wanted interval cannot be reached, or the record cannot tell a dead zone from none.
    """
    for path in (out, figure):
        refuse_existing(path, force)
    if fit is not None:
        model, noise = _from_fit(fit, left, right, slope_ratio)
    else:
        process = process_of(gain, time_constant or [], integrating, dead_time, dt)
        model = _model(process, left, right, slope_ratio, op_now, pv_now)
        noise = noise_of_numbers(noise_deviation, noise_time, process.dt)
    if achievable is not None:
        record = read_loop(achievable, op=op, pv=pv, time=False if ignore_time else time, dt=dt)
        answer = achievable_of(record, model, noise, spread=spread, seed=seed)
        show(answer.summary(), answer.to_dict(), json)
        raise typer.Exit(0 if answer.sees else 1)
    test = design_test(
        model, noise, op_limits=op_limits, op_now=op_now, pv_limits=pv_limits, sp_limits=sp_limits,
        rate_limit=rate_limit, shortest_hold=hold, duration=duration,
        wanted=None if interval is None else dict.fromkeys(TARGETS.get(target, ("width",)), interval),
        target=target, loop=loop, controller=controller_of_numbers(kp, ki), spread=spread, seed=seed,
        progress=_progress,
    )  # fmt: skip
    if out is not None:
        write_columns(out, test.columns(every_sample=not steps), force)
    if figure is not None:
        test.plot().savefig(figure, dpi=120)
    show(test.summary(), test.to_dict(), json)
    raise typer.Exit(0 if test.reached else 1)


def _progress(line: str) -> None:
    if sys.stderr.isatty():
        typer.echo(f"design: {line} ..", err=True)


def _from_fit(
    path: Path, left: float | None, right: float | None, slope_ratio: float
) -> tuple[FitFacts | Hammerstein, NoiseModel | None]:
    """The fit itself, or its process with break points that were guessed."""
    found = read_fit(path)
    if left is None and right is None:
        return found, None
    return Hammerstein(_zone(left, right, slope_ratio), found.linear, found.model.offset), found.noise


def _zone(left: float | None, right: float | None, slope_ratio: float) -> DeadZone:
    if left is None or right is None:
        raise ParameterError.expected("--left and --right", f"{left} and {right}", "give your guess, or --fit")
    return DeadZone(left, right, left_slope=slope_ratio)


def _model(
    process: LinearModel, left: float | None, right: float | None, slope_ratio: float, op_now: float | None, pv: float
) -> Hammerstein:
    """Offset such that PV is `pv` at rest at `op_now` (unknown: inside the dead zone)."""
    zone = _zone(left, right, slope_ratio)
    x = 0.0 if op_now is None else float(zone(op_now))
    return Hammerstein(zone, process, pv - (process.gain * x if x else 0.0))
