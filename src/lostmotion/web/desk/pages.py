"""Dropped files: upload, columns, jobs, results, downloads."""

from __future__ import annotations

import logging
from collections.abc import Awaitable, Callable
from datetime import UTC, datetime
from typing import Any

from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, RedirectResponse, Response
from starlette.routing import Route

from lostmotion.errors import LostMotionError
from lostmotion.files.results import read_json
from lostmotion.report.plant import loop_report
from lostmotion.web.desk.desk import Desk
from lostmotion.web.desk.fields import fields, in_fields, number, settings_of, study_given, way_of
from lostmotion.web.desk.item import Item
from lostmotion.web.desk.upload import received
from lostmotion.web.desk.views import as_json, columns_context, file_context, files_context
from lostmotion.web.page import Page, answer, environment
from lostmotion.web.trend.pages import trend_slot
from lostmotion.web.worker.task import BLOCK

Handler = Callable[[Request, Desk, Item], Response]
Change = Callable[[Desk, Item, dict[str, str]], Response]


def routes(page: Page) -> list[Route]:
    """Routes of this part; none where no files are taken."""
    desk = page.desk
    if desk is None:
        return []
    environment().filters["fields"] = in_fields

    def listed(request: Request) -> Response:
        desk.jobs.warm()
        return answer(page, request, "files.html.j2", **files_context(desk))

    async def dropped(request: Request) -> Response:
        items = await received(request, desk)
        where = address(items[0]) if len(items) == 1 else "/files"
        if "application/json" in request.headers.get("accept", ""):
            return JSONResponse({"url": where, "files": [item.id for item in items]}, 201)
        return RedirectResponse(where, 303)

    def shown(request: Request) -> Response:
        item = found(desk, request)

        def drawn() -> Response:
            trend = None if item.record_path is None else trend_slot(page, request, f"file:{item.id}")
            return answer(page, request, "file.html.j2", **file_context(desk, item, trend))

        return of_item(page, request, item, drawn)

    def columns(request: Request) -> Response:
        item = found(desk, request)
        return of_item(
            page, request, item, lambda: answer(page, request, "file_columns.html.j2", **columns_context(item))
        )

    def listed_json(request: Request) -> Response:  # noqa: ARG001  the signature of a route
        return JSONResponse([as_json(desk, item) for item in desk.items()])

    def shown_json(request: Request) -> Response:
        return JSONResponse(as_json(desk, found(desk, request)))

    changes: dict[str, Change] = {
        "columns": _columns, "way": _way, "again": _again, "cancel": _cancel, "remove": _remove, "study": _study,
        "block": _block,
    }  # fmt: skip
    downloads: dict[str, Callable[[Item], Response]] = {
        "report.html": _report, "diagnosis.json": _diagnosis, "fit.json": _fit, "study.json": _study_json,
        "block.json": _block_json, "block.zip": _block_zip,
    }  # fmt: skip
    return [
        Route("/files", listed),
        Route("/files", dropped, methods=["POST"]),
        Route("/files/{item}", shown),
        Route("/files/{item}/columns", columns),
        *(
            Route(f"/files/{{item}}/{name}", posted(page, desk, change), methods=["POST"])
            for name, change in changes.items()
        ),
        *(Route(f"/files/{{item}}/{name}", download(page, desk, give)) for name, give in downloads.items()),
        Route("/jobs/{job}/cancel", cancelled(desk), methods=["POST"]),
        Route("/api/v1/files", listed_json),
        Route("/api/v1/files/{item}", shown_json),
    ]


def address(item: Item) -> str:
    """Where the page of it is."""
    return f"/files/{item.id}"


def found(desk: Desk, request: Request) -> Item:
    """Item of the address, or 404."""
    item = desk.item(request.path_params["item"])
    if item is None:
        raise HTTPException(404)
    return item


def of_item(page: Page, request: Request, item: Item, work: Callable[[], Response]) -> Response:
    """Answer made of the files that are kept of an item; where one of them is damaged, a page with the ways on."""
    try:
        return work()
    except (HTTPException, LostMotionError):
        raise
    except Exception as error:
        logging.getLogger("lostmotion.web").exception("%s %s", request.method, request.url.path)
        return answer(page, request, "file_damaged.html.j2", 409, item=item, error=type(error).__name__)


def posted(page: Page, desk: Desk, change: Change) -> Callable[[Request], Awaitable[Response]]:
    """Route of a small form about an item."""

    async def route(request: Request) -> Response:
        item, form = found(desk, request), await fields(request)
        return await run_in_threadpool(of_item, page, request, item, lambda: change(desk, item, form))

    return route


