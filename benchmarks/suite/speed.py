"""Speed of the online estimators: ``run``, single ``update``, operations against time, many loops side by side."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit

from suite.experiment import Array, record
from suite.operations import operations

LONG = 1_000_000
SPARSE = 1000  # one parameter set in so many samples is kept
REPEATS = 7
SINGLE = 50_000
COUNTED = 640
LOOPS, LOOP_SAMPLES = 1000, 10_000
FEWER_LOOPS = 100  # where each begins with a batch fit


@dataclass(frozen=True)
class Speed:
    """Of one estimator: seconds a sample by ``run``, median seconds of one ``update``, operations a sample."""

    run: float
    update: float
    operations: float


@njit(cache=True, nogil=True)
def multiply_add(x: Array, y: Array, times: int) -> None:
    for _ in range(times):
        for i in range(x.size):
            y[i] += 1e-9 * x[i]


def peak_rate() -> float:
    """Operations a second of y += a x on 256 numbers: what compiled code reaches here without waiting for memory."""
    x, y, times = np.ones(256), np.ones(256), 200_000
    multiply_add(x, y, 10)
    return 2.0 * x.size * times / fastest(lambda: multiply_add(x, y, times))


def fastest(work: Callable[[], object]) -> float:
    """Least processor seconds of a few repeats: what the machine can do when nothing else asks for it."""
    times = []
    for _ in range(REPEATS):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return min(times)


def speed(make: Callable[[], Any]) -> Speed:
    """Measure one estimator on 10^6 samples of the experiment."""
    u, y = record(LONG, seed=1)
    warm = make()
    warm.run(u[:5000], y[:5000])
    count = operations(warm, u[5000 : 5000 + COUNTED], y[5000 : 5000 + COUNTED])
    seconds = fastest(lambda: make().run(u, y, every=SPARSE))
    return Speed(seconds / LONG, one_update(warm, u[5000:], y[5000:]), count)


def one_update(estimator: Any, u: Array, y: Array) -> float:
    """Median seconds of ``update(u, y)`` called from Python, the clock's own time taken off."""
    nothing = []
    for _ in range(1000):
        begin = time.perf_counter_ns()
        nothing.append(time.perf_counter_ns() - begin)
    taken = np.empty(SINGLE)
    for k, (command, output) in enumerate(zip(u[:SINGLE].tolist(), y[:SINGLE].tolist(), strict=True)):
        begin = time.perf_counter_ns()
        estimator.update(command, output)
        taken[k] = time.perf_counter_ns() - begin
    return 1e-9 * float(np.median(taken) - np.median(nothing))


def many(make: Callable[[], Any], run_many: Callable[..., Any], loops: int) -> dict[int, float]:
    """Least seconds of `loops` loops of 10,000 samples on one and on two workers, by turns."""
    records = [record(LOOP_SAMPLES, seed) for seed in range(loops)]
    u, y = (np.array(column) for column in zip(*records, strict=True))
    run_many([make(), make()], u[:2], y[:2], LOOP_SAMPLES, 2)
    seconds = {1: np.inf, 2: np.inf}
    for _ in range(REPEATS):
        for workers in (1, 2):
            estimators = [make() for _ in range(loops)]
            begin = time.perf_counter()
            run_many(estimators, u, y, LOOP_SAMPLES, workers)
            seconds[workers] = min(seconds[workers], time.perf_counter() - begin)
    return seconds


def two_threads() -> dict[int, float]:
    """Least seconds of the same sums one after the other and on two threads: what the machine itself can give."""
    x, times = np.ones(256), 10_000_000
    work = [(x, np.ones(256), times) for _ in range(2)]
    multiply_add(*work[0][:2], 10)
    seconds = {1: np.inf, 2: np.inf}
    for _ in range(REPEATS):
        for workers in (1, 2):
            with ThreadPoolExecutor(workers) as pool:
                begin = time.perf_counter()
                list(pool.map(lambda arguments: multiply_add(*arguments), work))
                seconds[workers] = min(seconds[workers], time.perf_counter() - begin)
    return seconds
