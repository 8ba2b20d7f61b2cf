"""Random loops with a dead zone whose truth is known: the family on which ``monte_carlo`` measures estimators."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.signal import lfilter

from lostmotion.arguments import whole
from lostmotion.arrays import FloatArray
from lostmotion.brief import Brief
from lostmotion.errors import LostMotionError
from lostmotion.evaluate.cramer_rao import cramer_rao
from lostmotion.evaluate.delay_margin import delay_margin
from lostmotion.evaluate.random_processes import Process, draw_noise, draw_pi, draw_process, noise_power
from lostmotion.models import DeadZone, Hammerstein, NoiseModel
from lostmotion.simulate import PI, LoopResponse, simulate_loop

SAMPLES = 3000  # of a record, as in docs/family.md
WARM_UP = 500  # samples before the record: it does not begin at rest
SHARE = (0.05, 0.6)  # half-width of the dead zone in halves of the range of OP, or width in ranges
SLOPE_RATIO = (0.3, 3.0)  # left over right, even in the logarithm: no side is favoured
SNR_DB = (5.0, 30.0)  # variance of the noise-free PV over variance of the noise
SPAN = (10.0, 50.0)  # range of OP, % of its span
SAMPLING_TIMES = (0.1, 0.5, 1.0, 2.0, 5.0)  # seconds: from the scan of a PLC to that of a historian
INTERVAL_PER_WIDTH = 1.0 / 3.0  # an expected 95 % interval narrower than this share of the width can be had
DELAY_MARGIN = 25.0  # from here on the record tells the delay: a test of it errs in 6 of 1,000 records
MOST_DRAWS = 200  # of plans: one is given up where its loop cannot be had
ROUNDS = 40  # of both tolerances: noise and set points change each other through the loop
SHARE_TOLERANCE, SNR_TOLERANCE = 0.05, 0.05  # relative, dB


@dataclass(frozen=True, eq=False, repr=False)
class RandomLoop(Brief):
    """One member of the family: a record and everything that is true about it.

    Attributes
    ----------
    index, seed : int
        ``random_loop(index, seed)`` makes it again.
    u, y : ndarray, shape (n,)
        Record: command in %, measured output in its units.
    clean : ndarray, shape (n,)
        Output without noise, ``y - clean`` is the noise.
    reference : ndarray, shape (n,), or None
        Set point; None in open loop.
    model : Hammerstein
        Truth, with right slope 1.
    noise : NoiseModel
        Truth; in a closed loop it is the disturbance too.
    process : {"real", "complex", "integrating"}
        Kind of the linear part.
    snr_db : float
        Variance of `clean` over the variance of the noise model, in dB.
    controller : PI or None
    """

    index: int
    seed: int
    u: FloatArray = field(repr=False)
    y: FloatArray = field(repr=False)
    clean: FloatArray = field(repr=False)
    reference: FloatArray | None = field(repr=False)
    model: Hammerstein
    noise: NoiseModel
    process: str
    snr_db: float
    controller: PI | None

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return f"number {self.index}", f"{self.process} process", f"{self.u.size} samples"

    @property
    def zone(self) -> DeadZone:
        """The dead zone."""
        assert isinstance(self.model.nonlinearity, DeadZone)  # noqa: S101  for the type checker
        return self.model.nonlinearity

    @property
    def dt(self) -> float:
        """Sampling time in seconds."""
        return self.model.linear.dt

    @property
    def closed(self) -> bool:
        """Recorded in closed loop."""
        return self.controller is not None

    @property
    def orders(self) -> tuple[int, int, int]:
        """na, nb and delay."""
        linear = self.model.linear
        return len(linear.a), len(linear.b) - 1, linear.delay

    @property
    def share(self) -> float:
        """Width of the dead zone in ranges of OP."""
        return self.zone.width / float(np.ptp(self.u))

    @property
    def truth(self) -> dict[str, float]:
        """True values by the names of ``HammersteinFit.parameters``."""
        zone = self.zone
        return {"left": zone.left, "right": zone.right, "width": zone.width, "slope_ratio": zone.left_slope}

    @cached_property
    def expected(self) -> dict[str, float]:
        """Standard errors of :attr:`truth` that the record allows (Cramer-Rao, from the true model)."""
        y = self.y if self.closed else None  # in open loop the noise model is independent of the rest
        bound = cramer_rao(self.model, self.u, self.noise, y=y, clean=self.clean)
        return {name: bound[name] for name in self.truth}

    @property
    def identifiable(self) -> bool:
        """Whether the expected 95 % intervals of both break points are narrower than a third of the width."""
        reach = 2.0 * 1.96 * max(self.expected["left"], self.expected["right"])
        return bool(reach < INTERVAL_PER_WIDTH * self.zone.width)

    @cached_property
    def delay_margin(self) -> float:
        """How clearly the record tells the delay; see :func:`lostmotion.evaluate.delay_margin.delay_margin`."""
        return delay_margin(self.model, self.u, self.noise, self.clean)

    @property
    def delay_told(self) -> bool:
        """Whether the record tells the delay exactly."""
        return self.delay_margin >= DELAY_MARGIN


@dataclass(frozen=True)
class _Plan:
    """What is drawn before the signals."""

    samples: int
    process: Process
    zone: DeadZone
    offset: float
    d: tuple[float, ...]
    snr_db: float
    share: float
    span: float
    centre: float
    limits: tuple[float, float]

    @property
    def model(self) -> Hammerstein:
        return Hammerstein(self.zone, self.process.linear, self.offset)


def random_loop(index: int, seed: int = 0, samples: int = SAMPLES) -> RandomLoop:
    """Member `index` of the family with `seed`.

    Half of the loops are closed, half have coloured noise, a third each has 1, 2 or 3 poles. Width of the dead zone
    5 to 60 % of the range of OP and not in its middle, slope ratio 0.3 to 3, signal-to-noise ratio 5 to 30 dB,
    delay up to 15 samples (from 0 in open loop, from 1 in a loop), dominant time constant 5 to 50 samples; poles
    real, complex or one at 1; a zero in some. Half of the records are in engineering units (OP near 50 %, PV with
    an offset), half in deviations. Open loop: random staircase, for integrating processes one that keeps PV in
    bounds. Closed loop: PI by Skogestad's rules, set-point moves, the noise acting as disturbance too.

    Parameters
    ----------
    index, seed : int
        Whole numbers >= 0; the same pair gives the same loop.
    samples : int
        Length of the record, at least 200.

    Examples
    --------
    >>> loop = random_loop(3)
    >>> loop.u.size, 5.0 <= loop.snr_db <= 30.0, 0.04 < loop.share < 0.7
    (3000, True, True)
    """
    index, seed, samples = whole("index", index, 0), whole("seed", seed, 0), whole("samples", samples, 200)
    random = np.random.default_rng([seed, index])
    closed, coloured = bool(random.random() < 0.5), bool(random.random() < 0.5)
    order = int(random.integers(1, 4))
    for _ in range(MOST_DRAWS):
        plan = _plan(random, samples, order, coloured, least_delay=1 if closed else 0)
        loop = _closed(random, plan, index, seed) if closed else _open(random, plan, index, seed)
        if loop is not None:
            return loop
    raise LostMotionError(f"expected a loop within {MOST_DRAWS} draws, got none for index {index}, seed {seed}")


def _plan(random: np.random.Generator, samples: int, order: int, coloured: bool, least_delay: int) -> _Plan:
    process = draw_process(random, order, least_delay, float(random.choice(SAMPLING_TIMES)))
    engineering = random.random() < 0.5
    span, share = random.uniform(*SPAN), random.uniform(*SHARE)
    centre = random.uniform(35.0, 65.0) if engineering else random.uniform(-0.2, 0.2) * span
    middle = centre + 0.35 * random.uniform(-1.0, 1.0) * (1.0 - share) * span
    ratio = float(np.exp(random.uniform(*np.log(SLOPE_RATIO))))
    zone = DeadZone(middle - 0.5 * share * span, middle + 0.5 * share * span, ratio, 1.0)
    offset = random.uniform(20.0, 400.0) if engineering else 0.0
    limits = (0.0, 100.0) if engineering else (-50.0, 50.0)
    d = draw_noise(random, coloured)
    return _Plan(samples, process, zone, offset, d, random.uniform(*SNR_DB), share, span, centre, limits)


def _unit_noise(random: np.random.Generator, plan: _Plan) -> FloatArray:
    """Noise of variance 1, warm-up included."""
    white = random.normal(size=WARM_UP + plan.samples)
    return np.asarray(lfilter([1.0], [1.0, *plan.d], white) / np.sqrt(noise_power(plan.d)))


def _open(random: np.random.Generator, plan: _Plan, index: int, seed: int) -> RandomLoop | None:
    """Random staircase that goes through the planned range."""
    hold = int(np.clip(round(plan.process.slowest * random.uniform(0.2, 1.0)), 2, 40))
    levels = random.uniform(-0.5, 0.5, size=-(-(WARM_UP + plan.samples) // hold))
    recorded = levels[WARM_UP // hold :]
    levels = np.clip((levels - recorded.min()) / np.ptp(recorded), 0.0, 1.0) * plan.span + plan.centre - 0.5 * plan.span
    if plan.process.kind == "integrating":
        levels = _balanced(random, levels, plan)
    u = np.repeat(levels, hold)[: WARM_UP + plan.samples]
    if plan.zone.width > SHARE[1] * np.ptp(u[WARM_UP:]):
        return None
    clean = plan.model.simulate(u)
    deviation = float(np.std(clean[WARM_UP:])) * 10.0 ** (-plan.snr_db / 20.0)
    y = clean + deviation * _unit_noise(random, plan)
    return _cut(plan, index, seed, u, y, clean, None, deviation, None)


def _balanced(random: np.random.Generator, levels: FloatArray, plan: _Plan) -> FloatArray:
    """Staircase that turns back where the integral of x has gone two steps away."""
    low, high = plan.centre - 0.5 * plan.span, plan.centre + 0.5 * plan.span
    zone, place, result = plan.zone, 0.0, levels.copy()
    bound = 2.0 * max(abs(float(np.asarray(zone(end)))) for end in (low, high))
    for step, level in enumerate(levels):
        x = float(np.asarray(zone(level)))
        if abs(place) > bound and x * place > 0.0:
            result[step] = random.uniform(low, zone.left) if place > 0.0 else random.uniform(zone.right, high)
        place += float(np.asarray(zone(result[step])))
    return result


def _closed(random: np.random.Generator, plan: _Plan, index: int, seed: int) -> RandomLoop | None:
    """Loop whose set points and noise are scaled until the range of OP and the noise ratio are as planned."""
    controller = draw_pi(random, plan.process, max(plan.zone.left_slope, plan.zone.right_slope))
    if controller is None:
        return None
    middle = 0.5 * (plan.zone.left + plan.zone.right)
    controller = PI(controller.kp, controller.ki, *plan.limits, bias=middle)
    moves = _set_points(random, plan)
    unit = _unit_noise(random, plan)
    wanted, scale, deviation = 10.0 ** (plan.snr_db / 10.0), 1.0, 0.0
    for _ in range(ROUNDS):
        response = simulate_loop(
            plan.model, controller, plan.offset + scale * moves, noise=deviation * unit, allow_unstable=True
        )
        u, clean = response.command[WARM_UP:], response.output[WARM_UP:]
        power, reach = float(np.var(clean)), float(np.ptp(u))
        if not (np.isfinite(power) and power > 0.0 and reach > 0.0):
            return None
        loud = deviation**2 * wanted / power
        wide = plan.zone.width / reach / plan.share
        if abs(wide - 1.0) < SHARE_TOLERANCE and abs(10.0 * np.log10(max(loud, 1e-9))) < SNR_TOLERANCE:
            return _settled(plan, index, seed, response, deviation, controller)
        deviation = np.sqrt(power / wanted) if loud < 0.1 else deviation * np.clip(loud, 0.1, 10.0) ** -0.5
        scale *= np.clip(wide, 0.2, 5.0) ** 0.7
    return None


def _set_points(random: np.random.Generator, plan: _Plan) -> FloatArray:
    """Random levels around the offset, for which OP at rest goes through the planned range."""
    process, zone = plan.process, plan.zone
    settling = process.linear.delay + sum(process.lags) + process.slowest
    hold = int(np.clip(round(settling * random.uniform(2.0, 5.0)), 30, 250))
    steps = random.uniform(-1.0, 1.0, size=-(-(WARM_UP + plan.samples) // hold))
    if process.kind == "integrating":
        levels = steps * abs(process.rate) * process.slowest * 0.5 * (1.0 - plan.share) * plan.span
    else:
        above, below = plan.centre + 0.5 * plan.span - zone.right, zone.left - plan.centre + 0.5 * plan.span
        levels = process.rate * np.where(steps > 0.0, steps * above, steps * below * zone.left_slope)
    return np.repeat(levels, hold)[: WARM_UP + plan.samples]


def _settled(
    plan: _Plan, index: int, seed: int, response: LoopResponse, deviation: float, controller: PI
) -> RandomLoop | None:
    """The loop as found, None where OP spends its time at a limit."""
    u = response.command
    if np.mean((u <= plan.limits[0]) | (u >= plan.limits[1])) > 0.02:
        return None
    return _cut(plan, index, seed, u, response.measured, response.output, response.reference, deviation, controller)


def _cut(
    plan: _Plan,
    index: int,
    seed: int,
    u: FloatArray,
    y: FloatArray,
    clean: FloatArray,
    reference: FloatArray | None,
    deviation: float,
    controller: PI | None,
) -> RandomLoop:
    """The record without its warm-up."""
    noise = NoiseModel(plan.d, deviation**2 / noise_power(plan.d))
    snr = 10.0 * np.log10(np.var(clean[WARM_UP:]) / deviation**2)
    return RandomLoop(
        index, seed, u[WARM_UP:].copy(), y[WARM_UP:].copy(), clean[WARM_UP:].copy(),
        None if reference is None else reference[WARM_UP:].copy(), plan.model, noise, plan.process.kind, float(snr),
        controller,
    )  # fmt: skip
