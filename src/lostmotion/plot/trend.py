"""PV with SP, and OP, of a record over time: a part of several figures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.plot.style import ALERT, MEASURED, MODEL, MOST_POINTS, calm, labelled
from lostmotion.records import LoopRecord
from lostmotion.records.outline import outline

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FAR = 3.0  # ranges of PV from which on SP is not drawn
MOST_MARKS = 50  # of gaps: more of them would hide the signals
UNITS = ((172_800.0, 86_400.0, "days"), (10_000.0, 3600.0, "h"), (600.0, 60.0, "min"), (0.0, 1.0, "s"))  # from .. s on


def draw_trend(above: Axes, below: Axes, rows: LoopRecord, start: int = 0) -> None:
    """Draw PV and SP above, OP and position below, over dates where they are known, else from row `start` on."""
    time, label = _times(rows, start)
    title = _measurement(above, rows, time)
    _line(below, rows, time, rows.op, color=MODEL, lw=1.0, label="OP")
    if rows.position is not None and np.isfinite(rows.position).any():
        _line(below, rows, time, rows.position, color=MEASURED, lw=0.9, label="position")
        _legend(below)
    above.tick_params(labelbottom=False)
    if np.issubdtype(time.dtype, np.datetime64):
        _dated(below)
    else:
        _mark_gaps((above, below), time[list(rows.gaps)])
    above.set_xlim(time[0], time[-1])
    calm(above, title, "", labelled("PV", rows.pv_unit))
    calm(below, "Controller output", label, labelled("OP", rows.op_unit))


def _times(rows: LoopRecord, start: int) -> tuple[npt.NDArray[Any], str]:
    """Time of every row, and what it is counted in; what gaps left out counts where it is known."""
    starts = rows.stretch_starts
    if rows.start is not None and starts is not None:
        edges = np.array([0, *rows.gaps, len(rows)])
        behind = np.repeat(starts - edges[:-1] * rows.dt, np.diff(edges))
        elapsed = np.arange(len(rows)) * rows.dt + behind
        began = np.datetime64(rows.start.replace(tzinfo=None), "us")
        return began + np.round(1e6 * elapsed).astype("timedelta64[us]"), "time"
    _, scale, unit = next(one for one in UNITS if len(rows) * rows.dt >= one[0])
    return (start + np.arange(len(rows))) * rows.dt / scale, f"time, {unit}"


def _dated(axes: Axes) -> None:
    """Short dates under an axis."""
    from matplotlib.dates import AutoDateLocator, ConciseDateFormatter  # noqa: PLC0415  optional extra

    locator = AutoDateLocator(minticks=3, maxticks=8)  # type: ignore[no-untyped-call]
    axes.xaxis.set_major_locator(locator)
    axes.xaxis.set_major_formatter(ConciseDateFormatter(locator))  # type: ignore[no-untyped-call]


def _mark_gaps(both: tuple[Axes, Axes], times: npt.NDArray[Any]) -> None:
    """Lines where time is missing, nobody knows how much."""
    for time in times[:MOST_MARKS]:
        for axes in both:
            axes.axvline(time, color=MEASURED, lw=0.8, ls=":")


def _measurement(axes: Axes, rows: LoopRecord, time: npt.NDArray[Any]) -> str:
    """Draw PV, and SP where it is near; return the title."""
    _line(axes, rows, time, rows.pv, color=MODEL, lw=1.0, label="PV")
    sp = rows.sp if rows.sp is not None and np.isfinite(rows.sp).any() else None
    if sp is None:
        return "Measurement"
    if _far(sp, rows.pv):
        return f"Measurement (set point far away: {np.nanmin(sp):.4g} .. {np.nanmax(sp):.4g})"
    _line(axes, rows, time, sp, color=ALERT, lw=1.0, ls="--", label="SP")
    _legend(axes)
    return "Measurement and set point"


def _legend(axes: Axes) -> None:
    axes.legend(fontsize=8, frameon=False, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.0)


def _line(axes: Axes, rows: LoopRecord, time: npt.NDArray[Any], values: FloatArray, **look: Any) -> None:
    """One signal, broken at gaps."""
    gaps = list(rows.gaps)
    time, values = np.insert(time, gaps, time[gaps]), np.insert(values, gaps, np.nan)
    shown = outline(values, 2 * MOST_POINTS)
    axes.plot(time[shown], values[shown], **look)


def _far(sp: FloatArray, pv: FloatArray) -> bool:
    """Whether SP would squash PV into a line: other units, or a loop that has lost it."""
    if not np.isfinite(pv).any():
        return False
    low, high = float(np.nanmin(pv)), float(np.nanmax(pv))
    away = max(low - float(np.nanmin(sp)), float(np.nanmax(sp)) - high)
    return bool(away > FAR * (high - low))
