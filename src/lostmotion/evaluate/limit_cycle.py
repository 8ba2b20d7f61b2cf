"""Limit cycles of a loop: predicted by the describing function, and measured in a signal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.models import LinearModel
from lostmotion.simulate import PI

ComplexArray = npt.NDArray[np.complex128]
FREQUENCIES = 600  # 1.7 % apart
DECADES = 4.5  # below the Nyquist frequency
LEAST_GAIN = 1e-6  # of an actuator: below it there is no loop
MARGIN = 0.5  # rad by which phases that may cross are taken wider
FEWEST_CROSSINGS = 4  # one and a half periods: a cycle has come back
PIECES = 4  # of the last third: what becomes smaller from each to the next dies out, an irregular swing does not
SUSTAINED = 0.8  # of the size of the first piece


@dataclass(frozen=True)
class LimitCycle:
    """Oscillation that neither grows nor dies out.

    Attributes
    ----------
    amplitude : float
        Of PV, half of peak to peak, in its units; 0: none.
    period : float
        Seconds; NaN where there is none.
    op_amplitude : float
        Of the controller output, in its units; 0: none.
    """

    amplitude: float = 0.0
    period: float = np.nan
    op_amplitude: float = 0.0

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return {**asdict(self), "period": self.period if np.isfinite(self.period) else None}


def predict_limit_cycles(
    gain: Callable[[float], complex], amplitudes: FloatArray, linear: LinearModel, controller: PI
) -> list[LimitCycle]:
    """Stable limit cycles by the describing function.

    Parameters
    ----------
    gain : callable (amplitude) -> complex
        Describing function of everything between controller output and process, amplitude in units of OP.
    amplitudes : ndarray
        Rising amplitudes of OP at which a cycle is sought.
    linear : LinearModel
    controller : PI
        Its limits are not looked at.

    Returns
    -------
    list of LimitCycle
        The stable ones, smallest first; none: no cycle between the first and the last amplitude.

    Notes
    -----
    Solves ``gain(A) L(jw) = -1`` with L of controller and sampled process as the crossing of two lines in the plane of
    log gain and phase. A cycle is stable where, along rising amplitude, ``-1 / gain`` leaves the side of the frequency
    response that it encloses (Gelb and Vander Velde 1968, chapter 3).
    """
    frequency = np.pi / linear.dt * np.logspace(-DECADES, -1e-3, FREQUENCIES)
    answer = loop_response(linear, controller, frequency)
    gains = np.array([gain(float(size)) for size in amplitudes])
    moving = np.abs(gains) > LEAST_GAIN
    if np.count_nonzero(moving) < 2:
        return []
    amplitudes, critical, first = amplitudes[moving], _smooth_log(-1.0 / gains[moving]), _smooth_log(answer)
    found = []
    for turn in 2.0j * np.pi * np.arange(-3, 3):
        other = critical + turn
        near = (first.imag > other.imag.min() - MARGIN) & (first.imag < other.imag.max() + MARGIN)
        if near.any():
            rows = slice(int(np.argmax(near)), near.size - int(np.argmax(near[::-1])))
            found += _crossings(first[rows], other, frequency[rows], amplitudes, controller, linear.dt)
    return sorted(found, key=lambda cycle: cycle.amplitude)


def _smooth_log(values: ComplexArray) -> ComplexArray:
    """Logarithm whose phase does not jump by a turn."""
    found = np.log(values)
    return np.asarray(found.real + 1j * np.unwrap(found.imag))


def loop_response(linear: LinearModel, controller: PI, frequency: FloatArray) -> ComplexArray:
    """PI and sampled process at frequencies in rad/s."""
    z = np.exp(1j * frequency * linear.dt)
    b, a = np.polyval(linear.b[::-1], 1.0 / z), np.polyval([*linear.a[::-1], 1.0], 1.0 / z)
    return np.asarray(_controller_response(controller, z, linear.dt) * b / a * z**-linear.delay)


def _controller_response(controller: PI, z: ComplexArray, dt: float) -> ComplexArray:
    return np.asarray(controller.kp + controller.ki * dt / (1.0 - 1.0 / z))


def _crossings(
    line: ComplexArray,
    other: ComplexArray,
    frequency: FloatArray,
    amplitudes: FloatArray,
    controller: PI,
    dt: float,
) -> list[LimitCycle]:
    """Stable crossings of the frequency response with the critical line."""
    p, r = line[:-1, None], np.diff(line)[:, None]
    q, s = other[None, :-1], np.diff(other)[None, :]
    area = _cross(r, s)
    with np.errstate(all="ignore"):
        along, across = _cross(q - p, s) / area, _cross(q - p, r) / area
        inside = (along >= 0) & (along < 1) & (across >= 0) & (across < 1) & (area > 0)
    cycles = []
    for i, j in np.argwhere(inside):
        w = float(np.interp(along[i, j], [0.0, 1.0], frequency[i : i + 2]))
        size = float(np.interp(across[i, j], [0.0, 1.0], amplitudes[j : j + 2]))
        answer = _controller_response(controller, np.exp(1j * np.array([w]) * dt), dt)
        cycles.append(LimitCycle(size / float(np.abs(answer[0])), 2.0 * np.pi / w, size))
    return cycles


def _cross(a: ComplexArray, b: ComplexArray) -> FloatArray:
    return np.asarray(a.real * b.imag - a.imag * b.real)


def _dies_out(signal: FloatArray, floor: float) -> bool:
    """Whether each piece of it is smaller than the one before; a beat between valve and block is not."""
    sizes = [0.5 * float(np.ptp(piece)) for piece in np.array_split(signal, PIECES)]
    smaller = all(after < before for before, after in pairwise(sizes))
    return sizes[-1] <= floor or (smaller and sizes[-1] < SUSTAINED * sizes[0])


def measure_limit_cycle(output: FloatArray, control: FloatArray, dt: float, floor: float) -> LimitCycle:
    """Limit cycle in the last third of noise-free signals.

    Parameters
    ----------
    output, control : ndarray, shape (n,)
        PV and OP of a loop at a constant set point.
    dt : float
        Sampling time in seconds.
    floor : float
        Amplitude of PV below which nothing counts.

    Examples
    --------
    >>> wave = np.sin(2 * np.pi * np.arange(900) / 30)
    >>> found = measure_limit_cycle(wave, 2 * wave, 0.5, 0.01)
    >>> round(found.amplitude, 2), round(found.period, 1), round(found.op_amplitude, 1)
    (0.99, 15.0, 2.0)
    """
    third = output.size // 3
    last = output[-third:]
    amplitude = 0.5 * float(np.ptp(last))
    if amplitude <= floor or _dies_out(last, floor):
        return LimitCycle()
    side = np.sign(last - 0.5 * (last.max() + last.min()))
    at = np.flatnonzero(np.diff(side[side != 0]) != 0)
    if at.size < FEWEST_CROSSINGS:
        return LimitCycle()
    period = 2.0 * dt * float(at[-1] - at[0]) / (at.size - 1)
    return LimitCycle(amplitude, period, 0.5 * float(np.ptp(control[-third:])))
