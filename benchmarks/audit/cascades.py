"""Are masters of cascades told from the data? Made plants of 50 loops, a day each.

Run: ``.venv/bin/python benchmarks/audit/cascades.py`` (a minute on one thread; ``--seeds 1 2 3``); prints how many
masters the plants have, how many are found with the right slave, and how many loops are called masters and are none.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import argparse  # noqa: E402

from lostmotion.evaluate.plants import random_plant  # noqa: E402
from lostmotion.plant.cascades import Cascades  # noqa: E402

LOOPS, DAYS = 50, 1.0


def told(seed: int) -> tuple[int, int, int]:
    """Of one plant: masters, those found with the right slave, and others that are called masters."""
    made = random_plant(seed, LOOPS, DAYS, 0)
    seen = Cascades()
    tags = [one.tag for one in made.plant_loops()]
    for tag, record in zip(tags, made.records(), strict=True):
        seen.add(tag, record)
    truth = {(tags[slave.master], tag) for tag, slave in zip(tags, made.loops, strict=True) if slave.master >= 0}
    found = set(seen.slaves().items())
    return len(truth), len(truth & found), len(found - truth)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, nargs="+", default=list(range(1, 21)))
    results = []
    for seed in parser.parse_args().seeds:
        results.append(told(seed))
        print(seed, *results[-1], flush=True)
    masters, right, wrong = (sum(one) for one in zip(*results, strict=True))
    print(f"{masters} masters, {right} of them found with their slave, {wrong} others called masters")


if __name__ == "__main__":
    main()
