"""One plausible plant under test: its answer from rest, and the Fisher information of that answer."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.signal import lfilter

from lostmotion.errors import ParameterError
from lostmotion.identify.families import DeadZoneFamily
from lostmotion.identify.problem import Problem, Structure
from lostmotion.models import DeadZone, Hammerstein, LinearModel, NoiseModel
from lostmotion.models._arguments import FloatArray
from lostmotion.simulate import PI, simulate_loop

IntArray = npt.NDArray[np.int64]
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

    @property
    def can_rest(self) -> bool:
        """An integrating process rests only inside the dead zone."""
        return self.model.linear.is_stable or not self.x_now

    @cached_property
    def pv_now(self) -> float:
        """PV at rest."""
        return self.model.offset + (self.model.linear.gain * self.x_now if self.x_now else 0.0)

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
        """OP and measured PV of a test; `signal` is OP in open loop, SP in closed loop."""
        source, stride = (self.noise, 1) if self.fine is None else self.fine
        noise = noise_samples(source, signal.size * stride, seed)[::stride]
        if self.controller is None:
            return signal, self.answer(signal) + noise
        response = simulate_loop(
            self.model, replace(self.controller, bias=self.op_now), signal,
            disturbance=self._fading(signal.size), noise=noise, allow_unstable=True,
        )  # fmt: skip
        return response.command, response.measured

    def _fading(self, n: int) -> FloatArray:
        """What is left in PV of the time before the test."""
        if not self.x_now:
            return np.zeros(n)
        linear = self.model.linear
        return self.x_now * (linear.gain - linear.step_response(n))

    @cached_property
    def linear(self) -> LinearModel:
        """Linear part with the right slope in it, as the likelihood has it."""
        return self.model.linear.scaled(self.zone.right_slope)

    @cached_property
    def structure(self) -> Structure:
        """Orders, all rows used."""
        linear, p = self.linear, self.noise.order
        return Structure(len(linear.a), len(linear.b) - 1, linear.delay, p, linear.delay + p)

    @cached_property
    def theta(self) -> FloatArray:
        """True parameter vector of one segment that starts at rest."""
        zone, linear = self.zone, self.linear
        a, b = np.array(linear.a), np.array(linear.b)
        c = np.zeros(self.structure.initial)
        if self.x_now:
            x = self.x_now / zone.right_slope
            for i in range(c.size):
                c[i] = x * b[i + 1 :].sum() - linear.gain * x * a[i:].sum()
        eta = [zone.left, zone.right, np.log(zone.left_slope / zone.right_slope)]
        return np.concatenate([a, b, [self.model.offset], eta, self.noise.d, c])

    def problem(self, u: FloatArray, y: FloatArray | None, segments: IntArray | None = None) -> Problem:
        """Likelihood of OP u (n,) and PV y; in open loop y is not needed."""
        rows = np.array([[0, u.size]]) if segments is None else segments
        return Problem(u, u if y is None else y, rows, DeadZoneFamily(-np.inf, np.inf), self.structure)


@functools.lru_cache(maxsize=64)
def noise_samples(noise: NoiseModel, n: int, seed: int) -> FloatArray:
    """Stationary output noise, shape (n,), read-only."""
    slowest = max((abs(pole) for pole in np.roots([1.0, *noise.d])), default=0.0)
    before = 0 if slowest == 0 else min(int(MEMORIES / -np.log(min(slowest, 0.9999))) + 10, 100_000)
    white = np.random.default_rng(seed).normal(scale=np.sqrt(noise.variance), size=n + before)
    samples = np.asarray(lfilter([1.0], [1.0, *noise.d], white))[before:]
    samples.setflags(write=False)
    return samples
