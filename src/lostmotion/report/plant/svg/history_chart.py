"""Size of the lost motion with its interval, run by run, and on the running plant between them."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime

import numpy as np
from markupsafe import Markup

from lostmotion.audit.plant_view import SizePoint
from lostmotion.report.plant.svg.axis import Axis
from lostmotion.report.plant.svg.chart import chart
from lostmotion.report.plant.svg.element import element, percent
from lostmotion.store.rows import UNDATED

DAY = 86_400.0


def history_chart(points: Sequence[SizePoint], of_what: str = "of span") -> Markup:
    """Circles with their 95 % intervals; an open bar where none was found, up to what is not excluded.

    Estimates of the running plant are rings; they are left out where the audits have no dates to place them by.
    """
    shown = [point for point in points if _top(point) is not None]
    if any(point.when.year <= UNDATED.year for point in shown if not point.live):
        shown = [point for point in shown if not point.live]
    if not shown:
        return Markup("")
    places, name = _places(shown)
    spare = max(0.08 * (max(places) - min(places)), 0.5)
    x = Axis(min(places) - spare, max(places) + spare, name)
    y = Axis(0.0, 1.1 * max(_top(point) or 0.0 for point in shown) or 1.0, f"size, % {of_what}", most=4)
    marks = [_mark(x.share(place), y, point) for place, point in zip(places, shown, strict=True)]
    live = sum(point.live for point in shown)
    beside = f" and {live} estimates of the running plant" if live else ""
    said = (
        f"Size of the lost motion in {len(shown) - live} runs{beside} with 95 % intervals; the table has the numbers."
    )
    return chart("Size over the runs", said, x, y, *marks, height=160)


def _top(point: SizePoint) -> float | None:
    """Highest value that is drawn; None where nothing is."""
    found = [one for one in (point.size, point.high, point.excluded) if one is not None and np.isfinite(one)]
    return max(found, default=None)


def _places(points: Sequence[SizePoint]) -> tuple[list[float], str]:
    """Days since the first where dates are known, else the numbers of the runs."""
    if any(point.when.year <= UNDATED.year for point in points) or len({point.when for point in points}) == 1:
        return [float(point.run) for point in points], "run"
    first: datetime = min(point.when for point in points)
    days = [(point.when - first).total_seconds() / DAY for point in points]
    return days, f"days since {first.day} {first:%b %Y}"


def _mark(at: float, y: Axis, point: SizePoint) -> Markup:
    x = percent(at)
    if point.size is None:
        top = percent(1.0 - y.share(point.excluded or 0.0))
        return element("line", class_="open", x1=x, x2=x, y1="100%", y2=top)
    ends = (point.low if point.low is not None else point.size, point.high if point.high is not None else point.size)
    low, high = (percent(1.0 - min(max(y.share(end), 0.0), 1.0)) for end in ends)
    whisker = element("line", class_="whisker live" if point.live else "whisker", x1=x, x2=x, y1=low, y2=high)
    kind = "dot live" if point.live else "dot"
    return whisker + element("circle", class_=kind, cx=x, cy=percent(1.0 - y.share(point.size)), r=4)
