"""Making pages again, oldest first, each in a process of its own."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from .ages import Age, age, oldest_first
from .catalogue import PAGES, Page
from .commit import ROOT
from .publish import MIXED, STORE

SHOWN_LINES = 5  # of what a failed script said last


@dataclass
class Outcome:
    """What became of each page."""

    made: list[str] = field(default_factory=list)
    failed: dict[str, str] = field(default_factory=dict)
    left: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        lines = [f"made: {', '.join(self.made) or 'none'}"]
        lines += [f"failed: {name}: {reason}" for name, reason in self.failed.items()]
        lines += [f"left for another time: {', '.join(self.left)}"] if self.left else []
        return "\n".join(lines)


def say(line: str) -> None:
    """Progress."""
    print(line, file=sys.stderr, flush=True)


def make(
    only: Iterable[str] = (),
    most_minutes: float = float("inf"),
    at_once: int = 1,
    pages: Iterable[Page] = PAGES,
    root: Path = ROOT,
    tell: Callable[[str], None] = say,
) -> Outcome:
    """Make the pages again for a release, oldest first; a page that fails does not stop the others.

    Parameters
    ----------
    only : iterable of str
        Names of pages; empty: all that were not made at this commit.
    most_minutes : float
        After these no further page is begun.
    at_once : int
        Pages made beside each other, of those that hold no times and keep to one core. The others come last, alone.
    """
    chosen, begun, outcome = wanted(set(only), oldest_first(pages, root)), time.monotonic(), Outcome()

    def remake(old: Age) -> None:
        name = old.page.name
        if time.monotonic() - begun > 60.0 * most_minutes:
            outcome.left.append(name)
            return
        tell(f"{old.page.file} by {old.page.script}, about {old.minutes:g} minutes; log {log_of(old.page)}")
        reason = fault(old.page, root)
        if reason:
            outcome.failed[name] = reason
        else:
            outcome.made.append(name)
        tell(f"{name}: {reason or 'made'}")

    beside = [old for old in chosen if old.page.shares] if at_once > 1 else []
    with ThreadPoolExecutor(at_once) as pool:
        list(pool.map(remake, beside))
    for old in chosen:
        if old not in beside:
            remake(old)
    return outcome


def wanted(only: set[str], ages: list[Age]) -> list[Age]:
    """Pages to be made, in their order."""
    unknown = only - {one.page.name for one in ages}
    if unknown:
        names = ", ".join(sorted(one.page.name for one in ages))
        raise LookupError(f"expected names of pages, got {', '.join(sorted(unknown))}; choose among {names}")
    return [one for one in ages if (one.page.name in only if only else not one.fresh)]


def fault(page: Page, root: Path) -> str:
    """Make a page; why that failed, or nothing."""
    before, log = stamp(root / page.file), root / log_of(page)
    log.parent.mkdir(parents=True, exist_ok=True)
    with log.open("w", encoding="utf-8") as stream:
        words = [sys.executable, "-u", page.script]
        done = subprocess.run(words, cwd=root, stdout=stream, stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        last = log.read_text(encoding="utf-8", errors="replace").splitlines()[-SHOWN_LINES:]
        return "\n    ".join([f"exit code {done.returncode}", *last])
    if stamp(root / page.file) == before:
        return "the script ran and wrote no page"
    made = age(page, root).footer
    return "the tree changed while it was made; make it again" if made is None or made.commit == MIXED else ""


def log_of(page: Page) -> Path:
    """Where a script's words go, relative to the repository; those of the last time are overwritten."""
    return STORE / f"{page.name}.log"


def stamp(path: Path) -> int | None:
    """When a file was written; None where it is not there."""
    return path.stat().st_mtime_ns if path.exists() else None
