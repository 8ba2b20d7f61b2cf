"""``lostmotion demo``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from lostmotion.cli.closed_output import echo
from lostmotion.cli.output import Force
from lostmotion.extras import MissingExtraError, extra, need_extra
from lostmotion.printable import shell_word

SAMPLES = 6000
LOOPS = 20  # simulated ones, for a mean error of 1 %
Folder = Annotated[Path, typer.Argument(metavar="FOLDER", help="Where the files go; made.", show_default=False)]


def demo(folder: Folder, force: Force = False) -> None:
    """Go the whole way on a simulated loop: record, check, identify, compensate, figure, and the loop before and after.

    Example: lostmotion demo lostmotion-demo

    The level tank of the ICINCO 2010 paper is simulated into a CSV; the commands that are shown work on it. The figure
    needs the extra plot; everything else works without.
    """
    import lostmotion as lm
    from lostmotion.files.writer import refuse

    files = [folder / f"LIC-101{ending}" for ending in (".csv", ".json", ".png", "-compensated.csv")]
    for file in files:
        refuse(file, force)
    record, fit, figure, compensated = files
    echo(f"Simulating {SAMPLES / 10:g} s of the level tank in routine operation (dead zone -1 .. 1, slopes 3).")
    _record(record, force)
    again = ("--force",) if force else ()
    gain = f"{lm.platforms.level_tank().linear.gain:.4f}"
    drawn: tuple[str, ...] = ("--figure", str(figure))
    missing = ""
    try:
        with extra("plot"):
            need_extra("plot")
    except MissingExtraError as error:
        drawn, missing = (), f"No figure: {error}"
    _run("check", str(record))
    _run("identify", str(record), "--gain", gain, "--out", str(fit), *drawn, *again)
    _run("compensate", str(record), "--fit", str(fit), "--out", str(compensated), *again)
    _before_and_after(fit)
    echo(f"\n{missing or f'Figure: {figure}'}")


def _record(path: Path, force: bool) -> None:
    import numpy as np

    import lostmotion as lm
    from lostmotion.files import write_columns

    loop = lm.routine_operation(SAMPLES, drift="mild", seed=7)
    columns = {"time_s": loop.time, "SP": loop.reference, "PV": loop.measured, "OP": loop.command}
    write_columns(path, {name: np.round(values, 5) for name, values in columns.items()}, force=force)


def _run(*words: str) -> None:
    """Show a command and run it, as if it had been typed."""
    from lostmotion.cli import app

    echo(f"\n$ lostmotion {' '.join(map(shell_word, words))}")
    code = app(list(words), prog_name="lostmotion", standalone_mode=False)
    if code:
        raise typer.Exit(code)


def _before_and_after(fit: Path) -> None:
    """The loop under the paper's load, without and with the identified inverse."""
    import numpy as np

    import lostmotion as lm
    from lostmotion.simulate.routine import PAPER_PI

    found = lm.DeadZone.from_dict(json.loads(fit.read_text(encoding="utf-8"))["model"]["nonlinearity"])
    tank = lm.platforms.level_tank()
    reference = np.repeat([0.0, -1.0, 1.0], [200, 400, 400])
    cases = (
        ("valve without fault", lm.Hammerstein(lm.Identity(), tank.linear), None),
        ("dead zone", tank, None),
        ("dead zone, compensated", tank, lm.DeadZoneCompensator.from_dead_zone(found)),
    )
    echo("\nSet point 0, -1, +1 %, white noise; mean absolute error of the level:")
    for name, plant, block in cases:
        loops = [
            lm.simulate_loop(plant, PAPER_PI, reference, compensator=block, noise=0.03, seed=seed)
            for seed in range(LOOPS)
        ]
        error = np.mean([np.mean(np.abs(loop.reference - loop.output)) for loop in loops])
        echo(f"  {name:24} {error:.3f}")
