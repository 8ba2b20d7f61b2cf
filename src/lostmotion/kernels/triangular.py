"""Triangular form of a table of which only a stretch of rows exists at a time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from lostmotion.arrays import FloatArray

STRETCH = 4096  # rows


def triangular(rows: Callable[[int, int], FloatArray], spans: list[tuple[int, int]], columns: int) -> FloatArray:
    """R of a QR factorisation, at most (columns, columns); `rows(start, stop)` makes the rows of a stretch."""
    root: FloatArray = np.zeros((0, columns))
    for start, stop in spans:
        for first in range(start, stop, STRETCH):
            part = rows(first, min(first + STRETCH, stop))
            root = np.asarray(np.linalg.qr(np.concatenate([root, part]), mode="r"))
    return root
