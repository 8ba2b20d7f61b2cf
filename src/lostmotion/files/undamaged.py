"""Readers that others wrote: whatever they do with damaged bytes becomes one error, and nothing else is said."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext

from lostmotion.errors import DataError, LostMotionError

_OWN = (LostMotionError, KeyboardInterrupt, SystemExit, GeneratorExit)
LONGEST = 200  # characters of what a reader says


@contextmanager
def undamaged(expected: str, source: str, remedy: str, quiet: bool = True) -> Iterator[None]:
    """Any error inside becomes a DataError, panics of Rust too, which are no exceptions and write to standard error.

    Parameters
    ----------
    expected, remedy : str
        As in :meth:`lostmotion.errors.InputError.expected`.
    source : str
        Name of the file.
    quiet : bool
        Send standard error nowhere meanwhile.

    Raises
    ------
    DataError

    Examples
    --------
    >>> with undamaged("a whole file", "a.zip", "pack it"):
    ...     raise IndexError("out of range")
    Traceback (most recent call last):
    ...
    lostmotion.errors.DataError: expected a whole file, got a damaged one, 'a.zip' (out of range); pack it
    """
    try:
        with _silent() if quiet else nullcontext():
            yield
    except _OWN:
        raise
    except MemoryError as error:
        raise DataError.expected(expected, f"more than there is memory for in {source!r}", "cut the export") from error
    except BaseException as error:
        reason = str(error).strip().split("\n", maxsplit=1)[0][:LONGEST] or type(error).__name__
        raise DataError.expected(expected, f"a damaged one, {source!r} ({reason})", remedy) from error


@contextmanager
def _silent() -> Iterator[None]:
    """Nothing reaches standard error meanwhile, not of libraries either."""
    try:
        kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    except OSError:  # there is none
        yield
        return
    os.dup2(nowhere, 2)
    os.close(nowhere)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
