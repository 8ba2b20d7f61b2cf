"""The figure of a simulated loop: output above, control below."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lostmotion.plot.style import ALERT, MEASURED, MODEL, calm, new_figure
from lostmotion.plot.time_axis import set_ticks, unit_of
from lostmotion.simulate import LoopResponse

if TYPE_CHECKING:
    from matplotlib.figure import Figure, SubFigure


def loop_figure(response: LoopResponse, title: str = "", figure: Figure | SubFigure | None = None) -> Figure:
    """Set point and output, controller output and command, against time.

    Parameters
    ----------
    response : LoopResponse
    title : str, optional
        Of the panel above.
    figure : matplotlib Figure or SubFigure, optional
        Drawn into instead of a new one.
    """
    figure = new_figure(10.0, 6.0, figure)
    above, below = figure.subplots(2, 1, sharex=True)
    length = float(response.time[-1] - response.time[0])
    unit = unit_of(length)
    time = response.time / unit.seconds
    above.plot(time, response.measured, color=MEASURED, lw=0.7, label="PV, measured")
    above.plot(time, response.output, color=MODEL, lw=1.1, label="PV without noise")
    above.plot(time, response.reference, color=ALERT, lw=1.2, ls="--", label="SP")
    below.plot(time, response.command, color=MODEL, lw=0.9, label="command to the valve")
    if (response.command != response.control).any():
        below.plot(time, response.control, color=MEASURED, lw=1.0, ls="--", label="controller output")
    set_ticks(below, unit, length)
    below.set_xlim(time[0], time[-1])
    calm(above, title or "Simulated loop", "", "PV")
    calm(below, "Control", unit.label, "OP")
    return figure
