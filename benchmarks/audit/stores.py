"""A store with a million assessments: time of every page's query, and SQLite against PostgreSQL, row for row.

    python -m benchmarks.audit.stores [--loops 26000] [--runs 39] [--databases sqlite postgresql] [--repeat 5]

A run of made rows (some words and numbers of each) is copied by SQL into the other runs and varied there by sums of
whole numbers, the same in both databases. Times of SQLite are processor time, those of PostgreSQL elapsed time.
"""

from __future__ import annotations

import argparse
import hashlib
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import sqlalchemy as sa
from benchmarks.audit.stand_in import SEVERITIES, VERDICTS

from lostmotion.store import carry
from lostmotion.store.queries import Filter
from lostmotion.store.rows import UNDATED, AssessmentRow, GroupRow, SpectrumRow, Stage, TraceRow
from lostmotion.store.run_rows import LoopRow, ReviewState, RunRow
from lostmotion.store.schema import assessment, metadata
from lostmotion.store.store import Screened, Store
from tests.support.stores import Server

END = UNDATED + timedelta(days=1)
AT = datetime(2026, 3, 1, tzinfo=UTC)
LIMIT = 0.1  # s of a page's query
BLOCK = 2000  # loops written together


def made(number: int) -> AssessmentRow:
    """Row of a loop, about as long as a real one."""
    words = "stiction of 2.1 % of span (1.9 .. 2.3), 97 % sure; swings every 34 s, 61 % of the variance"
    return AssessmentRow(
        f"FIC-{number:05d}", UNDATED, END, f"{number:016x}", "123456-1772323200000000000", "0" * 16, "0.1.0+0123456789",
        "1" * 16, Stage.ASSESSED, "swings every 34 s, and OP turns often enough", "OK", VERDICTS[number % 6],
        "actuator", number * 0.001, number * 0.0005, number * 0.002, number * 0.001, severity=SEVERITIES[number % 5],
        label="maintenance required", split="actuator", confidence=0.9, rows=86400, dt=1.0, manual=0.01, harris=0.5,
        period=34.0 + number % 100, health=("stale for 3 % of the time",), priority=(number * 7919 % 26000) / 260,
        evidence=tuple((f"line {one}", 0.1 * one, 1.0) for one in range(12)), priority_reason=words, value=0.5,
        advice=("Test the valve with small steps.",) * 2, seconds=1.5,
        indices={f"index {one}": one / 7.0 for one in range(10)},
    )  # fmt: skip


