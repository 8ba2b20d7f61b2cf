"""Loops in batches: as many as fill the overhead of a batch, together what lies in one file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from typing import TypeVar

from lostmotion.plant import PlantLoop

FEWEST, MOST = 16, 64  # loops of a batch; Dask costs 11 to 21 ms a batch, screening a loop some ms
BYTES = 64e6  # to be read in a batch: about a second, and what a worker holds at most once it has FEWEST
UNKNOWN = 1e6  # bytes of a loop of which nothing is known
Item = TypeVar("Item")


def file_of(loop: PlantLoop) -> str:
    """What is opened for a loop: its address without the name inside a file."""
    return loop.where.partition("#")[0] or loop.tag


def batches(loops: Iterable[PlantLoop], workers: int = 1) -> Iterator[tuple[PlantLoop, ...]]:
    """Batches of 16 to 64 loops, by bytes; loops of a file come one after another.

    Parameters
    ----------
    loops : iterable of PlantLoop
    workers : int
        Where there are few loops batches are smaller, so that each worker has some.

    Examples
    --------
    >>> [len(one) for one in batches([PlantLoop(f"L{number}", size=1) for number in range(200)])]
    [50, 50, 50, 50]
    """
    ordered = together(loops)
    most = fair(len(ordered), workers, MOST)
    few = min(FEWEST, most)
    batch: list[PlantLoop] = []
    held = 0.0
    for loop in ordered:
        full = len(batch) >= most or (len(batch) >= few and held + (loop.size or UNKNOWN) > BYTES)
        if full:
            yield tuple(batch)
            batch, held = [], 0.0
        batch.append(loop)
        held += loop.size or UNKNOWN
    if batch:
        yield tuple(batch)


def fair(items: int, workers: int, most: int) -> int:
    """Size of a batch with which each worker has four of them, so that none waits long for the last one."""
    return max(min(most, items // (4 * workers)), 1)


def together(loops: Iterable[PlantLoop]) -> list[PlantLoop]:
    """Loops of a file one after another, files in the order in which they come first."""
    files: dict[str, list[PlantLoop]] = {}
    for loop in loops:
        files.setdefault(file_of(loop), []).append(loop)
    return [loop for of_file in files.values() for loop in of_file]


def cut(items: Sequence[Item], size: int) -> list[Sequence[Item]]:
    """Pieces of a size, the last one shorter."""
    return [items[first : first + size] for first in range(0, len(items), size)]


def by_loop(pairs: Iterable[tuple[PlantLoop, Item]]) -> list[tuple[PlantLoop, tuple[Item, ...]]]:
    """What belongs to one loop together, and loops of a file one after another: each is read once."""
    ordered = sorted(pairs, key=lambda pair: (file_of(pair[0]), pair[0].tag))
    return [_gathered(list(group)) for _, group in groupby(ordered, lambda pair: pair[0].tag)]


def _gathered(pairs: Sequence[tuple[PlantLoop, Item]]) -> tuple[PlantLoop, tuple[Item, ...]]:
    return pairs[0][0], tuple(item for _, item in pairs)
