"""Loops by the ten thousand, simulated beside each other: half of them with a valve that sticks.

Everything is in samples of the controller and in units of the valve's lost motion (or of the disturbance, where there
is none), because a network that sees standardised signals knows neither. Nothing here comes from a real record.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch

STICKS, TUNING, EXTERNAL, NEITHER = range(4)
SHARES = (0.45, 0.13, 0.20, 0.22)  # of these classes
SAMPLES = 4000
SETTLING = 500  # samples left out
LONGEST = 64  # samples of dead time that the ring of past positions holds
FEWEST_SLIPS, LEAST_TRAVEL = 8, 0.15  # a valve that came loose less often shows no form

Tensor = torch.Tensor


@dataclass(frozen=True)
class Loops:
    """What the historian may keep of each loop, shape (loops, samples), and the truth, shape (loops,)."""

    op: Tensor
    pv: Tensor
    cause: Tensor
    integrating: Tensor


@dataclass(frozen=True)
class Process:
    """Two lags or an integrator with a lag, behind a dead time; each field has shape (loops,)."""

    integrating: Tensor
    gain: Tensor  # static, or per sample
    size: Tensor  # of PV for OP of size 1, within the time scale of the loop
    fast: Tensor  # pole
    slow: Tensor  # pole; 1 in an integrating process
    lag: Tensor  # samples
    delay: Tensor  # samples
    dead: Tensor  # samples of delay as the tuning counts it


def uniform(count: int, low: float, high: float, device: str) -> Tensor:
    """Uniform numbers."""
    return torch.rand(count, device=device) * (high - low) + low


def logarithmic(count: int, low: float, high: float, device: str) -> Tensor:
    """Numbers whose logarithm is uniform."""
    return torch.exp(uniform(count, math.log(low), math.log(high), device))


def chance(count: int, share: float, device: str) -> Tensor:
    """True in this share."""
    return torch.rand(count, device=device) < share


def simulate(count: int, device: str) -> Loops:
    """Draw and run loops; those that run away, do not move or whose valve hardly came loose are left out."""
    process = _process(count, device)
    cause = torch.multinomial(torch.tensor(SHARES, device=device), count, replacement=True)
    op, pv, valve = _run(process, cause, device)
    op, pv, valve = op[:, SETTLING:], pv[:, SETTLING:], valve[:, SETTLING:]
    sane = torch.isfinite(op).all(1) & torch.isfinite(pv).all(1) & (op.std(1) > 1e-4)
    sane &= (op.abs().amax(1) < 1e5) & (pv.abs().amax(1) < 1e4)
    slips, travel = (valve[:, 1:] != valve[:, :-1]).sum(1), valve.amax(1) - valve.amin(1)
    sane &= ~((cause == STICKS) & ((slips < FEWEST_SLIPS) | (travel < LEAST_TRAVEL)))
    return Loops(op[sane], pv[sane], cause[sane], process.integrating[sane])


def _process(n: int, d: str) -> Process:
    integrating = chance(n, 0.3, d)
    lag = logarithmic(n, 1.0, 60.0, d)
    second = lag * uniform(n, 0.0, 0.8, d) * chance(n, 0.7, d)
    delay = logarithmic(n, 1.0, 25.0, d).long()
    gain = torch.where(chance(n, 0.5, d), 1.0, -1.0) * logarithmic(n, 0.3, 3.0, d)
    filling = logarithmic(n, 5.0, 300.0, d)  # samples
    zero = torch.zeros(n, device=d)
    first_pole = torch.exp(-1.0 / lag)
    second_pole = torch.where(second > 0.05, torch.exp(-1.0 / second.clamp(min=0.05)), zero)
    return Process(
        integrating,
        torch.where(integrating, gain.sign() / filling, gain),
        torch.where(integrating, zero + 0.3, gain.abs()),
        torch.where(integrating, 0.3 * first_pole, first_pole),
        torch.where(integrating, zero + 1.0, second_pole),
        lag,
        delay,
        delay + second + torch.where(integrating, 0.3 * lag, zero) + 0.5,
    )


def _controller(p: Process, cause: Tensor, d: str) -> tuple[Tensor, Tensor]:
    """Gain and integral gain of a PI controller: Skogestad's rules at every pace, or near the limit of stability."""
    n = cause.numel()
    pace = p.dead * logarithmic(n, 0.4, 6.0, d) + p.dead
    gain = torch.where(p.integrating, 1.0 / (p.gain.abs() * pace), p.lag / (p.gain.abs() * pace))
    reset = torch.where(p.integrating, 4.0 * pace, torch.minimum(p.lag, 4.0 * pace)) * logarithmic(n, 0.4, 3.0, d)
    ultimate = _ultimate_gain(p, reset, d)
    tight = ultimate * uniform(n, 0.6, 1.08, d)
    gain = torch.where(cause == TUNING, tight, torch.minimum(gain, ultimate * uniform(n, 0.3, 0.9, d)))
    return gain, torch.where(chance(n, 0.95, d), gain / reset, torch.zeros(n, device=d))


