"""A fresh one-time address, for another browser or after a window was closed."""

from __future__ import annotations

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import BaseRoute, Route

from lostmotion.web.page import Page, answer
from lostmotion.web.server.guard import ANOTHER, FRESH_TOKEN


def routes(page: Page) -> list[BaseRoute]:
    """POST alone, which the guard takes from the page itself only: a link elsewhere cannot make addresses."""

    async def fresh(request: Request) -> Response:
        token = request.scope.get(FRESH_TOKEN)
        if token is None:
            raise HTTPException(404)
        return answer(page, request, "address.html.j2", address=f"{request.base_url}?token={token()}")

    return [Route(ANOTHER, fresh, methods=["POST"])]
