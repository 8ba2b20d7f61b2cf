"""Linear part: q^-d B(q)/A(q)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import coefficients, positive, whole
from lostmotion.arguments import signal as as_signal
from lostmotion.arrays import FloatArray
from lostmotion.errors import InputError, ParameterError
from lostmotion.extras import extra
from lostmotion.kernels import linear as kernel
from lostmotion.working_folder import MATPLOTLIB_FILE, without_settings

MOST_DELAY = 1e6  # samples: a dead time of more is a mistake in a unit, and an array of its own
AT_ONE = 1e-6  # distance of a pole from 1: roots of A are true to 1e-8 only where two of them meet
SETTLING = 1.0 - 1e-9  # modulus: a slower pole needs 1e9 samples, longer than any record, and counts as an integrator


@dataclass(frozen=True)
class LinearModel:
    """Discrete linear process ``y(k) = sum b_i x(k-d-i) - sum a_j y(k-j)`` (paper, eqs 1-2).

    Parameters
    ----------
    a : array_like, shape (na,)
        a1 .. a_na; the leading 1 of A is not written.
    b : array_like, shape (nb + 1,)
        b0 .. b_nb.
    delay : int
        d in samples, at least 0. A process behind a zero-order hold has delay >= 1.
    dt : float
        Sampling time in seconds.

    Raises
    ------
    ParameterError
        Coefficients that are not finite, no b, a negative delay, or dt <= 0.

    Examples
    --------
    >>> lag = LinearModel(a=[-0.5], b=[0.5], delay=1, dt=0.1)
    >>> lag.gain, lag.is_stable
    (1.0, True)
    >>> lag.simulate([1.0, 1.0, 1.0]).tolist()
    [0.0, 0.5, 0.75]
    """

    a: tuple[float, ...]
    b: tuple[float, ...]
    delay: int = 0
    dt: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "a", coefficients("a", self.a))
        object.__setattr__(self, "b", coefficients("b", self.b))
        object.__setattr__(self, "dt", positive("dt", self.dt))
        if not self.b:
            raise ParameterError.expected("at least b0", "no b", "give b=[b0, ..]")
        object.__setattr__(self, "delay", whole("delay", self.delay, 0))

    @classmethod
    def from_continuous(cls, num: npt.ArrayLike, den: npt.ArrayLike, dead_time: float, dt: float) -> Self:
        """Zero-order-hold equivalent of ``num(s)/den(s) exp(-dead_time s)``.

        Parameters
        ----------
        num, den : array_like
            Coefficients in falling powers of s; proper.
        dead_time : float
            Seconds, >= 0, any fraction of dt (the fraction adds a coefficient to B).
        dt : float
            Sampling time in seconds.

        Returns
        -------
        LinearModel
            With the sample that the hold itself takes counted in `delay`: dead_time = 3 dt gives delay 4.

        Raises
        ------
        ParameterError
            Improper or empty transfer function, negative dead time.

        Notes
        -----
        The paper's eq 30 writes the same A and B with q^-3; see ``platforms.level_tank``.

        Examples
        --------
        >>> tank = LinearModel.from_continuous([50], [1, 5.9, 29.5, 22.5], dead_time=0.3, dt=0.1)
        >>> tank.delay, [round(value, 5) for value in tank.b]
        (4, [0.00713, 0.02441, 0.00531])
        """
        num = np.trim_zeros(np.array(coefficients("num", num)), "f")
        den = np.array(coefficients("den", den))
        if den.size < num.size or num.size == 0 or den.size == 0 or den[0] == 0:
            raise ParameterError.expected("a proper num/den", f"{num}/{den}", "give falling powers of s")
        dt = positive("dt", dt)
        if not (np.isfinite(dead_time) and dead_time >= 0):
            raise ParameterError.expected("dead_time >= 0", dead_time, "give seconds")
        if dead_time / dt > MOST_DELAY:
            got = f"{dead_time / dt:.3g}"
            raise ParameterError.expected(f"a dead_time of at most {MOST_DELAY:g} samples", got, "give it in seconds")
        whole, fraction = divmod(dead_time / dt, 1.0)
        if min(fraction, 1.0 - fraction) < 1e-9:
            whole, fraction = round(dead_time / dt), 0.0
        a, b = _hold_equivalent(num / den[0], den / den[0], dt, fraction)
        leading = int(np.flatnonzero(np.abs(b) > 1e-14 * np.abs(b).max())[0])
        return cls(tuple(a), tuple(np.trim_zeros(b[leading:], "b")), int(whole) + leading, dt)

    @classmethod
    def from_control(cls, system: Any) -> Self:
        """From a discrete single-input single-output python-control transfer function."""
        if not system.dt or system.dt is True:
            raise ParameterError.expected("a discrete system with a sampling time", system.dt, "use c2d first")
        num, den = (np.atleast_1d(np.asarray(part[0][0], float)) for part in (system.num, system.den))
        num = np.trim_zeros(num, "f")
        excess = den.size - num.size
        zeros = den.size - np.trim_zeros(den, "b").size  # poles at z = 0 are delay
        b = np.trim_zeros(num, "b") / den[0]
        return cls(tuple(den[1 : den.size - zeros] / den[0]), tuple(b), excess, float(system.dt))

    @property
    def gain(self) -> float:
        """Static gain B(1)/A(1); infinite for an integrating process."""
        bottom = 1.0 + sum(self.a)
        return sum(self.b) / bottom if bottom else float(np.copysign(np.inf, sum(self.b)))

    @property
    def poles(self) -> npt.NDArray[np.complex128]:
        """Roots of A in the z plane."""
        return np.roots([1.0, *self.a]).astype(np.complex128)

    @property
    def is_stable(self) -> bool:
        """All poles strictly inside the unit circle."""
        return bool(kernel.is_stable(np.array(self.a), 1.0))

    def integrates(self, within: float = AT_ONE) -> bool:
        """Whether a pole is nearer to 1 than `within`.

        Examples
        --------
        >>> LinearModel([-1.0], [0.1], 1).integrates(), LinearModel([-0.99], [0.1], 1).integrates()
        (True, False)
        """
        return bool(np.min(np.abs(self.poles - 1.0), initial=1.0) < within)

    def slowest_lag(self, within: float = SETTLING) -> float:
        """Time constant of the slowest pole inside the radius `within`, in samples; 0 where no pole lags.

        Examples
        --------
        >>> round(LinearModel.from_continuous([1.0], [30.0, 1.0], 0.0, 2.0).slowest_lag(), 9)
        15.0
        """
        sizes = np.abs(self.poles)
        lagging = sizes[(sizes > 0.0) & (sizes < within)]
        return -1.0 / math.log(float(lagging.max())) if lagging.size else 0.0

    @property
    def slowest_time_constant(self) -> float:
        """That of the slowest settling pole in seconds; an integrator has none, and counts as 0."""
        return self.dt * self.slowest_lag()

    @property
    def process_time(self) -> float:
        """Dead time, at least a sample, and slowest time constant in seconds: a while after which a move has acted."""
        return float(self.dt * (max(self.delay, 1) + self.slowest_lag()))

    def simulate(self, x: npt.ArrayLike) -> FloatArray:
        """Output from rest for the internal variable x, shape (n,)."""
        return np.asarray(kernel.simulate(np.array(self.a), np.array(self.b), self.delay, as_signal("x", x)))

    def step_response(self, samples: int) -> FloatArray:
        """Output for a unit step of x, `samples` values from time 0."""
        return self.simulate(np.ones(samples))

    def scaled(self, factor: float) -> LinearModel:
        """The same dynamics with `factor` times the gain."""
        return LinearModel(self.a, tuple(factor * value for value in self.b), self.delay, self.dt)

    def to_control(self) -> Any:
        """As a python-control ``TransferFunction`` (needs the extra ``lostmotion[control]``)."""
        with extra("control"), without_settings(MATPLOTLIB_FILE):
            import control  # noqa: PLC0415  optional extra
        lag = self.delay + len(self.b) - 1
        order = max(lag, len(self.a))
        num = np.pad(self.b, (0, order - lag))
        den = np.pad([1.0, *self.a], (0, order - len(self.a)))
        return control.tf(num, den, self.dt)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        return {"a": list(self.a), "b": list(self.b), "delay": self.delay, "dt": self.dt}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Inverse of :meth:`to_dict`."""
        try:
            return cls(tuple(data["a"]), tuple(data["b"]), data["delay"], data["dt"])
        except KeyError as error:
            raise InputError.expected("keys a, b, delay, dt", sorted(data), "use to_dict()") from error


