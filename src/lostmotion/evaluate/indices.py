"""Indices of a control loop: the paper's eps1 and eps2, and what a valve goes through."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite_signal
from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError, ParameterError
from lostmotion.records.movement import reversals, travel
from lostmotion.simulate import LoopResponse

__all__ = ["control_variance", "loop_indices", "mean_absolute_error", "reversals", "travel"]


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


def _filled(name: str, values: npt.ArrayLike) -> FloatArray:
    """Finite signal with at least one sample."""
    array = finite_signal(name, values)
    if not array.size:
        raise DataError.expected(f"{name} with samples", "none", "give a longer track")
    return array
