"""The zoomable trend as a piece of a page: what its template shows, with links that zoom where there is no script."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlencode

from markupsafe import Markup
from starlette.datastructures import QueryParams

from lostmotion.errors import ParameterError
from lostmotion.report.digits import plain
from lostmotion.report.plant.svg.actuator_chart import actuator_chart
from lostmotion.report.plant.words import NO_ANSWER, moment_words, seconds_words
from lostmotion.web.trend.columns import Columns
from lostmotion.web.trend.sources import Source
from lostmotion.web.trend.stretch import rows_between, trend_of
from lostmotion.web.trend.svg import charts, plane, signal_names

WIDTH = 900  # pixels of a picture that does not know its screen
VENDOR = Path(__file__).parents[1] / "static" / "vendor" / "uPlot.iife.min.js"  # by `make web`; SVG without it
LEAST = 8  # rows of the narrowest zoom
PARTS = 12  # rows of the table
MOST_STRETCHES = 12  # that are listed in words


@dataclass(frozen=True)
class Slot:
    """What trend.html.j2 shows.

    Attributes
    ----------
    source : str
        As routes take it: "file:ID" or "loop:TAG".
    state : {"ready", "reading", "gone"}
    why : str
        Why there is nothing to draw.
    again : str
        Address of the page itself.
    start, stop, rows : int
    dt : float
    shown : str
        From when to when, in words.
    links : tuple of (str, str, str)
        Name of the step, what it does, address; empty address: not possible.
    charts : tuple of Markup
    names : mapping of str to str
    table : tuple
        Head and rows of the values.
    stretches : tuple of str
        What is shaded, in words.
    plane, actuator : Markup
    sized : bool
        A size was found: it stands as a band in `plane`.
    by_canvas : bool
        uPlot is there to draw it.
    """

    source: str
    state: str
    why: str = ""
    again: str = ""
    start: int = 0
    stop: int = 0
    rows: int = 0
    dt: float = 1.0
    shown: str = ""
    links: tuple[tuple[str, str, str], ...] = ()
    charts: tuple[Markup, ...] = ()
    names: Mapping[str, str] = field(default_factory=dict)
    table: tuple[tuple[str, ...], list[tuple[str, ...]]] = ((), [])
    stretches: tuple[str, ...] = ()
    plane: Markup = field(default_factory=Markup)
    actuator: Markup = field(default_factory=Markup)
    sized: bool = False
    by_canvas: bool = False


def slot(source: Source, path: str, query: QueryParams, with_actuator: bool = False) -> Slot:
    """Slot of a source for the rows that the address asks for (`start`, `stop`); all of them where it asks for none.

    Parameters
    ----------
    source : Source
    path : str
        Of the page in which it stands: its links lead there.
    query : QueryParams
        Of the request; other entries than its own are kept in the links.
    with_actuator : bool
        Draw the identified actuator beside PV over OP.

    Raises
    ------
    ParameterError
        `start` and `stop` are no rows of the record.
    """
    columns = source.columns
    if columns is None:
        return Slot(source.key, source.state, source.why, again=_address(path, query, {}))
    start, stop = rows_between(columns, asked(query, "start", 0), asked(query, "stop", len(columns)))
    found = trend_of(columns, start, stop, WIDTH)
    row, trace = source.row, source.trace
    op_unit = str(columns.facts["op_unit"])
    return Slot(
        source=source.key,
        state="ready",
        again=_address(path, query, {}),
        start=start,
        stop=stop,
        rows=len(columns),
        dt=columns.dt,
        shown=shown_words(columns, start, stop),
        links=tuple(
            (name, said, _address(path, query, {"start": ends[0], "stop": ends[1]}) if ends else "")
            for name, said, ends in steps(start, stop, len(columns))
        ),
        charts=charts(found, columns),
        names=signal_names(columns),
        table=values(columns, start, stop),
        stretches=tuple(_stretches(found["shaded"], columns)),
        plane=plane(columns, start, stop, row, trace),
        actuator=actuator_chart(trace, op_unit) if with_actuator and trace is not None else Markup(""),
        sized=row is not None and row.size is not None,
        by_canvas=VENDOR.is_file(),
    )


def asked(query: Mapping[str, str], name: str, usual: int) -> int:
    """Whole number of the address.

    Raises
    ------
    ParameterError
        It is none.
    """
    given = query.get(name, "")
    if not given:
        return usual
    try:
        return min(max(int(given[:20]), -(2**53)), 2**53)
    except ValueError:
        raise ParameterError.expected(f"a whole number as {name}", repr(given[:40]), "leave it out") from None


def steps(start: int, stop: int, rows: int) -> list[tuple[str, str, tuple[int, int] | None]]:
    """Name, words and rows of each step from here; None: it leads nowhere.

    Examples
    --------
    >>> [ends for _, _, ends in steps(0, 100, 100)], steps(50, 70, 100)[1][2]
    ([(25, 75), None, None, None, None], (40, 80))
    """
    length = stop - start
    half, nearer = length // 2, max(length // 2, min(LEAST, length))
    low, high = max(start - half, 0), min(stop + half, rows)
    first = start + (length - nearer) // 2
    return [
        ("in", "Zoom in", (first, first + nearer) if nearer < length else None),
        ("out", "Zoom out", (low, high) if length < rows else None),
        ("earlier", "Earlier", (low, low + length) if start > 0 else None),
        ("later", "Later", (high - length, high) if stop < rows else None),
        ("all", "Show all", (0, rows) if length < rows else None),
    ]


def shown_words(columns: Columns, start: int, stop: int) -> str:
    """From when to when, and how long."""
    first, last = columns.moment(start), columns.moment(stop - 1)
    long = seconds_words((stop - start) * columns.dt)
    if first is not None and last is not None:
        return f"{moment_words(first)} to {moment_words(last)} ({long} of data)"
    return f"{seconds_words(start * columns.dt)} to {seconds_words(stop * columns.dt)} after the start ({long})"


def values(columns: Columns, start: int, stop: int) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Head and rows of a table: lowest and highest of each signal in equal parts of what is shown."""
    found = trend_of(columns, start, stop, PARTS)
    names = [name for name in ("pv", "sp", "op", "position") if name in found]
    head = ("From", *(f"{signal_names(columns)[name]} {end}" for name in names for end in ("lowest", "highest")))
    each = 1 if found["finest"] else 2
    rows = []
    for place in range(0, len(found["t"]), each):
        cells = [end for name in names for end in _ends(found[name][place : place + each])]
        rows.append((_when(columns, round(found["t"][place] / columns.dt)), *cells))
    return head, rows


def _ends(drawn: list[float | None]) -> tuple[str, str]:
    known = [one for one in drawn if one is not None]
    return (plain(min(known)), plain(max(known))) if known else (NO_ANSWER, NO_ANSWER)


def _when(columns: Columns, row: int) -> str:
    moment = columns.moment(row)
    return seconds_words(row * columns.dt) if moment is None else f"{moment:%Y-%m-%d %H:%M:%S}"


def _stretches(shaded: list[tuple[float, float, str]], columns: Columns) -> list[str]:
    said = [
        f"{what}: {_when(columns, round(low / columns.dt))}, {seconds_words(high - low)}" for low, high, what in shaded
    ]
    left = len(said) - MOST_STRETCHES
    return said[:MOST_STRETCHES] + ([f"{left} more; zoom in to see them one by one"] if left > 0 else [])


def _address(path: str, query: QueryParams, own: Mapping[str, int]) -> str:
    kept = [(name, value) for name, value in query.multi_items() if name not in ("start", "stop", "part", "width")]
    pairs = [*kept, *((name, str(value)) for name, value in own.items())]
    return f"{path}?{urlencode(pairs)}#trend" if pairs else f"{path}#trend"
