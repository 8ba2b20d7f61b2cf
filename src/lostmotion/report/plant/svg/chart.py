"""Frame of a chart: grid, ticks and names at their own size; what is drawn inside is stretched to the width."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from markupsafe import Markup

from lostmotion.arrays import FloatArray
from lostmotion.report.plant.svg.axis import Axis
from lostmotion.report.plant.svg.element import element, percent

WIDE, HIGH = 2000, 1000  # units of the stretched part: finer than any screen or paper shows
TOP, BELOW = 24, 34  # pixels of padding that the stylesheet gives a chart, for ticks and names


def chart(title: str, words: str, x: Axis, y: Axis, *marks: Markup, height: int = 200, kind: str = "") -> Markup:
    """A chart with its name and what it shows in words, for who cannot see it.

    Parameters
    ----------
    title, words : str
    x, y : Axis
    marks : Markup
        Of :func:`stretched`, or placed in percent of the plot.
    height : int
        Of the plot, pixels.
    kind : str
        Further class.
    """
    return element(
        "svg", element("title", title), element("desc", words), *_grid(x, y), *marks, *_ticks(x, y),
        class_=f"chart {kind}".strip(), role="img", aria_label=f"{title}. {words}", width="100%",
        height=height + TOP + BELOW,
    )  # fmt: skip


def stretched(*marks: Markup) -> Markup:
    """Part whose coordinates are those of :func:`place`; lines keep their width."""
    return element(
        "svg", *marks, class_="inner", viewBox=f"0 0 {WIDE} {HIGH}", preserveAspectRatio="none", width="100%",
        height="100%",
    )  # fmt: skip


def line(kind: str, x: Axis, y: Axis, across: FloatArray, up: FloatArray) -> Markup:
    """Line through points, broken where one is not known."""
    right, down = _places(x, across, WIDE), HIGH - _places(y, up, HIGH)
    known = np.isfinite(right) & np.isfinite(down)
    starts = known & ~np.concatenate([[False], known[:-1]])
    points = zip(starts[known].tolist(), np.rint(right[known]).astype(int).tolist(),
                 np.rint(down[known]).astype(int).tolist(), strict=True)  # fmt: skip
    parts = [f"M{one} {other}" if first else f"{one} {other}" for first, one, other in points]
    return element("path", class_=kind, d=" ".join(parts), vector_effect="non-scaling-stroke") if parts else Markup("")


def region(kind: str, x: Axis, y: Axis, corners: Iterable[tuple[float, float]]) -> Markup:
    """Filled polygon."""
    points = " ".join(f"{WIDE * x.share(one):.0f},{HIGH - HIGH * y.share(other):.0f}" for one, other in corners)
    return element("polygon", class_=kind, points=points)


def upright(kind: str, x: Axis, low: float, high: float) -> Markup:
    """Band over the whole height, from one value of x to another; cut at the ends of the axis."""
    ends = [min(max(x.share(end), 0.0), 1.0) for end in (low, high)]
    return element("rect", class_=kind, x=percent(ends[0]), width=percent(ends[1] - ends[0]), y=0, height="100%")


def _places(axis: Axis, values: FloatArray, units: int) -> FloatArray:
    return np.asarray(units * (np.asarray(values, dtype=np.float64) - axis.low) / (axis.high - axis.low))


def _grid(x: Axis, y: Axis) -> list[Markup]:
    across = [
        element("line", class_="grid", x1="0", x2="100%", y1=percent(1 - at), y2=percent(1 - at)) for at, _ in y.ticks()
    ]
    up = [element("line", class_="grid", y1="0", y2="100%", x1=percent(at), x2=percent(at)) for at, _ in x.ticks()]
    return across + up


def _ticks(x: Axis, y: Axis) -> list[Markup]:
    left = [
        element("text", text, class_="tick", x="0", dx="-6", y=percent(1 - at), dy="0.32em", text_anchor="end")
        for at, text in y.ticks()
    ]
    under = [
        element("text", text, class_="tick", x=percent(at), y="100%", dy="1.3em", text_anchor="middle")
        for at, text in x.ticks()
    ]
    names = [
        element("text", y.name, class_="axis", x="0", y="0", dx="-50", dy="-0.7em"),
        element("text", x.name, class_="axis", x="100%", y="100%", dy="2.5em", text_anchor="end"),
    ]
    return left + under + names
