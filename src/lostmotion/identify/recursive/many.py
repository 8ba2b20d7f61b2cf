"""Many recursive estimators side by side: threads where compiled code does the work, processes where Python does.

A first window is fitted by Python, which two threads cannot do at the same time; `RecursiveML` is started in processes.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite_signal, whole
from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError, ParameterError
from lostmotion.identify.recursive.estimator import RecursiveEstimator
from lostmotion.identify.recursive.recursive_estimate import Trajectory
from lostmotion.workers import Pool, usable_processors

Job: TypeAlias = tuple[RecursiveEstimator, FloatArray, FloatArray, int]
CHUNKS = 4  # tasks of each thread: they end together although loops differ


def run_many(
    estimators: Sequence[RecursiveEstimator],
    u: npt.ArrayLike | Sequence[npt.ArrayLike],
    y: npt.ArrayLike | Sequence[npt.ArrayLike],
    every: int = 1,
    workers: int | None = None,
) -> list[Trajectory]:
    """Let each estimator take its own loop's samples; the results are those of one run after the other.

    Parameters
    ----------
    estimators : sequence of RecursiveEstimator
        Different ones, one for each loop; all that is needed of them is ``run(u, y, every)``.
    u, y : array_like, shape (loops, n), or a sequence of signals
        One row for each loop; lengths may differ between loops.
    every : int
        Every how many samples an estimate is kept.
    workers : int or None
        Threads, or processes for estimators that have a first window to fit; None: one for each core that this
        process may use. What goes to another process and comes back is pickled: u, y, estimator and trajectory.

    Returns
    -------
    list of Trajectory
        In the order of `estimators`.

    Raises
    ------
    DataError
        Signals of other number or length, or not finite; no estimator has taken a sample then.
    ParameterError
        An estimator without ``run`` or given twice, `every` or `workers` below 1.

    Examples
    --------
    >>> import lostmotion as lm
    >>> u = [lm.signals.prs(500, -5, 5, hold=10, seed=seed) for seed in range(3)]
    >>> loops = [lm.RecursiveIV(na=3, nb=2, delay=3) for _ in u]
    >>> [trajectory.errors.size for trajectory in lm.run_many(loops, u, [2 * row for row in u], every=100)]
    [500, 500, 500]
    """
    every = whole("every", every, 1)
    workers = usable_processors() if workers is None else whole("workers", workers, 1)
    estimators = list(estimators)
    if not all(callable(getattr(one, "run", None)) for one in estimators):
        raise ParameterError.expected("estimators with run(u, y, every)", repr(estimators)[:60], "see lm.RecursiveIV")
    if len({id(one) for one in estimators}) < len(estimators):
        raise ParameterError.expected("different estimators", "one of them twice", "make one for each loop")
    inputs, outputs = _rows("u", u, len(estimators)), _rows("y", y, len(estimators))
    for loop, (row, other) in enumerate(zip(inputs, outputs, strict=True)):
        if row.size != other.size:
            raise DataError.expected(f"y[{loop}] with {row.size} samples", other.size, "cut both to the same length")

    jobs = list(zip(estimators, inputs, outputs, [every] * len(estimators), strict=True))
    apart = [number for number, job in enumerate(jobs) if workers > 1 and _fits_first(job)]
    beside = sorted(set(range(len(jobs))) - set(apart))
    found: dict[int, Trajectory] = {}
    if apart:
        with Pool(min(workers, len(apart))) as processes:
            done = processes.map(_elsewhere, [jobs[number] for number in apart])
            for number, (changed, trajectory) in zip(apart, done, strict=True):
                vars(estimators[number]).update(changed)
                found[number] = trajectory
    parts = [list(part) for part in np.array_split(beside, max(1, min(len(beside), CHUNKS * workers)))]
    with ThreadPoolExecutor(workers) as threads:
        together = threads.map(_run, [[jobs[number] for number in part] for part in parts])
        for part, trajectories in zip(parts, together, strict=True):
            found |= zip(part, trajectories, strict=True)
    return [found[number] for number in range(len(jobs))]


def _fits_first(job: Job) -> bool:
    """Whether most of the work is Python: a first window is fitted in these samples."""
    estimator, u = job[:2]
    window = getattr(estimator, "start_samples", None)
    waits = window is not None and estimator.samples < window <= estimator.samples + u.size
    return waits and not estimator.started


def _run(jobs: list[Job]) -> list[Trajectory]:
    return [estimator.run(u, y, every) for estimator, u, y, every in jobs]


def _elsewhere(job: Job) -> tuple[dict[str, Any], Trajectory]:
    """In another process: what has become of the estimator goes back, too."""
    (trajectory,) = _run([job])
    return vars(job[0]), trajectory


def _rows(name: str, signals: npt.ArrayLike | Sequence[npt.ArrayLike], loops: int) -> list[FloatArray]:
    """One finite signal for each loop, or a DataError."""
    try:
        rows = list(signals)  # type: ignore[arg-type]
    except TypeError:
        raise DataError.expected(f"{name} of {loops} signals", repr(signals)[:60], "give one row for each") from None
    if len(rows) != loops:
        raise DataError.expected(f"{name} of {loops} signals", len(rows), "give one row for each estimator")
    return [finite_signal(f"{name}[{loop}]", row) for loop, row in enumerate(rows)]
