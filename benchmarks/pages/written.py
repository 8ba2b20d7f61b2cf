"""What pages of many loops are written with: tables, shares, and how far the run is."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence

TOLD_EVERY = 12  # loops


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> list[str]:
    """Markdown, with an empty line behind."""
    lines = [head, ["---"] * len(head), *rows]
    return [*("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines), ""]


def share(hits: Iterable[bool]) -> str:
    """Number and per cent; a digit more where the per cent would be rounded to none or all."""
    hits = list(hits)
    if not hits:
        return some(hits) or "0 of 0"
    percent = 100.0 * sum(hits) / len(hits)
    digits = 1 if 0.0 < percent < 1.0 or 99.0 < percent < 100.0 else 0
    return f"{some(hits)}, {percent:.{digits}f} %"


def some(hits: Iterable[bool]) -> str:
    """Number of how many, or nothing where there are none."""
    hits = list(hits)
    return f"{sum(hits)} of {len(hits)}" if hits else ""


def told(done: int, total: int) -> None:
    """Progress on stderr."""
    if done % TOLD_EVERY == 0 or done == total:
        print(f"{done} of {total} loops", file=sys.stderr, flush=True)
