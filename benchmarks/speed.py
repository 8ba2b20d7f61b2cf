"""Speed of ``identify`` against a plain ``scipy.optimize.least_squares`` output-error fit, same data, same run.

Run: ``.venv/bin/python benchmarks/speed.py`` (about 6 minutes, one thread); writes docs/speed.md. Processor time,
what is compared by turns.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent))  # for the plain Python loop in tests/naive
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"  # before NumPy is imported

import time  # noqa: E402
from collections.abc import Callable  # noqa: E402
from concurrent.futures import ProcessPoolExecutor  # noqa: E402
from multiprocessing import get_context  # noqa: E402

import numpy as np  # noqa: E402
from scipy.optimize import least_squares  # noqa: E402
from scipy.signal import lfilter  # noqa: E402

import lostmotion as lm  # noqa: E402
from lostmotion.evaluate import random_faulty_loop  # noqa: E402
from lostmotion.identify.likelihood import search  # noqa: E402
from pages import publish  # noqa: E402
from tests.naive.loop import closed_loop  # noqa: E402
from verdicts.second_family import CELLS, second_family  # noqa: E402

N = 20_000
REPEATS = 7
LOOKS = 3  # at every simulated loop
SAMPLES, SEEDS = 2000, 50_000  # loops of known fault: length, first seed
MEMORY_AT = 200_000  # samples
PLAIN = "plain `least_squares`, generic start"
ANALYSES = {
    "white": "`identify`, orders given, noise white",
    "auto": "`identify`, everything auto",
    "diagnose": "`diagnose`",
}
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


def median_times(works: dict[str, Callable[[], object]]) -> dict[str, float]:
    """Median seconds of processor time of each, by turns after a warm-up."""
    times: dict[str, list[float]] = {name: [] for name in works}
    for work in works.values():
        work()
    for _ in range(REPEATS):
        for name, work in works.items():
            begin = time.process_time()
            work()
            times[name].append(time.process_time() - begin)
    return {name: float(np.median(values)) for name, values in times.items()}


class Stopwatch:
    """Adds up the time inside ``refine`` for the dead zone."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self._inner = search.refine

    def __call__(self, problem: object, *arguments: object, **options: object) -> object:
        begin = time.process_time()
        result = self._inner(problem, *arguments, **options)
        if problem.family.kind == "dead zone":
            self.seconds += time.process_time() - begin
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

    times = median_times({"fast": fast, "slow": slow})
    return times["fast"], times["slow"]


def record(n: int) -> tuple[np.ndarray, np.ndarray]:
    u = lm.signals.prs(n, -5, 5, hold=10, seed=1)
    return u, TANK.simulate(u) + np.random.default_rng(1).normal(scale=0.03**0.5, size=n)


def diagnosed(n: int, loops: int) -> float:
    """Median seconds of ``diagnose`` over simulated loops of n samples; of 2,000 those of both families.

    Of each loop the least of LOOKS rounds: what else the machine does only adds to the time of a processor.
    """
    made = [random_faulty_loop(seed, n) for seed in range(SEEDS, SEEDS + loops)]
    if n == SAMPLES:
        made += [second_family(cell) for cell in range(0, CELLS, CELLS // loops)]
    times: dict[int, float] = {}
    for _ in range(LOOKS):
        for index, loop in enumerate(made):
            record_of = lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=loop.dt, op_span=(0.0, 100.0))
            begin = time.process_time()
            try:
                lm.diagnose(record_of)
            except lm.InputError:  # a constant, say: nothing is fitted
                continue
            times[index] = min(times.get(index, np.inf), time.process_time() - begin)
    return float(np.median(list(times.values())))


def run(what: str, n: int) -> Callable[[], object]:
    """One analysis of n samples, data made."""
    if what == "diagnose":
        loop = random_faulty_loop(SEEDS + 4, n)
        whole = lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=loop.dt, op_span=(0.0, 100.0))
        return lambda: lm.diagnose(whole)
    u, y = record(n)
    options = {"orders": (3, 2, 3), "noise": "white"} if what == "white" else {}
    return lambda: lm.identify(u, y, 0.1, **options, nonlinearity="dead zone")