def _ultimate_gain(p: Process, reset: Tensor, d: str) -> Tensor:
    """Gain of the controller at which the loop with this reset time oscillates, from its frequency response."""
    back = torch.exp(-1j * torch.logspace(-3.0, math.log10(3.0), 400, device=d))[None]
    fast, slow = p.fast[:, None], p.slow[:, None]
    integrator = torch.where(p.integrating[:, None], 1.0 / (1.0 - back), (1.0 - slow) / (1.0 - slow * back))
    response = p.gain.abs()[:, None] * (1.0 - fast) / (1.0 - fast * back) * integrator
    response = response * back ** (p.delay[:, None].float() + 1.0)
    response = response * (1.0 + 1.0 / (reset[:, None] * (1.0 - back)))
    phase = torch.angle(response)
    turns = torch.remainder(phase[:, 1:] - phase[:, :-1] + math.pi, 2.0 * math.pi) - math.pi
    crossed = torch.cumsum(torch.cat([phase[:, :1], turns], 1), 1) <= -math.pi
    at = torch.where(crossed.any(1), crossed.float().argmax(1), torch.full_like(p.delay, back.shape[1] - 1))
    return 1.0 / response.abs().gather(1, at[:, None])[:, 0].clamp(min=1e-9)


def _run(p: Process, cause: Tensor, d: str) -> tuple[Tensor, Tensor, Tensor]:
    n, zero = cause.numel(), torch.zeros(cause.numel(), device=d)
    gain, integral = _controller(p, cause, d)
    sign, sticks = p.gain.sign(), cause == STICKS
    # valve: it stays until |OP - position| > stay and then goes to OP -+ rest (He 2007); rest = stay: backlash
    jump = torch.where(chance(n, 0.25, d), zero, uniform(n, 0.0, 1.0, d) ** 1.5)
    stay, rest = (1.0 + jump) / 2.0, (1.0 - jump) / 2.0
    dead = torch.where(chance(n, 0.2, d) & (cause == NEITHER), 0.5 * logarithmic(n, 0.2, 1.0, d), zero)
    bent = torch.where(chance(n, 0.3, d), uniform(n, -0.25, 0.25, d), zero)
    bias = torch.where(sticks, 0.5 * torch.randn(n, device=d), zero)
    high, low = _limit(n, cause, d), -_limit(n, cause, d)
    # what else moves PV
    noise = logarithmic(n, 0.003, 0.4, d) * p.size
    colour = torch.where(chance(n, 0.3, d), uniform(n, 0.3, 0.9, d), zero)
    drift = logarithmic(n, 0.01, 1.0, d) * torch.where(sticks, torch.where(chance(n, 0.5, d), 0.05, 0.6), 1.0)
    memory = 1.0 - 1.0 / logarithmic(n, 5.0, 600.0, d)
    stepped, moved = chance(n, 0.25, d), chance(n, 0.2, d)  # load; set point
    every = logarithmic(n, 100.0, 1500.0, d)  # samples
    wave = _Waves(p, cause, d)
    # controller
    rate = torch.where(chance(n, 0.15, d), gain * gain / integral.clamp(min=1e-9) * uniform(n, 0.0, 0.1, d), zero)
    rate = torch.where(integral > 0.0, rate, zero)
    smooth = torch.where(chance(n, 0.3, d), uniform(n, 0.3, 0.9, d), zero)

    first, second, coloured, load, step, sp, seen, before = (zero.clone() for _ in range(8))
    position, held = zero.clone(), 0.6 * torch.randn(n, device=d)
    past, every_loop = torch.zeros(LONGEST, n, device=d), torch.arange(n, device=d)
    kept = torch.empty(3, SAMPLES, n, device=d)
    for t in range(SAMPLES):
        acting = past[(t - p.delay) % LONGEST, every_loop]
        acting = acting + bent * acting * acting.abs() / (1.0 + acting.abs()) + bias
        swing = wave.next()
        load = memory * load + drift * torch.sqrt(1.0 - memory**2) * torch.randn(n, device=d)
        if t % 20 == 0:
            step = torch.where(
                stepped & (torch.rand(n, device=d) < 20.0 / every), step + torch.randn(n, device=d), step
            )
        inside = p.gain * acting + p.gain.abs() * (load + step + torch.where(wave.outside, zero, swing))
        first = p.fast * first + (1.0 - p.fast) * inside
        second = torch.where(p.integrating, second + first, p.slow * second + (1.0 - p.slow) * first)
        coloured = colour * coloured + torch.sqrt(1.0 - colour**2) * torch.randn(n, device=d)
        pv = second + noise * coloured + torch.where(wave.outside, swing * p.gain.abs(), zero)
        seen = smooth * seen + (1.0 - smooth) * pv
        if t % 50 == 0:
            sp = torch.where(moved & (torch.rand(n, device=d) < 50.0 / every), p.size * torch.randn(n, device=d), sp)
        error = (sp - seen) * sign
        wanted = gain * error + held - rate * sign * (seen - before)
        before = seen
        op = torch.maximum(torch.minimum(wanted, high), low)
        held = held + torch.where(wanted == op, integral * error, zero)
        away = op - position
        slipped = torch.where(away.abs() > stay, op - away.sign() * rest, position)
        position = torch.where(sticks, slipped, op - torch.maximum(torch.minimum(op, dead), -dead))
        past[t % LONGEST] = position
        kept[0, t], kept[1, t], kept[2, t] = op, seen, position
    return kept[0].T, kept[1].T, kept[2].T


