"""Speed of ``identify`` against a plain ``scipy.optimize.least_squares`` output-error fit, same data, same run.

Run: ``.venv/bin/python benchmarks/speed.py`` (about 1 minute, one thread); writes docs/speed.md.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent))  # for the plain Python loop in tests/naive
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"  # before NumPy is imported

import resource  # noqa: E402
import time  # noqa: E402
from collections.abc import Callable  # noqa: E402
from concurrent.futures import ProcessPoolExecutor  # noqa: E402
from multiprocessing import get_context  # noqa: E402

import numpy as np  # noqa: E402
from scipy.optimize import least_squares  # noqa: E402
from scipy.signal import lfilter  # noqa: E402

import lostmotion as lm  # noqa: E402
from lostmotion.identify.likelihood import search  # noqa: E402
from pages import publish  # noqa: E402
from tests.naive.loop import closed_loop  # noqa: E402

N = 20_000
REPEATS = 7
OUTPUT = Path(__file__).parent.parent / "docs" / "speed.md"
TANK = lm.platforms.level_tank()


def plain_residuals(theta: np.ndarray, u: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Output error of the same model as anyone would write it: filter and subtract."""
    a, b, (left, right, ratio, offset) = theta[:3], theta[3:6], theta[6:]
    x = np.maximum(u - right, 0.0) + ratio * np.minimum(u - left, 0.0)
    return y - offset - lfilter(np.concatenate([np.zeros(3), b]), np.concatenate([[1.0], a]), x)


TRUTH = np.concatenate([TANK.linear.a, 3.0 * np.array(TANK.linear.b), [-1.0, 1.0, 1.0, 0.0]])
NEAR = TRUTH * np.concatenate([np.full(3, 0.99), np.full(3, 1.3), [1.4, 1.4, 1.3, 0.0]])
GENERIC = np.array([-0.5, 0.0, 0.0, 1.0, 1.0, 1.0, -0.5, 1.5, 1.5, 0.0])


def plain_fit(u: np.ndarray, y: np.ndarray, start: np.ndarray) -> np.ndarray:
    return least_squares(plain_residuals, start, args=(u, y), x_scale="jac", max_nfev=200).x


def median_time(work: Callable[[], object]) -> float:
    """Median seconds after one warm-up."""
    work()
    times = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return float(np.median(times))


class Stopwatch:
    """Adds up the time inside ``refine`` for the dead zone."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self._inner = search.refine

    def __call__(self, problem: object, *arguments: object, **options: object) -> object:
        begin = time.perf_counter()
        result = self._inner(problem, *arguments, **options)
        if problem.family.kind == "dead zone":
            self.seconds += time.perf_counter() - begin
        return result


def refinement_time(identify: Callable[[], object]) -> float:
    """Median seconds inside the likelihood refinement of the dead zone, rough and final, of one ``identify``."""
    times = []
    original = search.refine
    for _ in range(REPEATS):
        watch = Stopwatch()
        search.refine = watch
        try:
            identify()
        finally:
            search.refine = original
        times.append(watch.seconds)
    return float(np.median(times))


def loop_times() -> tuple[float, float]:
    """Median seconds of 1,000 samples of the compensated loop: ``simulate_loop``, and plain Python."""
    reference = np.repeat([0.0, -1.0, 1.0], [600, 200, 200])
    noise = np.random.default_rng(0).normal(scale=0.03**0.5, size=1000)
    zone = TANK.nonlinearity
    block, controller = lm.DeadZoneCompensator(zone), lm.PI(0.5, 0.7)
    four = (zone.left, zone.right, zone.left_slope, zone.right_slope)
    a, b = np.array(TANK.linear.a), np.array(TANK.linear.b)

    def fast() -> object:
        return lm.simulate_loop(TANK, controller, reference, compensator=block, noise=noise)

    def slow() -> object:
        return closed_loop(
            a, b, 3, 0.0, four, (*four, 0.0), 0.5, 0.07, -np.inf, np.inf, 0.0, reference, np.zeros(1000), noise
        )

    return median_time(fast), median_time(slow)


def record(n: int) -> tuple[np.ndarray, np.ndarray]:
    u = lm.signals.prs(n, -5, 5, hold=10, seed=1)
    return u, TANK.simulate(u) + np.random.default_rng(1).normal(scale=0.03**0.5, size=n)


def peak(n: int) -> int:
    """Largest resident memory, in bytes, of a process that identifies n samples."""
    lm.identify(*record(2000), 0.1, orders=(3, 2, 3))
    u, y = record(n)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    lm.identify(u, y, 0.1, orders=(3, 2, 3))
    return 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)


def doubles_per_sample() -> float:
    """Growth of the peak memory from 200,000 to 600,000 samples, in doubles per sample, in fresh processes."""
    sizes = (200_000, 600_000)
    peaks = []
    for size in sizes:
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
            peaks.append(pool.submit(peak, size).result())
    return (peaks[1] - peaks[0]) / 8 / (sizes[1] - sizes[0])


def main() -> None:
    u, y = record(N)

    def whole() -> object:
        return lm.identify(u, y, 0.1, orders=(3, 2, 3))

    def white() -> object:
        return lm.identify(u, y, 0.1, orders=(3, 2, 3), noise="white")

    def auto() -> object:
        return lm.identify(u, y, 0.1)

    times = {
        "maximum-likelihood refinement, noise white": refinement_time(white),
        "maximum-likelihood refinement, noise auto": refinement_time(whole),
        "whole `identify`, orders given, noise white": median_time(white),
        "whole `identify`, orders given": median_time(whole),
        "whole `identify`, everything auto": median_time(auto),
        "plain `least_squares`, generic start": median_time(lambda: plain_fit(u, y, GENERIC)),
        "plain `least_squares`, started near the truth": median_time(lambda: plain_fit(u, y, NEAR)),
    }
    plain = times["plain `least_squares`, generic start"]
    lines = [f"| {name} | {1e3 * value:.0f} ms | {plain / value:.1f} |" for name, value in times.items()]
    memory = doubles_per_sample()
    fast, slow = loop_times()
    loop = f"{1e6 * fast:.0f} us against {1e3 * slow:.1f} ms, {slow / fast:.0f} times faster"
    print("loop:", loop)
    print("\n".join(lines), f"\nmemory: {memory:.0f} doubles per sample")
    publish(OUTPUT, PAGE.format(rows="\n".join(lines), memory=memory, loop=loop))


PAGE = """# Speed of `identify`

Made by `.venv/bin/python benchmarks/speed.py`. Paper's plant, N = 20,000, one thread, median of 7 after a warm-up,
all in one run. The times are of the machine of that run; the ratio is what carries over.

| what | time | times faster than the plain fit from a generic start |
|---|---|---|
{rows}

The plain fit knows the orders, that the noise is white and where to start; `identify` searches the break points
globally, fits the linear alternative, settles noise and offset, tests the residuals and needs no start.

`simulate_loop`, 1,000 samples of the compensated tank: {loop} than the same loop in plain Python
(`tests/naive/loop.py`).

Memory: the peak of `identify` grows by {memory:.0f} doubles per sample (from 200,000 to 600,000 samples).
"""


if __name__ == "__main__":
    main()
