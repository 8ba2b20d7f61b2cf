"""PI settings from a process model, by Skogestad's rules."""

from __future__ import annotations

import numpy as np

from lostmotion.arguments import positive
from lostmotion.errors import ParameterError
from lostmotion.models import LinearModel
from lostmotion.simulate import PI


def simc(linear: LinearModel, slowness: float = 1.0) -> PI:
    """SIMC settings (Skogestad, Journal of Process Control 13, 2003).

    Parameters
    ----------
    linear : LinearModel
        Process.
    slowness : float
        Wanted closed-loop time constant in effective dead times: 1 is the rule's own, more is gentler.

    Notes
    -----
    First order with dead time by the half rule: the slowest real time constant, plus half of the next; the rest of
    the mean residence time (exact, from the coefficients) is dead time, so zeros, complex poles and the hold are in it.

    Raises
    ------
    ParameterError
        A slowness that is not positive, or a process without effect.

    Examples
    --------
    >>> lag = LinearModel.from_continuous([2.0], [10.0, 1.0], 1.5, 1.0)
    >>> pi = simc(lag)
    >>> round(pi.kp, 2), round(pi.kp / pi.ki, 1)
    (1.67, 10.0)
    """
    slowness = positive("slowness", slowness)
    a, b, dt = np.array([1.0, *linear.a]), np.array(linear.b), linear.dt
    integrating = linear.integrates()
    if integrating:
        a = np.polydiv(a, [1.0, -1.0])[0]
    gain = float(b.sum() / a.sum())
    if not (np.isfinite(gain) and gain):
        raise ParameterError.expected("a process with a gain", gain, "check the fit")
    mean = linear.delay + float(np.arange(b.size) @ b / b.sum() - np.arange(a.size) @ a / a.sum())
    residence = dt * (mean - 0.5)  # the hold counts for half a sample in `delay`
    poles = np.roots(a)
    real = poles[(np.abs(poles.imag) < 1e-9) & (poles.real > 0) & (poles.real < 1)].real
    constants = sorted((-dt / np.log(real)).tolist(), reverse=True)
    if integrating:
        dead = max(residence, 0.5 * dt)
        wanted = slowness * dead
        kp = dt / gain / (wanted + dead)
        return PI(kp, kp / (4.0 * (wanted + dead)))
    slowest = (constants[0] if constants else 0.0) + 0.5 * (constants[1] if len(constants) > 1 else 0.0)
    slowest = max(min(slowest, residence - 0.5 * dt), 0.5 * dt)
    dead = max(residence - slowest, 0.5 * dt)
    wanted = slowness * dead
    kp = slowest / gain / (wanted + dead)
    return PI(kp, kp / min(slowest, 4.0 * (wanted + dead)))
