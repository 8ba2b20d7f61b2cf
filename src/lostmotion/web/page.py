"""What the routes are given, and how they answer."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import jinja2
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response

from lostmotion.report.plant.pages import Exact, only_shown, with_code

if TYPE_CHECKING:
    from lostmotion.web.desk.desk import Desk


@dataclass(frozen=True)
class Page:
    """Settings of a page that is served.

    Attributes
    ----------
    store : str, optional
        Address of the results of an audit; None: there is none.
    desk : Desk, optional
        Where dropped files and jobs are; None: files are not taken here.
    monitors : tuple of str
        Files of JSON lines or states of `lostmotion online`.
    read_only : bool
        Nothing can be changed: no drop, no review, no job.
    fresh_addresses : bool
        An address lets one browser in, so the page offers a fresh one for another.
    """

    store: str | None = None
    desk: Desk | None = None
    monitors: tuple[str, ...] = ()
    read_only: bool = False
    fresh_addresses: bool = False

    @property
    def places(self) -> tuple[tuple[str, str], ...]:
        """Name and address of what the head of every page leads to."""
        known = (
            ("Plant", "/", self.store is not None),
            ("Files", "/files", self.desk is not None),
            ("Monitors", "/monitors", bool(self.monitors)),
        )
        return tuple((name, address) for name, address, there in known if there)


def answer(page: Page, request: Request, template: str, status: int = 200, **context: Any) -> Response:
    """HTML of a template of this package; every text in it is escaped.

    Parameters
    ----------
    page : Page
    request : Request
    template : str
        Name, as "plant_page.html.j2". It extends "page.html.j2".
    status : int
    **context
        What the template shows.
    """
    return HTMLResponse(rendered(page, request.url.path, template, **context), status)


def rendered(page: Page, path: str, template: str, **context: Any) -> str:
    """The text of it; `path` is where it will be found, for the mark in the head."""
    return environment().get_template(template).render(page=page, path=path, **context)


def told(page: Page, request: Request, status: int, title: str, text: str) -> Response:
    """Short answer: a page, or JSON to a program."""
    if request.url.path.startswith("/api/"):
        return JSONResponse({"error": title, "message": text}, status)
    return answer(page, request, "message.html.j2", status, heading=title, text=text)


@cache
def environment() -> jinja2.Environment:
    """Templates of the page, and those of the reports, from which it takes its pieces."""
    made = jinja2.Environment(
        loader=jinja2.ChoiceLoader(
            [jinja2.PackageLoader("lostmotion.web"), jinja2.PackageLoader("lostmotion.report.plant")]
        ),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
        finalize=only_shown,
    )
    made.filters |= {"code": with_code, "exact": Exact}
    return made
