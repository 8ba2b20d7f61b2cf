"""Standard output that nobody reads any more, or that lies on a full disk."""

from __future__ import annotations

import os
import sys
from contextvars import ContextVar

import typer

from lostmotion.errors import FileAccessError
from lostmotion.printable import printable

SHOWN: ContextVar[bool] = ContextVar("shown", default=False)  # JSON of a result is on standard output


def echo(text: str, *, err: bool = False, end: bool = True) -> None:
    """Print, on standard error or standard output, what a terminal can only show: the one place where commands do."""
    typer.echo(printable(text), err=err, nl=end)


def echo_data(text: str) -> None:
    """Print what is read again as it stands; a terminal gets what it can only show."""
    typer.echo(printable(text) if sys.stdout.isatty() else text, nl=False)


def say(text: str, end: bool = True) -> None:
    """Print; where nobody reads on the work goes on, for its files and its exit code."""
    try:
        echo(text, end=end)
    except BrokenPipeError:
        no_more_output()


def no_more_output() -> None:
    """Send what is still to be said nowhere, so that Python does not complain about it at its end."""
    try:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
    except (OSError, ValueError):
        return


def full_output(error: OSError) -> FileAccessError:
    """The error of a write to standard output; files have theirs told by the writer.

    Raises
    ------
    OSError
        It is another one.
    """
    import errno

    if error.errno not in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF):
        raise error
    no_more_output()
    return FileAccessError(f"expected room on standard output, got {error.strerror!r}; free some, or send it elsewhere")
