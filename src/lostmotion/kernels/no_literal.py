"""A whole number without a type of its own."""

from __future__ import annotations

import numpy as np

from lostmotion.kernels.numba_cache import njit


@njit(nogil=True, forceinline=True)
def no_literal(value: int) -> int:
    """The same number: handed on as it is, a literal would compile its callee once more, for this value only."""
    return np.int64(value)  # type: ignore[return-value]
