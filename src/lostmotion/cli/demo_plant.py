"""``lostmotion demo-plant``."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from lostmotion.cli.output import Force, PrintOptions
from lostmotion.cli.progress import progress

if TYPE_CHECKING:
    from lostmotion.evaluate.plants import LoopTruth

Folder = Annotated[Path, typer.Argument(metavar="FOLDER", help="Where the files go; made.", show_default=False)]
Loops = Annotated[int, typer.Option("--loops", help="Loops, in areas of six to fourteen.")]
Days = Annotated[float, typer.Option("--days", help="Days recorded.")]
Faults = Annotated[int, typer.Option("--faults", help="Loops with a fault: of valve, tuning or sensor.")]
Swings = Annotated[int, typer.Option("--swings", help="Oscillations from outside, that reach one to three loops.")]
Dt = Annotated[float, typer.Option("--dt", help="Seconds between rows.")]
Seed = Annotated[int, typer.Option("--seed", help="The same seed, the same plant.")]
Format = Annotated[str, typer.Option("--format", help='"parquet", or "csv", five times as large.')]


@dataclass(frozen=True)
class PlantOptions:
    """What the plant is like."""

    loops: Loops = 50
    days: Days = 2.0
    faults: Faults = 10
    swings: Swings = 1
    dt: Dt = 1.0
    seed: Seed = 1


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

    Flows, pressures, levels and temperatures disturb each other through streams, headers and a recycle; operators move
    set points and take loops into manual; a historian rounds, compresses and loses. Some loops have a fault: lost
    motion of 1 to 8 % of span, tuning near the limit of stability, a bad sensor. `loops.csv` is the list of the loops,
    `truth.csv` says what is wrong with which, and what swings because of what.
    """
    from lostmotion.evaluate.plants import random_plant
    from lostmotion.evaluate.plants.spread import with_spread
    from lostmotion.evaluate.plants.written import refuse, write_plant

    made = random_plant(
        plant.seed, plant.loops, plant.days, plant.faults, swings=plant.swings, dt=plant.dt
    )  # fmt: skip
    refuse(folder, made, format, force)
    made.simulate(_told("simulating"))
    progress("demo-plant: finding what swings with what ..")
    truth = with_spread(made)
    files = write_plant(folder, made, truth, format, _told("writing"))
    output.show(_summary(folder, truth), {"folder": str(folder), "files": [str(one) for one in files]} | _found(truth))


def _told(doing: str) -> Any:
    return lambda share: progress(f"demo-plant: {doing} {100 * share:.0f} % ..")


def _found(truth: tuple[LoopTruth, ...]) -> dict[str, Any]:
    return {"faults": [asdict(one) for one in truth if one.fault != "none"], "loops": len(truth)}


def _summary(folder: Path, truth: tuple[LoopTruth, ...]) -> str:
    ill = [one for one in truth if one.fault != "none"]
    swinging = sum(bool(one.swings_with) for one in truth)
    return "\n".join(
        [
            f"{len(truth)} loops in {folder}, {len(ill)} with a fault, {swinging} that swing; the list is loops.csv.",
            "What is wrong with which stands in truth.csv; look there last.",
            f"Next: lostmotion audit {folder} --loops {folder / 'loops.csv'} --report plant.html",
        ]
    )
