"""Progress of a command: one line on standard error, and silence where that is no terminal."""

from __future__ import annotations

import sys

import typer


def progress(text: str) -> None:
    """Replace the last line of a terminal by `text`; an empty text takes it away."""
    if sys.stderr.isatty():
        typer.echo(f"\r\x1b[K{text}", err=True, nl=False)
