"""The figure of a diagnosis: trend, PV over OP, evidence; the verdict above, what to do below."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lostmotion.diagnose import Diagnosis
from lostmotion.diagnose.evidence_words import LABEL, balance, cause, probability
from lostmotion.diagnose.op_span import op_span
from lostmotion.diagnose.shown_rows import shown_rows
from lostmotion.identify.actuators.kind import faults
from lostmotion.plot.style import ALERT, BAND, MEASURED, MODEL, calm, heading, labelled, new_figure, one_panel, rounded
from lostmotion.plot.trend import draw_in_one, draw_trend
from lostmotion.records import LoopRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

NOTICEABLE = 0.05  # log-odds that are not written as 0
HEADING = {
    "none": "Nothing wrong with the actuator",
    "other oscillation": "The loop oscillates, but not because of the actuator",
    "cannot tell": "Cannot tell",
}


def diagnosis_figure(
    diagnosis: Diagnosis,
    title: str | None = None,
    figure: Figure | SubFigure | None = None,
    ax: Axes | None = None,
) -> Figure:
    """PV with SP and OP over time, PV over OP, log-odds of the evidence.

    Parameters
    ----------
    diagnosis : Diagnosis
    title : str, optional
        Heading; default the tag and the verdict.
    figure : matplotlib Figure or SubFigure, optional
        Drawn into instead of a new one.
    ax : matplotlib Axes, optional
        Takes the trend alone, OP on a scale at its right.

    Raises
    ------
    ParameterError
        Both `figure` and `ax`, or one that is of no such type.
    """
    rows, start = shown_rows(diagnosis)
    if ax is not None:
        return one_panel(ax, figure, lambda axes: draw_in_one(axes, rows, start))
    figure = new_figure(12.0, 8.5, figure)
    data = diagnosis.fit.data
    name = data.tag or data.source or "record"
    heading(figure, title or f"{name}: {heading_of(diagnosis)}", advice_of(diagnosis))
    grid = figure.add_gridspec(2, 1, height_ratios=(2.0, 1.5))
    trend, beside = grid[0].subgridspec(2, 1), grid[1].subgridspec(1, 2, width_ratios=(2.0, 3.0))
    above = figure.add_subplot(trend[0])
    draw_trend(above, figure.add_subplot(trend[1], sharex=above), rows, start)
    _phase(figure.add_subplot(beside[0]), diagnosis, rows)
    _evidence(figure.add_subplot(beside[1]), diagnosis)
    return figure


def heading_of(diagnosis: Diagnosis) -> str:
    """The verdict with size and confidence, in one line."""
    said = HEADING.get(diagnosis.verdict, diagnosis.verdict.capitalize())
    if diagnosis.kind not in ("none", "actuator", "unknown"):
        said += f": {diagnosis.kind}"
    if np.isfinite(diagnosis.size_percent):
        ends = np.array(diagnosis.interval) * diagnosis.size_percent / diagnosis.size
        spread = float(ends[1] - ends[0])
        between = (
            f"95 %: {rounded(ends[0], spread)} .. {rounded(ends[1], spread)}" if np.isfinite(spread) else "apparent"
        )
        size = rounded(diagnosis.size_percent, spread if spread > 0.0 else np.inf)
        said += f", {size} % {op_span(diagnosis.record).words} ({between})"
        said += "" if diagnosis.severity == "unknown" else f", severity {diagnosis.severity}"
    if diagnosis.verdict == "cannot tell":
        first = max(diagnosis.probabilities, key=diagnosis.probabilities.__getitem__)
        said += f"; most likely: {cause(first)}, {100 * diagnosis.probabilities[first]:.0f} %"
    else:
        said += f", confidence {probability(diagnosis.confidence)}"
    return said


def advice_of(diagnosis: Diagnosis) -> str:
    """What to do."""
    return "What to do: " + " ".join(diagnosis.advice)


def _phase(axes: Axes, diagnosis: Diagnosis, rows: LoopRecord) -> None:
    ends, what = _lost(diagnosis, rows)
    if ends is not None:
        axes.axvspan(*ends, color=BAND, alpha=0.45, lw=0, label=what)
    period = diagnosis.measured.period
    axes.plot(rows.op, rows.pv, color="0.65", lw=0.6, label="rows above" if np.isfinite(period) or what else None)
    if np.isfinite(period):
        last = slice(-max(int(2 * period), 2), None)
        axes.plot(rows.op[last], rows.pv[last], color=MODEL, lw=1.4, label="last two periods")
    calm(axes, "PV over OP", labelled("OP", rows.op_unit), labelled("PV", rows.pv_unit))


def _lost(diagnosis: Diagnosis, rows: LoopRecord) -> tuple[tuple[float, float] | None, str]:
    """Lost motion on the axis of OP: the dead zone where it is, else a band as wide in the middle of OP."""
    fit = diagnosis.fit
    if not np.isfinite(diagnosis.size) or diagnosis.verdict not in [kind.name for kind in faults()]:
        return None, ""
    if diagnosis.verdict == fit.kind.name and fit.kind.dead_between:
        low, high = (fit.parameters[name] for name in fit.kind.break_points)
        return (low, high), diagnosis.verdict
    middle = 0.5 * float(rows.op.min() + rows.op.max())
    half = 0.5 * diagnosis.size
    return (middle - half, middle + half), f"size of the {diagnosis.verdict}"


def _evidence(axes: Axes, diagnosis: Diagnosis) -> None:
    """All evidence, strongest above; below it where it starts from and what it comes to."""
    found = balance(diagnosis.probabilities, (item.weight for item in diagnosis.evidence))
    bars = [(LABEL.get(item.name, (item.name, ""))[0], item.weight) for item in diagnosis.evidence]
    bars += [("before evidence", found.before), ("together", found.total)]
    places, weights = -np.arange(len(bars)), [weight for _, weight in bars]
    colours = [ALERT if weight > 0 else MODEL for weight in weights[:-2]] + ["0.75", "0.35"]
    axes.barh(places, weights, color=colours, height=0.65)
    axes.axvline(0.0, color="0.4", lw=0.8)
    axes.axhline(places[-2] + 0.5, color="0.8", lw=0.8)
    axes.set_yticks(places, [name for name, _ in bars])
    reach = 1.25 * max(*(abs(weight) for weight in weights), 1.0)
    axes.set_xlim(-reach, reach)
    for place, weight in zip(places, weights, strict=True):
        text = f"{weight:+.1f}" if abs(weight) >= NOTICEABLE else "0"
        axes.annotate(
            text, (weight, place), xytext=(4 if weight >= 0 else -4, 0), textcoords="offset points",
            ha="left" if weight >= 0 else "right", va="center", fontsize=8, color=MEASURED,
        )  # fmt: skip
    calm(axes, f"Evidence: {found.fault} against no actuator fault", "log-odds: right for, left against", "")
    axes.grid(False, axis="y")
