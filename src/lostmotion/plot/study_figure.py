"""The figure of a compensation study: trend before and after above, the spread over the uncertainty below."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lostmotion.evaluate import CompensationStudy
from lostmotion.evaluate.study.mistakes import GROUPS
from lostmotion.plot.style import ALERT, MEASURED, MODEL, calm, heading, new_figure
from lostmotion.plot.time_axis import set_ticks, unit_of
from lostmotion.simulate import LoopResponse

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

MOST_ROWS = 2000
FAR = 5.0  # times the IAE as it is: beyond it the axis is logarithmic
MARKS = {"2 standard errors": "o", "20 %": "s", "drawn": "."}
SHOWN = {"retuned": "retuned", "with, retuned": "block, retuned", "no fault": "no fault"}


def study_figure(
    study: CompensationStudy, title: str | None = None, figure: Figure | SubFigure | None = None
) -> Figure:
    """PV with SP and OP before and after, IAE and limit cycle on every plant that was tried.

    Parameters
    ----------
    study : CompensationStudy
    title : str, optional
        Heading; default the recommendation.
    figure : matplotlib Figure or SubFigure, optional
        Drawn into instead of a new one.
    """
    figure = new_figure(12.0, 9.0, figure)
    after = "with, retuned" if study.recommendation == "compensate and retune" else "with"
    first = 3 if after == "with, retuned" else 1
    heading(figure, title or study.reasons[0], " ".join(study.reasons[first : first + 2]))
    grid = figure.add_gridspec(3, 2, height_ratios=(1.0, 1.0, 1.4))
    left, right = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[0, 1])
    right.sharey(left)
    below = [figure.add_subplot(grid[1, 0], sharex=left), figure.add_subplot(grid[1, 1], sharex=right)]
    below[1].sharey(below[0])
    name = "With block and retuned controller" if after == "with, retuned" else "With the block"
    for upper, lower, case, said in ((left, below[0], "without", "As it is"), (right, below[1], after, name)):
        _trend(upper, lower, study.responses[case], study.settle, said)
    _errors(figure.add_subplot(grid[2, 0]), study, after)
    _cycles(figure.add_subplot(grid[2, 1]), study, after)
    return figure


def _trend(above: Axes, below: Axes, loop: LoopResponse, settle: int, name: str) -> None:
    rows = slice(settle, settle + MOST_ROWS)
    time = loop.time[rows] - loop.time[settle]
    unit, length = unit_of(float(time[-1])), float(time[-1])
    time = time / unit.seconds
    above.plot(time, loop.measured[rows], color=MEASURED, lw=0.7, label="PV")
    above.plot(time, loop.reference[rows], color=ALERT, lw=1.3, ls="--", label="SP")
    below.plot(time, loop.command[rows], color=MODEL, lw=0.8, label="to the valve")
    if (loop.command != loop.control).any():
        below.plot(time, loop.control[rows], color=ALERT, lw=0.8, alpha=0.8, label="of the controller")
    for axes in (above, below):
        axes.margins(x=0.0)
    above.tick_params(labelbottom=False)
    calm(above, name, "", "PV, SP")
    set_ticks(below, unit, length)
    calm(below, "Command", unit.label, "OP")


def _errors(axes: Axes, study: CompensationStudy, after: str) -> None:
    """IAE over that without, plant by plant."""
    cases = study.mistakes_retuned if after == "with, retuned" else study.mistakes
    for place, group in enumerate(GROUPS):
        ratios = sorted(case.ratio for case in cases if case.group == group)
        across = place + np.linspace(-0.3, 0.3, len(ratios)) if len(ratios) > 1 else np.array([place] * len(ratios))
        axes.plot(across, ratios, MARKS[group], color=MODEL, ms=6 if group != "drawn" else 9, alpha=0.75, ls="none")
    axes.axhline(1.0, color="0.35", lw=1.2)
    lines = {"as it is": 1.0, "block, estimate right": study.cases[after].ratio}
    lines |= {said: study.cases[name].ratio for name, said in SHOWN.items() if name != after}
    axes.axhline(study.cases[after].ratio, color=MODEL, lw=1.0, ls="--")
    everything = [case.ratio for case in cases] + list(lines.values())
    if max(everything) > FAR:
        axes.set_yscale("log")
    for place, value in enumerate(lines.values()):
        axes.plot(3.0 + place, value, "D", color=ALERT if value > 1.0 else "0.35", ms=6)
        axes.annotate(f"{value:.3g}", (3.0 + place, value), xytext=(0, 7), textcoords="offset points",
                      ha="center", fontsize=8, color=MEASURED)  # fmt: skip
    names = ["2 standard\nerrors", "20 %", "drawn", *(said.replace(" ", "\n", 1) for said in lines)]
    axes.set_xticks(range(len(names)), names)
    axes.axvline(2.5, color="0.8", lw=0.8)
    axes.margins(y=0.12)
    calm(axes, "Error (IAE) over that of today; on the left: block of a wrong estimate", "", "IAE ratio")


def _cycles(axes: Axes, study: CompensationStudy, after: str) -> None:
    """Limit cycle with over limit cycle without, and what the describing function says."""
    cases = study.mistakes_retuned if after == "with, retuned" else study.mistakes
    pairs = {
        group: [(c.without.amplitude, c.compensated.amplitude) for c in cases if c.group == group] for group in GROUPS
    }
    most = max((value for rows in pairs.values() for pair in rows for value in pair), default=0.0)
    now, then = study.cases["without"], study.cases[after]
    most = max(most, now.cycle.amplitude, then.cycle.amplitude)
    if most == 0.0:
        axes.text(0.5, 0.5, f"no limit cycle on any of {len(cases)} plants,\nwith or without the block", ha="center",
                  va="center", transform=axes.transAxes, fontsize=10, color=MEASURED)  # fmt: skip
        axes.set_xticks([])
        axes.set_yticks([])
        calm(axes, "Limit cycle of PV", "", "")
        return
    axes.plot([0.0, 1.1 * most], [0.0, 1.1 * most], color="0.35", lw=1.2)
    for group, rows in pairs.items():
        if rows:
            axes.plot(*np.array(rows).T, MARKS[group], color=MODEL, alpha=0.75, ls="none", label=group,
                      ms=6 if group != "drawn" else 9)  # fmt: skip
    axes.plot(now.cycle.amplitude, then.cycle.amplitude, "D", color=ALERT, label="estimate right")
    if now.predicted is not None and then.predicted is not None:
        axes.plot(now.predicted.amplitude, then.predicted.amplitude, "x", color=ALERT, ms=9, mew=2,
                  label="the same, describing function")  # fmt: skip
    axes.set_xlim(-0.03 * most, 1.15 * most)
    axes.set_ylim(-0.03 * most, 1.15 * most)
    said = "Limit cycle of PV; below the line: smaller with the block"
    calm(axes, said, "amplitude as it is", "amplitude with the block")
