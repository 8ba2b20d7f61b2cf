"""An error as a command tells it: one line on standard error, and with --json an object on standard output."""

from __future__ import annotations

import json

import typer

from lostmotion.cli.progress import progress
from lostmotion.cli.wording import message
from lostmotion.errors import LostMotionError


def say_error(error: LostMotionError | ImportError, as_json: bool) -> None:
    """Tell it."""
    progress("")
    said = message(error)
    if isinstance(error, LostMotionError) and as_json:
        typer.echo(json.dumps({"error": type(error).__name__, "message": said}))
    typer.echo(f"error: {said}", err=True)
