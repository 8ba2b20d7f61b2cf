"""Making pages again, one after another, each in a process of its own."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path

from .ages import Age, age, oldest_first
from .catalogue import PAGES, Page
from .sources import ROOT, forget


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


def make(
    only: Iterable[str] = (),
    most_minutes: float = float("inf"),
    pages: Iterable[Page] = PAGES,
    root: Path = ROOT,
    tell: Callable[[str], None] = lambda line: print(line, file=sys.stderr, flush=True),
) -> Outcome:
    """Make the stale pages again, oldest first; a page that fails does not stop the others.

    Parameters
    ----------
    only : iterable of str
        Names of pages, made whether stale or not; empty: all that are stale.
    most_minutes : float
        After these no further page is begun.
    """
    chosen, begun, outcome = wanted(set(only), oldest_first(pages, root)), time.monotonic(), Outcome()
    for number, one in enumerate(chosen, 1):
        name = one.page.name
        if time.monotonic() - begun > 60.0 * most_minutes:
            outcome.left.append(name)
            continue
        tell(f"[{number}/{len(chosen)}] {one.page.file} by {one.page.script}, about {one.minutes:g} minutes")
        reason = fault(one.page, root)
        if reason:
            tell(f"{name}: {reason}")
            outcome.failed[name] = reason
        else:
            outcome.made.append(name)
    return outcome


def wanted(only: set[str], ages: list[Age]) -> list[Age]:
    """Pages to be made, in their order."""
    unknown = only - {one.page.name for one in ages}
    if unknown:
        names = ", ".join(sorted(one.page.name for one in ages))
        raise LookupError(f"expected names of pages, got {', '.join(sorted(unknown))}; choose among {names}")
    return [one for one in ages if (one.page.name in only if only else one.stale)]


def fault(page: Page, root: Path) -> str:
    """Make a page; why that failed, or nothing."""
    before = stamp(root / page.file)
    done = subprocess.run([sys.executable, page.script], cwd=root, check=False)
    if done.returncode != 0:
        return f"exit code {done.returncode}"
    if stamp(root / page.file) == before:
        return "the script ran and wrote no page"
    forget()
    return "" if not age(page, root).stale else "changed while it was made; make it again"


def stamp(path: Path) -> int | None:
    """When a file was written; None where it is not there."""
    return path.stat().st_mtime_ns if path.exists() else None
