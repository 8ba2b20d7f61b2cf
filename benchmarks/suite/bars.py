"""RecursiveML against its bars: RMSE over the bound, coverage and convergence at 5,000, 20,000 and 200,000 samples."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from suite.experiment import CONVERGED, NAMES, TRUTH, Array, bound, record, routine

LENGTHS = (5000, 20_000, 200_000)
BOUND_SEEDS = 20  # over which the bound is averaged: it differs by a few % from one command to another


@dataclass(frozen=True)
class Bar:
    """One length: RMSE, bounds with the offset known to be zero and free, coverage of 95 % intervals, convergence."""

    samples: int
    seeds: int
    converged: int
    rmse: Array
    zero: Array
    free: Array
    coverage: Array


def measure(make: Callable[[], Any], samples: int, seeds: int) -> Bar:
    """Run all seeds of one length."""
    zone, reach = np.empty((seeds, 3)), np.empty((seeds, 3))
    commands = []
    for seed in range(seeds):
        u, y = record(samples, seed)
        estimator = make()
        estimator.run(u, y, every=samples)
        estimate = estimator.estimate
        zone[seed] = [estimate.parameters[name] for name in NAMES]
        reach[seed] = [np.diff(estimate.interval(name))[0] / 2 for name in NAMES]
        if seed < BOUND_SEEDS:
            commands.append(u)
    miss = zone - TRUTH
    good = np.all(np.abs(miss) < CONVERGED, axis=1)
    return Bar(
        samples,
        seeds,
        int(good.sum()),
        np.sqrt(np.mean(miss[good] ** 2, axis=0)),
        bound(commands, "zero"),
        bound(commands, "free"),
        np.mean(np.abs(miss) <= reach, axis=0),
    )


def false_events(make: Callable[[], Any], records: int) -> str:
    """Events in routine operation, where nothing changes: how many, in how many records."""
    found = []
    for seed in range(records):
        estimator = make()
        u, y = routine(seed)
        estimator.run(u, y, every=u.size)
        found.append(len(estimator.events))
    return f"{sum(found)} in {np.count_nonzero(found)} of {records} records"
