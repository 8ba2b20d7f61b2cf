"""One valve in many records: error of the size, kind, coverage of the interval; printed.

python benchmarks/pooled.py --seeds 20 --records 10 --rows 2000
python benchmarks/pooled.py --seeds 44 --kinds "dead zone"    # 20 to 60 s a valve

The ratio of medians of 20 valves is one of few numbers: it moves by a third from one set of seeds to the next.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence

import numpy as np

import lostmotion as lm
from lostmotion.arrays import FloatArray
from lostmotion.models import Backlash, DeadZone, Hammerstein, Identity, LinearModel, Nonlinearity, Stiction

KINDS = ("dead zone", "backlash", "stiction", "none")
REST = 50.0  # OP at home, % of span
SETTLED = 400  # rows thrown away


def records_of(seed: int, kind: str, number: int, rows: int) -> tuple[list[lm.LoopRecord], float]:
    """Records of one valve, and its size: process gain, noise, load and set point differ from record to record."""
    rng = np.random.default_rng([seed, KINDS.index(kind), 61])
    size = float(np.exp(rng.uniform(np.log(1.5), np.log(8.0))))
    valve = valve_of(rng, kind, size)
    level = bool(rng.random() < 0.25)
    constant, delay = float(np.exp(rng.uniform(np.log(2.0), np.log(20.0)))), int(rng.integers(1, 5))
    closed = constant * rng.uniform(0.7, 2.0)
    quiet = size * float(np.exp(rng.uniform(np.log(0.02), np.log(0.3))))
    found = []
    for _ in range(number):
        gain = float(rng.uniform(0.8, 1.25))
        linear, controller = loop_of(level, gain, constant, delay, closed)
        n = rows + SETTLED
        noise = quiet * rng.uniform(0.5, 2.0) * rng.normal(size=n)
        load = linear.simulate(drift(rng, n, closed + delay, size))
        response = lm.simulate_loop(
            Hammerstein(valve, linear),
            controller,
            set_point(rng, n, size),
            disturbance=load,
            noise=noise,
            allow_unstable=True,
        )
        kept = slice(SETTLED, n)
        op, pv, sp = (REST + signal[kept] for signal in (response.control, response.measured, response.reference))
        found.append(lm.LoopRecord(op, pv, sp, dt=1.0, op_span=(0.0, 100.0)))
    return found, 0.0 if kind == "none" else size


def valve_of(rng: np.random.Generator, kind: str, size: float) -> Nonlinearity:
    """In deviations from home."""
    if kind == "dead zone":
        middle = rng.uniform(-0.3, 0.3) * size
        return DeadZone(middle - 0.5 * size, middle + 0.5 * size)
    if kind == "backlash":
        return Backlash(size)
    return Stiction(size, size * rng.uniform(0.2, 1.0)) if kind == "stiction" else Identity()


def loop_of(level: bool, gain: float, constant: float, delay: int, closed: float) -> tuple[LinearModel, lm.PI]:
    """Process with lambda tuning; the controller does not know that the gain differs."""
    reach = closed + delay
    if level:
        linear, kp = LinearModel((-1.0,), (gain / constant,), delay, 1.0), constant / reach
        return linear, lm.PI(kp, kp / (4.0 * reach), -REST, REST)
    pole = float(np.exp(-1.0 / constant))
    kp = constant / reach
    return LinearModel((-pole,), (gain * (1.0 - pole),), delay, 1.0), lm.PI(kp, kp / constant, -REST, REST)


def drift(rng: np.random.Generator, n: int, pace: float, size: float) -> FloatArray:
    """Slow load, little in most records."""
    pole = np.exp(-1.0 / (pace * rng.uniform(4.0, 20.0)))
    scale = size * np.exp(rng.uniform(np.log(0.02), np.log(0.8)))
    steps = rng.normal(scale=scale * np.sqrt(1.0 - pole**2), size=n)
    load = np.zeros(n)
    for k in range(1, n):
        load[k] = pole * load[k - 1] + steps[k]
    return load


def set_point(rng: np.random.Generator, n: int, size: float) -> FloatArray:
    """A few moves in half of the records."""
    reference = np.zeros(n)
    if rng.random() < 0.5:
        for k in np.sort(rng.integers(0, n, size=int(rng.integers(2, 9)))):
            reference[k:] = rng.normal(scale=1.5 * size)
    return reference


def cases(
    seeds: int, first: int, number: int, rows: int, kinds: Sequence[str] = KINDS
) -> Iterator[tuple[str, float, lm.PooledDiagnosis, list[float]]]:
    """Truth, pooled diagnosis, and relative errors of the records that name the kind alone."""
    for seed in range(first, first + seeds):
        for kind in kinds:
            records, size = records_of(seed, kind, number, rows)
            pooled = lm.diagnose(records)
            alone = pooled.diagnoses
            right = [one.size / size - 1.0 for one in alone if one.verdict == kind and np.isfinite(one.size) and size]
            named = sum(one.verdict == kind for one in alone)
            low, high = pooled.interval
            error = np.median(np.abs(right)) if right else np.nan
            print(
                f"{seed:3} {kind:10} {size:5.2f}: {pooled.verdict:12} {pooled.size:6.3f} ({low:6.3f} {high:6.3f}) "
                f"sure {pooled.confidence:.2f} {pooled.kind_confidence:.2f}  alone right {named} of {number}, "
                f"error {error:.4f} "
                f"open {max(pooled.excluded.values(), default=np.nan):.2f} carried {pooled.carried_by!r} "
                + " ".join(f"{name} {value:.1f}" for name, value in pooled.totals.items() if name != "none"),
                flush=True,
            )
            yield kind, size, pooled, right


def main() -> None:
    """Print a line for each valve, then the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    for name, value in (("seeds", 20), ("first", 0), ("records", 10), ("rows", 2000)):
        parser.add_argument(f"--{name}", type=int, default=value)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS, help="only valves of these")
    asked = parser.parse_args()
    found = list(cases(asked.seeds, asked.first, asked.records, asked.rows, asked.kinds))
    table(found, asked.kinds)


