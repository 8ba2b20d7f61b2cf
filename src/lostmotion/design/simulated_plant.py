"""One plausible plant under test: its answer from rest, and the Fisher information of that answer."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.signal import lfilter

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.errors import ParameterError
from lostmotion.identify.actuators.dead_zone import DeadZoneFamily
from lostmotion.identify.likelihood.problem import Problem, Structure
from lostmotion.kernels.actuator import DEAD_ZONE
from lostmotion.kernels.loop import closed_loop
from lostmotion.models import DeadZone, Hammerstein, LinearModel, NoiseModel
from lostmotion.simulate import PI

_NO_INVERSE = np.zeros(5)
HAIR = 1e-9  # a pole this near to 1 integrates: models for a test are given, not fitted, and may be slow
MEMORIES = 10.0  # of the noise thrown away before it is used, so that it is stationary


@dataclass(frozen=True)
class Plant:
    """A model with its noise, at rest at OP = `op_now`; in a loop where there is a `controller`.

    Parameters
    ----------
    model : Hammerstein
        With a :class:`DeadZone`.
    noise : NoiseModel
    op_now : float
        OP at which everything has settled before the test.
    controller : PI or None
        None: open loop.
    seed : int
        Of the noise that enters the loop.
    fine : (NoiseModel, int) or None
        On a slower clock: the noise of the full clock and the samples per coarse sample. The loop is then disturbed by
        every so many samples of it, so that it goes as far as on the full clock; `noise` only weighs the information.
    """

    model: Hammerstein
    noise: NoiseModel
    op_now: float
    controller: PI | None = None
    seed: int = 0
    fine: tuple[NoiseModel, int] | None = None

    @cached_property
    def zone(self) -> DeadZone:
        """The dead zone."""
        zone = self.model.nonlinearity
        if not isinstance(zone, DeadZone):
            kind = type(zone).__name__
            raise ParameterError.expected("a DeadZone actuator", kind, "other kinds have no test design yet")
        return zone

    @cached_property
    def x_now(self) -> float:
        """Internal variable at rest."""
        return float(self.zone(self.op_now))

    @cached_property
    def integrating(self) -> bool:
        """Whether PV only rests where a load balances the actuator."""
        return self.model.linear.integrates(within=HAIR)

    @cached_property
    def pv_now(self) -> float:
        """PV at rest; of an integrating process by convention the offset."""
        return self.model.offset + (0.0 if self.integrating or not self.x_now else self.model.linear.gain * self.x_now)

    @cached_property
    def noise_deviation(self) -> float:
        """Standard deviation of the output noise."""
        return float(np.std(noise_samples(self.noise if self.fine is None else self.fine[0], 20_000, 0)))

    def anchored(self, pv: float) -> Plant:
        """The same plant with the offset that puts PV at rest to `pv`: where the loop stands now is known."""
        return replace(self, model=replace(self.model, offset=self.model.offset + pv - self.pv_now))

    def answer(self, u: FloatArray) -> FloatArray:
        """Noise-free PV for OP u (n,), from rest at `op_now`."""
        return self.model.simulate(u) + self._fading(u.size)

    def trial(self, signal: FloatArray) -> tuple[FloatArray, FloatArray]:
        """OP and PV of a test: without noise in open loop, with the plant's own noise, always the same, in a loop."""
        return (signal, self.answer(signal)) if self.controller is None else self.run(signal, self.seed)

    def run(self, signal: FloatArray, seed: int) -> tuple[FloatArray, FloatArray]:
        """OP and measured PV of a test; `signal` is OP in open loop, SP in closed loop.

        The same as ``simulate_loop`` with a bias, without its checks: the search calls this ten thousand times.
        """
        source, stride = (self.noise, 1) if self.fine is None else self.fine
        noise = noise_samples(source, signal.size * stride, seed)[::stride]
        if self.controller is None:
            return signal, self.answer(signal) + noise
        pi, zone, linear = self.controller, self._zone_parameters, self.model.linear
        _, op, _, _, pv = closed_loop(
            self._a, self._b, linear.delay, self.model.offset, zone, _NO_INVERSE, DEAD_ZONE, False,
            pi.kp, pi.ki * linear.dt, pi.low, pi.high, self.op_now, signal, self._fading(signal.size), noise,
        )  # fmt: skip
        return op, pv

    @cached_property
    def _a(self) -> FloatArray:
        return np.array(self.model.linear.a)

    @cached_property
    def _b(self) -> FloatArray:
        return np.array(self.model.linear.b)

    @cached_property
    def _zone_parameters(self) -> FloatArray:
        zone = self.zone
        return np.array([zone.left, zone.right, zone.left_slope, zone.right_slope])

    def _fading(self, n: int) -> FloatArray:
        """What is left in PV of the time before the test, or what the load of an integrating process does."""
        if not self.x_now:
            return np.zeros(n)
        linear = self.model.linear
        return self.x_now * ((0.0 if self.integrating else linear.gain) - linear.step_response(n))

    @cached_property
    def linear(self) -> LinearModel:
        """Linear part with the right slope in it, as the likelihood has it."""
        return self.model.linear.scaled(self.zone.right_slope)

    @cached_property
    def structure(self) -> Structure:
        """Orders, all rows used."""
        linear, p = self.linear, self.noise.order
        return Structure(len(linear.a), len(linear.b) - 1, linear.delay, p, linear.delay + p, self.integrating)

    @cached_property
    def theta(self) -> FloatArray:
        """True parameter vector of one segment that starts at rest."""
        zone, linear = self.zone, self.linear
        a, b = np.array(linear.a), np.array(linear.b)
        c = np.zeros(self.structure.initial)
        x = self.x_now / zone.right_slope
        if x and not self.integrating:
            for i in range(c.size):
                c[i] = x * b[i + 1 :].sum() - linear.gain * x * a[i:].sum()
        eta = [zone.left, zone.right, np.log(zone.left_slope / zone.right_slope)]
        load = [-x] if self.integrating else []
        return np.concatenate([a, b, [self.model.offset], eta, load, self.noise.d, c])

    @cached_property
    def free(self) -> FloatArray:
        """Directions of `theta` that are unknown (theta.size, free).

        In open loop without the noise model, which is independent of the rest.
        """
        problem = self.problem(np.zeros(1), None)
        held = range(problem.noise_at, problem.initial_at) if self.controller is None else ()
        return np.ascontiguousarray(problem.free_but(held))

    @cached_property
    def unsure(self) -> Plant:
        """The same plant to one who does not know its dead time and order: B with a coefficient more at either end."""
        linear = self.model.linear
        early = min(linear.delay, 1)
        wider = replace(linear, b=(*[0.0] * early, *linear.b, 0.0), delay=linear.delay - early)
        return replace(self, model=replace(self.model, linear=wider))

    def problem(self, u: FloatArray, y: FloatArray | None, segments: IntArray | None = None) -> Problem:
        """Likelihood of OP u (n,) and PV y; in open loop y is not needed."""
        rows = np.array([[0, u.size]]) if segments is None else segments
        return Problem(
            u, u if y is None else y, rows, DeadZoneFamily(-np.inf, np.inf, load=self.integrating), self.structure
        )


@functools.lru_cache(maxsize=64)
def noise_samples(noise: NoiseModel, n: int, seed: int) -> FloatArray:
    """Stationary output noise, shape (n,), read-only."""
    radius = noise.radius
    before = 0 if radius == 0 else min(int(MEMORIES / -np.log(min(radius, 0.9999))) + 10, 100_000)
    white = np.random.default_rng(seed).normal(scale=np.sqrt(noise.variance), size=n + before)
    samples = np.asarray(lfilter([1.0], [1.0, *noise.d], white))[before:]
    samples.setflags(write=False)
    return samples
