"""A trend as SVG, for browsers without script and on paper: PV with SP above, OP below, shaded what is not used."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from markupsafe import Markup

from lostmotion.arrays import FloatArray
from lostmotion.report.digits import bracketed
from lostmotion.report.plant.svg.actuator_chart import plane_chart
from lostmotion.report.plant.svg.axis import Axis
from lostmotion.report.plant.svg.chart import chart, line, stretched, upright
from lostmotion.report.plant.svg.element import element, percent
from lostmotion.report.plant.words import UNITS, moment_words, seconds_words
from lostmotion.store.rows import UNDATED, AssessmentRow, TraceRow
from lostmotion.web.trend.columns import Columns

LETTERS = {"manual": "M", "at a limit": "L", "missing": "X"}  # stand in a shaded stretch that is wide enough
WIDE = 0.012  # share of the picture that a letter needs
POINTS = 2000  # of PV over OP
HEIGHTS = {"pv": 190, "op": 130}


def time_axis(columns: Columns, start: int, stop: int) -> dict[str, Any]:
    """Where zero lies in seconds, seconds in a unit, and the name of the axis."""
    _, scale, unit = next(one for one in UNITS if (stop - start) * columns.dt >= one[0])
    moment = columns.moment(start)
    since = moment_words(moment) or ("the start" if not start else f"{seconds_words(start * columns.dt)}")
    gap = np.searchsorted(columns.gaps, start, "right") < np.searchsorted(columns.gaps, stop)
    return {"from": start * columns.dt, "scale": scale, "name": f"{unit}{' of data' if gap else ''} since {since}"}


def signal_names(columns: Columns) -> dict[str, str]:
    """Signals with their units."""
    units = {"sp": "pv_unit", "pv": "pv_unit", "op": "op_unit", "position": "op_unit"}
    shown = {"sp": "SP", "pv": "PV", "op": "OP", "position": "position"}
    return {name: shown[name] + bracketed(columns.facts[units[name]]) for name in columns.signals}


def charts(found: Mapping[str, Any], columns: Columns) -> tuple[Markup, Markup]:
    """PV and SP, and OP with the position, of what :func:`lostmotion.web.trend.stretch.trend_of` gives."""
    axis, names = time_axis(columns, found["start"], found["stop"]), signal_names(columns)
    length = (found["stop"] - found["start"]) * found["dt"] / axis["scale"]
    x = Axis(0.0, length, axis["name"], most=6)
    across = (np.array(found["t"]) - axis["from"]) / axis["scale"]
    bands = _bands(found, axis, x)
    above = _signals(found, ("sp", "pv"), across, x, names, bands)
    return above, _signals(found, ("position", "op"), across, x, names, bands)


def _signals(
    found: Mapping[str, Any], kinds: tuple[str, str], across: FloatArray, x: Axis, names: Mapping[str, str],
    bands: list[Markup],
) -> Markup:  # fmt: skip
    drawn = {name: np.array(found[name], dtype=np.float64) for name in kinds if name in found}
    name = " and ".join(names[one] for one in reversed(drawn))
    y = Axis.around(np.concatenate(list(drawn.values())), name, most=4)
    lines = [line(one, x, y, across, values) for one, values in drawn.items()]
    words = f"{name}, {x.name}; the table has the numbers."
    return chart(f"{name} over time", words, x, y, *bands, stretched(*lines), height=HEIGHTS[kinds[1]])


def _bands(found: Mapping[str, Any], axis: Mapping[str, Any], x: Axis) -> list[Markup]:
    bands = []
    for low, high, what in found["shaded"]:
        ends = ((low - axis["from"]) / axis["scale"], (high - axis["from"]) / axis["scale"])
        bands.append(upright(f"shade {what.replace(' ', '-')}", x, *ends))
        if x.share(ends[1]) - x.share(ends[0]) >= WIDE:
            middle = percent(x.share(0.5 * (ends[0] + ends[1])))
            bands.append(element("text", LETTERS[what], class_="letter", x=middle, y="0.9em", text_anchor="middle"))
    for where, _ in found["gaps"]:
        at = percent(x.share((where - axis["from"]) / axis["scale"]))
        bands.append(element("line", class_="gap", x1=at, x2=at, y1="0", y2="100%"))
    return bands


def plane(columns: Columns, start: int, stop: int, row: AssessmentRow | None, trace: TraceRow | None) -> Markup:
    """PV over OP of the rows shown, and the lost motion that was found as a band; of long stretches every n-th row."""
    step = max((stop - start) // POINTS, 1)
    op, pv = (np.asarray(columns.signals[name].values[start:stop:step]) for name in ("op", "pv"))
    known = np.isfinite(op) & np.isfinite(pv)
    if known.sum() < 2:
        return Markup("")
    seconds = op.size * step * columns.dt
    above, across = (np.where(known, values, np.nan).astype("<f4").tobytes() for values in (pv, op))
    tag, model = str(columns.facts["tag"]), "" if trace is None else trace.model
    shown = TraceRow(tag, UNDATED, start * columns.dt, seconds, b"", above, across, model)
    whole = replace(row or AssessmentRow(tag, UNDATED, UNDATED), dt=step * columns.dt)
    return plane_chart(shown, whole, columns.facts["pv_unit"], columns.facts["op_unit"])
