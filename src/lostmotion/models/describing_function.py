"""Describing function of any actuator, by its answer to a sine."""

from __future__ import annotations

import numpy as np

from lostmotion.arguments import finite, positive, whole
from lostmotion.arrays import FloatArray
from lostmotion.models.hammerstein import Nonlinearity


def describing_function(
    actuator: Nonlinearity, amplitude: float, bias: float = 0.0, *, periods: int = 4, samples: int = 20_000
) -> complex:
    """Complex gain of the fundamental of ``actuator(bias + amplitude * sin(t))`` in the steady state.

    Parameters
    ----------
    actuator : Nonlinearity
        Any model of an actuator, with or without memory. It starts at rest at `bias`.
    amplitude : float
        Amplitude of the sine in units of u, positive.
    bias : float
        Mean of the sine in units of u.
    periods : int
        Periods that are simulated; the last one counts.
    samples : int
        Samples a period, at least 8. The error is of the order of 1/samples where x jumps, 1/samples^2 elsewhere.

    Returns
    -------
    complex
        ``(b + ia) / amplitude`` for the fundamental ``b sin(t) + a cos(t)``; a negative imaginary part is lag.

    Raises
    ------
    ParameterError
        An amplitude that is not positive, a bias that is not finite, or too few periods or samples.

    Notes
    -----
    The models with a closed form have it as a method ``describing_function(amplitude)``.

    Examples
    --------
    >>> from lostmotion.models import Backlash
    >>> gain = describing_function(Backlash(1.0), amplitude=2.0)
    >>> exact = Backlash(1.0).describing_function(2.0)
    >>> bool(abs(gain - exact) < 1e-6)
    True
    """
    size, mean = positive("amplitude", amplitude), finite("bias", bias)
    turns, count = whole("periods", periods, 1), whole("samples", samples, 8)
    angle = 2.0 * np.pi / count * np.arange(count)
    command: FloatArray = np.tile(mean + size * np.sin(angle), turns)
    last = np.asarray(actuator(command))[-count:]
    return complex(2.0 / count * (last @ (np.sin(angle) + 1j * np.cos(angle))) / size)
