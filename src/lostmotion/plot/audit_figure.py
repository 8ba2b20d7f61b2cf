"""The figure of an audit: verdicts, the first of the ranking with their sizes, and what could be judged."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from lostmotion.audit.health import Health, health_of
from lostmotion.audit.plant_view import PlantView
from lostmotion.audit.row_facts import ends_percent
from lostmotion.plot.style import ALERT, BAND, MEASURED, MODEL, calm, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_LOOPS = 20  # of the ranking: more names would not be read
TICKS = (0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)  # % of span
LONGEST = 24  # letters of a tag


def audit_figure(view: PlantView, title: str | None = None) -> Figure:
    """Sizes of the first loops with their intervals; beside them verdicts and health.

    Parameters
    ----------
    view : PlantView
    title : str, optional
        Heading; default the plant and how many loops could be judged.
    """
    figure = new_figure(12.0, 8.0)
    health = health_of(view)
    heading = title or f"{view.run.plant or 'Audit'}: {health.judged} of {health.loops} loops could be judged"
    figure.suptitle(heading, fontsize=13, fontweight="bold", x=0.01, ha="left", parse_math=False)
    grid = figure.add_gridspec(2, 3)
    _ranking(figure.add_subplot(grid[:, :2]), view)
    _verdicts(figure.add_subplot(grid[0, 2]), view)
    _health(figure.add_subplot(grid[1, 2]), health)
    return figure


def _ranking(axes: Axes, view: PlantView) -> None:
    """Size and interval of each, most urgent above; a band up to what is not excluded."""
    rows = [row for row in view.leading if row.priority][:MOST_LOOPS]
    for place, row in enumerate(rows):
        if row.size_percent is not None:
            low, high = ends_percent(row) or (row.size_percent, row.size_percent)
            axes.plot([low, high], [-place] * 2, color=MODEL, lw=3)
            axes.plot(row.size_percent, -place, "o", color=MODEL, ms=6)
        elif row.excluded_percent is not None:
            axes.plot([0.0, min(row.excluded_percent, TICKS[-1])], [-place] * 2, color=MEASURED, lw=1.5, ls="--")
    names = [f"{_short(row.tag)}  {row.said}  {row.priority:.0f}" for row in rows]
    axes.set_yticks([-place for place in range(len(rows))], names, parse_math=False)
    axes.set_xscale("symlog", linthresh=1.0)  # 1 % and 60 % in one picture
    axes.set_xticks(TICKS, [f"{tick:g}" for tick in TICKS])
    axes.set_xlim(0.0, TICKS[-1])
    axes.axvspan(0.0, 1.0, color=BAND, alpha=0.35, lw=0, label="up to 1 %: recommended for control valves")
    said = "size, % of span, with its 95 % interval; dashed: not excluded"
    calm(axes, "Where to look first: loop, verdict, priority", said, "")
    axes.grid(False, axis="y")


def _verdicts(axes: Axes, view: PlantView) -> None:
    counts = Counter(row.said for row in view.leading).most_common()
    _bars(axes, counts, MODEL)
    calm(axes, "Verdicts", "loops", "")


def _health(axes: Axes, health: Health) -> None:
    counts = [
        ("judged", health.judged),
        ("cannot tell", health.cannot_tell),
        ("not assessed", health.screened),
        ("failed", health.failed),
        ("not reached", health.without_row),
    ]
    _bars(axes, [(name, count) for name, count in counts if count], ALERT)
    calm(axes, "What could be judged", "loops", "")


def _bars(axes: Axes, counts: list[tuple[str, int]], colour: str) -> None:
    """Bars with their numbers, the first above."""
    places = [-place for place in range(len(counts))]
    axes.barh(places, [count for _, count in counts], color=colour, height=0.65)
    axes.set_yticks(places, [name for name, _ in counts])
    for place, (_, count) in zip(places, counts, strict=True):
        axes.annotate(str(count), (count, place), xytext=(4, 0), textcoords="offset points", va="center", fontsize=8)
    axes.margins(x=0.15)
    axes.locator_params(axis="x", integer=True)


def _short(tag: str) -> str:
    return tag if len(tag) <= LONGEST else f"{tag[: LONGEST - 2]}.."
