"""The figure of a record: its trend, and PV over OP beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lostmotion.plot.style import MODEL, calm, heading, labelled, new_figure, one_panel
from lostmotion.plot.trend import draw_in_one, draw_trend
from lostmotion.records import LoopRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

MOST_IN_PLANE = 2000  # rows: more of them lie one over the other
FEWEST_LEVELS = 3  # of OP and of PV, for a plane that shows anything


def record_figure(
    record: LoopRecord, title: str | None = None, figure: Figure | SubFigure | None = None, ax: Axes | None = None
) -> Figure:
    """PV with SP and OP over time; beside them PV over OP, where both move.

    Parameters
    ----------
    record : LoopRecord
        Missing samples and gaps break the lines. Long records are drawn by the lowest and highest of short stretches,
        and the last 2000 rows alone in the plane.
    title : str, optional
        Heading; default the tag.
    figure : matplotlib Figure or SubFigure, optional
        Drawn into instead of a new one.
    ax : matplotlib Axes, optional
        Takes the trend alone, OP on a scale at its right.

    Raises
    ------
    ParameterError
        Both `figure` and `ax`, or one that is of no such type.
    """
    if ax is not None:
        return one_panel(ax, figure, lambda axes: draw_in_one(axes, record))
    plane = _plane_rows(record)
    figure = new_figure(12.0, 5.5, figure)
    name = record.tag or record.source or "record"
    counted = f"{len(record)} samples every {record.dt:g} s"
    heading(figure, title or f"{name}: {counted}")
    grid = figure.add_gridspec(1, 1 if plane is None else 2, width_ratios=(1.0,) if plane is None else (3.0, 2.0))
    trend = grid[0].subgridspec(2, 1)
    above = figure.add_subplot(trend[0])
    draw_trend(above, figure.add_subplot(trend[1], sharex=above), record)
    if plane is not None:
        _plane(figure.add_subplot(grid[1].subgridspec(1, 1)[0]), plane, len(plane) < len(record))
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
