"""Shared checks of what callers hand in: a value of the right kind, or an error that names it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError, ParameterError

LARGEST = 1e100  # of a number that is handed in: its square, and that of its reciprocal, are numbers
SHORTEST, LONGEST = 1e-12, 1e12  # s, of a sampling time or a scan


def finite(name: str, value: float) -> float:
    """`value` as a finite float, or a ParameterError that names it."""
    try:
        number = math.nan if isinstance(value, str) else float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise ParameterError.expected(f"finite {name}", value, "give a number")
    if abs(number) > LARGEST:
        raise ParameterError.expected(f"{name} within +-{LARGEST:g}", value, "give a number that a plant can have")
    return number


def seconds(name: str, value: float) -> float:
    """`value` as a sampling time, or a ParameterError that names it."""
    number = float(value)
    if not (math.isfinite(number) and number > 0):
        raise ParameterError.expected(f"{name} > 0", value, "give the sampling time in seconds")
    if not SHORTEST <= number <= LONGEST:
        raise ParameterError.expected(f"{name} from {SHORTEST:g} to {LONGEST:g} s", value, "give it in seconds")
    return number


def positive(name: str, value: float) -> float:
    """`value` as a positive finite float, or a ParameterError that names it."""
    number = finite(name, value)
    if number <= 0:
        raise ParameterError.expected(f"{name} > 0", value, "slopes and times are positive by convention")
    if number < 1.0 / LARGEST:
        raise ParameterError.expected(f"{name} from {1.0 / LARGEST:g} on", value, "give a number that a plant can have")
    return number


def not_negative(name: str, value: float) -> float:
    """`value` as a finite float >= 0, or a ParameterError that names it."""
    number = finite(name, value)
    if number < 0:
        raise ParameterError.expected(f"{name} >= 0", value, "widths and jumps have no sign")
    return number


def whole(name: str, value: object, least: int) -> int:
    """`value` as an int of at least `least`, or a ParameterError that names it."""
    try:
        number = int(value)  # type: ignore[call-overload]
        exact = number == value
    except (TypeError, ValueError, OverflowError):
        number, exact = least, False
    if not exact or number < least:
        raise ParameterError.expected(f"{name} as a whole number >= {least}", repr(value), "give samples")
    return int(number)


def coefficients(name: str, values: npt.ArrayLike) -> tuple[float, ...]:
    """One-dimensional coefficients as a tuple of finite floats."""
    try:
        array = np.asarray(values, dtype=np.float64)
        good = array.ndim == 1 and bool((np.abs(array) <= LARGEST).all())
    except (TypeError, ValueError):
        good = False
    if not good:
        raise ParameterError.expected(f"{name} as finite numbers in one dimension", values, "give a list of numbers")
    return tuple(float(value) for value in array)


def numbers(name: str, values: npt.ArrayLike) -> FloatArray:
    """Real numbers of any shape as a float array of the caller's own; masked entries become NaN."""
    if type(values) is np.ndarray and values.dtype == np.float64:
        return values.copy()
    try:
        if isinstance(values, np.ma.MaskedArray):
            values = np.where(np.ma.getmaskarray(values), np.nan, np.ma.getdata(values))
        array = np.array(values)
        real = not np.iscomplexobj(array)
        array = array.astype(np.float64) if real else array
    except (TypeError, ValueError):
        real = False
    if not real:
        raise DataError.expected(f"{name} as real numbers", repr(values)[:60], "convert it to floats")
    return array


def signal(name: str, values: npt.ArrayLike) -> FloatArray:
    """One-dimensional signal as a contiguous float array of its own."""
    array = numbers(name, values)
    if array.ndim != 1:
        raise DataError.expected(f"{name} of one dimension", f"shape {array.shape}", "pass one signal")
    return array


def finite_signal(name: str, values: npt.ArrayLike, n: int | None = None) -> FloatArray:
    """Signal without NaN or infinity, of length n where one is given."""
    array = signal(name, values)
    if n is not None and array.size != n:
        raise DataError.expected(f"{name} with {n} samples", array.size, "cut all signals to the same length")
    finite_rows = np.isfinite(array)
    if not finite_rows.all():
        row = int(np.argmin(finite_rows))
        raise DataError.expected(f"finite {name}", f"{array[row]} in row {row}", "mend the signal")
    return array


def elementwise(run: Callable[[FloatArray], FloatArray], values: npt.ArrayLike) -> float | FloatArray:
    """Apply a 1-D kernel to a scalar or to an array of any shape."""
    array = numbers("input", values)
    result = run(np.ascontiguousarray(array.ravel()))
    return float(result[0]) if array.ndim == 0 else result.reshape(array.shape)


def along_time(run: Callable[[FloatArray], FloatArray], values: npt.ArrayLike) -> float | FloatArray:
    """Apply a 1-D kernel with memory to a scalar or to a signal, shape (n,)."""
    array = numbers("input", values)
    if array.ndim > 1:
        raise ParameterError.expected(
            "a number or a signal of shape (n,)", f"shape {array.shape}", "the memory runs along time: pass one signal"
        )
    result = run(np.ascontiguousarray(array.ravel()))
    return float(result[0]) if array.ndim == 0 else result
