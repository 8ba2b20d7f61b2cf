"""Dropped files: upload, columns, jobs, results, downloads."""

from __future__ import annotations

from starlette.routing import Route

from lostmotion.web.page import Page


def routes(page: Page) -> list[Route]:  # noqa: ARG001
    """Routes of this part."""
    return []
