"""Triangle or sine? The shape of an oscillation tells a sticking valve from a linear cause."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.halves import cut_halves, sine, triangle

APEXES = np.linspace(0.05, 0.95, 37)  # where the triangle may have its tip; a saw tooth has it near an end


@dataclass(frozen=True)
class Shape:
    """Whether an oscillation is made of sines (index 0) or of triangles (index 1).

    Parameters
    ----------
    index : float
        Error of the sines over error of the sines plus that of the triangles; published limits: above 0.6 stiction,
        below 0.4 none.
    spread : float
        Standard error of the mean of the indices of the single half periods.
    halves : int
        Half periods used.
    """

    index: float
    spread: float
    halves: int


def shape_index(x: FloatArray, period: float) -> Shape:
    """Fit each half period of an oscillation by half a sine and by a triangle.

    Parameters
    ----------
    x : ndarray, shape (n,)
        OP of a loop with a self-regulating process, PV of one with an integrating process; finite, uniformly sampled.
    period : float
        Period of the oscillation in samples, at least 4 (8 and more are needed for 4 samples a half period).

    Raises
    ------
    DataError
        Fewer than two periods, a constant, or too few samples for each half period.

    Notes
    -----
    He, Wang, Pottmann and Qin (2007), "A curve fitting method for detecting valve stiction in oscillating control
    loops", Ind. Eng. Chem. Res. 46:8640. Controller and integrating process turn the square wave of a sticking valve
    into a triangle. Deviations: trend slower than the period and everything above its 7th harmonic are taken out
    first; errors are divided by the independent samples less the parameters adapted (sine 1, triangle 2), without
    which noise alone speaks for the triangle. A sine in much noise still comes to 0.57.

    Examples
    --------
    >>> t = np.arange(1000)
    >>> round(shape_index(np.sin(2 * np.pi * t / 50), 50).index, 2)
    0.0
    >>> round(shape_index(np.abs(t % 50 - 25), 50).index, 2)
    0.96
    """
    halves = cut_halves("x", x, period)
    of_sine = halves.misfit(sine(halves.place), 1)
    of_triangle = np.min([halves.misfit(triangle(halves.place, apex), 2) for apex in APEXES], axis=0)
    single = of_sine / (of_sine + of_triangle)
    index = float(halves.samples @ of_sine / (halves.samples @ (of_sine + of_triangle)))
    return Shape(index, float(single.std(ddof=1) / np.sqrt(single.size)), halves.count)
