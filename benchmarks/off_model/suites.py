"""What a suite is: jobs, the work of one, and a report of all rows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import gcd
from typing import Any

GOLDEN = 0.618  # of the cells: steps of this length leave the least gaps


@dataclass(frozen=True)
class Job:
    """One record of a suite: `cell` counts its design, `rate` the ways in which the same record is thinned."""

    suite: str
    cell: int
    seed: int = 0
    rate: int = 1


@dataclass(frozen=True)
class Suite:
    """Jobs for seeds, the work of one (in a worker process), and the report of all rows."""

    name: str
    jobs: Callable[[Sequence[int]], list[list[Job]]]  # those of one record together
    work: Callable[[Job], Any]
    report: Callable[[list[Any]], list[str]]
    folder: str = ""  # of real records, in ../shared/actuators


def drawn_jobs(suite: str, cells: int, rates: Sequence[int], seeds: Sequence[int]) -> list[list[Job]]:
    """All cells for each seed, in an order in which the first few are of all sorts."""
    stride = int(GOLDEN * cells)
    while gcd(stride, cells) > 1:
        stride -= 1
    order = [stride * at % cells for at in range(cells)]
    return [[Job(suite, cell, seed, rate) for rate in rates] for seed in seeds for cell in order]
