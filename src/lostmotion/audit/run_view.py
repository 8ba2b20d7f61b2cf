"""What a report shows, from a run of the store."""

from __future__ import annotations

import json
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from lostmotion.addresses import is_url, without_password
from lostmotion.audit.history import LoopHistory
from lostmotion.audit.live_points import live_estimates, live_points
from lostmotion.audit.plant_view import PlantView, RunFacts, SizePoint, leading_rows
from lostmotion.audit.row_facts import ends_percent
from lostmotion.store.rows import AssessmentRow
from lostmotion.store.run_rows import RunRow, RunState
from lostmotion.store.store import Store

if TYPE_CHECKING:
    from lostmotion.audit.audit_run import AuditRun

PAGES = 50  # loops that get a page of their own: nobody reads more a week
LIMIT = 4.0  # % of span, bad for a control valve


def view_of(run: AuditRun, pages: int = PAGES) -> PlantView:
    """All that a report of a run shows; history and pictures of the most urgent loops only."""
    leading = leading_rows(run.rows)
    told = [row.tag for row in leading if row.priority][:pages]
    with Store(run.store, write=False) as store:
        past = {tag: [pair for pair in store.history(tag) if pair[0].number <= run.run.number] for tag in told}
        live = [
            point
            for tag, pairs in past.items()
            if (loop := store.loop(tag)) is not None
            for point in live_points(live_estimates(store, run.run, tag), loop, [row for _, row in pairs])
        ]
        reviews = {tag: said[-1] for tag in told if (said := store.reviews(tag))}
        before = store.last_run(run.run.number)
    histories = {tag: run.loop(tag) for tag in told}
    growth = {tag: words for tag, one in histories.items() if (words := growth_words(one))}
    return PlantView(
        run=run_facts(run.run, before, run.store, sum(one.seconds for one in run.rows)),
        loops=run.loops,
        rows=run.rows,
        groups=run.groups,
        traces=run.traces(told),
        history=(*(size_point(made.number, row) for pairs in past.values() for made, row in pairs), *live),
        previous=run.previous,
        unread=run.unread,
        growth=growth,
        reviews={tag: " ".join([str(one.state), one.note]).strip() for tag, one in reviews.items()},
    )


def growth_words(found: LoopHistory) -> str:
    """A sentence about the growth of a size, where it is sure."""
    line = found.trend
    if not line.seen:
        return ""
    low, high = (365.25 / 12.0 * end for end in line.interval)
    said = f"{'grows' if line.slope > 0 else 'shrinks'} by {365.25 / 12.0 * abs(line.slope):.2g} % of span a month"
    ends = f" ({min(abs(low), abs(high)):.2g} .. {max(abs(low), abs(high)):.2g})"
    crossing = found.reaches(LIMIT)
    if crossing is None:
        return said + ends
    latest = "later than in ten years" if crossing.latest is None else _day(crossing.latest)
    when = f"; {LIMIT:g} % about {_day(crossing.expected)} ({_day(crossing.earliest)} .. {latest})"
    return said + ends + when


def _day(moment: datetime) -> str:
    return moment.date().isoformat()


def run_facts(row: RunRow, before: RunRow | None, store: str, spent: float | None = None) -> RunFacts:
    """What is said of a run; `spent` is its processor time in seconds."""
    settings = {name: value for name, value in json.loads(row.settings).items() if value not in (None, False)}
    return RunFacts(
        number=row.number,
        plant=Path(row.source).name or row.source,
        sources=(row.source,),
        started=row.began,
        ended=row.ended,
        code=row.code,
        settings=tuple((name.replace("_", " "), str(value)) for name, value in settings.items()),
        cpu_seconds=spent,
        complete=row.state is RunState.FINISHED,
        store=without_password(store) if is_url(store) else store,
        previous=None if before is None else before.began,
    )


def size_point(number: int, row: AssessmentRow) -> SizePoint:
    """What a run says of the size of one loop in one window."""
    ends = ends_percent(row)
    low, high = ends if ends is not None else (None, None)
    size = row.size_percent if row.kind == "actuator" else None
    return SizePoint(row.tag, number, row.window_start, row.said, size, low, high, row.excluded_percent)
