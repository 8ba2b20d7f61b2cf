"""Progress of a command: one line on standard error, and silence where that is no terminal."""

from __future__ import annotations

import sys
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

import lostmotion as lm
from lostmotion.cli.closed_output import echo
from lostmotion.errors import one_line

if TYPE_CHECKING:
    from lostmotion.records import LoopRecord

WHERE: ContextVar[str] = ContextVar("where", default="")  # which of several files this is


COMPILED = 150  # kernels that a first diagnosis compiles, nearly; an identification compiles a few less


def compiling(done: int) -> None:
    """Say how far compiling is, which the first command after an installation waits for."""
    progress(f"compiling for this processor, once: {done} of about {max(COMPILED, done)}")


def progress(text: str) -> None:
    """Replace the last line of a terminal by `text`; an empty text takes it away."""
    if sys.stderr.isatty():
        typer.echo("\r\x1b[K", err=True, nl=False)
        echo(one_line(f"{WHERE.get()}{text}") if text else "", err=True, end=False)


def read_with_progress(path: Path, **settings: Any) -> LoopRecord:
    """Record of a file, see :func:`lostmotion.read_loop`; a long file shows how far it is."""
    from lostmotion.files.watch import watched

    with watched(progress):
        record = lm.read_loop(path, **settings)
    progress("")
    return record
