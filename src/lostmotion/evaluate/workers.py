"""Seeds side by side on all cores, with progress."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, TypeVar

from rich.console import Console
from rich.progress import track

from lostmotion.workers import Pool, usable_processors

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
    processes = min(processes or usable_processors(), len(jobs))
    if processes <= 1:
        return list(_watched(map(work, jobs), len(jobs), label, progress))
    with Pool(processes) as pool:
        pool.share(work)
        return list(_watched(pool.map(_called, jobs), len(jobs), label, progress))


def _called(work: Callable[[Job], Any], job: Job) -> Any:
    return work(job)


def _watched(results: Iterable[Any], total: int, label: str, progress: Progress | None) -> Iterator[Any]:
    if progress is None:
        console = Console(stderr=True, force_terminal=None)
        yield from track(results, label, total=total, console=console, disable=not sys.stderr.isatty())
        return
    for done, result in enumerate(results, 1):
        progress(done, total)
        yield result
