"""The plant and its loops, from the store."""

from __future__ import annotations

from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from lostmotion.web.page import Page, told


def routes(page: Page) -> list[Route]:
    """Routes of this part."""

    def start(request: Request) -> Response:
        if page.desk is not None:
            return RedirectResponse("/files", 303)
        return told(page, request, 200, "Nothing to show", "Give --store, or files.")

    return [Route("/", start)]
