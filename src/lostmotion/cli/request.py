"""``lostmotion request``."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from lostmotion.cli.closed_output import echo
from lostmotion.cli.online import stop_on_signals
from lostmotion.cli.options import number
from lostmotion.cli.output import Json, OutputOptions
from lostmotion.cli.progress import progress
from lostmotion.errors import GateError, ParameterError

if TYPE_CHECKING:
    from threading import Event

    from lostmotion.live.plant_file import PlantFile
    from lostmotion.live.supervision.settings import BlockSettings

TAKEN, ANSWERED = 20.0, 360.0  # s until live has taken the request, and until the block has answered
LOOK = 0.2  # s between looks into the log
GOOD = ("verify", "accept")
BAD = ("not asked", "refusal", "withdraw", "failed", "lost", "shed")
Plant = Annotated[Path, typer.Argument(help="Plant file (TOML) of lostmotion live.", show_default=False)]
Tag = Annotated[str, typer.Argument(help="Loop whose block is asked.", show_default=False)]
Fit = Annotated[Path, typer.Argument(help="Result of `identify --out`, at the scan of the block.", show_default=False)]
Who = Annotated[str | None, number("--who", "Who asks; stands in the log beside the user of this machine.")]
Write = Annotated[bool, typer.Option("--write", help="Hand the request to the live --write that is at work.")]


def request(plant: Plant, tag: Tag, fit: Fit, who: Who = None, write: Write = False, json: Json = False) -> None:
    """Ask the block of a loop for the widths of a fit: first as a study, with --write in the plant.

    Example: lostmotion request plant.toml FIC101 fic101.json

    Example: lostmotion request plant.toml FIC101 fic101.json --who anna --write

    Without --write nothing is asked: the study is made and shown. With it the fit goes to the `lostmotion live --write`
    that is at work on this plant, which makes the same study, asks the block if it passes, and writes each answer into
    its log; they are shown here until the block shows the request to the operator. The exit code is 1 where it does
    not: not safe, not worth it, refused, or nobody at work.
    """
    from lostmotion.live.plant_file import read_plant_file

    said = read_plant_file(plant)
    block = _block(said, tag)
    if not write:
        _study(block, fit, json)
        return
    if not who or not any(sign.isalpha() for sign in who):
        raise ParameterError.expected("--who with a name", repr(who), "say who asks")
    with stop_on_signals() as stop:
        raise typer.Exit(0 if _asked(said, block, fit, who, json, stop) else 1)


def _block(plant: PlantFile, tag: str) -> BlockSettings:
    tags = [block.tag for block in plant.blocks if block.write]
    if tag not in tags:
        raise ParameterError.expected(f"a loop with write = true, out of {tags}", tag, "see the plant file")
    return next(block for block in plant.blocks if block.tag == tag)


def _study(block: BlockSettings, fit: Path, json: bool) -> None:
    """What the study says, and what would be asked."""
    import lostmotion as lm
    from lostmotion.live.proposal import proposal
    from lostmotion.live.supervision.studies import study_of_fit

    progress("request: simulating ..")
    study = study_of_fit(block, lm.read_fit(fit).to_dict())
    progress("")
    try:
        asked = proposal(block.block, study)
    except GateError as error:
        OutputOptions(json=json).show(f"{study.summary()}\n\nWould not be asked: {error}", _facts(study, None))
        raise typer.Exit(1) from error
    unit = block.block.settings["resolution"]
    words = ", ".join(f"{name} {unit * value:g}" for name, value in asked.to_dict().items())
    text = (
        f"{study.summary()}\n\nWould be asked of {block.name}: {words}. Nothing was asked: --who and --write do that."
    )
    OutputOptions(json=json).show(text, _facts(study, asked.to_dict()))


def _facts(study: Any, asked: dict[str, int] | None) -> dict[str, Any]:
    return {"asked": asked, "study": study.to_dict()}


def _asked(plant: PlantFile, block: BlockSettings, fit: Path, who: str, json: bool, stop: Event) -> bool:
    """Hand the request over, and show the answers; whether the operator sees it."""
    import lostmotion as lm
    from lostmotion.live.supervision.handed_over import Outbox

    supervision = plant.supervision
    if supervision is None or supervision.requests is None:
        got = "none"
        raise ParameterError.expected("requests = '..' in [supervision] of the plant file", got, "name a folder there")
    facts = lm.read_fit(fit).to_dict()
    out = Outbox(supervision.requests, block.tag)
    lines = _lines(supervision.log, block.name)
    next(lines)  # from its present end on
    out.hand_over(who, facts)
    begun, taken = time.monotonic(), False
    try:
        while not stop.is_set() and time.monotonic() - begun < (ANSWERED if taken else TAKEN):
            for line in next(lines):
                taken = taken or line.get("ask") == out.word
                if taken:
                    _show(line, json)
                    if line["event"] in (*GOOD, *BAD):
                        return line["event"] in GOOD
            stop.wait(LOOK)
    finally:
        if not taken and out.withdraw():
            echo("Nobody took the request; it is withdrawn, and nothing was asked.", err=True)
    if taken:
        echo(f"No answer yet; see {supervision.log}.", err=True)
    return False


def _lines(log: Path, name: str) -> Iterator[list[dict[str, Any]]]:
    """New lines of a block in the log, at each call; the first call only finds its end."""
    import json as json_module

    place, rest = log.stat().st_size if log.exists() else 0, b""
    yield []
    while True:
        found = []
        if log.exists():
            with log.open("rb") as stream:
                stream.seek(place)
                *whole, rest = (rest + stream.read()).split(b"\n")
                place = stream.tell()
            found = [line for text in whole if (line := json_module.loads(text or b"{}")).get("block") == name]
        yield found


def _show(line: dict[str, Any], json: bool) -> None:
    import json as json_module

    echo(json_module.dumps(line) if json else f"{line['event']} by {line['who']}: {line['answer']}")
