"""The plant: what needs a hand first, and how it was found out."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from lostmotion.audit.audit_run import as_loop
from lostmotion.audit.plant_view import PlantView
from lostmotion.report.plant.ranking import lines
from lostmotion.report.plant.words import moment_words, seconds_words
from lostmotion.store.run_rows import ReviewState, RunRow, RunState
from lostmotion.web.page import Page, answer, rendered, told
from lostmotion.web.plant import api, loop_pages
from lostmotion.web.plant.overview import Overview, Shown
from lostmotion.web.plant.query import SORTS, Query
from lostmotion.web.plant.stored import Plant

SHORT = 10  # lines of a table on the page of the plant; the page of each has all
HEADS = (  # of the ranking: text, name of the order
    ("#", ""), ("Loop", "tag"), ("Area, type", "area"), ("Verdict", "verdict"),
    ("Size with 95 % interval", "size"), ("Sure", "sure"), ("Priority, why", "priority"), ("What to do next", ""),
)  # fmt: skip
ORDERS = {
    "priority": "priority", "tag": "tag", "area": "area", "verdict": "verdict", "size": "size of the lost motion",
    "sure": "confidence", "swing": "share of a regular swing", "period": "period", "harris": "Harris index",
    "variability": "deviation of SP - PV", "travel": "travel of OP", "manual": "time in manual",
    "limited": "time at a limit", "missing": "time without values",
}  # fmt: skip


@dataclass(frozen=True)
class Head:
    """Head of a column that sorts.

    Attributes
    ----------
    text, link : str
    sorted : str
        "ascending", "descending"; empty: by another one.
    """

    text: str
    link: str
    sorted: str


def routes(page: Page) -> list[Route]:
    """Routes of this part."""
    if page.store is None:
        return [Route("/", _without_store(page))]
    plant = Plant(page.store)
    _warm(page, plant)

    def start(request: Request) -> Response:
        query = Query.of(request.query_params)
        overview = plant.overview(query.run)
        if overview is None:
            return _no_run(page, request, query)
        context = _context(plant, overview, query)
        return answer(page, request, "plant_page.html.j2", **context)

    def listed(request: Request) -> Response:
        """All groups, all news or everything about the data of a run."""
        query = Query.of(request.query_params)
        overview = plant.overview(query.run)
        if overview is None:
            return _no_run(page, request, query)
        what = request.path_params["what"]
        context = _parts(overview, query)
        return answer(page, request, "plant_list.html.j2", what=what, most=1000, **context)

    return [
        Route("/", plant.answers.route(start)),
        Route("/plant/{what:str}", plant.answers.route(_known(page, listed))),
        *loop_pages.routes(page, plant),
        *api.routes(page, plant),
    ]


def _warm(page: Page, plant: Plant) -> None:
    """Show the last run once before anybody asks: the page is there at once when its address is."""
    overview = plant.overview(0)
    if overview is not None:
        rendered(page, "/", "plant_page.html.j2", **_context(plant, overview, Query()))


def _known(page: Page, listed: Any) -> Any:
    def known(request: Request) -> Response:
        if request.path_params["what"] not in ("groups", "new", "data"):
            return told(page, request, 404, "Not found", "There is nothing at this address.")
        found: Response = listed(request)
        return found

    return known


def _without_store(page: Page) -> Any:
    def start(request: Request) -> Response:
        if page.desk is not None:
            return RedirectResponse("/files", 303)
        if page.monitors:
            return RedirectResponse("/monitors", 303)
        return told(page, request, 200, "Nothing to show", "Start it with `lostmotion serve --store plant.db`.")

    return start


def _no_run(page: Page, request: Request, query: Query) -> Response:
    text = (
        f"The store has no run {query.run}." if query.run else
        "The store has no run yet. Make one with `lostmotion audit FOLDER --store plant.db`."
    )  # fmt: skip
    return told(page, request, 404, "No such run", text)


def _context(plant: Plant, overview: Overview, query: Query) -> dict[str, Any]:
    shown = overview.shown(query, brief=True)
    query = replace(query, page=(shown.first - 1) // query.per + 1)
    narrow, wide = overview.treemaps[1], overview.treemaps[0]
    return {
        **_parts(overview, query),
        "runs": [(one.number, run_words(one)) for one in plant.runs()],
        "lines": ranking(overview, query, shown),
        "shown": shown,
        "pages": max(-(-shown.total // query.per), 1),
        "heads": heads(query),
        "choices": overview.choices,
        "orders": {name: ORDERS[name] for name in SORTS},
        "counts": overview.counts,
        "findings": overview.health.findings(overview.words("said")),
        "treemap_wide": wide,
        "treemap_narrow": narrow,
        "most": SHORT,
    }


def _parts(overview: Overview, query: Query) -> dict[str, Any]:
    """What is said of a run as a whole."""
    return {
        "query": query,
        "run": overview.run,
        "facts": overview.facts,
        "state": state_words(overview.run),
        "began": moment_words(overview.run.began),
        "before": overview.before,
        "before_began": moment_words(overview.before.began) if overview.before else "",
        "loops": len(overview.frame),
        "health": overview.health,
        "unread": overview.unread,
        "news": overview.news,
        "groups": overview.groups,
        "period": seconds_words,
    }


def ranking(overview: Overview, query: Query, shown: Shown) -> list[Any]:
    """Lines of the ranking as reports have them."""
    reviews = {line.loop.tag: str(line.review) for line in shown.lines if line.review != ReviewState.NEW}
    rows = [line.row for line in shown.lines]
    view = PlantView(overview.facts, tuple(as_loop(line.loop) for line in shown.lines), tuple(rows), reviews=reviews)
    return lines(view, rows, query.loop, overview.new_tags, shown.first)


def heads(query: Query) -> list[Head | str]:
    """Heads of the ranking: a link sorts, and turns the order where it is sorted so already."""
    found: list[Head | str] = []
    for text, name in HEADS:
        if not name:
            found.append(text)
            continue
        same = query.sort == name
        falling = (SORTS[name][1] or name == "priority") != query.turned  # the rank rises where the priority falls
        said = ("descending" if falling else "ascending") if same else ""
        found.append(Head(text, query.link(sort=name, turned=same and not query.turned), said))
    return found


def run_words(run: RunRow) -> str:
    """A run in a list."""
    state = "" if run.state is RunState.FINISHED else f", {run.state}"
    return f"{run.number}: {moment_words(run.began) or 'not dated'}{state}"


def state_words(run: RunRow) -> str:
    """Why a run is not complete; empty: it is."""
    if run.state is RunState.RUNNING:
        return "The audit is at work, or was killed: what is here is not all. Load the page again to see more."
    if run.state is RunState.STOPPED:
        return f"The audit was stopped{': ' + run.note if run.note else ''}. The same command goes on with it."
    return "The run was never finished." if run.state is RunState.ABANDONED else ""
