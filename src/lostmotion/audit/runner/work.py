"""What a worker does with a batch: read, screen or assess; what goes wrong with a loop is a row of it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, cast

from lostmotion.audit.runner.code import code_version
from lostmotion.audit.runner.engine.protocol import one_line, resolved
from lostmotion.audit.runner.plan import definition
from lostmotion.audit.settings import AuditSettings
from lostmotion.errors import LostMotionError, SetupError, SlowError
from lostmotion.plant import PlantLoop, PlantSource
from lostmotion.plant.loop_list import in_loop_list
from lostmotion.records import LoopRecord
from lostmotion.store.encoded import encoded
from lostmotion.store.rows import UNDATED, AssessmentRow, SpectrumRow, Stage, TraceRow
from lostmotion.workers.interrupt import within

NOTHING = "the source gave nothing for it"
NO_WINDOW = "no window holds two samples"


@dataclass(frozen=True)
class Steps:
    """Functions of an audit, by their import path: workers find them by it.

    Attributes
    ----------
    windows, screen, assess : str
        Called in workers.
    ranked, groups : str
        Called by the coordinator; empty: that step is left out.
    """

    windows: str = "lostmotion.audit.screen.windows:windows_of"
    screen: str = "lostmotion.audit.screen.screen:screen"
    assess: str = "lostmotion.audit.assess.assess:assess"
    ranked: str = "lostmotion.audit.rank:ranked"
    groups: str = "lostmotion.audit.groups.groups:groups"


@dataclass(frozen=True)
class Job:
    """What all batches of a run have in common.

    Attributes
    ----------
    source : PlantSource
    settings : AuditSettings
    steps : Steps
    code : str
        Of the coordinator: a worker with another one would mix two programs in one run.
    """

    source: PlantSource
    settings: AuditSettings
    steps: Steps = field(default_factory=Steps)
    code: str = field(default_factory=code_version)


Wanted = tuple[PlantLoop, tuple[AssessmentRow, ...]]
Screened = tuple[tuple[AssessmentRow, ...], tuple[SpectrumRow, ...]]
Assessed = tuple[tuple[AssessmentRow, ...], tuple[TraceRow, ...]]


def screen_batch(job: Job, loops: tuple[PlantLoop, ...]) -> tuple[Screened, ...]:
    """Rows of all windows of each loop, in the order of the loops; at least one of each."""
    _need_same_code(job)
    windows, screen = resolved(job.steps.windows), resolved(job.steps.screen)

    def work(loop: PlantLoop, record: LoopRecord) -> Screened:
        found = [_screened(screen, loop, one, job.settings) for one in windows(record, job.settings)]
        if not found:
            return (failed(loop, NO_WINDOW),), ()
        return tuple(row for row, _ in found), tuple(spectrum for _, spectrum in found if spectrum is not None)

    results = _each(job, loops, work, lambda loop, why: ((failed(loop, why),), ()))
    return tuple(_checked(job, loop, rows, more) for loop, (rows, more) in zip(loops, results, strict=True))


def _screened(
    screen: Callable[..., Any], loop: PlantLoop, window: Any, settings: AuditSettings
) -> tuple[AssessmentRow, SpectrumRow | None]:
    """One window; that it takes too long is its own."""
    began = time.process_time()
    given = (loop, window.record, window.start, window.end, settings)
    try:
        return cast("tuple[AssessmentRow, SpectrumRow | None]", within(settings.loop_minutes, screen, *given))
    except SlowError as error:
        row = AssessmentRow(loop.tag, window.start, window.end, fingerprint=window.record.fingerprint)
        return replace(lost(row, str(error)), seconds=time.process_time() - began), None


def assess_batch(job: Job, wanted: tuple[Wanted, ...]) -> tuple[Assessed, ...]:
    """Assessed rows of the windows of each loop, in the order in which they are wanted."""
    _need_same_code(job)
    windows, assess = resolved(job.steps.windows), resolved(job.steps.assess)
    rows_of = {loop.tag: rows for loop, rows in wanted}
    loops = tuple(loop for loop, _ in wanted)

    def work(loop: PlantLoop, record: LoopRecord) -> Assessed:
        there = {window.start: window.record for window in windows(record, job.settings)}
        found = [_assessed(assess, loop, there.get(row.window_start), row, job) for row in rows_of[loop.tag]]
        return tuple(row for row, _ in found), tuple(trace for _, trace in found if trace is not None)

    results = _each(job, loops, work, lambda loop, why: (tuple(lost(row, why) for row in rows_of[loop.tag]), ()))
    return tuple(_checked(job, loop, rows, more) for loop, (rows, more) in zip(loops, results, strict=True))


def _assessed(
    assess: Callable[..., Any], loop: PlantLoop, record: LoopRecord | None, row: AssessmentRow, job: Job
) -> tuple[AssessmentRow, TraceRow | None]:
    """One window; its error is its own."""
    if record is None:
        return lost(row, "its data have changed since it was screened"), None
    began = time.process_time()
    try:
        new, trace = within(job.settings.loop_minutes, assess, loop, record, row, job.settings)
    except Exception as error:  # noqa: BLE001  one loop in thousands must not end the run
        return replace(lost(row, said(error)), seconds=time.process_time() - began), None
    return new, trace


def failed(loop: PlantLoop, why: str) -> AssessmentRow:
    """Row of a loop that could not be looked at."""
    return AssessmentRow(loop.tag, UNDATED, UNDATED, stage=Stage.FAILED, fit_for_use=False, error=why)


def lost(row: AssessmentRow, why: str) -> AssessmentRow:
    """Row of a window that was screened, and could not be assessed."""
    return replace(row, stage=Stage.FAILED, error=why)


def stamped(job: Job, loop: PlantLoop, row: AssessmentRow) -> AssessmentRow:
    """Row with what it depends on."""
    return replace(
        row, tag=loop.tag, stamp=loop.stamp, settings=job.settings.digest(), code=job.code, definition=definition(loop)
    )


def _checked(job: Job, loop: PlantLoop, rows: Iterable[AssessmentRow], more: Any) -> Any:
    """Rows that the store can keep."""
    kept = []
    for row in (stamped(job, loop, one) for one in rows):
        try:
            encoded(row)
            kept.append(row)
        except LostMotionError as error:
            bare = AssessmentRow(loop.tag, row.window_start, row.window_end, fingerprint=row.fingerprint)
            kept.append(stamped(job, loop, lost(bare, str(error))))
    return tuple(kept), more


def _each(
    job: Job,
    loops: Sequence[PlantLoop],
    work: Callable[[PlantLoop, LoopRecord], Any],
    refused: Callable[[PlantLoop, str], Any],
) -> list[Any]:
    """Result of each loop, in their order; read together, and one by one where that fails."""
    found: dict[str, Any] = {}
    for loop, record in _records(job, loops):
        try:
            found[loop.tag] = work(loop, record) if isinstance(record, LoopRecord) else refused(loop, said(record))
        except Exception as error:  # noqa: BLE001  one loop in thousands must not end the run
            found[loop.tag] = refused(loop, said(error))
    return [found[loop.tag] if loop.tag in found else refused(loop, NOTHING) for loop in loops]


def _records(job: Job, loops: Sequence[PlantLoop]) -> Iterator[tuple[PlantLoop, LoopRecord | Exception]]:
    left = {loop.tag: loop for loop in loops}
    try:
        for loop, record in job.source.read(loops, job.settings.since, job.settings.until):
            left.pop(loop.tag, None)
            yield loop, record
    except Exception as error:  # noqa: BLE001  a source that raises instead of giving the error
        if len(loops) == 1:
            yield loops[0], error
            return
        for loop in left.values():
            yield from _records(job, [loop])


def said(error: BaseException) -> str:
    """Error in one line; of one that was raised on purpose its words are enough, with those of a loop list."""
    return in_loop_list(" ".join(str(error).split()))[:500] if isinstance(error, LostMotionError) else one_line(error)


def _need_same_code(job: Job) -> None:
    if job.code != code_version():
        raise SetupError(
            f"expected lostmotion {job.code} on the worker, got {code_version()}; install the same one (and the same "
            "NumPy, SciPy, Numba, Polars) on the workers and here"
        )
