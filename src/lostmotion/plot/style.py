"""One look for all figures: calm, readable in grey and by colour-blind eyes; no text lies over another."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable
from typing import TYPE_CHECKING

from lostmotion.errors import ParameterError
from lostmotion.extras import extra
from lostmotion.working_folder import import_matplotlib

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

MEASURED = "0.45"
MODEL = "#0b5394"
BAND = "#9fc5e8"
ALERT = "#b45f06"
MOST_POINTS = 4000

WIDE, PANEL = 9.0, (2.6, 1.3)  # inches of a figure, and of a panel, below which letters shrink with it
SMALLEST = 0.65  # of the usual size
BOLD, NORMAL = 0.62, 0.55  # mean width of a letter of DejaVu Sans over its size
MIN_LETTERS = 12  # a line of fewer is no line any more, however narrow the panel
LEGEND_SIZE, LEGEND_ROW = 8, 12.0  # points: letters, and what a row takes between title and panel
HANDLE = 7  # letters that a handle and the gap beside it are wide
UNPLACED, LABELS = 0.775, 0.6  # share of a figure that panels have before a layout, inches that labels take after it
MAX_DIGITS = 5  # of a number in a title
PLAIN_RANGE = (1e-4, 1e6)  # numbers outside are written with an exponent


def new_figure(width: float = 12.0, height: float = 8.0, figure: Figure | SubFigure | None = None) -> Figure:
    """Figure that belongs to no window, so that it can be made anywhere; or the given one, to draw into.

    Parameters
    ----------
    width, height : float
        Of a new figure, in inches.
    figure : matplotlib Figure or SubFigure, optional
        Taken instead of a new one; what it holds stays. A figure without a layout engine gets the constrained one.
    """
    with extra("plot"):
        import_matplotlib()
        from matplotlib.figure import Figure  # noqa: PLC0415  optional extra
    if figure is None:
        return Figure(figsize=(width, height), layout="constrained")
    if not hasattr(figure, "add_gridspec"):
        remedy = "pass a Figure or a SubFigure; an Axes is taken as ax"
        raise ParameterError.expected("a matplotlib figure", type(figure).__name__, remedy)
    if isinstance(figure, Figure) and figure.get_layout_engine() is None:
        figure.set_layout_engine("constrained")
    return figure  # type: ignore[return-value]  # a SubFigure draws as a Figure does


def one_panel(ax: Axes, figure: Figure | SubFigure | None, draw: Callable[[Axes], None]) -> Figure:
    """Draw one panel into an Axes that the caller has made, and return its figure.

    Raises
    ------
    ParameterError
        Also a figure is given, or `ax` is no Axes.
    """
    if figure is not None:
        raise ParameterError.expected("figure= or ax=", "both", "leave one out: ax takes one panel, figure all of them")
    if not hasattr(ax, "twinx"):
        raise ParameterError.expected("a matplotlib Axes", type(ax).__name__, "pass one of figure.axes")
    draw(ax)
    return ax.figure  # type: ignore[return-value]


def heading(figure: Figure, text: str, below: str = "") -> None:
    """Write what was found above a figure and, smaller, what follows from it below; both wrapped to its width."""
    inches = figure.bbox.width / figure.dpi
    scale = min(max(inches / WIDE, SMALLEST), 1.0)
    text = _wrapped(text, inches, 13 * scale * BOLD)
    figure.suptitle(text, fontsize=13 * scale, fontweight="bold", x=0.01, ha="left", parse_math=False)
    if below:
        below = _wrapped(below, inches, 9 * scale * NORMAL)
        figure.supxlabel(below, fontsize=9 * scale, x=0.01, ha="left", parse_math=False)


def _wrapped(text: str, inches: float, letter: float) -> str:
    """Text in lines that are at most so wide; `letter` is the width of one in points."""
    letters = max(int(72.0 * inches / letter), MIN_LETTERS)
    held = text.replace(" %", "\u00a0%").replace(" .. ", "\u00a0..\u00a0")  # numbers stay together
    lines = "\n".join(textwrap.fill(line, letters, break_long_words=False) for line in held.split("\n"))
    return lines.replace("\u00a0", " ")


def labelled(name: str, unit: str) -> str:
    """Name with its unit in brackets, where there is one.

    Examples
    --------
    >>> labelled("PV", "m3/h"), labelled("PV", "")
    ('PV [m3/h]', 'PV')
    """
    return f"{name} [{unit}]" if unit else name


def rounded(value: float, spread: float) -> str:
    """Number with two digits of its spread, and five altogether at most.

    Examples
    --------
    >>> rounded(2.00667, 0.04), rounded(50123.4, 0.1), rounded(2.388e10, 1.0), rounded(2.0048, 0.0)
    ('2.007', '50123', '2.388e+10', '2')
    """
    size = abs(value)
    if not math.isfinite(value) or not PLAIN_RANGE[0] <= size < PLAIN_RANGE[1]:
        return f"{value:.4g}"
    if not (math.isfinite(spread) and spread > 0.0):
        return f"{value:.3g}"
    places = min(1 - math.floor(math.log10(spread)), MAX_DIGITS - 1 - math.floor(math.log10(size)))
    return f"{value:.{max(places, 0)}f}"


def calm(axes: Axes, title: str, x: str, y: str) -> None:
    """Title, labels, light grid, no box; what has a label stands in a row of its own under the title.

    To be called when all is drawn. Texts are wrapped to the size that the panel has now, and are smaller in small ones.
    """
    width, height = _size_of(axes)
    scale = min(max(min(width / PANEL[0], height / PANEL[1]), SMALLEST), 1.0)
    rows = 0 if axes.get_legend() else _legend(axes, width, scale)
    pad = 6.0 + LEGEND_ROW * scale * rows
    title = _wrapped(title, width, 10 * scale * BOLD)
    axes.set_title(title, loc="left", fontsize=10 * scale, fontweight="bold", pad=pad, parse_math=False)
    axes.set_xlabel(_wrapped(x, width, 9 * scale * NORMAL), fontsize=9 * scale, parse_math=False)
    axes.set_ylabel(_wrapped(y, height, 9 * scale * NORMAL), fontsize=9 * scale, parse_math=False)
    axes.tick_params(labelsize=8 * scale)
    axes.xaxis.get_offset_text().set_fontsize(8 * scale)
    axes.grid(True, color="0.92", linewidth=0.8)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _size_of(axes: Axes) -> tuple[float, float]:
    """Width and height of a panel in inches, as a layout that is yet to come will make them."""
    width, height = axes.bbox.width / axes.figure.dpi, axes.bbox.height / axes.figure.dpi
    if axes.figure.get_layout_engine() is None or axes.get_subplotspec() is None:
        return width, height
    return max(width / UNPLACED - LABELS, 0.5 * width), max(height / UNPLACED - LABELS, 0.5 * height)


def _legend(axes: Axes, width: float, scale: float) -> int:
    """Legend between title and panel, in as few rows as its names allow; return how many."""
    handles, names = axes.get_legend_handles_labels()
    if not names:
        return 0
    letters = 72.0 * width / (NORMAL * LEGEND_SIZE * scale)
    columns = next(count for count in range(len(names), 0, -1) if _length(names, count) <= letters or count == 1)
    axes.legend(
        handles, names, fontsize=LEGEND_SIZE * scale, frameon=False, ncols=columns, loc="lower left",
        bbox_to_anchor=(0.0, 1.0), borderaxespad=0.0, borderpad=0.2, handlelength=1.6, columnspacing=1.2,
        labelspacing=0.2,
    )  # fmt: skip
    return math.ceil(len(names) / columns)


def _length(names: list[str], columns: int) -> int:
    """Letters of a row of a legend, which matplotlib fills column by column, the first ones longer."""
    rows, longer = divmod(len(names), columns)
    lengths, first = 0, 0
    for column in range(columns):
        end = first + rows + (column < longer)
        lengths += max(map(len, names[first:end])) + HANDLE
        first = end
    return lengths
