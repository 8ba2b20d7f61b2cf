"""Iterative key-term separation in batch (Voros, 1997), of which the paper's recursion is the child."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite, finite_signal, positive, whole
from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError
from lostmotion.kernels import dead_zone as zone_kernel
from lostmotion.kernels.threads import one_thread
from lostmotion.models import DeadZone, Hammerstein, LinearModel

SETTLED = 1e-9  # relative move of the dead zone at which the iteration ends


@dataclass(frozen=True, eq=False)
class VorosFit:
    """Result of :func:`voros`.

    Attributes
    ----------
    model : Hammerstein
    parameters : dict of float
        left, right, left_slope, right_slope, a1 .., b0 ...
    iterations : int
    converged : bool
    """

    model: Hammerstein
    parameters: dict[str, float]
    iterations: int
    converged: bool


@one_thread
def voros(
    u: npt.ArrayLike,
    y: npt.ArrayLike,
    orders: tuple[int, int, int],
    gain: float,
    dt: float = 1.0,
    most_iterations: int = 500,
    relaxation: float = 0.2,
) -> VorosFit:
    """Dead zone and linear part by iterated least squares with key-term separation.

    Each iteration rebuilds the internal variable and the switching functions from the estimate before and solves
    the linear regression of eq 22 over the whole record. Under output noise it inherits the bias of least squares.

    Parameters
    ----------
    u, y : array_like, shape (n,)
        Command and output in deviations (dead zone around u = 0).
    orders : (na, nb, delay)
    gain : float
        Known static gain (eq 25).
    dt : float
        Sampling time in seconds.
    most_iterations : int
        Give up after so many.
    relaxation : float
        Share of the way that the dead zone moves towards its new estimate, in (0, 1]. 1 is the method as published;
        from an unknown dead zone it overshoots, b0 turns negative and the iteration is caught there.

    Raises
    ------
    DataError
        Signals of different length or too short.

    References
    ----------
    Voros, J., "Parameter identification of discontinuous Hammerstein systems", Automatica 33, 1997, 1141-1146.

    Examples
    --------
    >>> import lostmotion as lm
    >>> tank = lm.platforms.level_tank()
    >>> u = lm.signals.prs(2000, -5, 5, hold=10, seed=0)
    >>> fit = voros(u, tank.simulate(u), (3, 2, 3), gain=tank.linear.gain)
    >>> round(fit.parameters["right"], 6)
    1.0
    """
    na, nb, delay = (whole(name, value, 0) for name, value in zip(("na", "nb", "delay"), orders, strict=True))
    u = finite_signal("u", u)
    y = finite_signal("y", y, u.size)
    gain, dt = finite("gain", gain), positive("dt", dt)
    head = max(na, delay + nb)
    if u.size < head + 3 * (na + nb + 4):
        raise DataError.expected(f"at least {head + 3 * (na + nb + 4)} samples", u.size, "use a longer record")
    rows = np.empty((na + 4 + nb, y.size - head))
    for i in range(na):
        rows[i] = -y[head - i - 1 : y.size - i - 1]
    zone = np.array([0.0, 0.0, 1.0, 1.0])
    theta = np.zeros(na + nb + 4)
    converged, iteration = False, 0
    while iteration < most_iterations and not converged:
        iteration += 1
        x = zone_kernel.forward_run(u, *zone)
        theta = _regress(rows, y[head:], u, x, zone, (head, nb, delay))
        target = zone.copy()
        trusted = _separate(theta, na, nb, gain, target, (float(u.min()), float(u.max())))
        move = relaxation * (target - zone)
        zone = zone + move
        converged = trusted and float(np.abs(move).max()) <= SETTLED * float(np.abs(zone).max())
    return _package(theta, zone, (na, nb, delay), dt, iteration, converged)


def _regress(
    rows: FloatArray, y: FloatArray, u: FloatArray, x: FloatArray, zone: FloatArray, layout: tuple[int, int, int]
) -> FloatArray:
    """Least squares of eq 22 with the switching functions and x of the present zone; `rows` holds past outputs."""
    head, nb, delay = layout
    n = u.size
    at = len(rows) - nb - 4
    delayed = u[head - delay : n - delay]
    rows[at + 1] = -(delayed > zone[1]).astype(float)
    rows[at + 3] = -(delayed < zone[0]).astype(float)
    rows[at] = -rows[at + 1] * delayed
    rows[at + 2] = -rows[at + 3] * delayed
    for i in range(nb):
        rows[at + 4 + i] = x[head - delay - i - 1 : n - delay - i - 1]
    gram = rows @ rows.T
    scale = np.sqrt(np.diag(gram)) + np.finfo(float).tiny
    solution = np.linalg.lstsq(gram / np.outer(scale, scale), (rows @ y) / scale, rcond=1e-14)[0]
    return np.asarray(solution / scale)


def _separate(theta: FloatArray, na: int, nb: int, gain: float, zone: FloatArray, span: tuple[float, float]) -> bool:
    """Zone from theta by the fixed-point form of eq 26, with the guards of the recursion; whether none was hit."""
    bottom, later = 1.0 + theta[:na].sum(), theta[na + 4 : na + 4 + nb].sum()
    slope, ratio = (theta[na] + zone[3] * later) / (gain * bottom), theta[na + 2] / theta[na]
    if not (slope > 0.0 and 0.1 < ratio < 10.0):
        return False
    zone[3], zone[2] = slope, slope * ratio
    right, left = theta[na + 1] / theta[na], theta[na + 3] / theta[na + 2]
    zone[1] = right if 0.0 <= right < span[1] else zone[1]
    zone[0] = left if span[0] < left <= 0.0 else zone[0]
    return bool(0.0 <= right < span[1] and span[0] < left <= 0.0)


def _package(
    theta: FloatArray, zone: FloatArray, orders: tuple[int, int, int], dt: float, iteration: int, converged: bool
) -> VorosFit:
    na, nb, delay = orders
    linear = LinearModel(tuple(theta[:na]), (theta[na] / zone[3], *theta[na + 4 : na + 4 + nb]), delay, dt)
    values = dict(zip(("left", "right", "left_slope", "right_slope"), zone.tolist(), strict=True))
    values |= {f"a{i + 1}": value for i, value in enumerate(linear.a)}
    values |= {f"b{i}": value for i, value in enumerate(linear.b)}
    return VorosFit(Hammerstein(DeadZone(*zone.tolist()), linear), values, iteration, converged)
