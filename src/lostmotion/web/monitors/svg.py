"""Width of a monitored dead zone over time, with its interval."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from itertools import pairwise
from typing import Any

import numpy as np
from markupsafe import Markup

from lostmotion.report.plant.svg.axis import Axis
from lostmotion.report.plant.svg.chart import chart, line, region, stretched
from lostmotion.report.plant.words import UNITS, moment_words

Point = tuple[Any, float, float | None, float | None]


def width_chart(points: Sequence[Point]) -> Markup:
    """Line with a band of 95 %; nothing for fewer than two points."""
    if len(points) < 2:
        return Markup("")
    times, name = _times([point[0] for point in points])
    x = Axis(times[0], times[-1] if times[-1] > times[0] else times[0] + 1.0, name, most=6)
    values = np.array([point[1] for point in points])
    low, high = (
        np.array([point[1] if point[end] is None else point[end] for point in points], dtype=float) for end in (2, 3)
    )
    y = Axis(0.0, 1.1 * float(np.max([values, high])) or 1.0, "width, units of OP", most=4)
    across = np.array(times)
    edge = [*zip(across, low, strict=True), *zip(across[::-1], high[::-1], strict=True)]
    said = f"Width of the dead zone in {len(points)} reports with its 95 % interval."
    band = region("interval", x, y, edge)
    return chart("Width over time", said, x, y, stretched(band, line("pv", x, y, across, values)), height=170)


def _times(given: Sequence[Any]) -> tuple[list[float], str]:
    """Places that rise and the name of the axis: time since the first where it is known, else the number of reports."""
    moments = [_seconds(one) for one in given]
    known = [one for one in moments if one is not None]
    if len(known) < len(moments) or any(after < before for before, after in pairwise(known)):
        return [float(place) for place in range(len(given))], "report"
    _, scale, unit = next(one for one in UNITS if known[-1] - known[0] >= one[0])
    began = moment_words(datetime.fromisoformat(given[0])) if isinstance(given[0], str) else ""
    return [(one - known[0]) / scale for one in known], f"{unit} since {began or 'the first report'}"


def _seconds(time: Any) -> float | None:
    if isinstance(time, str):
        try:
            moment = datetime.fromisoformat(time)
        except ValueError:
            return None
        return (moment.replace(tzinfo=None) - datetime(1970, 1, 1)).total_seconds()
    return float(time) if isinstance(time, int | float) else None
