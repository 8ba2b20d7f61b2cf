"""The command ``lostmotion``: thin commands over the library.

Exit codes: 0 done, 1 a finding that needs you or a failure, 2 wrong usage.
"""

from __future__ import annotations

import json
import sys
from typing import Annotated, Any

import typer

import lostmotion
from lostmotion.cli.commands import PLAIN, Commands
from lostmotion.cli.progress import progress
from lostmotion.cli.wording import message
from lostmotion.errors import LostMotionError

app = typer.Typer(
    name="lostmotion",
    help="Find the lost motion of an actuator in the records of its control loop, and take it away.",
    cls=Commands,
    no_args_is_help=True,
    **PLAIN,
)


def _say_version(asked: bool) -> None:
    if asked:
        typer.echo(f"lostmotion {lostmotion.__version__}")
        raise typer.Exit


Version = Annotated[bool, typer.Option("--version", help="Say the version.", callback=_say_version, is_eager=True)]


@app.callback()
def _whole(version: Version = False) -> None:
    pass


def main(arguments: list[str] | None = None) -> Any:
    """Run the command line; errors of lostmotion become one line and exit code 1."""
    words = sys.argv[1:] if arguments is None else arguments
    try:
        return app(words, prog_name="lostmotion")
    except (LostMotionError, ImportError) as error:
        _say_error(error, words)
        sys.exit(1)


def _say_error(error: LostMotionError | ImportError, words: list[str]) -> None:
    """One line on standard error, and with --json an object on standard output."""
    progress("")
    said = message(error)
    if isinstance(error, LostMotionError) and "--json" in words:
        typer.echo(json.dumps({"error": type(error).__name__, "message": said}))
    typer.echo(f"error: {said}", err=True)
