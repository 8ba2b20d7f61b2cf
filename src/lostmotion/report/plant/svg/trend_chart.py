"""SP and PV over time, and OP below, of a trace."""

from __future__ import annotations

import math

import numpy as np
from markupsafe import Markup

from lostmotion.arrays import FloatArray
from lostmotion.report.digits import bracketed, plain
from lostmotion.report.plant.svg.axis import Axis
from lostmotion.report.plant.svg.chart import chart, line, stretched
from lostmotion.report.plant.words import UNITS
from lostmotion.store.rows import TraceRow

FAR = 3.0  # ranges of PV from which on SP is not drawn: other units, or a loop that has lost it


def signals(trace: TraceRow) -> dict[str, FloatArray]:
    """SP (where there is one), PV and OP, each of shape (n,)."""
    stored = {"SP": trace.sp, "PV": trace.pv, "OP": trace.op}
    return {name: np.frombuffer(data, "<f4").astype(np.float64) for name, data in stored.items() if data}


def trend_charts(trace: TraceRow, pv_unit: str = "", op_unit: str = "") -> tuple[Markup, ...]:
    """PV with SP, and OP, over the time since the start of the window."""
    found = signals(trace)
    if len(found.get("PV", ())) < 2 or len(found.get("OP", ())) < 2:
        return ()
    _, scale, unit = next(one for one in UNITS if trace.seconds >= one[0])
    start, stop = trace.start / scale, (trace.start + trace.seconds) / scale
    time = Axis(start, stop if stop > start else start + 1.0, f"time in the window, {unit}")
    above, said = _measurement(found, time, pv_unit)
    values = found["OP"]
    up = Axis.around(values, f"OP{bracketed(op_unit)}", most=4)
    below = chart(
        "Controller output over time", _words("OP", values), time, up,
        stretched(line("op", time, up, _instants(time, values), values)), height=120,
    )  # fmt: skip
    return chart("Measurement and set point over time", said, time, *above, height=170), below


def _measurement(found: dict[str, FloatArray], time: Axis, unit: str) -> tuple[tuple[Axis, Markup], str]:
    pv, sp = found["PV"], found.get("SP")
    near = sp is not None and not _far(sp, pv)
    both = np.concatenate([pv, sp]) if sp is not None and near else pv
    up = Axis.around(both, f"{'PV and SP' if near else 'PV'}{bracketed(unit)}", most=4)
    lines = [line("pv", time, up, _instants(time, pv), pv)]
    said = _words("PV", pv)
    if sp is not None and near:
        lines.insert(0, line("sp", time, up, _instants(time, sp), sp))
        said += f" {_words('SP', sp)}"
    return (up, stretched(*lines)), said


def _instants(time: Axis, values: FloatArray) -> FloatArray:
    return np.linspace(time.low, time.high, values.size)


def _far(sp: FloatArray, pv: FloatArray) -> bool:
    if not (np.isfinite(pv).any() and np.isfinite(sp).any()):
        return True
    low, high = float(np.nanmin(pv)), float(np.nanmax(pv))
    away = max(low - float(np.nanmin(sp)), float(np.nanmax(sp)) - high)
    return bool(away > FAR * (high - low))


def _words(name: str, values: FloatArray) -> str:
    known = values[np.isfinite(values)]
    return f"{name} from {plain(float(known.min()))} to {plain(float(known.max()))}." if known.size else f"No {name}."


def _places(extent: float) -> int:
    """Decimals with which a hundredth of the extent still shows."""
    return min(max(2 - math.floor(math.log10(extent)), 0), 9) if extent > 0.0 else 2


def trend_table(trace: TraceRow) -> list[tuple[str, ...]]:
    """Signal, lowest, mean, highest, and deviation of each: the trend in numbers."""
    rows = []
    for name, values in signals(trace).items():
        known = values[np.isfinite(values)]
        if known.size:
            facts = (known.min(), known.mean(), known.max(), known.std())
            places = _places(float(np.ptp(known)))
            rows.append((name, *(f"{fact:.{places}f}" for fact in facts)))
    return rows