def _hold_equivalent(num: FloatArray, den: FloatArray, dt: float, fraction: float) -> tuple[FloatArray, FloatArray]:
    """A without its leading 1, and B from lag 0, of a held input delayed by `fraction` of a sample."""
    phi, gamma_late, output, feedthrough = _held_states(num, den, dt)
    order = len(den) - 1
    if order == 0:
        full = np.array([feedthrough])
        return np.array([]), full if fraction == 0 else np.array([0.0, feedthrough])
    a = np.asarray(np.poly(phi), dtype=np.float64)
    if fraction == 0:
        return a[1:], _numerator(phi, [gamma_late], output, [feedthrough], a)
    early = _held_states(num, den, (1.0 - fraction) * dt)[1]  # the newest input acts for the rest of the sample
    older = gamma_late - early
    return a[1:], _numerator(phi, [early, older], output, [0.0, feedthrough], a)


def _held_states(num: FloatArray, den: FloatArray, dt: float) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Transition, input, output matrices and feedthrough of the held state-space model."""
    from scipy import linalg, signal  # noqa: PLC0415  seconds of import that only this conversion needs

    scale = 2.0 ** float(np.frexp(np.abs(num).max())[1])  # SciPy drops coefficients below 1e-14, small gains as well
    states, inputs, outputs, through = signal.tf2ss(num / scale, den)
    n = len(den) - 1
    block = np.zeros((n + 1, n + 1))
    block[:n, :n], block[:n, n:] = states[:n, :n], inputs[:n]
    power = linalg.expm(block * dt)
    return power[:n, :n], power[:n, n], scale * np.ravel(outputs)[:n], scale * float(np.ravel(through)[0])


def _numerator(
    phi: FloatArray, gammas: list[FloatArray], output: FloatArray, through: list[float], a: FloatArray
) -> FloatArray:
    """B from the first Markov parameters: B = A * impulse response."""
    n = len(a) - 1
    length = n + len(gammas)
    impulse = np.zeros(length)
    for lag, (gamma, direct) in enumerate(zip(gammas, through, strict=True)):
        impulse[lag] += direct
        state = gamma
        for k in range(lag + 1, length):
            impulse[k] += output @ state
            state = phi @ state
    return np.convolve(a, impulse)[:length]
