"""How an audit scales: 1 and 2 workers, processes against Dask, cost of a batch, and a model of 64 workers from it.

    python -m benchmarks.audit.scaling [--loops 64] [--cost 0.5] [--batches 400] [--engines processes dask]
    python -m benchmarks.audit.scaling --source FOLDER [--window SECONDS]     real loops, screened and diagnosed

Without a source the work is busy waiting for so many seconds of processor time a loop (benchmarks/audit/stand_in.py).
Times are elapsed: they are worth something only where the machine has nothing else to do; its load is printed.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from dataclasses import replace
from datetime import timedelta
from pathlib import Path
from typing import Any

from benchmarks.audit.stand_in import STEPS, MadePlant

from lostmotion.audit.runner.batches import cut
from lostmotion.audit.runner.engine import Done, Task, open_engine
from lostmotion.audit.runner.engine.protocol import resolved
from lostmotion.audit.runner.run import Progress, run_audit
from lostmotion.audit.runner.work import Steps
from lostmotion.audit.settings import AuditSettings
from lostmotion.store.rows import UNDATED, AssessmentRow, Stage
from lostmotion.store.run_rows import LoopRow, RunRow
from lostmotion.store.store import Screened, Store

MODEL = 64
LOOPS = 26000


def audited(engine_name: str, workers: int, source: Any, settings: AuditSettings, steps: Steps) -> dict[str, float]:
    """Elapsed seconds of a run and of its stages, once the workers have started; processor seconds of its rows."""
    engine = open_engine(engine_name, workers)
    warm(engine, workers)
    at: dict[str, float] = {}

    def note(progress: Progress) -> None:
        at.setdefault(progress.stage, time.perf_counter())

    with tempfile.TemporaryDirectory() as folder, Store(Path(folder) / "a.db") as store:
        began = time.perf_counter()
        cpu = time.process_time()
        run = run_audit(source, store, settings, engine, note, steps=steps)
        ended = time.perf_counter()
        own = time.process_time() - cpu
        rows = store.rows(run)
    engine.close()
    return {
        "whole": ended - began, "screen": at["assess"] - at["screen"], "assess": at["rank"] - at["assess"],
        "rank": ended - at["rank"], "work": sum(row.seconds for row in rows), "coordinator": own, "rows": len(rows),
    }  # fmt: skip


def warm(engine: Any, workers: int) -> None:
    """Start the workers, and import in them what the audit needs."""
    items = [("lostmotion.audit.runner.work",)] * (4 * workers)
    assert sum(len(one.items) for one in engine.run(Task("benchmarks.audit.scaling:imported"), items)) == len(items)


def imported(_: Any, items: tuple[str, ...]) -> tuple[None, ...]:
    """Import modules, and wait a little: another worker takes the next one."""
    for item in items:
        __import__(item)
    time.sleep(0.2)
    return (None,) * len(items)


def overhead(engine_name: str, batches: int) -> float:
    """Elapsed seconds of a batch of 16 items that does nothing, with 2 workers."""
    engine = open_engine(engine_name, 2)
    list(engine.run(Task("benchmarks.audit.light:double", 1), [(1,)] * 8))
    began = time.perf_counter()
    items = [tuple(range(16)) for _ in range(batches)]
    found = engine.run(Task("benchmarks.audit.light:double", 1), items)
    done = sum(len(one.items) for one in found if isinstance(one, Done))
    took = time.perf_counter() - began
    engine.close()
    assert done == 16 * batches
    return took / batches


def written(rows: int = 2000) -> float:
    """Processor seconds of the coordinator for a row: screened, then assessed."""
    with tempfile.TemporaryDirectory() as folder, Store(Path(folder) / "a.db") as store:
        run, _ = store.begin(RunRow("plant"))
        made = [AssessmentRow(f"L{one}", UNDATED, UNDATED + timedelta(1), value=0.5) for one in range(rows)]
        store.put_loops(run, [LoopRow(row.tag) for row in made])
        began = time.process_time()
        for part in cut(made, 16):
            store.put_screened(run, [Screened((row,)) for row in part])
            store.put_assessed(run, [replace(row, stage=Stage.ASSESSED) for row in part])
        return (time.process_time() - began) / rows


def model(work: float, batch: float, row: float) -> None:
    """Hours of 26,000 loops by workers: work side by side, batches and rows one after another in the coordinator."""
    for workers in (1, 2, 4, 8, 16, 32, MODEL, 2 * MODEL):
        alone = LOOPS * (2 * batch / 16 + row)
        took = max(LOOPS * work / workers, alone)
        times = LOOPS * work / took
        print(f"  {workers:4d} workers: {took / 60:8.1f} min, {times:6.1f} times one; coordinator {alone / 60:.1f} min")


def main() -> None:
    """Measure and say."""
    words = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    words.add_argument("--loops", type=int, default=64)
    words.add_argument("--cost", type=float, default=0.5)
    words.add_argument("--batches", type=int, default=400)
    words.add_argument("--engines", nargs="+", default=["processes", "dask"])
    words.add_argument("--source", nargs="+")
    words.add_argument("--window", type=float)
    words.add_argument("--most", type=float, default=2.0, help="seconds of a loop in the model, without a source")
    settings = words.parse_args()
    if settings.source:
        source, steps = resolved("lostmotion.plant:open_plant")(*settings.source), Steps()
    else:
        tags = tuple(f"L{number:05d}" for number in range(settings.loops))
        source, steps = MadePlant(tags, cost=settings.cost), STEPS
    print(f"load before: {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
    found = {}
    for name in settings.engines:
        for workers in (1, 2):
            found[name, workers] = one = audited(name, workers, source, AuditSettings(window=settings.window), steps)
            print(f"{name}, {workers}: " + ", ".join(f"{key} {value:.2f}" for key, value in one.items()), flush=True)
        print(f"{name}: 2 workers are {found[name, 1]['whole'] / found[name, 2]['whole']:.2f} times as fast as 1")
    if len(settings.engines) > 1:
        first, second = (found[name, 2]["whole"] for name in settings.engines[:2])
        print(
            f"{settings.engines[1]} took {100 * (second / first - 1):+.1f} % against {settings.engines[0]}, 2 workers"
        )
    row = written()
    print(f"store: {1e3 * row:.2f} ms of processor time of the coordinator for each row, screened and assessed")
    one = found[settings.engines[0], 1]
    work = one["work"] / one["rows"] if settings.source else settings.most
    for name in settings.engines:
        batch = overhead(name, settings.batches)
        print(f"{name}: {1e3 * batch:.2f} ms a batch of 16; {LOOPS} loops of {work:.2f} s each, by this model:")
        model(work, batch, row)


if __name__ == "__main__":
    main()
