"""The figure of a simulated loop: output above, control below."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lostmotion.plot.style import ALERT, MEASURED, MODEL, calm, new_figure
from lostmotion.simulate import LoopResponse

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def loop_figure(response: LoopResponse, title: str = "") -> Figure:
    """Set point and output, controller output and command, against time in seconds."""
    figure = new_figure(10.0, 6.0)
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot(response.time, response.measured, color=MEASURED, lw=0.7, label="measured")
    above.plot(response.time, response.output, color=MODEL, lw=1.1, label="output")
    above.plot(response.time, response.reference, color=ALERT, lw=1.2, ls="--", label="set point")
    below.plot(response.time, response.command, color=MODEL, lw=0.9, label="command to the actuator")
    if (response.command != response.control).any():
        below.plot(response.time, response.control, color=MEASURED, lw=1.0, ls="--", label="controller output")
    for axes in (above, below):
        axes.legend(fontsize=8, framealpha=0.85, edgecolor="none", ncols=3, loc="upper right")
    calm(above, title or "Output", "", "PV")
    calm(below, "Control", "time, s", "OP")
    return figure
