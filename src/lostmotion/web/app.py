"""The application: routes of all parts, static files, and what is said where something is missing or goes wrong."""

from __future__ import annotations

import logging
from functools import cache
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import BaseRoute, Mount, Route
from starlette.staticfiles import StaticFiles

from lostmotion.errors import FileAccessError, LostMotionError, one_line
from lostmotion.report.plant import stylesheet
from lostmotion.web import another_browser
from lostmotion.web.desk import pages as file_pages
from lostmotion.web.monitors import pages as monitor_pages
from lostmotion.web.page import Page, told
from lostmotion.web.plant import pages as plant_pages
from lostmotion.web.trend import pages as trend_pages

PARTS = (plant_pages, file_pages, trend_pages, monitor_pages, another_browser)
STATIC = Path(__file__).with_name("static")
BRIEFLY = {"cache-control": "private, max-age=60"}
SAID = {
    404: ("Not found", "There is nothing at this address."),
    405: ("Not possible", "This address is not asked in this way."),
}


def create_app(page: Page) -> Starlette:
    """Application without its guard (:class:`lostmotion.web.server.guard.Guard`), which the server puts around it."""

    def refused(request: Request, error: Exception) -> Response:
        assert isinstance(error, HTTPException)  # noqa: S101  registered for it
        title, text = SAID.get(error.status_code, ("Not possible", ""))
        return told(page, request, error.status_code, title, text or str(error.detail))

    def wrong(request: Request, error: Exception) -> Response:
        """An error that says what was expected, got, and what to do."""
        status = 503 if isinstance(error, FileAccessError) else 400
        return told(page, request, status, "Not possible", one_line(str(error)))

    def failed(request: Request, error: Exception) -> Response:
        logging.getLogger("lostmotion.web").error("%s %s", request.method, request.url.path, exc_info=error)
        return told(page, request, 500, "Something went wrong", "The page failed; where it was started it says why.")

    routes: list[BaseRoute] = [route for part in PARTS for route in part.routes(page)]
    routes += [Route("/static/report.css", _style), Mount("/static", _Static(directory=STATIC))]
    handlers = {HTTPException: refused, LostMotionError: wrong, Exception: failed}
    return Starlette(routes=routes, exception_handlers=handlers)


class _Static(StaticFiles):
    """Files of this package, which say nothing about a plant: a browser asks for them once a minute."""

    def file_response(self, *args: Any, **options: Any) -> Response:
        """Its answer, kept for a moment."""
        found = super().file_response(*args, **options)
        found.headers.update(BRIEFLY)
        return found


def _style(request: Request) -> Response:  # noqa: ARG001  the signature of a route
    return Response(_report_style(), media_type="text/css", headers=BRIEFLY)


@cache
def _report_style() -> str:
    return stylesheet()
