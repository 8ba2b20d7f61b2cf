"""The texts of a figure: whether one lies over another, and whether their numbers can be read."""

from __future__ import annotations

import re
from itertools import combinations

TOUCHES = 1.0  # pixels that count as no overlap
MOST_DIGITS = 5


def texts_of(figure):
    """Headings, titles, legends and labels, with what they say."""
    found = [figure._suptitle, figure._supxlabel]
    for axes in figure.axes:
        found += [axes._left_title, axes.get_legend(), axes.xaxis.label, axes.yaxis.label]
    return [one for one in found if one is not None and (not hasattr(one, "get_text") or one.get_text())]


def overlaps(figure):
    """Pairs of texts that lie over each other, and texts that leave the figure."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas = FigureCanvasAgg(figure.get_figure(root=True) if hasattr(figure, "subfigp") else figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    texts = texts_of(figure)
    boxes = [one.get_window_extent(renderer) for one in texts]
    names = [one.get_text() if hasattr(one, "get_text") else f"legend {one.get_texts()[0].get_text()}" for one in texts]
    found = []
    for first, second in combinations(range(len(boxes)), 2):
        a, b = boxes[first], boxes[second]
        across = min(a.x1, b.x1) - max(a.x0, b.x0)
        along = min(a.y1, b.y1) - max(a.y0, b.y0)
        if min(across, along) > TOUCHES:
            found.append((names[first], names[second]))
    outer = figure.bbox
    for name, box in zip(names, boxes, strict=True):
        if box.x0 < outer.x0 - TOUCHES or box.x1 > outer.x1 + TOUCHES or box.y1 > outer.y1 + TOUCHES:
            found.append((name, "edge"))
    return found


def assert_readable(figure):
    assert overlaps(figure) == []
    headings = [figure._suptitle.get_text()] if figure._suptitle else []
    for text in (*headings, *(axes.get_title(loc="left") for axes in figure.axes)):
        for number in re.findall(r"\d[\d.]*(?:e[+-]?\d+)?", text.split(": ", 1)[-1]):
            assert "e" not in number, text
            assert len(number.replace(".", "").strip("0")) <= MOST_DIGITS, text
