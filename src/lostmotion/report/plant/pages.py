"""Reports as one HTML file each: nothing is fetched, and without script everything is still there."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import jinja2
from markupsafe import Markup, escape

from lostmotion.audit.health import health_of
from lostmotion.audit.plant_view import LoopView, PlantView
from lostmotion.audit.rules import findings_counted
from lostmotion.printable import printable
from lostmotion.report.plant.changes import changes
from lostmotion.report.plant.loop_page import LoopPage, loop_page
from lostmotion.report.plant.ranking import lines, sections
from lostmotion.report.plant.sizes import size_trends
from lostmotion.report.plant.svg.bars import count_bar
from lostmotion.report.plant.svg.treemap import treemap
from lostmotion.report.plant.words import moment_words, seconds_words
from lostmotion.store.rows import AssessmentRow, Stage

MOST_PAGES = 50  # of loops in one file: some 40 kB each
MOST_RANKED = 100  # lines of the ranking
MOST_LISTED = 1000  # lines of the table of all loops; a browser stays quick, the CSV has them all
MOST_SHORT = 30  # lines of every other table
NARROW = (360, 640)  # pixels of the treemap on a telephone
NEW = frozenset(("new finding", "grew", "another fault"))


@dataclass(frozen=True)
class Count:
    """How often something came, with its bar."""

    name: str
    count: int
    bar: Markup
    letter: str = ""


def plant_report(view: PlantView) -> str:
    """Report of a plant as one HTML file.

    Parameters
    ----------
    view : PlantView
        Plain rows; at most MOST_PAGES loops get a page, and the file says how many there are.

    Returns
    -------
    str
    """
    worth = worth_a_page(view.leading)
    anchors = {row.tag: f"loop-{number}" for number, row in enumerate(worth[:MOST_PAGES], 1)}
    ranked = [row for row in view.leading if row.priority][:MOST_RANKED]
    ranked = ranked or [row for row in view.leading if row.stage is Stage.ASSESSED][:MOST_RANKED]
    places = {row.tag: f"rank-{place}" for place, row in enumerate(ranked, 1)}

    def address(tag: str) -> str:
        anchor = anchors.get(tag) or places.get(tag)
        return f"#{anchor}" if anchor else ""

    pages = [loop_page(view.loop_view(tag), anchor) for tag, anchor in anchors.items()]
    return _render(
        "plant.html.j2", **plant_context(view, ranked, address), pages=pages, worth=len(worth), **_assets(view)
    )


def plant_context(view: PlantView, ranked: Sequence[AssessmentRow], address: Callable[[str], str]) -> dict[str, Any]:
    """Everything that an overview shows; `address` gives the address of a loop, "" for none."""
    found, health = changes(view), health_of(view)
    new = frozenset(one.tag for one in found if one.what in NEW)
    ranking = lines(view, ranked, address, new)
    return {
        "run": view.run,
        "facts": _run_facts(view),
        "health": health,
        "findings": health.findings(Counter(row.said for row in view.leading)),
        "unread": view.unread,
        "counts": _counts(view.leading),
        "ranking": ranking,
        "urgent": sum(bool(row.priority) for row in view.leading),
        "sections": sections(ranked, ranking),
        "all_lines": lines(view, view.leading[:MOST_LISTED], address, new),
        "loops": len(view.leading),
        "treemap_wide": treemap(view.leading, view.by_tag, address),
        "treemap_narrow": treemap(view.leading, view.by_tag, address, *NARROW),
        "groups": [(group, [(member, address(member[0])) for member in group.members]) for group in view.groups],
        "changes": found,
        "compared": bool(view.previous),
        "trends": size_trends(view),
        "most": MOST_SHORT,
        "link": address,
        "period": seconds_words,
    }


def loop_report(view: LoopView) -> str:
    """Report of one loop as one HTML file."""
    return _render("one_loop.html.j2", page=loop_page(view), run=view.run, **_assets(view))


def loop_section(page: LoopPage, level: int = 2) -> Markup:
    """Section of one loop, for a page that has a head of its own; `level` of its heading."""
    macros: Any = _environment().get_template("loop.html.j2").module
    return Markup(macros.loop_section(page, level))  # noqa: S704  a template with autoescape


def stylesheet() -> str:
    """CSS of all pages, for a file of its own."""
    return _render("report.css")


def script() -> str:
    """What sorts and filters tables, for a file of its own; no page needs it."""
    return _render("report.js")


def worth_a_page(rows: Sequence[AssessmentRow]) -> list[AssessmentRow]:
    """Loops that somebody will want to look into: told, not cleared, and with a priority where they are ranked."""
    ranked = any(row.priority is not None for row in rows)
    told = [row for row in rows if row.said not in ("none", "not assessed", "failed")]
    return [row for row in told if row.priority or not ranked] or list(rows[:1])


def _assets(view: PlantView | LoopView) -> dict[str, Any]:
    """Style and script, and the line at the head of every printed page: dates only, which need no escaping in CSS."""
    when = moment_words(view.run.started)
    return {
        "css": Markup(stylesheet()),  # noqa: S704  our own file
        "js": Markup(script()),  # noqa: S704  our own file
        "printed": f"Lost motion, run of {when}" if when else "Lost motion",
    }


def _run_facts(view: PlantView) -> list[tuple[str, str]]:
    run = view.run
    took = "" if run.cpu_seconds is None else f"{seconds_words(run.cpu_seconds)} of processor time"
    found = [
        ("Run", f"{run.number}" if run.number else ""),
        ("Started", moment_words(run.started)),
        ("Ended", moment_words(run.ended)),
        ("Compared with", f"run of {moment_words(run.previous)}" if run.previous else ""),
        ("Data", ", ".join(run.sources)),
        ("Took", took),
        ("Version", run.code),
        *run.settings,
    ]
    return [(name, text) for name, text in found if text]


def _counts(rows: Sequence[AssessmentRow]) -> list[tuple[str, list[Count]]]:
    """Titles and counts: findings, verdicts, NE 107, where the cause lies, class of performance."""
    said = Counter(row.said for row in rows)
    kinds = [
        ("Finding", Counter(dict(findings_counted(said)))),
        ("Verdict", said),
        ("NE 107", Counter(row.label or "no label" for row in rows)),
        ("Cause in", Counter("nothing found" if row.split == "none" else row.split for row in rows)),
        ("Performance", Counter(row.performance for row in rows)),
    ]
    return [(title, _counted(found)) for title, found in kinds if found]


def _counted(found: Counter[str]) -> list[Count]:
    most = max(found.values())
    return [Count(name, count, count_bar(count, most)) for name, count in found.most_common()]


@cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("lostmotion.report.plant"),
        autoescape=jinja2.select_autoescape(("html.j2",)),
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
        finalize=only_shown,
    )
    environment.filters["code"] = with_code
    return environment


class Exact(str):
    """Text that comes back from a form as it is: it stands in an attribute, and nobody reads it there."""

    __slots__ = ()


def only_shown(value: Any) -> Any:
    """What a template puts out, with signs that steer (direction of writing, controls) written out."""
    if not isinstance(value, str) or isinstance(value, Exact):
        return value
    text = printable(value)
    return value if text is value else Markup(text) if isinstance(value, Markup) else text  # noqa: S704  as it was


def with_code(text: str) -> Markup:
    """Text whose parts between backticks are commands."""
    parts = str(text).split("`")
    if len(parts) % 2 == 0:
        return escape(text)
    pieces = [Markup("<code>{}</code>").format(part) if place % 2 else escape(part) for place, part in enumerate(parts)]
    return Markup("").join(pieces)


def _render(template: str, **context: Any) -> str:
    return _environment().get_template(template).render(**context)
