"""Random processes, noises and PI tunings at a sensible sampling time: what the family of random loops is made of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from lostmotion.arrays import FloatArray
from lostmotion.models import LinearModel
from lostmotion.simulate import PI

SLOWEST = (5.0, 50.0)  # samples: the time constant that dominates
FASTEST = 1.5  # samples: a lag shorter than this would not be seen
DAMPING = (0.25, 0.9)  # of a complex pair: below it hardly a process, above it two lags
LONGEST_DELAY = 15  # samples
KINDS = (("real", "integrating"), ("real", "complex", "integrating"), ("real", "complex", "integrating"))  # by order
SHARES = ((0.75, 0.25), (0.45, 0.35, 0.2), (0.45, 0.35, 0.2))  # probabilities of KINDS
ZERO_SHARE = 0.25  # of the processes of order 2 and 3 have a zero of their own
DETUNING = (1.3, 1.8)  # largest sensitivity that the PI is tuned for
SPEED = (0.2, 1.0)  # time constant of the closed loop, in those of the process, where the delay allows
GAINS = np.geomspace(1.0, 0.01, 60)  # tried, in units of Skogestad's gain
FREQUENCIES = np.geomspace(1e-4, np.pi, 500)  # radians a sample, 2 % apart, to Nyquist


@dataclass(frozen=True)
class Process:
    """Linear part with what a tuning rule needs.

    Attributes
    ----------
    linear : LinearModel
    kind : {"real", "complex", "integrating"}
    lags : tuple of float
        Time constants in samples, slowest first, without the integrator; a complex pair counts as one lag of
        2 zeta / omega.
    slowest : float
        Time constant in samples that dominates.
    rate : float
        Static gain, or the ramp per sample of an integrating process for x = 1.
    """

    linear: LinearModel
    kind: str
    lags: tuple[float, ...]
    slowest: float
    rate: float


def draw_process(random: np.random.Generator, order: int, least_delay: int, dt: float) -> Process:
    """Process of a random kind with `order` poles and a delay of `least_delay` to 15 samples."""
    kind = str(random.choice(KINDS[order - 1], p=SHARES[order - 1]))
    slowest = float(np.exp(random.uniform(*np.log(SLOWEST))))
    den, lags = _denominator(random, kind, order, slowest)
    num = np.ones(1)
    if order > 1 and random.random() < ZERO_SHARE:
        leads = random.random() < 0.6
        zero = random.uniform(0.2, 1.2) if leads else -random.uniform(0.1, 0.5)  # the second: inverse response
        num = np.array([zero * slowest, 1.0])
    rate = float(np.exp(random.uniform(np.log(0.1), np.log(10.0)))) * (-1.0 if random.random() < 0.25 else 1.0)
    if kind == "integrating":
        rate /= slowest
    held = LinearModel.from_continuous(rate * num, den, dead_time=0.0, dt=1.0)
    delay = int(random.integers(least_delay, LONGEST_DELAY + 1))
    return Process(LinearModel(held.a, held.b, delay, dt), kind, lags, slowest, rate)


def _denominator(
    random: np.random.Generator, kind: str, order: int, slowest: float
) -> tuple[FloatArray, tuple[float, ...]]:
    """Continuous denominator with constant term 1 (or a factor s), time in samples; and its lags."""

    def lag() -> float:
        return max(slowest * random.uniform(0.2, 0.9), FASTEST)

    if kind == "complex":
        damping = random.uniform(*DAMPING)
        omega = 1.0 / (damping * slowest)
        den, lags = np.array([omega**-2, 2 * damping / omega, 1.0]), [2 * damping / omega]
    elif kind == "integrating":
        den, lags = np.array([1.0, 0.0]), []
    else:
        den, lags = np.array([slowest, 1.0]), [slowest]
    while den.size <= order:
        lags.append(lag())
        den = np.convolve(den, [lags[-1], 1.0])
    return den, tuple(sorted(lags, reverse=True))


def draw_noise(random: np.random.Generator, coloured: bool) -> tuple[float, ...]:
    """Coefficients d of the noise: none, or an autoregression of order 1 or 2."""
    if not coloured:
        return ()
    if random.random() < 0.6:
        return (-random.uniform(0.5, 0.98),)
    if random.random() < 0.5:
        poles = random.uniform(0.3, 0.95, size=2)
        return (-float(poles.sum()), float(poles.prod()))
    radius, angle = random.uniform(0.5, 0.95), random.uniform(0.1, 1.5)
    return (-2.0 * radius * np.cos(angle), radius**2)


def noise_power(d: tuple[float, ...]) -> float:
    """Variance of (1/D) e for white e of variance 1."""
    impulse = np.zeros(5000)
    impulse[0] = 1.0
    return float(np.sum(lfilter([1.0], [1.0, *d], impulse) ** 2))


def draw_pi(random: np.random.Generator, process: Process, steepest: float) -> PI | None:
    """PI by Skogestad's rules (J. Process Control 13, 2003, 291-309), None where there is none.

    Half rule and SIMC, the closed loop's time constant being the effective delay or a share of the process's,
    whichever is longer; the gain is then lowered until the largest sensitivity is at most what was drawn.
    `steepest` is the steeper slope of the actuator: the loop is stable with it.
    """
    lags = list(process.lags)
    integrating = process.kind == "integrating"
    first = 1.0 if integrating else lags.pop(0)  # the ramp of an integrator stands for gain / lag
    second = lags.pop(0) if lags else 0.0
    delay = process.linear.delay + 0.5 * second + sum(lags)
    first += 0.0 if integrating else 0.5 * second
    reach = delay + max(delay, process.slowest * random.uniform(*SPEED))
    time = 4.0 * reach if integrating else min(first, 4.0 * reach)
    skogestad = first / (process.rate * steepest * reach)
    wanted = random.uniform(*DETUNING)
    linear = process.linear.scaled(steepest)
    for gain in GAINS * skogestad:
        if _stable(linear, gain, gain / time) and sensitivity(linear, gain, gain / time) <= wanted:
            return PI(kp=float(gain), ki=float(gain / time / linear.dt))
    return None


def sensitivity(linear: LinearModel, kp: float, ki_sample: float) -> float:
    """Largest |1 / (1 + G C)| over the frequencies of the sampled loop."""
    back = np.exp(-1j * FREQUENCIES)  # q^-1
    process = back**linear.delay * np.polyval(linear.b[::-1], back) / np.polyval([*linear.a[::-1], 1.0], back)
    return float(np.max(1.0 / np.abs(1.0 + process * (kp + ki_sample / (1.0 - back)))))


def _stable(linear: LinearModel, kp: float, ki_sample: float) -> bool:
    """Whether (1 - q^-1) A + q^-d B ((1 - q^-1) kp + ki) has all its roots inside the unit circle."""
    open_part = np.convolve([1.0, -1.0], [1.0, *linear.a])
    loop_part = np.concatenate([np.zeros(linear.delay), np.convolve(linear.b, [kp + ki_sample, -kp])])
    size = max(open_part.size, loop_part.size)
    total = np.pad(open_part, (0, size - open_part.size)) + np.pad(loop_part, (0, size - loop_part.size))
    return bool(np.abs(np.roots(total)).max(initial=0.0) < 1.0 - 1e-6)
