"""The figure of a test design: OP, predicted PV with its limits, expected interval against time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lostmotion.design import TestDesign
from lostmotion.plot.style import ALERT, BAND, MEASURED, MODEL, MOST_POINTS, calm, heading, new_figure
from lostmotion.plot.time_axis import set_ticks, unit_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

TALLEST = 100.0  # times the final half-width: more is not drawn


def design_figure(design: TestDesign, title: str | None = None, figure: Figure | SubFigure | None = None) -> Figure:
    """Three panels over time: OP with the plausible break points, PV with band and limits, expected interval.

    Parameters
    ----------
    design : TestDesign
    title : str, optional
        Heading; default what it reaches.
    figure : matplotlib Figure or SubFigure, optional
        Drawn into instead of a new one.
    """
    figure = new_figure(11.0, 8.0, figure)
    above, middle, below = figure.subplots(3, 1, sharex=True, height_ratios=[1.2, 1.2, 1.0])
    heading(figure, title or _title(design))
    unit = unit_of(design.duration)
    scale = unit.seconds
    _op(above, design, scale)
    _pv(middle, design, scale)
    _interval(below, design, scale)
    below.set_xlabel(unit.label, fontsize=9)
    set_ticks(below, unit, design.duration)
    below.set_xlim(0.0, design.duration / scale)
    return figure


def _title(design: TestDesign) -> str:
    reach = design.expected[design.target]
    said = (
        f"{_called(design.target)} to +-{reach:.2g} of OP (95 %)"
        if np.isfinite(reach)
        else "not possible within the limits"
    )
    what = "OP steps, open loop" if design.loop == "open" else "SP steps, closed loop"
    missed = "" if design.reached or not np.isfinite(reach) else ", wanted interval not reached"
    return f"Test design: {what}: {said}{missed}"


def _called(target: str) -> str:
    return target if target == "width" else f"{target} breakpoint"


def _rows(design: TestDesign, scale: float) -> tuple[np.ndarray, slice]:
    """Times to draw; long tests are drawn from their start only, the rest repeats it."""
    rows = slice(0, min(len(design.signal), MOST_POINTS * 5))
    return np.arange(len(design.signal))[rows] * design.dt / scale, rows


def _op(axes: Axes, design: TestDesign, scale: float) -> None:
    time, rows = _rows(design, scale)
    seen = design.prediction
    for name in ("left", "right"):
        low, high = design.break_points[name]
        axes.axhspan(low, high, color="0.9", lw=0)
        axes.annotate(
            f"{name} breakpoint", (1.0, 0.5 * (low + high)), xycoords=("axes fraction", "data"), fontsize=7,
            xytext=(4, 0), textcoords="offset points", ha="left", va="center", color="0.35", annotation_clip=False,
        )  # fmt: skip
    if design.loop == "closed":
        axes.fill_between(time, seen.op_low[rows], seen.op_high[rows], color=BAND, alpha=0.6, lw=0, label="plausible")
        axes.plot(time, seen.op[rows], color=MODEL, lw=0.9, label="OP, predicted")
    else:
        axes.step(time, design.signal[rows], where="post", color=MODEL, lw=1.1, label="OP, to be set")
    limits = design.limits.levels if design.loop == "open" else design.limits.op
    _limits(axes, limits)
    calm(axes, "OP; grey: where the breakpoints may be", "", "OP")


def _pv(axes: Axes, design: TestDesign, scale: float) -> None:
    time, rows = _rows(design, scale)
    seen = design.prediction
    axes.fill_between(
        time, seen.pv_low[rows], seen.pv_high[rows], color=BAND, alpha=0.6, lw=0, label="plausible plants with noise"
    )
    axes.plot(time, seen.pv[rows], color=MODEL, lw=1.0, label="PV of the model, without noise")
    if design.loop == "closed":
        axes.step(time, design.signal[rows], where="post", color=MEASURED, lw=1.2, label="SP, to be set")
    _limits(axes, design.limits.pv)
    calm(axes, "PV", "", "PV")


def _limits(axes: Axes, limits: tuple[float, float]) -> None:
    for limit in limits:
        if np.isfinite(limit):
            axes.axhline(limit, color=ALERT, lw=1.0, ls="--", label="limits" if limit == limits[1] else None)


def _interval(axes: Axes, design: TestDesign, scale: float) -> None:
    growth = design.growth
    highest = TALLEST * min((value for value in growth["model"] if np.isfinite(value)), default=np.inf)
    known = False
    for name, colour, label in (
        ("model", MODEL, "if the model is right"),
        ("assured", BAND, "4 plausible plants in 5"),
    ):
        values = growth[name]
        shown = values < highest
        known = known or bool(shown.any())
        axes.plot(growth["time_s"][shown] / scale, values[shown], color=colour, lw=1.6, label=label)
    end = design.duration / scale
    rival = design.prs_expected[design.target]
    if np.isfinite(rival):
        axes.plot([end], [rival], "s", color=MEASURED, ms=6, clip_on=False, label="PRS of the same length")
    if design.wanted is not None:
        axes.axhline(design.wanted[design.target], color=ALERT, lw=1.0, ls="--", label="wanted")
    if known or np.isfinite(rival):
        axes.set_yscale("log")
        for axis_format in (axes.yaxis.set_major_formatter, axes.yaxis.set_minor_formatter):
            axis_format(lambda value, _: f"{value:.3g}" if f"{value:.0e}"[0] in "1235" else "")
        axes.tick_params(axis="y", which="minor", labelsize=7)
    calm(axes, f"Expected 95 % interval of the {_called(design.target)}, +-", "", "interval, units of OP")
