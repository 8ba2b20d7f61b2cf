"""Seeds side by side on all cores, with progress."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import Any, TypeVar

from rich.console import Console
from rich.progress import track

Job = TypeVar("Job")


def run_all(work: Callable[[Job], Any], jobs: Sequence[Job], label: str, processes: int | None = None) -> list[Any]:
    """Results of `work` for all jobs in their order; a bar on stderr where that is a terminal."""
    console = Console(stderr=True, force_terminal=None)
    silent = not sys.stderr.isatty()
    processes = min(processes or os.cpu_count() or 1, len(jobs))
    if processes <= 1:
        return [work(job) for job in track(jobs, label, console=console, disable=silent)]
    with ProcessPoolExecutor(processes) as pool:
        results = pool.map(work, jobs)
        return list(track(results, label, total=len(jobs), console=console, disable=silent))
