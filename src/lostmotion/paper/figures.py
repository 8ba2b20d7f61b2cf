"""Figures 3, 5 and 9 to 13 of the paper, with its axes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lostmotion.paper.control import LEVEL_AT_ZERO, ControlStudy
from lostmotion.paper.estimation import ZONE, EstimationStudy, Run
from lostmotion.paper.published import CONVERGED_BY, SYMBOLS, TABLE_1
from lostmotion.plot.style import ALERT, MEASURED, MODEL, calm, new_figure
from lostmotion.simulate import platforms
from lostmotion.simulate.platforms.level_tank import DT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = (MODEL, ALERT, "#38761d", "#741b47")
STYLES = ("-", "--", "-.", ":")


def characteristics() -> Figure:
    """Figures 3 and 5: dead zone and its inverse."""
    zone = platforms.level_tank().nonlinearity
    inverse = zone.inverse()  # type: ignore[attr-defined]
    figure = new_figure(9.0, 3.6)
    grid = np.linspace(-3, 3, 601)
    left, right = figure.subplots(1, 2)
    left.plot(grid, np.asarray(zone(grid)), color=MODEL)
    calm(left, "Figure 3: dead zone", "u", "x")
    for part in (grid[grid < 0], grid[grid > 0]):
        right.plot(part, np.asarray(inverse(part)), color=MODEL)
    right.plot([0], [0], "o", color=MODEL, ms=4)
    calm(right, "Figure 5: its inverse", "uc", "u")
    return figure


def trajectories(study: EstimationStudy) -> Figure:
    """Figure 9: A, B and the dead zone against time, first seed of the paper's method, all seeds faint."""
    runs = study.runs["riv"]
    figure = new_figure(9.0, 10.0)
    a_axes, b_axes, zone_axes = figure.subplots(3, 1, sharex=True)
    first = runs[0]
    time = first.samples * DT
    _lines(a_axes, time, first.polynomials[:, :3], ("a1", "a2", "a3"))
    _lines(b_axes, time, _b(first), ("b0", "b1", "b2"))
    for run in runs[1:]:
        zone_axes.plot(run.samples * DT, run.trajectory, color="0.85", lw=0.5, zorder=1)
    _lines(zone_axes, time, first.trajectory, ZONE)
    b_axes.set_ylim(-0.02, 0.05)
    zone_axes.set_ylim(-2, 5)
    calm(a_axes, "Figure 9 (a): polynomial A", "", "")
    calm(b_axes, "(b): polynomial B", "", "")
    calm(zone_axes, f"(c): dead zone; grey: {len(runs) - 1} more seeds", "time, s", "")
    for axes in (a_axes, b_axes, zone_axes):
        if time[-1] > CONVERGED_BY:
            axes.axvline(CONVERGED_BY, color="0.5", lw=0.8, ls=":")
    return figure


def _b(run: Run) -> np.ndarray:
    """Columns b0, b1, b2 along a run; theta holds b0 mr, so b0 needs the slope."""
    slope = run.trajectory[:, ZONE.index("right_slope")]
    return np.column_stack([run.polynomials[:, 3] / slope, run.polynomials[:, 7:9]])


def _lines(axes: object, time: np.ndarray, values: np.ndarray, names: tuple[str, ...]) -> None:
    for column, name in enumerate(names):
        label = SYMBOLS.get(name, name)
        axes.plot(  # type: ignore[attr-defined]
            time, values[:, column], color=COLOURS[column], ls=STYLES[column], lw=1.4, label=label, zorder=2
        )
        axes.axhline(TABLE_1[name][1], color=COLOURS[column], lw=0.6, alpha=0.6)  # type: ignore[attr-defined]


def responses(study: ControlStudy) -> Figure:
    """Figures 10 to 13: level without dead zone, with it, compensated; and both control signals."""
    figure = new_figure(10.0, 12.0)
    panels = figure.subplots(4, 1, sharex=True)
    titles = {
        "ideal": "Figure 10: level without dead zone",
        "without": "Figure 11: dead zone, no compensation",
        "with": "Figure 12: dead zone, compensated",
    }
    for axes, (case, title) in zip(panels, titles.items(), strict=False):
        loop = study.responses[case]
        axes.plot(loop.time, loop.measured + LEVEL_AT_ZERO, color=MODEL, lw=0.9, label="level")
        axes.plot(loop.time, loop.reference + LEVEL_AT_ZERO, color=ALERT, lw=1.2, ls="--", label="reference")
        axes.set_ylim(44, 56)
        calm(axes, title, "", "level, %")
    last = panels[3]
    without, with_it = study.responses["without"], study.responses["with"]
    last.plot(
        with_it.time, with_it.command + LEVEL_AT_ZERO, color=MODEL, lw=0.9, label="compensated (behind the inverse)"
    )
    last.plot(without.time, without.command + LEVEL_AT_ZERO, color=MEASURED, lw=1.2, ls="--", label="not compensated")
    calm(last, "Figure 13: control signals", "time, s", "control, %")
    return figure
