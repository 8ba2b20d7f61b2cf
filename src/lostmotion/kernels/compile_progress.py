"""How far the compiling of the kernels is, for those who want to show it; needs no Numba before there is some."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

Report = Callable[[int], None]
_REPORTS: list[Report] = []


@contextmanager
def compile_reports(report: Report) -> Iterator[None]:
    """Call `report` with the number of kernels compiled so far in this process, as each of them begins."""
    _REPORTS.append(report)
    try:
        yield
    finally:
        _REPORTS.remove(report)


def count_compiled() -> None:
    """Begin to count; called once, when Numba is loaded."""
    from numba.core import event  # noqa: PLC0415  half a second

    class Counter(event.Listener):
        done = 0

        def on_start(self, event: Any) -> None:
            if event.data["dispatcher"].py_func.__module__.startswith("lostmotion.kernels"):
                Counter.done += 1
                for report in _REPORTS:
                    report(Counter.done)

        def on_end(self, event: Any) -> None:
            pass

    event.register("numba:compile", Counter())  # type: ignore[no-untyped-call]
