"""Trend of the sizes over the runs: what was, what is, and whether the intervals show a change."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass

from markupsafe import Markup

from lostmotion.audit.plant_view import PlantView, SizePoint
from lostmotion.report.digits import FINEST, digits, span
from lostmotion.report.plant.svg.history_chart import history_chart
from lostmotion.report.plant.words import moment_words, sized

QUANTILE = 1.96  # ends of a 95 % interval in standard errors


@dataclass(frozen=True)
class SizeTrend:
    """A loop whose size is known from two runs or more."""

    tag: str
    runs: int
    first: str
    last: str
    change: str
    said: str


def size_trends(view: PlantView) -> list[SizeTrend]:
    """Loops in the order of the ranking."""
    by_tag: dict[str, list[SizePoint]] = defaultdict(list)
    for point in view.history:
        if point.size is not None and not point.live:
            by_tag[point.tag].append(point)
    order = {row.tag: place for place, row in enumerate(view.leading)}
    several = [tag for tag, points in by_tag.items() if len(points) > 1 and tag in order]
    return [
        _trend(tag, sorted(by_tag[tag], key=_when), view.growth.get(tag, ""))
        for tag in sorted(several, key=order.__getitem__)
    ]


def _when(point: SizePoint) -> tuple[float, int]:
    return point.when.timestamp(), point.run


def _trend(tag: str, points: list[SizePoint], growth: str) -> SizeTrend:
    first, last = points[0], points[-1]
    change, said = _change(first, last)
    return SizeTrend(tag, len(points), size_of(first), size_of(last), change, growth or said)


def size_of(point: SizePoint) -> str:
    """Size with its interval in % of span."""
    if point.size is None:
        known = point.excluded is not None and math.isfinite(point.excluded)
        return f"up to {point.excluded:.2g} % not excluded" if known else ""
    if point.low is None or point.high is None:
        return f"about {point.size:.2g} %"
    value, between = sized(point.size, (point.low, point.high))
    return f"{value} % ({between})"


def _change(first: SizePoint, last: SizePoint) -> tuple[str, str]:
    """Difference with its interval, and what it shows; the two runs are taken as independent."""
    if None in (first.size, first.low, first.high, last.size, last.low, last.high):
        return "", "no interval: the change cannot be judged"
    assert first.size is not None  # noqa: S101  for the type checker
    assert last.size is not None  # noqa: S101
    errors = [((point.high or 0.0) - (point.low or 0.0)) / (2.0 * QUANTILE) for point in (first, last)]
    error = max(math.hypot(*errors), 1e-12)
    value = last.size - first.size
    low, high = value - QUANTILE * error, value + QUANTILE * error
    shown = digits(value, error)[0]
    text = f"{'+' if value > 0 else ''}{shown} ({span(low, high, error)})"
    if abs(value) < FINEST * max(abs(last.size), abs(first.size)):
        return text, "no change that matters"
    if low > 0.0:
        return text, "larger than at first"
    return text, "smaller than at first" if high < 0.0 else "no change that the intervals show"


def history_rows(points: tuple[SizePoint, ...]) -> list[tuple[str, str, str, str]]:
    """Run (of the running plant the watch), date, verdict and size of each."""
    return [(_run(point), moment_words(point.when), point.said, size_of(point)) for point in points]


def _run(point: SizePoint) -> str:
    return f"live {point.run}" if point.live else str(point.run)


def history_picture(points: tuple[SizePoint, ...], of_what: str) -> Markup:
    """Chart of the history; nothing for a single run."""
    return history_chart(points, of_what) if len(points) > 1 else Markup("")
