"""The command ``lostmotion``: thin commands over the library; exit codes in ``exit_codes``."""

from __future__ import annotations

import sys
from typing import Annotated, Any

import typer

import lostmotion
from lostmotion.cli.closed_output import SHOWN, echo, full_output
from lostmotion.cli.commands import PLAIN, Commands
from lostmotion.cli.exit_codes import ATTENTION, exit_code
from lostmotion.cli.failure import say_error
from lostmotion.cli.pairs import apart
from lostmotion.cli.progress import compiling
from lostmotion.errors import DataError, LostMotionError
from lostmotion.extras import extra
from lostmotion.kernels.compile_progress import compile_reports

app = typer.Typer(
    name="lostmotion",
    help="Find the lost motion of an actuator in the records of its control loop, and take it away.",
    cls=Commands,
    no_args_is_help=True,
    **PLAIN,
)


def _say_version(asked: bool) -> None:
    if asked:
        echo(f"lostmotion {lostmotion.__version__}")
        raise typer.Exit


NO_MEMORY = DataError.expected("room in memory", "no more of it", "cut the record, or work on a larger computer")
Version = Annotated[bool, typer.Option("--version", help="Say the version.", callback=_say_version, is_eager=True)]


@app.callback()
def _whole(version: Version = False) -> None:
    pass


def main(arguments: list[str] | None = None) -> Any:
    """Run the command line; errors of lostmotion become one line and an exit code of the table."""
    words = apart(sys.argv[1:] if arguments is None else arguments)
    SHOWN.set(False)
    try:
        return _told(words)
    except OSError as error:
        say_error(full_output(error), False, words)
        sys.exit(ATTENTION)


def _told(words: list[str]) -> Any:
    try:
        with extra(), compile_reports(compiling):
            return app(words, prog_name="lostmotion")
    except (LostMotionError, ImportError, MemoryError) as error:
        known = NO_MEMORY if isinstance(error, MemoryError) else error
        say_error(known, "--json" in words, words)
        sys.exit(exit_code(known))
