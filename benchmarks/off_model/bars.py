"""Tables, and counts against their bars."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

MET, MISSED, EMPTY = "met", "MISSED", "no record"


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> list[str]:
    """Markdown, with an empty line behind."""
    lines = [head, ["---"] * len(head), *rows]
    return [*("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines), ""]


def share(hits: Iterable[bool]) -> str:
    """Number, and per cent."""
    hits = list(hits)
    return f"{sum(hits)} of {len(hits)}, {100.0 * sum(hits) / len(hits):.1f} %" if hits else "0 of 0"


def at_least(what: str, hits: Iterable[bool], bar: float) -> list[object]:
    """Row of a summary: a share that should be no smaller than the bar (0 to 1)."""
    hits = list(hits)
    verdict = EMPTY if not hits else MET if sum(hits) >= bar * len(hits) - 1e-9 else MISSED
    return [what, share(hits), f">= {100.0 * bar:g} %", verdict]


def at_most(what: str, hits: Iterable[bool], bar: float) -> list[object]:
    """Row of a summary: a share that should be no larger than the bar (0 to 1)."""
    hits = list(hits)
    verdict = EMPTY if not hits else MET if sum(hits) <= bar * len(hits) + 1e-9 else MISSED
    return [what, share(hits), f"<= {100.0 * bar:g} %", verdict]


def summary(rows: Iterable[Sequence[object]]) -> list[str]:
    """Table of such rows."""
    return table(("summary", "measured", "bar", ""), rows)
