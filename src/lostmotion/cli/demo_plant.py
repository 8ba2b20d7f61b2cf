"""``lostmotion demo-plant``."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Annotated, Any

import typer

from lostmotion.cli.output import Force, PrintOptions
from lostmotion.cli.progress import progress
from lostmotion.printable import shell_word

if TYPE_CHECKING:
    from lostmotion.evaluate.plants import LoopTruth

Folder = Annotated[Path, typer.Argument(metavar="FOLDER", help="Where the files go; made.", show_default=False)]
Loops = Annotated[int, typer.Option("--loops", help="Loops, in areas of six to fourteen.")]
Days = Annotated[float, typer.Option("--days", help="Days recorded.")]
Faults = Annotated[int, typer.Option("--faults", min=0, max=10_000, help="Loops with a fault.")]
Moves = Annotated[float, typer.Option("--moves", min=0, max=10_000, help="New set points a day of each loop, about.")]
Swings = Annotated[int, typer.Option("--swings", help="Oscillations from outside, that reach one to three loops.")]
Dt = Annotated[float, typer.Option("--dt", help="Seconds between rows.")]
Seed = Annotated[int, typer.Option("--seed", help="The same seed, the same plant.")]
Format = Annotated[str, typer.Option("--format", help='"parquet", or "csv", five times as large.')]


LIST, TRUTH = "loops.csv", "truth.csv"
WIDTH = 100  # characters of a line
SOME = (
    "What to expect: the audit names about two of three faulty valves with their size, and blames no healthy one. A "
    'quarter to three quarters of the loops stay "cannot tell", for the reasons of a real plant: lost motion that is '
    "small beside the disturbances, an oscillation that comes from elsewhere, few moves of the set point, signals "
    "that were compressed, rounded or frozen, a loop in manual."
)
NONE = (
    "What to expect: nearly all loops stay undecided. No set point moves, so only feedback moves OP, and such data do "
    "not identify the valve."
)


@dataclass(frozen=True)
class PlantOptions:
    """What the plant is like."""

    loops: Loops = 12
    days: Days = 1.0
    faults: Faults = 4
    moves: Moves = 24.0
    swings: Swings = 1
    dt: Dt = 1.0
    seed: Seed = 2


def demo_plant(
    folder: Folder,
    format: Format = "parquet",  # noqa: A002  the word of the option
    *,
    plant: PlantOptions,
    force: Force = False,
    output: PrintOptions,
) -> None:
    """Make a plant to try an audit on: a file a loop, a list of the loops, and the truth beside them.

    Example: lostmotion demo-plant plant --loops 50 --days 2

    Flows, pressures, levels and temperatures disturb each other through streams, headers and a recycle; operators and
    recipes move set points several times a shift, and take loops into manual; a historian rounds, compresses and loses.
    Some loops have a fault: lost motion of 1.5 to 8 % of span, tuning near the limit of stability, a bad sensor.
    `loops.csv` is the list of the loops. The answer key is `truth.csv`: the fault of each loop, and the source of its
    oscillation.
    """
    from lostmotion.evaluate.plants import random_plant
    from lostmotion.evaluate.plants.spread import with_spread
    from lostmotion.evaluate.plants.written import refuse, write_plant

    made = random_plant(
        plant.seed, plant.loops, plant.days, plant.faults, swings=plant.swings, dt=plant.dt, moves=plant.moves
    )
    refuse(folder, made, format, force)
    made.simulate(_told("simulating"))
    progress("demo-plant: finding the source of each oscillation ..")
    truth = with_spread(made)
    files = write_plant(folder, made, truth, format, _told("writing"))
    written = {"folder": str(folder), "files": [str(one) for one in files]}
    output.show(_summary(folder, truth, plant), written | _found(truth))


def _told(doing: str) -> Any:
    return lambda share: progress(f"demo-plant: {doing} {100 * share:.0f} % ..")


def _found(truth: tuple[LoopTruth, ...]) -> dict[str, Any]:
    return {"faults": [asdict(one) for one in truth if one.fault != "none"], "loops": len(truth)}


def _summary(folder: Path, truth: tuple[LoopTruth, ...], plant: PlantOptions) -> str:
    swinging = sum(bool(one.swings_with) for one in truth)
    days = f"{plant.days:g} day{'s' if plant.days != 1.0 else ''}"
    paragraphs = (
        f"{len(truth)} loops in {folder}, {days}, a row each {plant.dt:g} s: {_faults(truth)}; {swinging} loops "
        f"oscillate. The list of the loops is {LIST}. The answer key is {TRUTH}.",
        SOME if plant.moves else NONE,
    )
    place, list_ = shell_word(str(folder)), shell_word(str(folder / LIST))
    return "\n".join(
        [
            *(fill(one, WIDTH) for one in paragraphs),
            f"Next: lostmotion audit {place} --loops {list_} --report plant.html",
            "Then: lostmotion serve plant.db",
        ]
    )


def _faults(truth: tuple[LoopTruth, ...]) -> str:
    """Number of each kind of fault."""
    found = Counter(one.fault for one in truth if one.fault != "none")
    ordered = sorted(found.items(), key=lambda one: (-one[1], one[0]))
    return ", ".join(f"{count} x {fault}" for fault, count in ordered) or "no fault"
