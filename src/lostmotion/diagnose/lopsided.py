"""Is one half of a swing the other one upside down? So swings a valve that sticks, but not a saw tooth from outside."""

from __future__ import annotations

import numpy as np
import scipy.fft

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.filters import checked_period, high_pass, standard_signal, without_line
from lostmotion.diagnose.oscillation import BAND, SLOWEST, WINDOW

WIDEST = 0.5  # of the frequency: the bands of fundamental and second harmonic must not meet


def lopsided_index(x: FloatArray, period: float) -> float:
    """Amplitude of the second harmonic that keeps step with the fundamental, over that of the fundamental.

    Parameters
    ----------
    x : ndarray, shape (n,)
        OP or PV, finite, uniformly sampled.
    period : float
        Period of the oscillation in samples, at least 4; the record holds two.

    Returns
    -------
    float
        0 where the second half of each cycle is the first upside down (sine, square, even triangle), whatever noise
        and a wandering period add; 0.5 for a saw tooth, 0.25 for one behind an integrator.

    Raises
    ------
    DataError
        Fewer than two periods, or a constant.

    Notes
    -----
    With z1 and z2 the analytic signals near the frequency and near its double, z2 is regressed on z1^2 / |z1|, which
    has the amplitude of the fundamental and turns twice as fast: what is not locked to the fundamental averages out.

    Examples
    --------
    >>> t = np.arange(1000)
    >>> round(lopsided_index(np.abs(t % 50 - 25.0), 50), 2), round(lopsided_index(t % 50.0, 50), 2)
    (0.0, 0.5)
    """
    signal = without_line(standard_signal("x", x, 16))
    period = checked_period(period, signal.size)
    spectrum = scipy.fft.fft(high_pass(signal, SLOWEST * period))
    order = np.arange(signal.size) * (period / signal.size)
    order[signal.size // 2 :] = np.inf  # the other half of the spectrum makes the signal real
    band = min(max(BAND, WINDOW / signal.size * period), WIDEST)
    inner = slice(int(period / 2.0), signal.size - int(period / 2.0))  # both ends ring
    first = scipy.fft.ifft(np.where(np.abs(order - 1.0) <= band, spectrum, 0.0))[inner]
    second = scipy.fft.ifft(np.where(np.abs(order - 2.0) <= min(2.0 * band, WIDEST), spectrum, 0.0))[inner]
    size = np.maximum(np.abs(first), 1e-300)
    return float(abs(np.vdot(first**2 / size, second)) / max(float(size @ size), 1e-300))
