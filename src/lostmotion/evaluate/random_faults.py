"""Random closed loops of which the fault is known: on them the diagnosis is calibrated, and can be checked by anyone.

OP and PV are in percent of span. A loop is a process (fast and slow self-regulating, second order, level), a PI
controller tuned for it, an actuator, drift and noise; a badly tuned loop has a controller near its
limit of stability, a disturbed one swings because something upstream does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arguments import positive, whole
from lostmotion.arrays import FloatArray
from lostmotion.brief import Brief
from lostmotion.models import (
    Backlash,
    DeadZone,
    Hammerstein,
    Identity,
    LinearModel,
    Nonlinearity,
    Saturation,
    Stiction,
)
from lostmotion.simulate import PI, LoopResponse, simulate_loop

FAULTS = ("none", "dead zone", "backlash", "stiction", "saturation")
CAUSES = (*FAULTS, "tuning", "disturbance")
PROCESSES = ("flow", "pressure", "temperature", "level")
WIDTHS = (1.0, 10.0)  # % of span
REST = 50.0  # OP at which the loop is at home, in % of span
MOST_SLOW = 12.0  # periods of an external oscillation in a record, at least
SETTLED = 0.25  # of the simulated record is thrown away: the loop has forgotten how it began
BEYOND = (0.05, 0.67)  # share of the time beyond a limit at which a saturation can be seen
SCAN = 0.02  # smallest stored step of PV and OP in % of span, where the historian rounds


@dataclass(frozen=True, eq=False, repr=False)
class FaultyLoop(Brief):
    """A record with its truth.

    Attributes
    ----------
    cause : str
        Of CAUSES: what makes the loop behave as it does.
    process : str
        Of PROCESSES.
    actuator : Nonlinearity
    width : float
        Full width (dead zone, backlash) or band (stiction) in % of span; 0 elsewhere.
    op, pv, sp : ndarray, shape (n,)
        In % of span.
    dt : float
        Seconds.
    noise_in_op : float
        Deviation that measurement noise has in OP.
    """

    cause: str
    process: str
    actuator: Nonlinearity
    width: float
    op: FloatArray
    pv: FloatArray
    sp: FloatArray
    dt: float
    noise_in_op: float

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return self.cause, self.process, f"{self.op.size} samples"

    @property
    def visible(self) -> bool:
        """Whether the record can show the fault.

        Lost motion: wider than twice the noise in OP, and OP turned by more than it. Saturation: OP is beyond a
        limit for a twentieth to two thirds of the time.
        """
        if isinstance(self.actuator, Saturation):
            beyond = (self.op - REST < self.actuator.low) | (self.op - REST > self.actuator.high)
            return BEYOND[0] < float(beyond.mean()) < BEYOND[1]
        return self.width > 2.0 * self.noise_in_op and float(np.ptp(self.op)) > 1.2 * self.width


def random_faulty_loop(
    seed: int,
    samples: int = 2000,
    cause: str | None = None,
    process: str | None = None,
    *,
    rough: bool = False,
    share: float = 1.0,
) -> FaultyLoop:
    """Draw a loop.

    Parameters
    ----------
    seed : int
    samples : int
    cause, process : str, optional
        Of CAUSES and PROCESSES; None: drawn.
    rough : bool
        Also steps of load in half of the loops, noise with long tails in a third, and a swing from upstream in a third,
        whatever the cause.
    share : float
        Of the width that is drawn: below 1 a fault that noise and load, which are drawn for the whole of it, hide.

    Examples
    --------
    >>> loop = random_faulty_loop(3, samples=500, cause="stiction")
    >>> loop.op.size, loop.actuator.kind
    (500, 'stiction')
    """
    rng = np.random.default_rng([whole("seed", seed, 0), 47])
    cause = str(rng.choice(CAUSES)) if cause is None else cause
    process = str(rng.choice(PROCESSES)) if process is None else process
    linear, controller, pace = _process(rng, process, cause == "tuning")
    width = float(np.exp(rng.uniform(*np.log(WIDTHS))))
    actuator = _actuator(rng, cause, positive("share", share) * width)
    n = round(samples / (1.0 - SETTLED))
    deviation = width * np.exp(rng.uniform(np.log(0.01), np.log(0.5))) / max(abs(controller.kp), 0.3)
    noise = deviation * (_grains(rng, n) if rough else rng.normal(size=n))
    load = _drift(rng, n, pace, width)
    if rough:
        load = load + _steps(rng, n, pace, width)
    if cause == "disturbance" or (rough and rng.random() < 1.0 / 3.0):
        load = load + _upstream(rng, n, pace, width)
    response = _run(linear, controller, actuator, _set_point(rng, n, width), load, noise)
    kept = slice(n - samples, n)
    step = SCAN * float(rng.choice([0.0, 0.1, 1.0]))
    op, pv = _stored(response.control[kept], step), _stored(response.measured[kept], step)
    size = getattr(actuator, "width", getattr(actuator, "band", 0.0))
    in_op = deviation * abs(controller.kp)
    return FaultyLoop(
        cause, process, actuator, float(size), op, pv, REST + response.reference[kept], linear.dt, float(in_op)
    )


def _process(rng: np.random.Generator, process: str, badly: bool) -> tuple[LinearModel, PI, float]:
    """Process, controller, and its pace in samples."""
    gain = float(rng.choice([-1.0, 1.0]) * np.exp(rng.uniform(np.log(0.4), np.log(2.5))))
    constant = float(np.exp(rng.uniform(np.log(2.0), np.log(25.0))))
    delay = int(rng.integers(1, 4)) if process in ("flow", "level") else int(rng.integers(2, 3 + int(constant / 2)))
    pole = float(np.exp(-1.0 / constant))
    closed = constant * rng.uniform(0.6, 2.5) if process != "flow" else rng.uniform(1.5, 6.0)
    if process == "flow":
        pole = float(np.exp(-1.0 / rng.uniform(1.0, 4.0)))
    if process == "level":
        gain *= 1.0 / constant
        linear = LinearModel((-1.0,), (gain,), delay, 1.0)
        kp = 1.0 / (gain * (closed + delay))
        ki = kp / (4.0 * (closed + delay))
    else:
        a = np.array([1.0, -pole])
        if process == "temperature":
            a = np.convolve(a, [1.0, -float(np.exp(-1.0 / (constant * rng.uniform(0.1, 0.5))))])
        linear = LinearModel(tuple(a[1:].tolist()), (gain * float(a.sum()),), delay, 1.0)
        time = -1.0 / np.log(pole)
        kp = time / (gain * (closed + delay))
        ki = kp / min(time, 4.0 * (closed + delay))
    if badly:  # with dead time enough that it swings slower than it is sampled
        linear = LinearModel(linear.a, linear.b, delay + 2, 1.0)
        kp, ki = near_the_limit(linear, kp, ki, rng.uniform(0.93, 0.995))
    return linear, PI(kp, ki, -REST, REST), closed + delay


def near_the_limit(linear: LinearModel, kp: float, ki: float, share: float) -> tuple[float, float]:
    """The same PI with a gain a little below that at which the loop is unstable, found by bisection."""
    low, high = 0.0, 1.0
    while _stable(linear, high * kp, high * ki) and high < 1e4:
        low, high = high, 2.0 * high
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _stable(linear, middle * kp, middle * ki) else (low, middle)
    return share * low * kp, share * low * ki


def _stable(linear: LinearModel, kp: float, ki: float) -> bool:
    """Roots of A (1 - q^-1) + q^-d B (kp + ki - kp q^-1)."""
    left = np.convolve(np.r_[1.0, linear.a], [1.0, -1.0])
    right = np.convolve(np.r_[np.zeros(linear.delay), linear.b], [kp + ki * linear.dt, -kp])
    size = max(left.size, right.size)
    total = np.pad(left, (0, size - left.size)) + np.pad(right, (0, size - right.size))
    return bool(np.abs(np.roots(total)).max(initial=0.0) < 1.0)


def _actuator(rng: np.random.Generator, cause: str, width: float) -> Nonlinearity:
    """Actuator in deviations from its place at home."""
    if cause == "dead zone":
        middle = rng.uniform(-0.3, 0.3) * width
        return DeadZone(middle - 0.5 * width, middle + 0.5 * width)
    if cause == "backlash":
        return Backlash(width)
    if cause == "stiction":
        return Stiction(width, width * rng.uniform(0.2, 1.2), str(rng.choice(["kano", "he"])))
    if cause == "saturation":
        return Saturation(-rng.uniform(0.1, 0.5) * width, rng.uniform(0.1, 0.5) * width)
    return Identity()


def _drift(rng: np.random.Generator, n: int, pace: float, width: float) -> FloatArray:
    """Slow load, in units of OP."""
    pole = np.exp(-1.0 / (pace * rng.uniform(3.0, 20.0)))
    size = width * np.exp(rng.uniform(np.log(0.005), np.log(1.0)))  # half of them little: limit cycles are seen
    steps = rng.normal(scale=size * np.sqrt(1.0 - pole**2), size=n)
    drift = np.zeros(n)
    for k in range(1, n):
        drift[k] = pole * drift[k - 1] + steps[k]
    return drift


def _steps(rng: np.random.Generator, n: int, pace: float, width: float) -> FloatArray:
    """Load that changes in steps, in half of the loops: batches, pumps and valves elsewhere are switched."""
    if rng.random() < 0.5:
        return np.zeros(n)
    changes = rng.random(n) < 1.0 / (pace * rng.uniform(8.0, 60.0))
    levels = rng.normal(scale=width * rng.uniform(0.1, 1.0), size=n)
    return np.asarray(levels[np.maximum.accumulate(np.where(changes, np.arange(n), 0))])


def _grains(rng: np.random.Generator, n: int) -> FloatArray:
    """Noise of deviation 1; in a third of the loops with the tails of Student's t, three degrees of freedom."""
    if rng.random() < 2.0 / 3.0:
        return rng.normal(size=n)
    return np.asarray(rng.standard_t(3.0, size=n) / np.sqrt(3.0))