def table(found: Sequence[tuple[str, float, lm.PooledDiagnosis, list[float]]], kinds: Sequence[str]) -> None:
    """Kind, coverage and ratio of errors, kind by kind and of all kinds together."""
    ratios: dict[str, list[float]] = {}
    for kind in kinds:
        mine = [(size, pooled, right) for name, size, pooled, right in found if name == kind]
        named = [(size, pooled, right) for size, pooled, right in mine if pooled.verdict == kind]
        print(f"\n{kind}: {len(named)} of {len(mine)} right; verdicts {[pooled.verdict for _, pooled, _ in mine]}")
        if kind == "none" or not named:
            continue
        errors = np.array([pooled.size / size - 1.0 for size, pooled, _ in named])
        single = np.array([error for _, _, right in named for error in right])
        inside = np.mean([pooled.interval[0] <= size <= pooled.interval[1] for size, pooled, _ in named])
        print(f"  size within its interval {100 * inside:.0f} %")
        if single.size:
            told("root mean square", np.sqrt(np.mean(errors**2)), np.sqrt(np.mean(single**2)))
            told("median", np.median(np.abs(errors)), np.median(np.abs(single)))
        ratios[kind] = [
            abs(pooled.size / size - 1.0) / float(np.median(np.abs(right))) for size, pooled, right in named if right
        ]
        if ratios[kind]:
            print(f"  ratio of each valve, median of {len(ratios[kind])}: {np.median(ratios[kind]):.2f}")
    every = [ratio for one in ratios.values() for ratio in one]
    if every:
        print(f"\nratio of each valve, all kinds, median of {len(every)}: {np.median(every):.2f}")


def told(what: str, pooled: float, single: float) -> None:
    """One row of the table."""
    print(f"  {what} error: pooled {pooled:.4f}, single {single:.4f}, ratio {pooled / single:.2f}")


if __name__ == "__main__":
    main()
