"""A valve that follows its command no faster than a rate."""

from __future__ import annotations

from lostmotion.arrays import FloatArray
from lostmotion.kernels.numba_cache import njit


@njit(nogil=True)
def sensitivities(u: FloatArray, up: float, down: float, x: FloatArray, dx: FloatArray) -> None:
    """Fill the position `x` (n,) for the command u (n,), from rest at its first value, and its derivatives.

    `up` and `down`, both positive, are the largest moves in a sample; the rows of `dx` (2, n) belong to them.
    """
    x[0] = u[0]
    dx[0, 0] = dx[1, 0] = 0.0
    for k in range(1, u.size):
        move = u[k] - x[k - 1]
        if move > up:
            x[k] = x[k - 1] + up
            dx[0, k], dx[1, k] = dx[0, k - 1] + 1.0, dx[1, k - 1]
        elif move < -down:
            x[k] = x[k - 1] - down
            dx[0, k], dx[1, k] = dx[0, k - 1], dx[1, k - 1] - 1.0
        else:
            x[k] = u[k]
            dx[0, k] = dx[1, k] = 0.0
