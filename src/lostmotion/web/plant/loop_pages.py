"""One loop of a plant: verdict and why, its review, downloads, and its study."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from lostmotion.audit.plant_view import LoopView
from lostmotion.errors import DataError, FileAccessError, LostMotionError, ParameterError
from lostmotion.report.plant import loop_report
from lostmotion.report.plant.words import files_of, moment_words
from lostmotion.store.run_rows import ReviewState
from lostmotion.web.page import Page, answer, told
from lostmotion.web.plant.overview import Overview
from lostmotion.web.plant.query import Query, loop_address
from lostmotion.web.plant.stored import Plant, Told
from lostmotion.web.trend.pages import loop_slot

MOST_FORM = 16_384  # bytes of a form
MOST_WHO, MOST_NOTE = 100, 2000  # characters


def routes(page: Page, plant: Plant) -> list[Route]:
    """Routes of loops."""

    def found(request: Request) -> tuple[Query, Overview, Told] | None:
        query = Query.of(request.query_params)
        overview = plant.brief(query.run)
        said = None if overview is None else plant.loop(overview, tag_of(request))
        return None if overview is None or said is None else (query, overview, said)

    def show(request: Request) -> Response:
        known = found(request)
        if known is None:
            return _unknown(page, request)
        query, overview, said = known
        trend = loop_slot(page, request, overview.run, said.view.row, said.view.trace)
        context = _context(page, overview, query, said)
        return answer(page, request, "loop_page.html.j2", trend=trend, **context)

    def report(request: Request) -> Response:
        known = found(request)
        if known is None:
            return _unknown(page, request)
        view = known[2].view
        return Response(loop_report(view), media_type="text/html", headers=attached(f"{view.row.tag}.html"))

    async def review(request: Request) -> Response:
        given = await form_of(request)
        tag = tag_of(request)
        await run_in_threadpool(put_review, plant, tag, given)
        words = Query.of(request.query_params).words()
        return RedirectResponse(f"{loop_address(tag, words)}#review", 303)

    async def study(request: Request) -> Response:
        await form_of(request)
        known = await run_in_threadpool(found, request)
        if known is None:
            return _unknown(page, request)
        try:
            where = await run_in_threadpool(_study, page, known[1], known[2].view)
        except LostMotionError as error:
            return told(page, request, 409, "Not possible", str(error))
        return RedirectResponse(where, 303)

    return [
        Route("/loops/{tag:path}/review", review, methods=["POST"]),
        Route("/loops/{tag:path}/study", study, methods=["POST"]),
        Route("/loops/{tag:path}/report.html", plant.answers.route(report, keep=False)),
        Route("/loops/{tag:path}", plant.answers.route(show, keep=False)),
    ]


def tag_of(request: Request) -> str:
    """Tag of the address; one that a browser would resolve stands behind the "?"."""
    return str(request.path_params.get("tag") or request.query_params.get("tag", ""))


def attached(name: str) -> dict[str, str]:
    """Headers of a download; the name is no path anywhere."""
    plain = re.sub(r"[^A-Za-z0-9._-]+", "_", name).lstrip(".")[-100:] or "download"
    return {"content-disposition": f'attachment; filename="{plain}"'}


async def form_of(request: Request) -> dict[str, str]:
    """Fields of a form, read with a limit.

    Raises
    ------
    ParameterError
        It is longer than any form of the page, or no form.
    """
    body = b""
    async for piece in request.stream():
        body += piece
        if len(body) > MOST_FORM:
            raise ParameterError.expected(f"a form of at most {MOST_FORM} bytes", "more", "shorten the note")
    return dict(parse_qsl(body.decode("utf-8", "replace"), keep_blank_values=True, max_num_fields=20))


def put_review(plant: Plant, tag: str, given: dict[str, Any]) -> None:
    """Put a decision down.

    Raises
    ------
    ParameterError
        State, who or note cannot be used; or no such loop.
    """
    words = {name: " ".join(str(given.get(name, "")).split()) for name in ("state", "who", "note")}
    if words["state"] not in list(ReviewState):
        raise ParameterError.expected(f"one of {', '.join(ReviewState)}", repr(words["state"]), "choose one")
    for name, most in (("who", MOST_WHO), ("note", MOST_NOTE)):
        if "\0" in words[name]:
            raise ParameterError.expected(f"text as {name}", "NUL in it", "type it again")
        if len(words[name]) > most or (name == "who" and not words[name]):
            got = f"{len(words[name])} characters"
            raise ParameterError.expected(f"1 to {most} characters as {name}", got, "say who decided, shortly")
    plant.review(tag, ReviewState(words["state"]), words["who"], words["note"])


def _unknown(page: Page, request: Request) -> Response:
    return told(page, request, 404, "No such loop", "The run has no loop of this name.")


def _context(page: Page, overview: Overview, query: Query, said: Told) -> dict[str, Any]:
    tag, words = said.view.row.tag, query.words()
    return {
        "query": query,
        "view": said.view,
        "loop_page": said.page,
        "run": overview.run,
        "began": moment_words(overview.run.began),
        "reviews": [(moment_words(one.at), str(one.state), one.who, one.note) for one in reversed(said.reviews)],
        "states": [str(state) for state in ReviewState],
        "review_address": loop_address(tag, words, "review"),
        "study_address": loop_address(tag, words, "study") if page.desk is not None else "",
        "report_address": loop_address(tag, words, "report.html"),
        "json_address": "/api/v1" + loop_address(tag, words),
    }


def _study(page: Page, overview: Overview, view: LoopView) -> str:
    """Address of the result: the record is read again, diagnosed and studied at the desk.

    Raises
    ------
    DataError, FileAccessError
        The source is not there any more, or cannot be opened here.
    """
    if page.desk is None:
        raise DataError.expected("a page that takes files", "one that is read-only", "start it without --read-only")
    loop = view.loop
    files, name = files_of(loop, overview.facts)
    missing = next((one for one in files if not Path(one).exists()), None if files else loop.where or "no file")
    if missing is not None:
        raise FileAccessError(f"expected the data of {loop.tag}, got {missing}, which is not here; drop its record")
    asked = {"op": loop.op, "pv": loop.pv, "sp": loop.sp, "mode": loop.mode, "op_span": loop.op_span,
             "pv_span": loop.pv_span, "loop": name,
             "dt": loop.dt, "time": loop.time}  # fmt: skip
    item = page.desk.open(files, loop.tag, {name: value for name, value in asked.items() if value})
    return f"/files/{item.id}"
