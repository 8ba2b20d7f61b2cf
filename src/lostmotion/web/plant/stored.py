"""The store behind the page: runs as overviews that are kept, one loop, reviews."""

from __future__ import annotations

import threading
import time
from collections import OrderedDict
from functools import cached_property

from starlette.requests import Request

from lostmotion.audit.plant_view import LoopView
from lostmotion.audit.stored_loop import stored_loop
from lostmotion.report.plant import LoopPage, loop_page
from lostmotion.store.run_rows import ReviewRow, ReviewState, RunRow, RunState
from lostmotion.store.store import Store
from lostmotion.web.plant.kept import Answers, Kept
from lostmotion.web.plant.overview import Overview
from lostmotion.web.plant.query import Query

KEPT = 3  # overviews: 26,000 loops are some 10 MB each
LOOPS = 100  # of which it is kept what is said: some 100 kB each
YOUNG = 5.0  # s for which a run that is at work is not looked at again


class Told:
    """What is said of a loop.

    Parameters
    ----------
    store : Store
    view : LoopView
    """

    def __init__(self, store: Store, view: LoopView) -> None:
        self._store, self.view = store, view

    @cached_property
    def page(self) -> LoopPage:
        """Its texts, tables and pictures."""
        return loop_page(self.view)

    @cached_property
    def reviews(self) -> list[ReviewRow]:
        """What was decided about it, the oldest first."""
        return self._store.reviews(self.view.row.tag)


class Plant:
    """Results of audits.

    Parameters
    ----------
    address : str
        Of the store.

    Raises
    ------
    FileAccessError
        No store, or one of another version.
    """

    def __init__(self, address: str) -> None:
        self.address = address
        self.store = Store(address, write=False)
        self.answers = Answers(self.store.stamp, self._settled)
        self._loops: Kept[Told] = Kept(LOOPS)
        self._kept: OrderedDict[tuple[object, ...], Overview] = OrderedDict()
        self._made: dict[int, tuple[float, tuple[object, ...]]] = {}
        self._lock = threading.Lock()

    def runs(self) -> list[RunRow]:
        """Runs, the newest first."""
        return self.store.runs()

    def overview(self, number: int) -> Overview | None:
        """A run with all that is counted from it; 0: the last one. None: there is none."""
        found = self.brief(number)
        return None if found is None else found.complete()

    def brief(self, number: int) -> Overview | None:
        """The same for who needs little of it: nothing is counted before it is asked for."""
        run = self.store.last_run() if not number else self.store.run(number)
        if run is None:
            return None
        with self._lock:
            key = self._key(run)
            if key not in self._kept:
                self._kept[key] = Overview(self.store, run)
            self._kept.move_to_end(key)
            while len(self._kept) > KEPT:
                self._kept.popitem(last=False)
            return self._kept[key]

    def _key(self, run: RunRow) -> tuple[object, ...]:
        """What an overview is kept by: a finished run changes no more, one at work with each beat of its heart."""
        key = (run.number, run.state, run.ended if run.state is RunState.FINISHED else run.heartbeat)
        made, known = self._made.get(run.number, (0.0, key))
        if known in self._kept and known[1] == run.state and time.monotonic() - made < YOUNG:
            return known
        self._made = {run.number: (time.monotonic(), key)}
        return key

    def _settled(self, request: Request) -> bool:
        """Whether a request asks for a run that is finished."""
        overview = self.brief(Query.of(request.query_params).run)
        return overview is not None and overview.run.state is RunState.FINISHED

    def loop(self, overview: Overview, tag: str) -> Told | None:
        """What a run and those before say of a loop; None: the run does not know it."""
        name, stamp = (overview.run.number, tag), self.store.stamp()
        known = self._loops.get(name, stamp)
        if known is not None:
            return known
        view = stored_loop(self.store, overview.run, tag, overview.facts, overview.groups)
        if view is None:
            return None
        found = Told(self.store, view)
        if overview.run.state is RunState.FINISHED:
            self._loops.put(name, stamp, found)
        return found

    def review(self, tag: str, state: ReviewState, who: str, note: str) -> None:
        """Put a decision down.

        Raises
        ------
        ParameterError
            No such loop.
        """
        with Store(self.address) as store:
            store.review(tag, state, who, note)
