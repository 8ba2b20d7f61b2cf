"""The figure of a diagnosis of many records: size of each with its interval, the pooled band, and what each said."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lostmotion.diagnose import PooledDiagnosis
from lostmotion.plot.diagnosis_figure import advice_of, heading_of
from lostmotion.plot.style import ALERT, BAND, MEASURED, MODEL, calm, heading, labelled, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

COLOURS = {"for": ALERT, "against": MODEL, "nothing": "0.75"}
MOST_NAMES = 30  # under the lower axis; more would not be read


def pooled_figure(found: PooledDiagnosis, title: str | None = None, figure: Figure | SubFigure | None = None) -> Figure:
    """Sizes over time or order, and log-likelihoods.

    Parameters
    ----------
    found : PooledDiagnosis
    title : str, optional
        Heading; default the verdict.
    figure : matplotlib Figure or SubFigure, optional
        Drawn into instead of a new one.
    """
    figure = new_figure(12.0, 7.5, figure)
    heard = sum(bool(share.rows) for share in found.shares)
    heading(figure, title or f"One valve, {heard} records: {heading_of(found)}", advice_of(found))
    above = figure.add_subplot(2, 1, 1)
    below = figure.add_subplot(2, 1, 2, sharex=above)
    _sizes(above, found)
    _gains(below, found)
    return figure


def _sizes(axes: Axes, found: PooledDiagnosis) -> None:
    """Of every record that shows one, and the common one."""
    shown = [share for share in found.shares if share.rows and np.isfinite(share.size)]
    if np.isfinite(found.size):
        axes.axhspan(*found.interval, color=BAND, alpha=0.45, lw=0, label="all together (95 %)")
        axes.axhline(found.size, color=MODEL, lw=1.2)
    for share in shown:
        axes.plot([share.place] * 2, share.interval, color=COLOURS[share.said], lw=1.6)
        axes.plot(share.place, share.size, "o", color=COLOURS[share.said], ms=5)
    _line(axes, found, [share.place for share in shown if share.said == "for"])
    if not shown:
        axes.text(0.5, 0.5, "no record shows a size by itself", transform=axes.transAxes, ha="center", color=MEASURED)
    axes.set_ylim(bottom=0.0)
    axes.tick_params(labelbottom=False)
    calm(axes, "Size that each shows by itself", "", labelled("size, units of OP", found.record.op_unit))


def _line(axes: Axes, found: PooledDiagnosis, places: list[float]) -> None:
    """The trend, where it is seen."""
    if found.trend.seen and np.isfinite(found.size):
        ends = np.array([min(places), max(places)])
        middle = found.size + found.trend.slope * (ends - np.mean(places))
        axes.plot(ends, middle, color=MEASURED, lw=1.2, ls="--", label="trend")


def _gains(axes: Axes, found: PooledDiagnosis) -> None:
    heard = [share for share in found.shares if share.rows]
    places = [share.place for share in found.shares]
    width = 0.6 * min(np.diff(np.sort(places)), default=1.0)
    axes.bar([s.place for s in heard], [s.gain for s in heard], width, color=[COLOURS[s.said] for s in heard])
    axes.axhline(0.0, color="0.4", lw=0.8)
    timed = found.trend.unit == "day"
    if not timed and len(places) <= MOST_NAMES:
        axes.set_xticks(places, [share.name for share in found.shares], rotation=60, ha="right", fontsize=7)
    calm(
        axes,
        "Evidence of each: up for the fault, down against it; none: left out",
        "time, days" if timed else "",
        "log-likelihood over a linear process",
    )
