"""Shared checks of what callers hand to models."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from lostmotion.errors import DataError, ParameterError

FloatArray = npt.NDArray[np.float64]


def finite(name: str, value: float) -> float:
    """`value` as a finite float, or a ParameterError that names it."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise ParameterError.expected(f"finite {name}", value, "give a number")
    return number


def positive(name: str, value: float) -> float:
    """`value` as a positive finite float, or a ParameterError that names it."""
    number = finite(name, value)
    if number <= 0:
        raise ParameterError.expected(f"{name} > 0", value, "slopes and times are positive by convention")
    return number


def coefficients(name: str, values: npt.ArrayLike) -> tuple[float, ...]:
    """One-dimensional coefficients as a tuple of finite floats."""
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != 1 or not np.isfinite(array).all():
        raise ParameterError.expected(f"{name} as finite numbers in one dimension", values, "see the docstring")
    return tuple(array.tolist())


def signal(name: str, values: npt.ArrayLike) -> FloatArray:
    """One-dimensional signal as a contiguous float array."""
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim != 1:
        raise DataError.expected(f"{name} of one dimension", f"shape {array.shape}", "pass one signal")
    return array


def elementwise(run: Callable[[FloatArray], FloatArray], values: npt.ArrayLike) -> float | FloatArray:
    """Apply a 1-D kernel to a scalar or to an array of any shape."""
    array = np.asarray(values, dtype=np.float64)
    result = run(np.ascontiguousarray(array.ravel()))
    return float(result[0]) if array.ndim == 0 else result.reshape(array.shape)