def filled(store: Store, loops: int, runs: int) -> None:
    """Runs of all loops."""
    rows = [made(number) for number in range(loops)]
    for _ in range(runs):
        run, _ = store.begin(RunRow("plant", digest="d", code="c", began=AT))
        listed = [LoopRow(row.tag, area=f"area {number % 40}", loop_type="flow") for number, row in enumerate(rows)]
        store.put_loops(run, listed)
        if run == 1:
            for first in range(0, loops, BLOCK):
                part = rows[first : first + BLOCK]
                store.put_screened(
                    run, [Screened((one,), (SpectrumRow(one.tag, UNDATED, 0.0, 1.0, b"1" * 384),)) for one in part]
                )
            traces = [TraceRow(row.tag, UNDATED, 0.0, 1200.0, *[b"1" * 4800] * 3) for row in rows[:500]]
            store.put_assessed(run, rows[:500], traces)
        else:
            vary(store, run)
        store.put_groups(run, [group(number, rows) for number in range(min(loops // 6, 200))])
        store.finish(run)
    for number in range(0, min(loops, 2000), 2):
        store.review(f"FIC-{number:05d}", list(ReviewState)[number % 5], "Ada", "seen", AT)


def vary(store: Store, run: int) -> None:
    """The first run's rows, with other words and numbers."""
    step = sa.cast(assessment.c.loop_id, sa.BigInteger) * 31 + run * 17
    words = {name: choice(step, of) for name, of in (("verdict", VERDICTS), ("severity", SEVERITIES))}
    with store.engine.connect().execution_options(writing=True) as connection, connection.begin():
        ids = list(connection.scalars(sa.select(assessment.c.loop_id).where(assessment.c.run_id == 1)))
        for first in range(0, len(ids), BLOCK):
            carry.copy(connection, 1, run, ids[first : first + BLOCK])
        other = {"priority": (step * 7919 % 26000) / 260.0, "size": (step % 1000) / 64.0}
        connection.execute(assessment.update().where(assessment.c.run_id == run).values(words | other))


def choice(step: Any, words: tuple[str, ...]) -> Any:
    """One of the words by a number."""
    return sa.case(*((step % len(words) == number, word) for number, word in enumerate(words[1:], 1)), else_=words[0])


def group(number: int, rows: list[AssessmentRow]) -> GroupRow:
    """Six loops."""
    members = rows[6 * number : 6 * number + 6]
    return GroupRow(
        number + 1, 34.0, members[0].tag, 0.8, "first", tuple((row.tag, UNDATED, 0.9, 0.5) for row in members)
    )


def pages(store: Store, runs: int) -> dict[str, Callable[[], Any]]:
    """What every page asks."""
    last, tag = runs, "FIC-00123"
    return {
        "last run": store.last_run,
        "runs": store.runs,
        "table by priority": lambda: store.lines(last),
        "table by size, page 200": lambda: store.lines(last, sort="size", offset=9950),
        "table by tag": lambda: store.lines(last, sort="tag", descending=False),
        "table by area": lambda: store.lines(last, sort="area", descending=False),
        "table of a verdict": lambda: store.lines(last, Filter(said="stiction", severity="severe")),
        "table of an area": lambda: store.lines(last, Filter(area="area 7", loop_type="flow")),
        "table of a text": lambda: store.lines(last, Filter(text="fic-0012")),
        "table of a review": lambda: store.lines(last, Filter(review="work order")),
        "table of what is new to review": lambda: store.lines(last, Filter(review="new", said="stiction")),
        "counts": lambda: store.counts(last),
        "treemap": lambda: store.areas(last),
        "news": lambda: store.news(last, limit=200),
        "all news": lambda: store.news(last),
        "loop": lambda: store.loop(tag),
        "history of a loop": lambda: store.history(tag),
        "traces of a loop": lambda: store.traces(last, tag),
        "spectra of 100 loops": lambda: store.spectra(last, [f"FIC-{one:05d}" for one in range(100)]),
        "reviews of a loop": lambda: store.reviews(tag),
        "groups": lambda: store.groups(last),
        "unread": lambda: store.unread(last),
    }


def digest(store: Store) -> dict[str, tuple[int, str]]:
    """Rows of each table, how many and a digest of all of them in the order of their keys."""
    found = {}
    with store.engine.connect() as connection:
        for table in metadata.sorted_tables:
            columns = [one for one in table.columns if one.name not in ("coordinator", "heartbeat", "began", "ended")]
            rows = connection.execution_options(yield_per=2000).execute(
                sa.select(*columns).order_by(*table.primary_key)
            )
            sha, count = hashlib.sha256(), 0
            for row in rows:
                sha.update(repr(tuple(row)).encode())
                count += 1
            found[table.name] = count, sha.hexdigest()[:12]
    return found


def bytes_of(store: Store) -> int:
    """What the database takes on its disk."""
    words = "SELECT pg_database_size(current_database())"
    if store.engine.dialect.name == "sqlite":
        words = "SELECT page_count * page_size FROM pragma_page_count(), pragma_page_size()"
    with store.engine.connect() as connection:
        return int(connection.execute(sa.text(words)).scalar_one())


def measured(kind: str, store: Store, settings: argparse.Namespace) -> tuple[dict[str, Any], float]:
    """Answers of all pages, and the longest time."""
    clock = time.process_time if kind == "sqlite" else time.perf_counter
    answers, longest = {}, 0.0
    for name, ask in pages(store, settings.runs).items():
        times = []
        for _ in range(settings.repeat):
            began = clock()
            answers[name] = ask()
            times.append(clock() - began)
        middle = statistics.median(times)
        longest = max(longest, middle)
        print(f"  {name:32} {1e3 * middle:7.1f} ms   first {1e3 * times[0]:7.1f} ms", flush=True)
    return answers, longest


def main() -> None:
    """Fill, ask, compare."""
    words = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    words.add_argument("--loops", type=int, default=26000)
    words.add_argument("--runs", type=int, default=39)
    words.add_argument("--repeat", type=int, default=5)
    words.add_argument("--databases", nargs="+", default=["sqlite", "postgresql"])
    settings = words.parse_args()
    server = Server() if "postgresql" in settings.databases else None
    found, good = [], True
    with tempfile.TemporaryDirectory(prefix="stores-") as folder:
        try:
            for kind in settings.databases:
                address = str(Path(folder) / "plant.db") if kind == "sqlite" or server is None else server.database()
                began = time.monotonic(), time.process_time()
                with Store(address) as store:
                    filled(store, settings.loops, settings.runs)
                    took = time.monotonic() - began[0], time.process_time() - began[1]
                    print(f"{kind}: filled in {took[0]:.0f} s ({took[1]:.0f} s of processor here)", flush=True)
                    if server is not None and kind == "postgresql":
                        with store.engine.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
                            connection.execute(sa.text("ANALYZE"))
                    answers, longest = measured(kind, store, settings)
                    good &= longest < LIMIT
                    size = bytes_of(store)
                    found.append((digest(store), answers))
                    print(
                        f"{kind}: longest {1e3 * longest:.1f} ms; {found[-1][0]['assessment'][0]} assessments, "
                        f"{size / 1e9:.2f} GB",
                        flush=True,
                    )
                for file in Path(folder).iterdir():  # one database on the disk at a time
                    file.unlink()
        finally:
            if server is not None:
                server.stop()
    if len(found) == 2:
        same = found[0][0] == found[1][0]
        asked = {name for name in found[0][1] if plain(found[0][1][name]) != plain(found[1][1][name])}
        print(f"tables row for row the same: {same}; pages that differ: {sorted(asked) or 'none'}")
        good &= same and not asked
    sys.exit(0 if good else 1)


def plain(answer: Any) -> Any:
    """Answer without the times of runs."""
    if isinstance(answer, RunRow):
        return replace(answer, began=None, heartbeat=None, ended=None)
    return [plain(one) for one in answer] if isinstance(answer, list | tuple) else answer


if __name__ == "__main__":
    main()
