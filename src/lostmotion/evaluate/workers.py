"""Seeds side by side on all cores, with progress."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import Any, TypeVar

from rich.console import Console
from rich.progress import track

Job = TypeVar("Job")
Progress = Callable[[int, int], None]


def run_all(
    work: Callable[[Job], Any],
    jobs: Sequence[Job],
    label: str,
    processes: int | None = None,
    progress: Progress | None = None,
) -> list[Any]:
    """Results of `work` for all jobs in their order.

    `progress` is called with the number done and the number of all; without it there is a bar on stderr where that
    is a terminal.
    """
    processes = min(processes or os.cpu_count() or 1, len(jobs))
    if processes <= 1:
        return list(_watched((work(job) for job in jobs), len(jobs), label, progress))
    with ProcessPoolExecutor(processes) as pool:
        return list(_watched(pool.map(work, jobs), len(jobs), label, progress))


def _watched(results: Iterable[Any], total: int, label: str, progress: Progress | None) -> Iterator[Any]:
    if progress is None:
        console = Console(stderr=True, force_terminal=None)
        yield from track(results, label, total=total, console=console, disable=not sys.stderr.isatty())
        return
    for done, result in enumerate(results, 1):
        progress(done, total)
        yield result
