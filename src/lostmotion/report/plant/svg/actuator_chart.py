"""PV over OP with the lost motion that was found, and the identified actuator itself."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from markupsafe import Markup

from lostmotion.arrays import FloatArray
from lostmotion.errors import LostMotionError
from lostmotion.report.digits import bracketed, plain
from lostmotion.report.plant.svg.axis import Axis
from lostmotion.report.plant.svg.chart import chart, line, stretched, upright
from lostmotion.report.plant.svg.trend_chart import signals
from lostmotion.store.rows import AssessmentRow, TraceRow

PERIODS = 2.0  # drawn strongly
POINTS = 200  # of one way of OP
BEYOND = 0.15  # of the range of OP, on either side of it
HIGH = 260


def model_of(trace: TraceRow) -> dict[str, Any]:
    """What the trace says of the fitted actuator; empty where there is none or it cannot be read."""
    try:
        found = json.loads(trace.model) if trace.model else {}
        _actuator(found.get("actuator", {}))
    except (ValueError, TypeError, AttributeError, KeyError, LostMotionError):
        return {}
    return dict(found)


def swings(row: AssessmentRow) -> bool:
    """Whether it has a regular period."""
    return row.period is not None and row.regularity is not None and row.regularity > 1.0


def plane_chart(trace: TraceRow, row: AssessmentRow, pv_unit: str = "", op_unit: str = "") -> Markup:
    """PV over OP; behind it a band as wide as the lost motion, at its place where that is known."""
    found = signals(trace)
    op, pv = _paired(trace, row, found.get("OP", np.empty(0)), found.get("PV", np.empty(0)))
    if op.size < 2:
        return Markup("")
    x, y = Axis.around(op, f"OP{bracketed(op_unit)}", most=4), Axis.around(pv, f"PV{bracketed(pv_unit)}")
    lines = [line("faint", x, y, op, pv)]
    if swings(row) and row.period is not None and trace.seconds > 0.0:
        last = slice(-max(int(PERIODS * row.period / trace.seconds * op.size), 2), None)
        lines.append(line("pv", x, y, op[last], pv[last]))
    said = f"PV over OP; OP goes from {plain(float(np.nanmin(op)))} to {plain(float(np.nanmax(op)))}."
    place = _band(row, model_of(trace), 0.5 * float(np.nanmin(op) + np.nanmax(op)))
    if place:
        said += f" The band is as wide as the lost motion, {plain(place[1][1] - place[1][0])} of OP."
    bands = [upright(kind, x, *ends) for kind, ends in zip(("interval", "lost"), place, strict=False)]
    return chart("PV over OP", said, x, y, *bands, stretched(*lines), height=HIGH, kind="plane")


def actuator_chart(trace: TraceRow, op_unit: str = "") -> Markup:
    """Position of the identified actuator over OP, once up and down, with both ends of the interval of its size."""
    model = model_of(trace)
    if not model:
        return Markup("")
    op = signals(trace).get("OP", np.empty(0))
    op = op[np.isfinite(op)]
    if op.size < 2 or not op.min() < op.max():
        return Markup("")
    spare = BEYOND * float(op.max() - op.min())
    way = np.linspace(op.min() - spare, op.max() + spare, POINTS)
    cycle = np.concatenate([way, way[::-1], way])
    paths = {"actuator": _positions(model["actuator"], cycle)}
    for kind, shaped in (("least", _resized(model, 0)), ("most", _resized(model, 1))):
        if shaped is not None:
            paths[kind] = _positions(shaped, cycle)
    unit = bracketed(op_unit)
    x = Axis(float(way[0]), float(way[-1]), f"OP{unit}", most=4)
    settled = [values[POINTS:] for values in paths.values()]  # the first way up depends on where it began
    y = Axis.around(np.concatenate(settled), f"position{unit}")
    drawn = [line(kind, x, y, cycle[POINTS:], values[POINTS:]) for kind, values in reversed(list(paths.items()))]
    edges = [
        upright("interval", x, *ends)
        for name, ends in model.get("intervals", {}).items()
        if name in ("left", "right") and None not in ends
    ]
    said = "Position that the identified actuator takes while OP goes up and down once."
    return chart("Identified actuator", said, x, y, *edges, stretched(*drawn), height=HIGH, kind="plane")


def parameter_rows(trace: TraceRow) -> list[tuple[str, str, str]]:
    """Name, value and 95 % interval of each parameter of the identified actuator."""
    model = model_of(trace)
    rows = []
    for name, value in model.get("actuator", {}).items():
        if isinstance(value, int | float):
            rows.append((name.replace("_", " "), plain(float(value)), _interval(model, name)))
    name = model.get("size")
    if name and name not in model["actuator"]:
        rows.append((str(name), "", _interval(model, str(name))))
    return rows


def _interval(model: Mapping[str, Any], name: str) -> str:
    low, high = model.get("intervals", {}).get(name, (None, None))
    return "" if low is None or high is None else f"{plain(low)} .. {plain(high)}"


def _positions(actuator: Mapping[str, Any], op: FloatArray) -> FloatArray:
    return np.asarray(_actuator(dict(actuator))(op), dtype=np.float64)


def _resized(model: Mapping[str, Any], end: int) -> dict[str, Any] | None:
    """The actuator with its size at an end of the interval; None where it has no size of its own."""
    name = model.get("size")
    ends = model.get("intervals", {}).get(name)
    if name not in model["actuator"] or not ends or ends[end] is None:
        return None
    return {**model["actuator"], str(name): max(float(ends[end]), 0.0)}


def _band(row: AssessmentRow, model: Mapping[str, Any], middle: float) -> list[tuple[float, float]]:
    """Bands on the axis of OP: as wide as the upper end of the interval, and as the size."""
    if row.size is None:
        return []
    own = model.get("actuator", {})
    if "left" in own and "right" in own:
        middle = 0.5 * (own["left"] + own["right"])
    wide = row.high if row.high is not None else row.size
    return [(middle - 0.5 * width, middle + 0.5 * width) for width in (wide, row.size)]


def _paired(trace: TraceRow, row: AssessmentRow, op: FloatArray, pv: FloatArray) -> tuple[FloatArray, FloatArray]:
    """OP and PV of the same instants: of a trace that holds lowest and highest by turns, the middle of the two."""
    count = min(op.size, pv.size)
    op, pv = op[:count], pv[:count]
    whole = row.dt is not None and trace.seconds / row.dt <= 1.5 * count
    if whole or count < 4:
        return op, pv
    even = count // 2 * 2
    return op[:even].reshape(-1, 2).mean(axis=1), pv[:even].reshape(-1, 2).mean(axis=1)


def _actuator(data: dict[str, Any]) -> Any:
    from lostmotion.models.registry import actuator_from_dict  # noqa: PLC0415  compiled kernels, for who draws one

    return actuator_from_dict(data)
