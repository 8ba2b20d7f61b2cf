"""Width of a monitored dead zone over time, with its interval."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from itertools import pairwise
from typing import Any

import numpy as np
from markupsafe import Markup

from lostmotion.arrays import FloatArray
from lostmotion.report.plant.svg.axis import Axis
from lostmotion.report.plant.svg.chart import chart, line, region, stretched
from lostmotion.report.plant.words import UNITS, moment_words
from lostmotion.web.monitors.said import Point

GAP = 3.0  # usual times between two reports
DIGITS = 6  # of seconds: closer reports are one
LONE = 0.006  # of the axis: what is drawn of a report between two gaps


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
    parts, marks = _stretches(across), []
    for part in parts:
        places, middle, lower, upper = (_seen(signal[part]) for signal in (across, values, low, high))
        if part.stop - part.start == 1:
            places = places + LONE * (x.high - x.low) * np.array([-0.5, 0.5])
        edge = [*zip(places, lower, strict=True), *zip(places[::-1], upper[::-1], strict=True)]
        marks += [region("interval", x, y, edge), line("pv", x, y, places, middle)]
    gaps = f" {len(parts) - 1} gap{'s' if len(parts) > 2 else ''}." if len(parts) > 1 else ""
    said = f"Width of the dead zone in {len(points)} reports with its 95 % interval.{gaps}"
    return chart("Width over time", said, x, y, stretched(*marks), height=170)


def _seen(part: FloatArray) -> FloatArray:
    """A report between two gaps twice: a line has two ends."""
    return np.repeat(part, 2) if part.size == 1 else part


def _stretches(times: FloatArray) -> list[slice]:
    """Parts without a gap: reports that came as often as usual."""
    steps = np.diff(times)
    ends = [0, *(np.flatnonzero(steps > GAP * np.median(steps)) + 1).tolist(), times.size]
    return [slice(first, stop) for first, stop in pairwise(ends)]


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
    return round(float(time), DIGITS) if isinstance(time, int | float) else None