def _upstream(rng: np.random.Generator, n: int, pace: float, width: float) -> FloatArray:
    """A periodic load that this loop does not cause: a sine, or the square wave of another valve behind two lags."""
    period = min(pace * rng.uniform(4.0, 25.0), n / MOST_SLOW)
    time = np.arange(n) + np.cumsum(rng.normal(scale=rng.uniform(0.0, 0.1), size=n))
    wave = np.sin(2.0 * np.pi * time / period)
    if rng.random() < 0.5:
        wave = np.sign(wave)
        for lag in period * rng.uniform(0.08, 0.4, size=2):
            pole = float(np.exp(-1.0 / lag))
            wave = LinearModel((-pole,), (1.0 - pole,), 1).simulate(wave)
    return np.asarray(width * rng.uniform(0.5, 3.0) * wave)


def _set_point(rng: np.random.Generator, n: int, width: float) -> FloatArray:
    """Constant in most loops; a few moves in others."""
    reference = np.zeros(n)
    if rng.random() < 0.3:
        for k in np.sort(rng.integers(0, n, size=int(rng.integers(2, 9)))):
            reference[k:] = rng.normal(scale=width)
    return reference


def _run(
    linear: LinearModel,
    controller: PI,
    actuator: Nonlinearity,
    reference: FloatArray,
    load: FloatArray,
    noise: FloatArray,
) -> LoopResponse:
    """Simulate; the load passes through the process like OP does."""
    added = linear.simulate(load)
    return simulate_loop(
        Hammerstein(actuator, linear), controller, reference, disturbance=added, noise=noise, allow_unstable=True
    )


def _stored(signal: FloatArray, step: float) -> FloatArray:
    """About the middle of the span, rounded as a historian does."""
    values = REST + signal
    return np.asarray(np.round(values / step) * step) if step > 0 else values
