"""How wide is the figure that PV draws over OP? Apparent stiction, in units of OP."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.filters import checked_period, high_pass, low_pass, standard_signal, without_line
from lostmotion.errors import DataError

SLOWEST = 2.0  # periods kept in the figure
FASTEST = 3.5  # harmonics kept in the figure
STRAIGHT = 1e-9  # an ellipse thinner than this part of its length is a line
CONSTRAINT = np.array([[0.0, 0.0, 2.0], [0.0, -1.0, 0.0], [2.0, 0.0, 0.0]])  # 4 a c - b^2 of the conic


@dataclass(frozen=True)
class Ellipse:
    """Ellipse around which PV over OP runs.

    Parameters
    ----------
    width : float
        Chord through its centre along OP: the apparent stiction, in units of OP.
    share : float
        That of the whole extent of the ellipse along OP, 0 (a line) to 1 (upright): the sine of the phase between OP
        and PV.
    misfit : float
        Root mean square of (distance from the centre over that of the ellipse in the same direction) - 1. Around 0.1
        the figure is an ellipse, above 0.4 hardly.
    """

    width: float
    share: float
    misfit: float


def apparent_stiction(op: FloatArray, pv: FloatArray, period: float) -> Ellipse:
    """Fit an ellipse to PV over OP, both filtered around the oscillation.

    Parameters
    ----------
    op, pv : ndarray, shape (n,)
        Finite, uniformly sampled.
    period : float
        Period of the oscillation in samples, at least 4.

    Raises
    ------
    DataError
        Fewer than two periods, a constant signal, or no ellipse in the figure.

    Notes
    -----
    Choudhury, Shah, Thornhill and Shook (2006), "Automatic detection and quantification of stiction in control
    valves", Control Eng. Practice 14:1395. The width is their 2 m n / sqrt(m^2 sin^2 a + n^2 cos^2 a). It is apparent
    because process and controller widen and narrow it: a delay without any stiction has a width too. Read it only
    where the other indices speak for a valve. Deviation: the published filter keeps 0.05 cycles per sample on both
    sides of the frequency, which for slow oscillations is the whole spectrum or none of the oscillation; here half
    the frequency to 3.5 times the frequency is kept. Ellipse by Fitzgibbon, Pilu and Fisher (1999), "Direct least
    square fitting of ellipses", in the arrangement of Halir and Flusser (1998).

    Examples
    --------
    >>> t = 2 * np.pi * np.arange(1000) / 50
    >>> round(apparent_stiction(3 * np.sin(t), np.sin(t - np.pi / 6), 50).width, 1)  # 2 * 3 * sin(30 degrees)
    3.0
    """
    u, y = standard_signal("op", op, 16), standard_signal("pv", pv, 16)
    if u.size != y.size:
        raise DataError.expected(f"pv with {u.size} samples", y.size, "cut both signals to the same length")
    period = checked_period(period, u.size)
    unit = float(np.std(op / np.abs(op).max()) * np.abs(op).max())
    x, z = _around(u, period), _around(y, period)
    scale_x, scale_z = float(x.std()), float(z.std())
    if min(scale_x, scale_z) < 1e-12:
        raise DataError.expected("OP and PV that oscillate", f"nothing around {period:.4g} samples", "check the period")
    x, z = x / scale_x, z / scale_z
    if 1.0 - abs(float(x @ z)) / x.size < STRAIGHT:
        return Ellipse(0.0, 0.0, 0.0)
    a, b, c, d, e, f = fit_ellipse(x, z)
    at_x, at_z = np.linalg.solve([[2.0 * a, b], [b, 2.0 * c]], [-d, -e])
    level = -(f + 0.5 * (d * at_x + e * at_z))
    half_chord = math.sqrt(level / a)
    share = math.sqrt((4.0 * a * c - b * b) / (4.0 * a * c))
    dx, dz = x - at_x, z - at_z
    distance = np.sqrt((a * dx**2 + b * dx * dz + c * dz**2) / level)
    return Ellipse(2.0 * half_chord * scale_x * unit, share, float(np.sqrt(np.mean((distance - 1.0) ** 2))))


def fit_ellipse(x: FloatArray, y: FloatArray) -> tuple[float, float, float, float, float, float]:
    """Ellipse a x^2 + b x y + c y^2 + d x + e y + f = 0 of smallest algebraic distance to points, a > 0.

    Raises
    ------
    DataError
        The points lie on a line or too near to one point.

    Notes
    -----
    Worked out about the mean of the points: the distance and the constraint do not know where the origin is, but the
    squares of coordinates far from it leave few digits for the figure itself.
    """
    at_x, at_y = float(np.mean(x)), float(np.mean(y))
    a, b, c, d, e, f = _fit_around_origin(x - at_x, y - at_y)
    constant = f - d * at_x - e * at_y + a * at_x**2 + b * at_x * at_y + c * at_y**2
    return a, b, c, d - 2.0 * a * at_x - b * at_y, e - 2.0 * c * at_y - b * at_x, constant


def _fit_around_origin(x: FloatArray, y: FloatArray) -> tuple[float, float, float, float, float, float]:
    """Fit of Halir and Flusser to points around the origin."""
    quadratic = np.column_stack([x * x, x * y, y * y])
    linear = np.column_stack([x, y, np.ones(x.size)])
    try:
        inner = -np.linalg.solve(linear.T @ linear, linear.T @ quadratic)
        reduced = np.linalg.solve(CONSTRAINT, quadratic.T @ quadratic + quadratic.T @ linear @ inner)
        vectors = np.real(np.linalg.eig(reduced)[1])
    except np.linalg.LinAlgError:
        vectors = np.zeros((3, 3))
    kind = 4.0 * vectors[0] * vectors[2] - vectors[1] ** 2
    best = vectors[:, int(np.argmax(kind))]
    if kind.max() > 0.0:
        conic = np.concatenate([best, inner @ best]) * np.sign(best[0])
        a, b, c, d, e, f = conic.tolist()
        if a * e * e + c * d * d - b * d * e > f * (4.0 * a * c - b * b):  # it has real points
            return a, b, c, d, e, f
    raise DataError.expected("points around an ellipse", "none that fits", "check the period and that the loop swings")


def _around(x: FloatArray, period: float) -> FloatArray:
    """What lies around the oscillation."""
    return low_pass(high_pass(without_line(x), SLOWEST * period), period / FASTEST)