def download(page: Page, desk: Desk, give: Callable[[Item], Response]) -> Callable[[Request], Response]:
    """Route of a file about an item."""

    def route(request: Request) -> Response:
        item = found(desk, request)
        return of_item(page, request, item, lambda: give(item))

    return route


def cancelled(desk: Desk) -> Callable[[Request], Response]:
    """Route that cancels a job by its own id."""

    def route(request: Request) -> Response:
        job = desk.jobs.job(request.path_params["job"])
        if job is None:
            raise HTTPException(404)
        desk.jobs.cancel(job.id)
        return RedirectResponse(f"/files/{job.item}", 303)

    return route


def _back(item: Item, anchor: str = "") -> Response:
    return RedirectResponse(address(item) + anchor, 303)


def _columns(desk: Desk, item: Item, form: dict[str, str]) -> Response:
    desk.change(item, settings_of(form, item.asked))
    return _back(item)


def _way(desk: Desk, item: Item, form: dict[str, str]) -> Response:
    result = item.result or {}
    desk.change(item, {**item.asked, **way_of(result.get("error", {}), form.get("way", ""))})
    return _back(item)


def _again(desk: Desk, item: Item, form: dict[str, str]) -> Response:  # noqa: ARG001  as all changes
    desk.read(item)
    return _back(item)


def _cancel(desk: Desk, item: Item, form: dict[str, str]) -> Response:  # noqa: ARG001
    desk.jobs.cancel_of({item.id})
    return _back(item)


def _remove(desk: Desk, item: Item, form: dict[str, str]) -> Response:  # noqa: ARG001
    desk.remove(item)
    return RedirectResponse("/files", 303)


def _study(desk: Desk, item: Item, form: dict[str, str]) -> Response:
    _need(item.view is not None)
    before = item.study or {}
    given = study_given(form, before.get("asked", {}))
    if form.get("use"):
        given |= _ways(before)
    desk.start(item, "study", {name: value for name, value in given.items() if value is not None})
    return _back(item, "#block")


def _ways(study: dict[str, Any]) -> dict[str, Any]:
    """Settings that open the gate at which the study ended."""
    steps = study.get("steps") or [{}]
    return dict(steps[-1].get("settings") or {})


def _block(desk: Desk, item: Item, form: dict[str, str]) -> Response:
    _need((item.folder / BLOCK).is_file())
    given = {
        "to": form.get("to", "st"),
        "name": form.get("name", ""),
        "date": form.get("date") or datetime.now(UTC).date().isoformat(),
        "real": form.get("real", "lreal"),
        "scan_time": number(form, "scan_time"),
    }
    desk.start(item, "block", given)
    return _back(item, "#block")


def _need(there: object) -> None:
    """404 for what is not there yet."""
    if not there:
        raise HTTPException(404)


def _report(item: Item) -> Response:
    view = item.view
    _need(view)
    assert view is not None  # noqa: S101  else 404
    return Response(loop_report(view), media_type="text/html", headers=_as_file(item, "html"))


def _diagnosis(item: Item) -> Response:
    result = item.result or {}
    _need("diagnosis" in result)
    return JSONResponse(result["diagnosis"], headers=_as_file(item, "diagnosis.json"))


def _fit(item: Item) -> Response:
    result = item.result or {}
    _need("diagnosis" in result)
    return JSONResponse(result["diagnosis"]["fit"], headers=_as_file(item, "fit.json"))


def _study_json(item: Item) -> Response:
    _need(item.study)
    return JSONResponse(item.study, headers=_as_file(item, "study.json"))


def _block_json(item: Item) -> Response:
    _need((item.folder / BLOCK).is_file())
    return JSONResponse(
        read_json(item.folder / BLOCK, "a block", "study it again"), headers=_as_file(item, "block.json")
    )


def _block_zip(item: Item) -> Response:
    export = item.export or {}
    _need("file" in export and item.zip_path.is_file())
    return FileResponse(item.zip_path, media_type="application/zip", filename=str(export["file"]))


def _as_file(item: Item, ending: str) -> dict[str, str]:
    """Header that has it saved, under a name of plain letters."""
    stem = "".join(sign if sign.isascii() and (sign.isalnum() or sign in "-_") else "_" for sign in item.stem)
    return {"content-disposition": f'attachment; filename="{stem[:60] or "loop"}.{ending}"'}
