"""Where the columns of a trend come from: a dropped file, or a loop of the plant whose data are read again."""

from __future__ import annotations

import threading
from collections import OrderedDict
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from lostmotion.errors import DataError, FileAccessError
from lostmotion.store.rows import AssessmentRow, TraceRow
from lostmotion.store.run_rows import RunRow
from lostmotion.store.store import Store
from lostmotion.web.kept_record import ABOUT, kept_columns
from lostmotion.web.trend.columns import Columns
from lostmotion.web.trend.loop_records import LoopRecords, Read
from lostmotion.web.worker.jobs import OPEN

if TYPE_CHECKING:
    from lostmotion.web.page import Page

OPENED = 16  # columns that stay open


@dataclass(frozen=True)
class Source:
    """Columns of a loop, if they are there.

    Attributes
    ----------
    key : str
        "file:ID" or "loop:TAG".
    name : str
        What people call it.
    state : {"ready", "reading", "gone"}
    why : str
        Why they are not there.
    columns : Columns, optional
    row : AssessmentRow, optional
        What is known of the loop.
    trace : TraceRow, optional
        Its stored picture, with the identified actuator.
    """

    key: str
    name: str
    state: str
    why: str = ""
    columns: Columns | None = None
    row: AssessmentRow | None = None
    trace: TraceRow | None = None


class Sources:
    """All of a page.

    Parameters
    ----------
    page : Page
    """

    def __init__(self, page: Page) -> None:
        self._page = page
        self._store: Store | None = None
        self._loops = LoopRecords()
        self._opened: OrderedDict[tuple[Path, int], Columns] = OrderedDict()
        self._lock = threading.Lock()

    def of(self, key: str, run: int | None = None) -> Source | None:
        """A source; None: there is none of that name."""
        kind, _, name = key.partition(":")
        find = {"file": self._file, "loop": self._loop}.get(kind)
        return None if find is None else find(key, name, run)

    def _file(self, key: str, name: str, run: int | None) -> Source | None:  # noqa: ARG002  as of a loop
        desk = self._page.desk
        item = None if desk is None else desk.item(name)
        if desk is None or item is None:
            return None
        place = item.record_path
        if place is None and desk.state(item) in OPEN:
            return Source(key, item.name, "reading", "The file is being read.")
        if place is None:
            return Source(key, item.name, "gone", "No record was read from the file.")
        view = item.view
        row, trace = (None, None) if view is None else (view.row, view.trace)
        return Source(key, item.name, "ready", columns=self._open(place), row=row, trace=trace)

    def of_loop(self, made: RunRow, row: AssessmentRow, trace: TraceRow | None) -> Source:
        """Source of a loop of the plant that somebody has found already: its run, row and stored picture."""
        tag, key = row.tag, f"loop:{row.tag}"
        read = self._loops.ask(Read(str(self._page.store), made.number, made.source, tag))
        if isinstance(read, str) or read is None:
            why = read or "The data of the loop are being read."
            return Source(key, tag, "gone" if read else "reading", why, row=row, trace=trace)
        return Source(key, tag, "ready", columns=self._open(read), row=row, trace=trace)

    def _loop(self, key: str, tag: str, run: int | None) -> Source | None:  # noqa: ARG002  as of a file
        if self._page.store is None:
            return None
        store = self._store or Store(self._page.store, write=False)
        self._store = store  # opened once: that takes longer than all questions
        newest = store.history(tag, 1)
        made = store.run(run) if run is not None else newest[0][0] if newest else None
        rows = store.windows(made.number, tag) if made is not None else []
        if made is None or not rows:
            return None
        row = max(rows, key=lambda one: one.priority or 0.0)
        traces = store.traces(made.number, tag)
        trace = next((one for one in traces if one.window_start == row.window_start), next(iter(traces), None))
        return self.of_loop(made, row, trace)

    def _open(self, folder: Path) -> Columns:
        """Columns of a folder; it is opened anew where it was written anew."""
        try:
            name = folder, (folder / ABOUT).stat().st_mtime_ns
            with self._lock:
                if name not in self._opened:
                    self._opened[name] = kept_columns(folder)
                self._opened.move_to_end(name)
                while len(self._opened) > OPENED:
                    self._opened.popitem(last=False)
                return self._opened[name]
        except (OSError, DataError) as error:
            raise FileAccessError(f"{error}") from error
