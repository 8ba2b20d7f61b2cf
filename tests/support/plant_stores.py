"""A small store for tests of the page: the plant of `plant_rows` in two runs, with data for its loops if wanted."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime

import numpy as np

from lostmotion.store.run_rows import LoopRow, RunRow, UnreadRow
from lostmotion.store.store import Screened, Store
from tests.support.plant_rows import END, START, plant, sound, trace

TAGS = ("FIC-1", "FIC-2", "FIC-3", "FIC-4", "FIC-5")


def plant_store(folder, tags=TAGS, view=None, data=True):
    """Address of a store whose last run is `plant(tags)`; the run before found nothing in its first two loops."""
    source, address, view = folder / "plant", str(folder / "plant.db"), view or plant(tags)
    if data:
        source.mkdir()
        write_record(source / "record.csv")
    loops = [LoopRow(one.tag, one.area, one.loop_type, where="record.csv", weight=one.weight) for one in view.loops]
    with Store(address) as store:
        for number in (1, 2):
            began = datetime(2026, 11, 14 + number, 8, tzinfo=UTC)
            run, _ = store.begin(RunRow(str(source), digest=f"d{number}", code="0.1.0", began=began))
            unread = [UnreadRow("notes.txt", "no columns")] if number == 2 else []
            store.put_loops(run, loops, unread)
            rows = view.rows if number == 2 else tuple(_before(one.tag) for one in view.loops[:2])
            store.put_screened(run, [Screened((replace(row, window_start=START, window_end=END),)) for row in rows])
            if number == 2:
                store.put_assessed(run, [row for row in rows if row.stage == "assessed"], [trace(view.loops[0].tag)])
                store.put_groups(run, view.groups)
            store.finish(run)
    return address


def _before(tag):
    return sound(tag)


def write_record(path, rows=4000):
    """A loop whose valve sticks, as CSV."""
    angle = np.arange(rows) / 40.0
    op, pv = 50.0 + 3.0 * np.sin(angle), 20.0 + np.sign(np.sin(angle - 1.0))
    lines = [f"{k * 10},{op[k]:.3f},{pv[k]:.3f},20" for k in range(rows)]
    path.write_text("time_s,OP,PV,SP\n" + "\n".join(lines) + "\n", encoding="utf-8")
