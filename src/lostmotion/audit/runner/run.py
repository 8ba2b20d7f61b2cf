"""Run an audit: screen every loop, assess what is worth it, rank, group. It can be killed anywhere and gone on with."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from datetime import datetime
from typing import Any

from lostmotion.audit.runner import plan
from lostmotion.audit.runner.batches import batches, by_loop, cut, fair
from lostmotion.audit.runner.code import code_version
from lostmotion.audit.runner.engine.protocol import Done, Engine, Lost, Task, resolved
from lostmotion.audit.runner.work import Job, Steps, failed, lost, stamped
from lostmotion.audit.settings import AuditSettings
from lostmotion.errors import LostMotionError
from lostmotion.plant import PlantLoop, PlantSource
from lostmotion.store.carry import Known
from lostmotion.store.encoded import as_json
from lostmotion.store.rows import AssessmentRow, SpectrumRow, TraceRow
from lostmotion.store.run_rows import RunRow, RunState
from lostmotion.store.store import Screened, Store

ASSESSED_TOGETHER = 16  # windows of a batch, where nothing limits the time
PRECISE = 4  # .. where a budget is to be kept, and the order of values
BLOCKS = 8  # batches of a worker among which those of a file are put together: the order of values matters less
SCREEN, ASSESS = "lostmotion.audit.runner.work:screen_batch", "lostmotion.audit.runner.work:assess_batch"


@dataclass(frozen=True)
class Progress:
    """How far a run is.

    Attributes
    ----------
    stage : str
        "screen", "assess", "rank".
    done, total : int
        Loops of the screen, windows of the assessment; what was carried over or done before counts as done.
    rate : float, optional
        A second.
    seconds_left : float, optional
        Of this stage.
    """

    stage: str
    done: int
    total: int
    rate: float | None = None
    seconds_left: float | None = None


Report = Callable[[Progress], None]


def run_audit(
    source: PlantSource,
    store: Store,
    settings: AuditSettings,
    engine: Engine,
    progress: Report | None = None,
    *,
    name: str = "",
    steps: Steps | None = None,
    resume: bool = True,
) -> int:
    """Audit all loops of a source, and put the results into a store.

    A run that was not finished, of the same source (by `name`), settings and code, is gone on with. What an earlier run
    has done with the same data, settings and code is carried over.

    Parameters
    ----------
    source : PlantSource
    store : Store
    settings : AuditSettings
    engine : Engine
        Not closed.
    progress : callable, optional
        Called with a :class:`Progress` whenever something is done.
    name : str
        Of the source, in words.
    steps : Steps, optional
        Functions by import path, for tests and other ways to judge.
    resume : bool
        False: an unfinished run is abandoned.

    Returns
    -------
    int
        Number of the run.

    Raises
    ------
    DataError
        No loops, or two with one tag.
    FileAccessError
        The store cannot be written, or another audit is at work in it.
    EngineError
        No workers any more; what was done is kept, and the next call goes on.
    """
    loops = plan.loops_of(source.loops())
    job = Job(source, settings, steps or Steps(), code_version())
    number, _ = store.begin(_run_row(name, job, engine), resume=resume)
    with store.beating(number):
        try:
            _work(_Run(number, store, engine, job, loops, progress or (lambda _: None)))
        except KeyboardInterrupt:
            _stop(store, number, "stopped by hand")
            raise
        except LostMotionError as error:
            _stop(store, number, str(error))
            raise
    return number


def _stop(store: Store, number: int, note: str) -> None:
    with suppress(LostMotionError):  # the store may be what has failed
        store.finish(number, RunState.STOPPED, note)


def _run_row(name: str, job: Job, engine: Engine) -> RunRow:
    settings = job.settings
    values = {one.name: getattr(settings, one.name) for one in fields(settings)}
    texts = {key: value.isoformat() if isinstance(value, datetime) else value for key, value in values.items()}
    return RunRow(
        name, as_json(texts), settings.digest(), job.code, settings.since, settings.until, settings.screen_only,
        engine.name, engine.workers,
    )  # fmt: skip


@dataclass(frozen=True)
class _Run:
    """What the stages of a run work with."""

    number: int
    store: Store
    engine: Engine
    job: Job
    loops: dict[str, PlantLoop]
    report: Report

    def task(self, work: str) -> Task:
        return Task(work, self.job)


def _work(run: _Run) -> None:
    unread = [plan.unread_row(one) for one in run.job.source.unread()]
    run.store.put_loops(run.number, [plan.loop_row(loop) for loop in run.loops.values()], unread)
    _screen(run)
    if not run.job.settings.screen_only:
        _assess(run)
    _rank(run)
    run.store.finish(run.number)


def _screen(run: _Run) -> None:
    wanted = {tag: Known(loop.stamp, plan.definition(loop)) for tag, loop in run.loops.items()}
    done = run.store.done(run.number, wanted)
    missing = [loop for tag, loop in run.loops.items() if tag not in done]
    pace = _Pace("screen", len(done), len(run.loops), run.report)
    for outcome in run.engine.run(run.task(SCREEN), batches(missing, run.engine.workers)):
        found = [Screened(*one) for one in _screened(run, outcome)]
        run.store.put_screened(run.number, found)
        pace.did(len(found))


def _screened(run: _Run, outcome: Done | Lost) -> Iterable[tuple[tuple[AssessmentRow, ...], tuple[SpectrumRow, ...]]]:
    if isinstance(outcome, Done):
        return outcome.results
    return [((stamped(run.job, outcome.item, failed(outcome.item, outcome.why)),), ())]


def _assess(run: _Run) -> None:
    keys = run.store.worth(run.number)
    limit = run.job.settings.cpu_minutes
    budget = plan.Budget(None if limit is None else 60.0 * limit, run.store.spent(run.number) if limit else 0.0)
    pace = _Pace("assess", 0, len(keys), run.report)
    done: set[tuple[str, datetime]] = set()
    for outcome in run.engine.run(run.task(ASSESS), plan.within(_wanted(run, keys, limit), budget, _windows)):
        rows, traces = _assessed(run, outcome)
        run.store.put_assessed(run.number, rows, traces)
        for row in rows:
            budget.took(row.seconds)
            done.add((row.tag, row.window_start))
        pace.did(len(rows))
    for part in cut([key for key in keys if key not in done], 500):
        left = run.store.chosen(run.number, part)
        run.store.put_ranks(run.number, [replace(row, reason=plan.over_budget(row.reason)) for row in left], "reason")


def _windows(batch: Sequence[tuple[PlantLoop, Sequence[AssessmentRow]]]) -> int:
    return sum(len(rows) for _, rows in batch)


def _wanted(run: _Run, keys: Sequence[tuple[str, datetime]], limit: float | None) -> Iterator[Any]:
    """Batches of windows, the most valuable first; without a budget those of a file together in each block."""
    size = fair(len(keys), run.engine.workers, ASSESSED_TOGETHER if limit is None else PRECISE)
    block = size * run.engine.workers * BLOCKS if limit is None else size
    for part in cut(keys, block):
        rows = [replace(row, reason=plan.without_budget(row.reason)) for row in run.store.chosen(run.number, part)]
        pairs = by_loop((run.loops[row.tag], row) for row in rows)
        yield from _cut_by_windows(pairs, size)


def _cut_by_windows(pairs: Sequence[tuple[PlantLoop, tuple[AssessmentRow, ...]]], size: int) -> Iterator[Any]:
    """Batches of about `size` windows; those of a loop stay together."""
    batch: list[Any] = []
    for pair in pairs:
        batch.append(pair)
        if _windows(batch) >= size:
            yield tuple(batch)
            batch = []
    if batch:
        yield tuple(batch)


def _assessed(run: _Run, outcome: Done | Lost) -> tuple[list[AssessmentRow], list[TraceRow]]:
    if isinstance(outcome, Done):
        rows = [row for found, _ in outcome.results for row in found]
        return rows, [trace for _, traces in outcome.results for trace in traces]
    loop, rows = outcome.item
    return [stamped(run.job, loop, lost(row, outcome.why)) for row in rows], []


def _rank(run: _Run) -> None:
    steps, store = run.job.steps, run.store
    run.report(Progress("rank", 0, 1))
    rows, found = store.rows(run.number), ()
    if steps.groups:
        found = resolved(steps.groups)(store.spectra(run.number), rows, run.loops)
        store.put_groups(run.number, found)
    if steps.ranked:
        store.put_ranks(run.number, resolved(steps.ranked)(rows, run.loops, found))
    run.report(Progress("rank", 1, 1))


class _Pace:
    """Rate and time left of a stage, by what is done since it began."""

    def __init__(self, stage: str, before: int, total: int, report: Report) -> None:
        self.stage, self.before, self.total, self.report = stage, before, total, report
        self.done = 0
        self.began = time.monotonic()
        report(Progress(stage, before, total))

    def did(self, number: int) -> None:
        """So many more are done."""
        self.done += number
        rate = self.done / max(time.monotonic() - self.began, 1e-9)
        now = self.before + self.done
        self.report(Progress(self.stage, now, self.total, rate, (self.total - now) / rate if rate else None))