def _limit(n: int, cause: Tensor, d: str) -> Tensor:
    """Of OP: seldom near, but where a loop is to swing by its tuning."""
    far = torch.where(chance(n, 0.12, d), logarithmic(n, 0.3, 5.0, d), logarithmic(n, 20.0, 60.0, d))
    return torch.where(cause == TUNING, logarithmic(n, 1.0, 6.0, d), far)


class _Waves:
    """A swing from outside: sine, square, triangle or lopsided, rounded by a lag, its period wandering."""

    def __init__(self, p: Process, cause: Tensor, d: str) -> None:
        n, self.device = cause.numel(), d
        swings = (cause == EXTERNAL) | (chance(n, 0.08, d) & (cause == STICKS))
        self.period = (4.0 * math.pi * (p.dead + 1.0) * logarithmic(n, 0.4, 6.0, d)).clamp(8.0, 900.0)  # samples
        self.form = torch.randint(0, 4, (n,), device=d)
        size = logarithmic(n, 0.5, 3.0, d) * torch.where(cause == EXTERNAL, 1.0, 0.4)
        self.size = torch.where(swings, size, torch.zeros(n, device=d))
        self.wander = 3.0 * logarithmic(n, 0.0005, 0.03, d)
        self.round = torch.exp(-1.0 / (self.period * uniform(n, 0.01, 0.15, d)))
        self.outside = chance(n, 0.6, d) & ~p.integrating  # added to PV, not to the load
        self.phase = uniform(n, 0.0, 2.0 * math.pi, d)
        self.value = torch.zeros(n, device=d)

    def next(self) -> Tensor:
        """The swing at the next sample."""
        step = 1.0 + self.wander * torch.randn(self.phase.numel(), device=self.device)
        self.phase = self.phase + 2.0 * math.pi / self.period * step
        sine = torch.sin(self.phase)
        form = torch.where(
            self.form == 0, sine, torch.where(self.form == 1, sine.sign(), 2.0 / math.pi * torch.asin(sine))
        )
        form = torch.where(self.form == 3, sine + 0.4 * torch.sin(2.0 * self.phase + 1.0), form)
        self.value = self.round * self.value + (1.0 - self.round) * form
        return self.size * self.value
