"""Speed of ``identify`` against a plain ``scipy.optimize.least_squares`` output-error fit, same data, same run.

Run: ``.venv/bin/python benchmarks/speed.py`` (about 1 minute, one thread); writes docs/speed.md.
"""

from __future__ import annotations

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"  # before NumPy is imported

import time  # noqa: E402
import tracemalloc  # noqa: E402
from collections.abc import Callable  # noqa: E402
from pathlib import Path  # noqa: E402

import numpy as np  # noqa: E402
from scipy.optimize import least_squares  # noqa: E402
from scipy.signal import lfilter  # noqa: E402

import lostmotion as lm  # noqa: E402
from lostmotion.identify import search  # noqa: E402

N = 20_000
REPEATS = 7
OUTPUT = Path(__file__).parent.parent / "docs" / "speed.md"
TANK = lm.platforms.level_tank()


def plain_residuals(theta: np.ndarray, u: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Output error of the same model as anyone would write it: filter and subtract."""
    a, b, (left, right, ratio, offset) = theta[:3], theta[3:6], theta[6:]
    x = np.maximum(u - right, 0.0) + ratio * np.minimum(u - left, 0.0)
    return y - offset - lfilter(np.concatenate([np.zeros(3), b]), np.concatenate([[1.0], a]), x)


def plain_fit(u: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Started near the truth, which ours is not: from a far start it often ends elsewhere."""
    truth = np.concatenate([TANK.linear.a, 3.0 * np.array(TANK.linear.b), [-1.0, 1.0, 1.0, 0.0]])
    start = truth * np.concatenate([np.full(3, 0.99), np.full(3, 1.3), [1.4, 1.4, 1.3, 0.0]])
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
    """Adds up the time inside ``refine``."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self._inner = search.refine

    def __call__(self, *arguments: object, **options: object) -> object:
        begin = time.perf_counter()
        result = self._inner(*arguments, **options)
        self.seconds += time.perf_counter() - begin
        return result


def refinement_time(identify: Callable[[], object]) -> float:
    """Median seconds inside the likelihood refinement of one ``identify`` with a known noise model."""
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


def doubles_per_sample(identify: Callable[[], object]) -> float:
    """Peak of the memory that NumPy and Python take during ``identify``, in doubles per sample."""
    tracemalloc.start()
    identify()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak / 8 / N


def main() -> None:
    u = lm.signals.prs(N, -5, 5, hold=10, seed=1)
    y = TANK.simulate(u) + np.random.default_rng(1).normal(scale=0.03**0.5, size=N)

    def whole() -> object:
        return lm.identify(u, y, 0.1, orders=(3, 2, 3))

    def white() -> object:
        return lm.identify(u, y, 0.1, orders=(3, 2, 3), noise="white", offset="free")

    def auto() -> object:
        return lm.identify(u, y, 0.1)

    times = {"identify, orders given": median_time(whole), "identify, white noise given": median_time(white)}
    times["identify, everything auto"] = median_time(auto)
    refine = refinement_time(white) / 2  # linear model and dead zone are both refined: rough, then to the end
    plain = median_time(lambda: plain_fit(u, y))
    lines = [f"| maximum-likelihood refinement of the dead zone | {1e3 * refine:.0f} ms | {plain / refine:.0f} |"]
    lines += [f"| {name} | {1e3 * value:.0f} ms | {plain / value:.1f} |" for name, value in times.items()]
    lines.append(f"| plain `least_squares` output-error fit, started near the truth | {1e3 * plain:.0f} ms | 1 |")
    memory = doubles_per_sample(whole)
    print("\n".join(lines), f"\nmemory: {memory:.0f} doubles per sample")
    OUTPUT.write_text(PAGE.format(rows="\n".join(lines), memory=memory), encoding="utf-8")


PAGE = """# Speed of `identify`

Made by `.venv/bin/python benchmarks/speed.py`. Paper's plant, N = 20,000, one thread, median of 7 after a warm-up, all
in one run. The times are of the machine of that run; the ratio is what carries over.

| what | time | times faster than the plain fit |
|---|---|---|
{rows}

Peak memory of `identify`: {memory:.0f} doubles per sample beyond the data.
"""


if __name__ == "__main__":
    main()
