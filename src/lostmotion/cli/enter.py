"""Print a fresh address of the page whenever Enter is pressed in its terminal."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable

from lostmotion.cli.closed_output import echo

HINT = "Press Enter for the address of another browser, or after the window was closed. Ctrl-C ends the page."


def print_on_enter(fresh: Callable[[], str]) -> None:
    """Start to listen, and print how, where standard input is a terminal; elsewhere nothing is read.

    Parameters
    ----------
    fresh : callable
        Returns a new address.
    """
    if sys.stdin is None or not sys.stdin.isatty():
        return
    if hasattr(signal, "SIGTTIN"):  # a page that was put into the background goes on, without listening
        signal.signal(signal.SIGTTIN, signal.SIG_IGN)
    echo(HINT, err=True)
    threading.Thread(target=_listen, args=(sys.stdin.fileno(), fresh), daemon=True).start()


def _listen(terminal: int, fresh: Callable[[], str]) -> None:
    """Line by line from the descriptor itself: a thread inside `sys.stdin` would keep the program from ending."""
    try:
        while os.read(terminal, 1024):
            echo(fresh())
            sys.stdout.flush()
    except OSError:
        return
