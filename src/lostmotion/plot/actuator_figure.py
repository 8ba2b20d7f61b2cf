"""The figure of an actuator: OP and position over time, and their difference over OP with the dead band."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lostmotion.actuator import ActuatorResponse
from lostmotion.plot.style import ALERT, BAND, MEASURED, MODEL, calm, heading, labelled, new_figure, one_panel

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

MOST_ROWS = 4000  # of the trend, and of the plane: more lie one over the other


def actuator_figure(
    response: ActuatorResponse,
    title: str | None = None,
    figure: Figure | SubFigure | None = None,
    ax: Axes | None = None,
) -> Figure:
    """OP and position over time; OP minus position over OP, with the dead band as a strip.

    Parameters
    ----------
    response : ActuatorResponse
    title : str, optional
        Heading; default the finding.
    figure : matplotlib Figure or SubFigure, optional
        Drawn into instead of a new one.
    ax : matplotlib Axes, optional
        Takes the trend alone.

    Raises
    ------
    ParameterError
        Both `figure` and `ax`, or one that is of no such type.
    """
    if ax is not None:
        return one_panel(ax, figure, lambda axes: _trend(axes, response))
    figure = new_figure(12.0, 4.5, figure)
    name = response.record.tag or response.record.source or "record"
    heading(figure, title or f"{name}: {response.finding}", response.message)
    grid = figure.add_gridspec(1, 2, width_ratios=(3.0, 2.0))
    _trend(figure.add_subplot(grid[0]), response)
    _difference(figure.add_subplot(grid[1]), response)
    return figure


def _rows(response: ActuatorResponse) -> slice:
    return slice(0, min(len(response.record), MOST_ROWS))


def _position(response: ActuatorResponse) -> np.ndarray:
    record = response.record
    return record.pv if record.position is None else record.position


def _trend(axes: Axes, response: ActuatorResponse) -> None:
    rows, record = _rows(response), response.record
    time = record.dt * np.arange(len(record))[rows]
    axes.plot(time, record.op[rows], color=MODEL, lw=1.0, label="OP")
    axes.plot(time, _position(response)[rows], color=MEASURED, lw=1.0, label="position")
    calm(axes, "OP and position", "time [s]", labelled("OP", record.op_unit))


def _difference(axes: Axes, response: ActuatorResponse) -> None:
    rows, record = _rows(response), response.record
    axes.plot(record.op[rows], (record.op - _position(response))[rows], ".", color=MEASURED, ms=2.0)
    if np.isfinite(response.dead_band) and np.isfinite(response.offset):
        half = 0.5 * response.dead_band
        axes.axhspan(response.offset - half, response.offset + half, color=BAND, alpha=0.5, lw=0.0, label="dead band")
        axes.axhline(response.offset, color=ALERT, lw=0.8)
    unit = record.op_unit
    calm(axes, "OP minus position", labelled("OP", unit), labelled("OP - position", unit))
