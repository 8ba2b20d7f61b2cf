"""How far the reading of a long file is, for whoever wants to know."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

LONG = 1 << 25  # bytes: less is read in a second or two

_WATCHER: ContextVar[Callable[[str], None] | None] = ContextVar("watcher", default=None)


@contextmanager
def watched(by: Callable[[str], None]) -> Iterator[None]:
    """Call `by` with a few words now and then while a long file is read.

    Examples
    --------
    >>> with watched(print):
    ...     tell("rows", 1, 4)
    rows: 25 %
    >>> tell("rows", 2, 4)
    """
    before = _WATCHER.set(by)
    try:
        yield
    finally:
        _WATCHER.reset(before)


def tell(what: str, done: int, total: int) -> None:
    """Say how much of something is done."""
    watcher = _WATCHER.get()
    if watcher is not None:
        watcher(f"{what}: {100 * done // max(total, 1)} %")
