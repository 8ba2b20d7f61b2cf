"""JSON under /api/v1/: what the pages show, under the names of the rows of the store (docs/page.md)."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from datetime import datetime
from typing import Any

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from lostmotion.audit.health import Health
from lostmotion.errors import ParameterError
from lostmotion.web.page import Page, told
from lostmotion.web.plant.loop_pages import MOST_FORM, attached, put_review, tag_of
from lostmotion.web.plant.overview import Overview
from lostmotion.web.plant.query import Query
from lostmotion.web.plant.stored import Plant

ROOT = "/api/v1"
SIMPLE = frozenset((str, int, bool, type(None)))  # what JSON has as it is


def routes(page: Page, plant: Plant) -> list[Route]:
    """Routes of this part."""

    def of_run(asked: Any) -> Any:
        def answered(request: Request) -> Response:
            query = Query.of(request.query_params)
            overview = plant.overview(query.run)
            if overview is None:
                return told(page, request, 404, "No such run", "The store has no run of this number.")
            found = asked(plant, overview, query, request)
            if found is None:
                return told(page, request, 404, "No such loop", "The run has no loop of this name.")
            return JSONResponse(found) if not isinstance(found, Response) else found

        return plant.answers.route(answered)

    def runs(request: Request) -> Response:  # noqa: ARG001  the signature of a route
        return JSONResponse({"runs": plain(plant.runs())})

    async def review(request: Request) -> Response:
        given = await _json_of(request)
        tag = str(given.get("tag", ""))
        await run_in_threadpool(put_review, plant, tag, given)
        return JSONResponse({"reviews": plain(await run_in_threadpool(plant.store.reviews, tag))}, 201)

    return [
        Route(f"{ROOT}/runs", plant.answers.route(runs, keep=False)),
        Route(f"{ROOT}/loops", of_run(_loops)),
        Route(f"{ROOT}/loops/{{tag:path}}", of_run(_loop)),
        Route(f"{ROOT}/groups", of_run(_groups)),
        Route(f"{ROOT}/health", of_run(_health)),
        Route(f"{ROOT}/counts", of_run(_counts)),
        Route(f"{ROOT}/news", of_run(_news)),
        Route(f"{ROOT}/reviews", of_run(_reviews)),
        Route(f"{ROOT}/reviews", review, methods=["POST"]),
    ]


def plain(value: Any) -> Any:
    """JSON-ready, with the names of the fields; numbers that JSON does not know are null.

    Examples
    --------
    >>> from lostmotion.store.rows import GroupRow
    >>> plain(GroupRow(1, float("inf"), "FIC-1", None, "", ()))
    {'number': 1, 'period': None, 'source': 'FIC-1', 'confidence': None, 'why': '', 'members': []}
    """
    kind = type(value)
    if kind in SIMPLE:
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, list | tuple):
        return [plain(one) for one in value]
    if isinstance(value, datetime):
        return value.isoformat()
    if isinstance(value, Mapping):
        return {str(key): plain(one) for key, one in value.items()}
    names = _names(kind)
    return {name: plain(getattr(value, name)) for name in names} if names else value


def _names(kind: type[Any]) -> tuple[str, ...]:
    """Fields of a row; none of what is no row."""
    if kind not in _NAMES:
        _NAMES[kind] = tuple(one.name for one in fields(kind)) if is_dataclass(kind) else ()
    return _NAMES[kind]


_NAMES: dict[type[Any], tuple[str, ...]] = {}


def _loops(plant: Plant, overview: Overview, query: Query, request: Request) -> dict[str, Any]:  # noqa: ARG001
    shown = overview.shown(query)
    last = shown.first + len(shown.lines) > shown.total
    page = (shown.first - 1) // query.per + 1
    return {
        "run": overview.run.number,
        "total": shown.total,
        "page": page,
        "per": query.per,
        "next": None if last else f"{ROOT}/loops{query.words(page=page + 1)}",
        "loops": [
            {**plain(line.loop), "review": str(line.review), "assessment": plain(line.row)} for line in shown.lines
        ],
    }


def _loop(plant: Plant, overview: Overview, query: Query, request: Request) -> Any:  # noqa: ARG001
    said = plant.loop(overview, tag_of(request))
    if said is None:
        return None
    view, tag = said.view, said.view.row.tag
    found = {
        "run": overview.run.number,
        "loop": plain(plant.store.loop(tag)),
        "assessment": plain(view.row),
        "windows": plain(view.windows),
        "history": plain(view.history),
        "growth": view.growth,
        "group": plain(view.group),
        "model": json.loads(view.trace.model) if view.trace is not None and view.trace.model else None,
        "reviews": plain(said.reviews),
    }
    return JSONResponse(found, headers=attached(f"{tag}.json") if request.query_params.get("download") else None)


def _groups(plant: Plant, overview: Overview, query: Query, request: Request) -> dict[str, Any]:  # noqa: ARG001
    return {"run": overview.run.number, "groups": plain(overview.groups)}


def _news(plant: Plant, overview: Overview, query: Query, request: Request) -> dict[str, Any]:  # noqa: ARG001
    before = overview.before
    return {
        "run": overview.run.number,
        "before": None if before is None else before.number,
        "news": plain(overview.news),
    }


def _health(plant: Plant, overview: Overview, query: Query, request: Request) -> dict[str, Any]:  # noqa: ARG001
    health: Health = overview.health
    found = plain(health)
    for name in ("not_judged", "data"):
        reasons = getattr(health, name)
        found[name] = [{"text": one.text, "loops": len(one.tags), "tags": list(one.tags[:100])} for one in reasons]
    return {"run": overview.run.number, "judged": health.judged, **found, "unread": plain(overview.unread)}


def _counts(plant: Plant, overview: Overview, query: Query, request: Request) -> dict[str, Any]:  # noqa: ARG001
    names = {"verdict": "said", "label": "label", "split": "split", "area": "area", "type": "type", "stage": "stage"}
    return {"run": overview.run.number, **{name: overview.words(column) for name, column in names.items()}}


def _reviews(plant: Plant, overview: Overview, query: Query, request: Request) -> dict[str, Any]:  # noqa: ARG001
    return {"reviews": plain(plant.store.reviews(request.query_params.get("tag", "")))}


async def _json_of(request: Request) -> dict[str, Any]:
    body = b""
    async for piece in request.stream():
        body += piece
        if len(body) > MOST_FORM:
            raise ParameterError.expected(f"at most {MOST_FORM} bytes", "more", "shorten the note")
    try:
        found = json.loads(body)
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict):
        raise ParameterError.expected("a JSON object with tag, state, who, note", "something else", "see docs/page.md")
    return found
