"""Indices of a control loop: the paper's eps1 and eps2, and what a valve goes through."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lostmotion import _verbs
from lostmotion.errors import DataError, ParameterError
from lostmotion.models._arguments import FloatArray, finite, finite_signal
from lostmotion.simulate import LoopResponse


def loop_indices(response: LoopResponse, start: float = 0.0, stop: float | None = None) -> dict[str, float]:
    """Indices of one track of a simulated loop; eps2 of the measured output, as in the paper.

    Raises
    ------
    ParameterError
        The track holds no sample.
    """
    inside = (response.time >= start - 1e-9) & (response.time < (np.inf if stop is None else stop - 1e-9))
    if not inside.any():
        raise ParameterError.expected("a track inside the response", f"{start} .. {stop} s", "give seconds")
    command = response.command[inside]
    return {
        "eps1": control_variance(command),
        "eps2": mean_absolute_error(response.reference[inside], response.measured[inside]),
        "travel": travel(command),
        "reversals": float(reversals(command)),
    }


_verbs.indices.register(LoopResponse, loop_indices)


def control_variance(u: npt.ArrayLike) -> float:
    """Variance of the control signal, ``mean((u - mean u)^2)`` (paper, eq 32), in units of u squared.

    Examples
    --------
    >>> control_variance([0.0, 2.0, 0.0, 2.0])
    1.0
    """
    return float(np.var(_filled("u", u)))


def mean_absolute_error(reference: npt.ArrayLike, y: npt.ArrayLike) -> float:
    """Integral absolute error per sample, ``mean(|r - y|)`` (paper, eq 33), in units of y.

    Examples
    --------
    >>> mean_absolute_error([1.0, 1.0], [0.5, 2.0])
    0.75
    """
    r = _filled("reference", reference)
    return float(np.mean(np.abs(r - finite_signal("y", y, r.size))))


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
    values = _filled("command", command).tolist()
    low = high = extreme = values[0]
    direction, count = 0, 0
    for value in values:
        if direction == 0:  # not yet known: watch both extremes
            low, high = min(low, value), max(high, value)
            if high > low and high - low >= band:
                direction, extreme = (1 if value == high else -1), value
        elif direction * (value - extreme) >= 0:
            extreme = value
        elif abs(value - extreme) >= band:
            count, direction, extreme = count + 1, -direction, value
    return count


def _filled(name: str, values: npt.ArrayLike) -> FloatArray:
    """Finite signal with at least one sample."""
    array = finite_signal(name, values)
    if not array.size:
        raise DataError.expected(f"{name} with samples", "none", "give a longer track")
    return array
