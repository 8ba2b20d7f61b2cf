"""LoopView of one loop from a store, without the rows of all others."""

from __future__ import annotations

from collections.abc import Sequence

from lostmotion.audit.audit_run import as_loop
from lostmotion.audit.history import history
from lostmotion.audit.live_points import live_estimates, live_points
from lostmotion.audit.plant_view import LoopView, PlantView, RunFacts
from lostmotion.audit.run_view import growth_words, size_point
from lostmotion.store.rows import GroupRow, Stage
from lostmotion.store.run_rows import RunRow
from lostmotion.store.store import Store

MOST = 1000  # windows of all runs: a day each, three years


def stored_loop(
    store: Store, run: RunRow, tag: str, facts: RunFacts, groups: Sequence[GroupRow] = ()
) -> LoopView | None:
    """What a run and those before it say of one loop.

    Parameters
    ----------
    store : Store
    run : RunRow
    tag : str
    facts : RunFacts
        Of the run.
    groups : sequence of GroupRow
        Of the run.

    Returns
    -------
    LoopView or None
        None: the run does not know the loop.
    """
    rows, loop = store.windows(run.number, tag), store.loop(tag)
    if not rows or loop is None:
        return None
    past = [(made.number, row) for made, row in reversed(store.history(tag, MOST)) if made.number <= run.number]
    assessed = [row for _, row in past if row.stage is Stage.ASSESSED]
    live = live_points(live_estimates(store, run, tag), loop, [*rows, *assessed])
    reviews = store.reviews(tag)
    growth = growth_words(history(assessed)) if assessed else ""
    view = PlantView(
        run=facts,
        loops=(as_loop(loop),),
        rows=tuple(rows),
        groups=tuple(groups),
        traces=tuple(store.traces(run.number, tag)),
        history=(*(size_point(number, row) for number, row in past), *live),
        growth={tag: growth},
        reviews={tag: str(reviews[-1].state)} if reviews else {},
    )
    return view.loop_view(tag)
