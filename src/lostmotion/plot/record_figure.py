"""The figure of a record: its trend, and PV over OP beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lostmotion.plot.style import MODEL, calm, labelled, new_figure
from lostmotion.plot.trend import draw_trend
from lostmotion.records import LoopRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_IN_PLANE = 2000  # rows: more of them lie one over the other
FEWEST_LEVELS = 3  # of OP and of PV, for a plane that shows anything


def record_figure(record: LoopRecord, title: str | None = None) -> Figure:
    """PV with SP and OP over time; beside them PV over OP, where both move.

    Parameters
    ----------
    record : LoopRecord
        Missing samples and gaps break the lines. Long records are drawn by the lowest and highest of short stretches,
        and the last 2000 rows alone in the plane.
    title : str, optional
        Heading; default the tag.
    """
    plane = _plane_rows(record)
    figure = new_figure(12.0, 5.5)
    name = record.tag or record.source or "record"
    counted = f"{len(record)} samples every {record.dt:g} s"
    figure.suptitle(title or f"{name}: {counted}", fontsize=13, fontweight="bold", x=0.01, ha="left")
    grid = figure.add_gridspec(2, 5)
    trend = slice(0, 5 if plane is None else 3)
    above = figure.add_subplot(grid[0, trend])
    draw_trend(above, figure.add_subplot(grid[1, trend], sharex=above), record)
    if plane is not None:
        _plane(figure.add_subplot(grid[:, 3:]), plane, len(plane) < len(record))
    return figure


def _plane_rows(record: LoopRecord) -> LoopRecord | None:
    """The last rows of a record; None where OP or PV takes too few values in them."""
    rows = record[-MOST_IN_PLANE:]
    there = ~rows.missing
    levels = min(np.unique(rows.op[there]).size, np.unique(rows.pv[there]).size)
    return rows if levels >= FEWEST_LEVELS else None


def _plane(axes: Axes, rows: LoopRecord, shortened: bool) -> None:
    """Path of the loop, the way in which it runs round not told."""
    gaps = list(rows.gaps)
    op, pv = (np.insert(values, gaps, np.nan) for values in (rows.op, rows.pv))
    axes.plot(op, pv, color=MODEL, lw=0.7, alpha=0.8)
    title = f"PV over OP, last {len(rows)} rows" if shortened else "PV over OP"
    calm(axes, title, labelled("OP", rows.op_unit), labelled("PV", rows.pv_unit))
