"""Array types, defined once."""

from __future__ import annotations

from mmap import mmap
from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
ComplexArray = npt.NDArray[np.complex128]
Reals = npt.NDArray[np.floating[Any]]  # of one type throughout, float64 or float32

LARGE = 1 << 20  # bytes


def own_pages(shape: tuple[int, ...], dtype: npt.DTypeLike = np.float64) -> npt.NDArray[Any]:
    """Zeros of a shape, where large in memory pages of their own: these go back to the system as soon as it is gone.

    The allocator keeps most of the room of large arrays, for smaller ones that are between them.
    """
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    if size < LARGE:
        return np.zeros(shape, dtype)
    return np.frombuffer(mmap(-1, size), dtype).reshape(shape)
