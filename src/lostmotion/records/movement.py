"""What a valve goes through: travel and reversals per hour, time at its limits."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite, finite_signal, positive
from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError, ParameterError
from lostmotion.records.span import PERCENT

TOLERANCE = 0.001  # of the span


def travel(command: npt.ArrayLike) -> float:
    """Sum of all moves of the command, in its units.

    Examples
    --------
    >>> travel([0.0, 1.0, -1.0])
    3.0
    """
    return float(np.sum(np.abs(np.diff(finite_signal("command", command)))))


def reversals(command: npt.ArrayLike, band: float = 0.0) -> int:
    """How often the command turned round by at least `band` (and more than nothing).

    Raises
    ------
    ParameterError
        A negative band.

    Examples
    --------
    >>> reversals([0.0, 1.0, 1.0, 0.0, 0.1, 0.0, 1.0], band=0.5)
    2
    """
    if not finite("band", band) >= 0:
        raise ParameterError.expected("band >= 0", band, "give the noise band in units of the command")
    values = _filled(command)
    low = high = extreme = float(values[0])
    direction, count = 0, 0
    for value in map(float, values):  # a list of them would be large
        if direction == 0:  # not yet known: watch both extremes
            low, high = min(low, value), max(high, value)
            if high > low and high - low >= band:
                direction, extreme = (1 if value == high else -1), value
        elif direction * (value - extreme) >= 0:
            extreme = value
        elif abs(value - extreme) >= band:
            count, direction, extreme = count + 1, -direction, value
    return count


def travel_per_hour(op: npt.ArrayLike, dt: float, span: tuple[float, float] = PERCENT) -> float:
    """Sum of all moves of OP in percent of its span per hour.

    Parameters
    ----------
    op : array_like, shape (n,)
        Command.
    dt : float
        Sampling time in seconds.
    span : (float, float)
        Smallest and largest OP, in its units.

    Raises
    ------
    ParameterError
        dt <= 0, or a span the wrong way round.
    DataError
        Fewer than two samples.

    Examples
    --------
    >>> travel_per_hour([0.0, 1.0, 0.0, 1.0, 0.0], dt=900.0)
    4.0
    """
    low, high = _span(span)
    return 100.0 * travel(op) / (high - low) / _hours(op, dt)


def reversals_per_hour(op: npt.ArrayLike, dt: float, band: float = 0.0) -> float:
    """How often OP turned round by at least `band` per hour.

    Parameters
    ----------
    op : array_like, shape (n,)
        Command.
    dt : float
        Sampling time in seconds.
    band : float
        Noise band in units of OP: smaller swings do not count.

    Raises
    ------
    ParameterError
        dt <= 0, or a negative band.
    DataError
        Fewer than two samples.

    Examples
    --------
    >>> reversals_per_hour([0.0, 1.0, 0.0, 1.0, 0.0], dt=900.0)
    3.0
    """
    return reversals(op, band) / _hours(op, dt)


def share_at_limits(op: npt.ArrayLike, limits: tuple[float, float] = PERCENT, tolerance: float = TOLERANCE) -> float:
    """Share of samples at or beyond a limit of OP.

    Parameters
    ----------
    op : array_like, shape (n,)
        Command.
    limits : (float, float)
        Smallest and largest OP, in its units.
    tolerance : float
        What counts as at the limit, as a share of the span.

    Raises
    ------
    ParameterError
        Limits the wrong way round, a negative tolerance.
    DataError
        No samples.

    Examples
    --------
    >>> share_at_limits([0.0, 50.0, 100.0, 99.95])
    0.75
    """
    low, high = _span(limits)
    if not finite("tolerance", tolerance) >= 0.0:
        raise ParameterError.expected("tolerance >= 0", tolerance, "give a share of the span")
    values = finite_signal("op", op)
    if not values.size:
        raise DataError.expected("op with samples", "none", "give a longer record")
    near = tolerance * (high - low)
    return float(np.mean((values <= low + near) | (values >= high - near)))


def _span(span: tuple[float, float]) -> tuple[float, float]:
    """Checked span."""
    low, high = finite("span", span[0]), finite("span", span[1])
    if not low < high:
        raise ParameterError.expected("a span (low, high)", span, "turn it round")
    return low, high


def _hours(op: npt.ArrayLike, dt: float) -> float:
    """Length of the record in hours."""
    step = positive("dt", dt)
    n = finite_signal("op", op).size
    if n < 2:
        raise DataError.expected("op with 2 samples", n, "give a longer record")
    return (n - 1) * step / 3600.0


def _filled(command: npt.ArrayLike) -> FloatArray:
    """Finite signal with at least one sample."""
    array = finite_signal("command", command)
    if not array.size:
        raise DataError.expected("command with samples", "none", "give a longer track")
    return array
