"""The command ``lostmotion``: thin commands over the library.

Exit codes: 0 done, 1 a finding that needs you or a failure, 2 wrong usage.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import typer

from lostmotion.cli.check import check
from lostmotion.cli.compensate import compensate
from lostmotion.cli.design import design
from lostmotion.cli.diagnose import diagnose
from lostmotion.cli.export import export
from lostmotion.cli.identify import identify
from lostmotion.cli.online import online
from lostmotion.cli.paper import paper
from lostmotion.cli.simulate import simulate
from lostmotion.cli.wording import message
from lostmotion.errors import LostMotionError

app = typer.Typer(
    name="lostmotion",
    help="Find the lost motion of an actuator in the records of its control loop, and take it away.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
for command in (check, diagnose, identify, compensate, simulate, design, export, online, paper):
    app.command()(command)


def main(arguments: list[str] | None = None) -> Any:
    """Run the command line; errors of lostmotion become one line and exit code 1."""
    words = sys.argv[1:] if arguments is None else arguments
    try:
        return app(words, prog_name="lostmotion")
    except LostMotionError as error:
        said = message(error, _options(words))
        if "--json" in words:
            typer.echo(json.dumps({"error": type(error).__name__, "message": said}))
        typer.echo(f"error: {said}", err=True)
        sys.exit(1)
    except ImportError as error:
        typer.echo(f"error: {error}", err=True)
        sys.exit(1)


def _options(words: list[str]) -> set[str]:
    """Options of the command that was typed."""
    commands = getattr(typer.main.get_command(app), "commands", {})
    typed = next((commands[word] for word in words if word in commands), None)
    return {option for parameter in typed.params for option in parameter.opts} if typed else set()
