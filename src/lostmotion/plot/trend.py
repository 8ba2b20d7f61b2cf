"""PV with SP, and OP, of a record over time: a part of several figures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.plot.style import ALERT, MEASURED, MODEL, MOST_POINTS, calm, labelled
from lostmotion.plot.time_axis import set_dates, set_ticks, unit_of
from lostmotion.records import LoopRecord
from lostmotion.records.outline import outline

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FAR = 3.0  # ranges of PV from which on SP is not drawn
MOST_MARKS = 50  # of gaps: more of them would hide the signals
BEYOND = 0.25  # of the range of PV and SP that an axis shows above and below it, where a simulation goes farther


def draw_trend(
    above: Axes, below: Axes, rows: LoopRecord, start: int = 0, simulated: FloatArray | None = None, title: str = ""
) -> None:
    """Draw PV and SP above, OP and position below, over dates where they are known, else from row `start` on.

    Parameters
    ----------
    simulated : ndarray, shape (n,), optional
        PV of a model on the same rows, drawn over the measured one.
    title : str, optional
        Of the panel above; default what it holds.
    """
    time = _times(rows, start)
    usual = _measurement(above, rows, time, simulated)
    position = rows.position if rows.position is not None and np.isfinite(rows.position).any() else None
    _line(below, rows, time, rows.op, color=MODEL, lw=1.0, label=None if position is None else "OP")
    if position is not None:
        _line(below, rows, time, position, color=MEASURED, lw=0.9, label="position")
    above.tick_params(labelbottom=False)
    _set_time((above, below), rows, time, start)
    calm(above, title or usual, "", labelled("PV", rows.pv_unit))
    calm(below, "Controller output", below.get_xlabel(), labelled("OP", rows.op_unit))


def draw_in_one(axes: Axes, rows: LoopRecord, start: int = 0) -> None:
    """Draw PV and SP on the left scale of one panel, OP below them on the right one."""
    time = _times(rows, start)
    _measurement(axes, rows, time, None)
    right = axes.twinx()
    _line(right, rows, time, rows.op, color=MEASURED, lw=0.9)
    axes.plot([], [], color=MEASURED, lw=0.9, label="OP, right scale")
    (low, high), (lowest, highest) = axes.get_ylim(), right.get_ylim()
    axes.set_ylim(low - (high - low), high)
    right.set_ylim(lowest, highest + (highest - lowest))
    right.set_ylabel(labelled("OP", rows.op_unit), fontsize=9)
    right.tick_params(labelsize=8)
    right.spines["top"].set_visible(False)
    _set_time((axes,), rows, time, start)
    calm(axes, "Measurement and controller output", axes.get_xlabel(), labelled("PV", rows.pv_unit))


def _times(rows: LoopRecord, start: int) -> npt.NDArray[Any]:
    """Time of every row: dates, or the unit of the axis; what gaps left out counts where it is known."""
    starts = rows.stretch_starts
    if rows.start is not None and starts is not None:
        edges = np.array([0, *rows.gaps, len(rows)])
        behind = np.repeat(starts - edges[:-1] * rows.dt, np.diff(edges))
        elapsed = np.arange(len(rows)) * rows.dt + behind
        began = np.datetime64(rows.start.replace(tzinfo=None), "us")
        return began + np.round(1e6 * elapsed).astype("timedelta64[us]")
    return (start + np.arange(len(rows))) * rows.dt / unit_of(len(rows) * rows.dt).seconds


def _set_time(panels: tuple[Axes, ...], rows: LoopRecord, time: npt.NDArray[Any], start: int) -> None:
    """Ticks, label and limits of the time axis; the last panel has the label."""
    if np.issubdtype(time.dtype, np.datetime64):
        set_dates(panels[-1])
        panels[-1].set_xlabel("time")
    else:
        unit = unit_of(len(rows) * rows.dt)
        set_ticks(panels[-1], unit, len(rows) * rows.dt)
        panels[-1].set_xlabel(unit.label + (" from the start of the record" if start else ""))
        _mark_gaps(panels, time[list(rows.gaps)])
    panels[0].set_xlim(time[0], time[-1])


def _mark_gaps(panels: tuple[Axes, ...], times: npt.NDArray[Any]) -> None:
    """Lines where time is missing, nobody knows how much."""
    for time in times[:MOST_MARKS]:
        for axes in panels:
            axes.axvline(time, color=MEASURED, lw=0.8, ls=":")


def _measurement(axes: Axes, rows: LoopRecord, time: npt.NDArray[Any], simulated: FloatArray | None) -> str:
    """Draw PV, and SP where it is near; return the title."""
    sp = rows.sp if rows.sp is not None and np.isfinite(rows.sp).any() else None
    far = sp is not None and _far(sp, rows.pv)
    alone = simulated is None and (sp is None or far)
    if simulated is None:
        _line(axes, rows, time, rows.pv, color=MODEL, lw=1.0, label=None if alone else "PV")
    else:
        _line(axes, rows, time, rows.pv, color="0.6", lw=1.0, label="PV")
        _line(axes, rows, time, simulated, color=MODEL, lw=1.0, label="model")
    if sp is not None and not far:
        _line(axes, rows, time, sp, color=ALERT, lw=1.1, ls="--", label="SP")
    if simulated is not None:
        _limit(axes, [rows.pv] if sp is None or far else [rows.pv, sp])
    if sp is None:
        return "Measurement"
    if far:
        return f"Measurement (set point far away: {np.nanmin(sp):.4g} .. {np.nanmax(sp):.4g})"
    return "Measurement and set point"


def _limit(axes: Axes, measured: list[FloatArray]) -> None:
    """Keep the scale to what was measured, and what is not far beyond it."""
    low = min(float(np.nanmin(values)) for values in measured)
    high = max(float(np.nanmax(values)) for values in measured)
    room, shown = BEYOND * (high - low), axes.get_ylim()
    axes.set_ylim(max(shown[0], low - room), min(shown[1], high + room))


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