def peak(what: str, n: int) -> int:
    """Largest resident memory, in bytes, that an analysis of n samples takes in this process."""
    run(what, 3000)()
    work = run(what, n)
    Path("/proc/self/clear_refs").write_text("5")  # the largest so far is what is there now
    before = resident("VmRSS")
    work()
    return resident("VmHWM") - before


def resident(name: str) -> int:
    """Resident memory of this process, in bytes, now or largest; `ru_maxrss` is inherited from who started it."""
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith(name + ":"))


def doubles_per_sample(what: str) -> float:
    """Peak memory at MEMORY_AT samples, in doubles per sample, in a fresh process."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        return pool.submit(peak, what, MEMORY_AT).result() / 8 / MEMORY_AT


def main() -> None:
    u, y = record(N)
    works: dict[str, Callable[[], object]] = {
        "whole `identify`, orders given, noise white": lambda: lm.identify(
            u, y, 0.1, orders=(3, 2, 3), noise="white", nonlinearity="dead zone"
        ),
        "whole `identify`, orders given": lambda: lm.identify(u, y, 0.1, orders=(3, 2, 3), nonlinearity="dead zone"),
        "whole `identify`, everything auto": lambda: lm.identify(u, y, 0.1, nonlinearity="dead zone"),
        PLAIN: lambda: plain_fit(u, y, GENERIC),
        "plain `least_squares`, started near the truth": lambda: plain_fit(u, y, NEAR),
    }
    white, given, *_ = works.values()
    times = {
        "inside the refinement of the dead zone, rough and final, noise white": refinement_time(white),
        "inside the refinement of the dead zone, rough and final, noise auto": refinement_time(given),
        **median_times(works),
    }
    lines = [f"| {name} | {1e3 * value:.0f} ms | {times[PLAIN] / value:.1f} |" for name, value in times.items()]
    found = {n: diagnosed(n, loops) for n, loops in ((SAMPLES, 10), (N, 4))}
    plain = times[PLAIN]
    diagnoses = [f"| `diagnose`, {n:,} samples | {value:.2f} s | {value / plain:.1f} |" for n, value in found.items()]
    memory = [f"| {name} | {doubles_per_sample(what):.0f} |" for what, name in ANALYSES.items()]
    fast, slow = loop_times()
    loop = f"{1e6 * fast:.0f} us against {1e3 * slow:.1f} ms, {slow / fast:.0f} times faster"
    parts = {"rows": lines, "diagnoses": diagnoses, "memory": memory}
    page = PAGE.format(loop=loop, looks=LOOKS, **{name: "\n".join(part) for name, part in parts.items()})
    print(page)
    publish(OUTPUT, page)


PAGE = """# Speed of `identify` and `diagnose`

Made by `.venv/bin/python benchmarks/speed.py`. Paper's plant, N = 20,000, one thread, median of 7 after a warm-up,
processor time, all by turns in one run. The times are of the machine of that run; the ratio is what carries over.

| what | time | times faster than the plain fit from a generic start |
|---|---|---|
{rows}

The plain fit knows the orders, that the noise is white and where to start; `identify` searches the break points
globally, fits the linear alternative, settles noise and offset, tests the residuals and needs no start.

Median over simulated loops of known fault (both families of `benchmarks/diagnosis.py`; of the longer ones the first),
of each the least of {looks} rounds, as what else a machine does adds to the time of a processor; single rounds have
differed by a third:

| what | processor time | times the plain fit from a generic start |
|---|---|---|
{diagnoses}

In the runs of this page in its first week the plain fit took 77 to 261 ms: seconds hang on the hour of the machine,
ratios hang on it less.

<!-- words by hand -->

Memory beyond the data at 200,000 samples, largest:

| what | doubles per sample |
|---|---|
{memory}

`simulate_loop`, 1,000 samples of the compensated tank: {loop} than the same loop in plain Python
(`tests/naive/loop.py`).
"""


if __name__ == "__main__":
    main()
