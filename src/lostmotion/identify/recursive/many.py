"""Many recursive estimators side by side."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite_signal, whole
from lostmotion.arrays import FloatArray, IntArray
from lostmotion.errors import DataError, ParameterError
from lostmotion.identify.recursive.estimator import RecursiveEstimator
from lostmotion.identify.recursive.recursive_estimate import Trajectory

CHUNKS = 4  # tasks of each worker: they end together although loops differ


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
        Threads; None: one for each core that this process may use. The compiled kernels run at the same time.

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
    workers = len(os.sched_getaffinity(0)) if workers is None else whole("workers", workers, 1)
    estimators = list(estimators)
    if not all(callable(getattr(one, "run", None)) for one in estimators):
        raise ParameterError.expected("estimators with run(u, y, every)", repr(estimators)[:60], "see lm.RecursiveIV")
    if len({id(one) for one in estimators}) < len(estimators):
        raise ParameterError.expected("different estimators", "one of them twice", "make one for each loop")
    inputs, outputs = _rows("u", u, len(estimators)), _rows("y", y, len(estimators))
    for loop, (row, other) in enumerate(zip(inputs, outputs, strict=True)):
        if row.size != other.size:
            raise DataError.expected(f"y[{loop}] with {row.size} samples", other.size, "cut both to the same length")

    def run_some(loops: IntArray) -> list[Trajectory]:
        return [estimators[loop].run(inputs[loop], outputs[loop], every) for loop in loops]

    parts = np.array_split(np.arange(len(estimators)), max(1, min(len(estimators), CHUNKS * workers)))
    with ThreadPoolExecutor(workers) as pool:
        return [trajectory for part in pool.map(run_some, parts) for trajectory in part]


def _rows(name: str, signals: npt.ArrayLike | Sequence[npt.ArrayLike], loops: int) -> list[FloatArray]:
    """One finite signal for each loop, or a DataError."""
    try:
        rows = list(signals)  # type: ignore[arg-type]
    except TypeError:
        raise DataError.expected(f"{name} of {loops} signals", repr(signals)[:60], "give one row for each") from None
    if len(rows) != loops:
        raise DataError.expected(f"{name} of {loops} signals", len(rows), "give one row for each estimator")
    return [finite_signal(f"{name}[{loop}]", row) for loop, row in enumerate(rows)]
