"""One look for all figures: calm, readable in grey and by colour-blind eyes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lostmotion.extras import extra

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MEASURED = "0.45"
MODEL = "#0b5394"
BAND = "#9fc5e8"
ALERT = "#b45f06"
MOST_POINTS = 4000


def new_figure(width: float = 12.0, height: float = 8.0) -> Figure:
    """Figure that belongs to no window, so that it can be made anywhere."""
    with extra("plot"):
        from matplotlib.figure import Figure  # noqa: PLC0415  optional extra
    return Figure(figsize=(width, height), layout="constrained")


def labelled(name: str, unit: str) -> str:
    """Name with its unit in brackets, where there is one.

    Examples
    --------
    >>> labelled("PV", "m3/h"), labelled("PV", "")
    ('PV [m3/h]', 'PV')
    """
    return f"{name} [{unit}]" if unit else name


def calm(axes: Axes, title: str, x: str, y: str) -> None:
    """Title, labels, light grid, no box."""
    axes.set_title(title, loc="left", fontsize=10, fontweight="bold")
    axes.set_xlabel(x, fontsize=9)
    axes.set_ylabel(y, fontsize=9)
    axes.tick_params(labelsize=8)
    axes.grid(True, color="0.92", linewidth=0.8)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
