"""Trends: a stretch of a record as JSON, as a piece of a page, and as a page of its own."""

from __future__ import annotations

import json
from functools import lru_cache
from typing import Any
from urllib.parse import quote

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from lostmotion.report.plant.svg.trend_chart import trend_charts
from lostmotion.store.rows import AssessmentRow, TraceRow
from lostmotion.store.run_rows import RunRow
from lostmotion.web.page import Page, answer, told
from lostmotion.web.trend.slot import Slot, asked, slot
from lostmotion.web.trend.sources import Source, Sources
from lostmotion.web.trend.stretch import WIDEST, rows_between, trend_of
from lostmotion.web.trend.svg import signal_names, time_axis

USUAL = 1000  # pixels


@lru_cache(maxsize=8)
def sources(page: Page) -> Sources:
    """Those of a page."""
    return Sources(page)


def trend_slot(page: Page, request: Request, key: str, run: int | None = None) -> Slot | None:
    """What ``{% include "trend.html.j2" %}`` shows as `trend`; None: no such file or loop.

    Parameters
    ----------
    key : str
        "file:ID" or "loop:TAG".
    run : int, optional
        Of which the data are read; None: the last one that has the loop.
    """
    source = sources(page).of(key, run)
    return None if source is None else slot(source, request.url.path, request.query_params)


def loop_slot(page: Page, request: Request, made: RunRow, row: AssessmentRow, trace: TraceRow | None) -> Slot:
    """The same of a loop of the plant that somebody has found already: its run, row and stored picture."""
    return slot(sources(page).of_loop(made, row, trace), request.url.path, request.query_params)


def routes(page: Page) -> list[Route]:
    """Routes of this part."""

    def find(request: Request) -> Source | None:
        run = asked(request.query_params, "run", 0)
        return sources(page).of(request.query_params.get("source", ""), run or None)

    def missing(request: Request) -> Response:
        what = "Give source=file:ID of a file that was dropped, or source=loop:TAG of a loop of the plant."
        return told(page, request, 404, "No such trend", what)

    def as_json(request: Request) -> Response:
        source = find(request)
        if source is None:
            return missing(request)
        columns = source.columns
        if columns is None:
            status = 202 if source.state == "reading" else 410
            return JSONResponse({"state": source.state, "message": source.why}, status)
        query = request.query_params
        start, stop = rows_between(columns, asked(query, "start", 0), asked(query, "stop", len(columns)))
        found = trend_of(columns, start, stop, min(asked(query, "width", USUAL), WIDEST))
        head = {"source": source.key, "tag": columns.facts["tag"], "names": signal_names(columns)}
        return _json({**head, "axis": time_axis(columns, start, stop), **found})

    def state(request: Request) -> Response:
        source = find(request)
        if source is None:
            return missing(request)
        return JSONResponse({"state": "ready" if source.columns is not None else source.state, "message": source.why})

    def whole(request: Request) -> Response:
        source = find(request)
        if source is None:
            return missing(request)
        made = slot(source, request.url.path, request.query_params, with_actuator=True)
        part = request.query_params.get("part") == "1"
        stored = trend_charts(source.trace) if source.trace is not None and made.state != "ready" else ()
        template = "trend_pieces.html.j2" if part else "trend_page.html.j2"
        return answer(page, request, template, trend=made, name=source.name, stored=stored, back=_back(source.key))

    return [Route("/api/v1/trend", as_json), Route("/api/v1/trend/state", state), Route("/trend", whole)]


def _back(key: str) -> str:
    """Page of the file or loop."""
    kind, _, name = key.partition(":")
    return f"/files/{quote(name, safe='')}" if kind == "file" else f"/loops/{quote(name, safe='')}"


def _json(found: dict[str, Any]) -> Response:
    return Response(json.dumps(found, allow_nan=False, separators=(",", ":")), media_type="application/json")
