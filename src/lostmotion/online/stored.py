"""What a state file may hold, value by value: nothing of it is used before this has been looked at."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

from lostmotion.errors import DataError
from lostmotion.files.grid import KINDS
from lostmotion.files.schema import checked, each, either, flag, group, number, one_of, or_null, row, text, whole
from lostmotion.online.masks import REASONS
from lostmotion.online.timeline import MOST_ANCHORS

WHAT = "a state"
REMEDY = "start anew with another state file, or take a backup"
LONG = 2.5e11  # s on either side of 1970, to the year 9999
SMALL, LARGE = 1e-100, 1e100  # of weights and widths
MOST_COLUMNS = MOST = 100_000
Check = Callable[[Any], float | None]

seconds = number(-LONG, LONG)
positive = number(1e-12, 1e12)
column, calendar = text(10_000), one_of("", "local", "UTC")
count = whole()

ASKED = group(
    op=column, pv=column, time=either(one_of(False), or_null(column)), mode=or_null(column),
    automatic=each(column, 1000), dt=or_null(positive),
)  # fmt: skip
LAYOUT = group(
    header=text(), names=each(column, MOST_COLUMNS, 1), delimiter=text(16), op=column, pv=column,
    time=or_null(column), mode=or_null(column), decimal=one_of(None, ".", ","), dt=positive, scale=positive,
    orders=each(one_of("day first", "month first", "year first", ""), 3), calendar=calendar,
    automatic=each(column, 1000), notes=each(text(), 1000), last_date=column, date=or_null(column),
)  # fmt: skip
GRID = group(
    clock=row(or_null(seconds), number(-LONG, LONG), seconds, one_of(0.0, 1.0)),
    counts=group(**dict.fromkeys(("rows", "inserted", *KINDS), count)),
)
MARK = group({"head": text(64), "tail": text(64)}, offset=count)
HEAD = {"version": one_of(1), "file": flag(), "asked": ASKED, "offset": count, "mark": MARK}
POSITION = either(
    group(**HEAD, layout=one_of(None)),
    group(**HEAD, lines=count, end=one_of("", "\n", "\r"), layout=LAYOUT, grid=GRID),
)
MONITOR = group(
    {"came": count},
    settings=group(
        dt=positive, report_every=whole(1), trend_every=whole(1), op_limits=or_null(row(number(), number())),
        frozen=or_null(whole(2)), width_limit=or_null(number(SMALL)), calendar=calendar,
    ),
    counts=group(missing=count, outliers=count),
    masks=group(counts=group(**dict.fromkeys(REASONS, count)), value=or_null(number()), run=count),
    timeline=group(anchors=each(row(count, seconds), MOST_ANCHORS), last=or_null(seconds), shift=seconds),
    trend=group(most=whole(4, MOST), points=each(row(seconds, number(-LARGE, LARGE), number(SMALL, LARGE)), MOST)),
    period_from=or_null(seconds), limit_told=flag(), failure=text(100_000), told=count, sigma=or_null(number(0.0)),
)  # fmt: skip


def check_position(position: Any) -> float | None:
    """Sampling time of the position of a follower; DataError where it is none."""
    stored: dict[str, Any] = checked(position, POSITION, WHAT, REMEDY)
    layout: dict[str, Any] | None = stored["layout"]
    if stored["mark"]["offset"] != stored["offset"] or stored["file"] != ("head" in stored["mark"]):
        _refuse("a mark that belongs to the offset", stored["mark"]["offset"])
    if stored["file"] != ("tail" in stored["mark"]):
        _refuse("a mark of a file with head and tail", "one without")
    if layout is None:
        return None
    names = layout["names"]
    used = [layout[name] for name in ("op", "pv", "time", "mode", "date") if layout[name] is not None]
    if len(set(names)) < len(names) or not {*used} <= {*names} or len(set(used)) < len(used):
        _refuse("columns out of the names, each once", used)
    if not layout["delimiter"] or (layout["date"] is not None and layout["time"] is None):
        _refuse("a delimiter, and a time beside a date", repr(layout["delimiter"]))
    if "" in layout["orders"] and len(layout["orders"]) > 1:
        _refuse("orders of dates, or times of day", layout["orders"])
    return float(layout["dt"])


def check_monitor(header: Any) -> dict[str, Any]:
    """Header of a monitor; DataError where it is none."""
    stored: dict[str, Any] = checked(header, MONITOR, WHAT, REMEDY)
    points = stored["trend"]["points"]
    if len(points) > stored["trend"]["most"] or any(after[0] <= before[0] for before, after in pairwise(points)):
        _refuse("points of the trend in order", f"{len(points)} others")
    anchors = stored["timeline"]["anchors"]
    if any(after[0] < before[0] for before, after in pairwise(anchors)):
        _refuse("anchors of the timeline in order", f"{len(anchors)} others")
    return stored


def _refuse(expected: str, got: Any) -> None:
    raise DataError.expected(f"{expected} in {WHAT}", str(got)[:100], REMEDY)
