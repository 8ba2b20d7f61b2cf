"""What depends on the data alone is found once: a search asks for it again and again."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar
from weakref import finalize

Found = TypeVar("Found")


def remembered(work: Callable[..., Found]) -> Callable[..., Found]:
    """The same function of data and plain values; what it finds is kept while the data are there."""
    kept: dict[tuple[Any, ...], Found] = {}

    @wraps(work)
    def remembering(data: Any, *arguments: Any) -> Found:
        key = (id(data), *arguments)
        if key not in kept:
            kept[key] = work(data, *arguments)
            finalize(data, kept.pop, key, None).atexit = False
        return kept[key]

    return remembering


def remembered_of_signals(work: Callable[..., Found]) -> Callable[..., Found]:
    """The same of data that are made anew from the same arrays u, y and segments."""
    kept: dict[tuple[Any, ...], Found] = {}

    @wraps(work)
    def remembering(data: Any, *arguments: Any) -> Found:
        arrays = data.u, data.y, data.segments
        key = (*map(id, arrays), *arguments)
        if key not in kept:
            kept[key] = work(data, *arguments)
            for array in arrays:  # an id without its array may be that of another one
                finalize(array, kept.pop, key, None).atexit = False
        return kept[key]

    return remembering
