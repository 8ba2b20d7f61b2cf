"""Small bars that stand in a cell of a table; the number stands beside them."""

from __future__ import annotations

from markupsafe import Markup

from lostmotion.audit.row_facts import ends_percent
from lostmotion.report.plant.svg.element import element, percent
from lostmotion.report.plant.words import excluded_words
from lostmotion.store.rows import AssessmentRow

ODDS = 4.0  # of log-odds: longer bars say no more
BASE = element("line", class_="base", x1="0", x2="100%", y1="50%", y2="50%")


def size_bar(row: AssessmentRow, most: float) -> Markup:
    """Size with its interval on a line from 0 to `most` %; dashed up to what is not excluded."""
    marks = [BASE]
    if row.size_percent is not None:
        low, high = ends_percent(row) or (row.size_percent, row.size_percent)
        marks.append(_span("whisker", low / most, high / most))
        marks.append(_dot(row.size_percent / most))
    elif row.excluded_percent is not None and excluded_words(row):
        marks.append(_span("open", 0.0, row.excluded_percent / most))
    return _small(*marks)


def count_bar(count: int, most: int) -> Markup:
    """Bar from the left."""
    return _small(element("rect", class_="count", x="0", y="20%", height="60%", width=percent(count / max(most, 1))))


def odds_bar(weight: float) -> Markup:
    """Bar from the middle: to the right for the fault, to the left against it."""
    share = 0.5 * min(abs(weight) / ODDS, 1.0)
    middle = element("line", class_="base", x1="50%", x2="50%", y1="0", y2="100%")
    kind, start = ("for", 0.5) if weight > 0 else ("against", 0.5 - share)
    return _small(element("rect", class_=kind, x=percent(start), y="20%", height="60%", width=percent(share)), middle)


def _small(*marks: Markup) -> Markup:
    return element("svg", *marks, class_="bar", aria_hidden="true", width="100%", height="16")


def _dot(share: float) -> Markup:
    """Circle at the size; an arrow where that is beyond the line."""
    if share > 1.0:
        return element("text", "▶", class_="beyond", x="100%", y="50%", dy="0.35em", text_anchor="end")
    return element("circle", class_="dot", cx=percent(_inside(share)), cy="50%", r=4)


def _span(kind: str, low: float, high: float) -> Markup:
    return element("line", class_=kind, x1=percent(_inside(low)), x2=percent(_inside(high)), y1="50%", y2="50%")


def _inside(share: float) -> float:
    return min(max(share, 0.0), 1.0)
