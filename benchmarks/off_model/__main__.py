"""``identify`` on real motors and on plants that are not quite of its model's shape.

Run: ``.venv/bin/python -m benchmarks.off_model`` prints a table and a summary against its bars for each suite;
``--suite NAME ..``: these; ``--seeds 0 1``: seeds of the drawn records, each a whole design; ``--first N``: the first N
records of each suite; ``--workers N``; ``--out FILE``: all rows as JSON. Real records: ../shared/actuators.

A record that takes longer than 120 s counts as no answer. The simulated plants share nothing with the package.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported, also in workers

import argparse  # noqa: E402
import json  # noqa: E402
import math  # noqa: E402
import sys  # noqa: E402
import time  # noqa: E402
from collections.abc import Sequence  # noqa: E402
from concurrent.futures import ProcessPoolExecutor, as_completed  # noqa: E402
from dataclasses import asdict  # noqa: E402
from multiprocessing import get_context  # noqa: E402
from pathlib import Path  # noqa: E402
from typing import Any  # noqa: E402

import numpy as np  # noqa: E402
from scipy.signal import lfilter  # noqa: E402

import lostmotion as lm  # noqa: E402

from . import asymmetric, levels, mixed, servos, thinning, wheels  # noqa: E402
from .places import ACTUATORS  # noqa: E402
from .suites import Job, Suite  # noqa: E402

SUITES = {
    suite.name: suite for module in (wheels, asymmetric, thinning, levels, servos, mixed) for suite in module.SUITES
}
SEEDS = (0, 1, 2, 3, 4)


def run(suite: Suite, jobs: Sequence[Job], workers: int) -> list[Any]:
    """Rows in the order of the jobs, with progress on stderr."""
    rows: dict[int, Any] = {}
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        waiting = {pool.submit(suite.work, job): at for at, job in enumerate(jobs)}
        for done in as_completed(waiting):
            rows[waiting[done]] = done.result()
            print(f"[{len(rows)}/{len(jobs)}] {done.result()}", file=sys.stderr, flush=True)
    return [rows[at] for at in sorted(rows)]


def compile_kernels() -> None:
    """Once, into the cache of Numba, before a record is timed."""
    levels = np.repeat(np.random.default_rng(0).uniform(-10.0, 10.0, 30), 10)
    lm.identify(levels, lfilter([0.0, 0.3], [1.0, -0.7], levels) + np.random.default_rng(1).normal(size=300), 1.0)


def plain(value: Any) -> Any:
    """JSON has no nan and no infinity: nan becomes null, infinity a word."""
    if isinstance(value, dict):
        return {name: plain(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [plain(one) for one in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value


def main() -> None:
    """Run the suites and print."""
    parser = argparse.ArgumentParser(
        prog="benchmarks.off_model", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--suite", nargs="+", choices=SUITES, default=list(SUITES))
    parser.add_argument("--seeds", type=int, nargs="+", default=SEEDS)
    parser.add_argument("--first", type=int, default=None, metavar="N", help="the first N records of each suite")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=None, metavar="FILE")
    given = parser.parse_args()
    compile_kernels()
    raw: dict[str, Any] = {}
    for name in given.suite:
        suite, begun = SUITES[name], time.perf_counter()
        if suite.folder and not (ACTUATORS / suite.folder).is_dir():
            sys.exit(f"expected the real records in {ACTUATORS / suite.folder}, got no such folder; lay them there")
        jobs = [job for together in suite.jobs(given.seeds)[: given.first] for job in together]
        rows = run(suite, jobs, given.workers)
        minutes = (time.perf_counter() - begun) / 60.0
        print("\n".join([f"## {name}: {len(rows)} rows, {minutes:.1f} minutes", "", *suite.report(rows)]), flush=True)
        raw[name] = [plain({**asdict(job), **asdict(row)}) for job, row in zip(jobs, rows, strict=True)]
        if given.out is not None:
            given.out.write_text(json.dumps(raw, indent=1, allow_nan=False), encoding="utf-8")


if __name__ == "__main__":
    main()
