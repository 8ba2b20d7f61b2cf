"""What the network sees of a record: the twin on the GPU of ``lostmotion.diagnose.waveform``, and its disturbing."""

from __future__ import annotations

import torch
from torch.nn.functional import interpolate

from waveform.loops import Loops, Tensor, chance, logarithmic

A_CYCLE, CYCLES = 32, 8  # values a cycle, cycles in a window
SIZE = A_CYCLE * CYCLES
FEWEST = 3.5  # cycles in a record
FASTEST = 8  # samples a cycle
SLOWEST = 3  # cycles in a record
LARGEST = 5.0  # standard deviations


def kept(loops: Loops) -> tuple[Tensor, Tensor]:
    """OP and PV as a historian keeps them: every first, second or fourth sample, often cut short and rounded."""
    every = [1, 2, 4][int(torch.randint(0, 3, (1,)))]
    op, pv = loops.op[:, ::every], loops.pv[:, ::every]
    if float(torch.rand(1)) < 0.5:
        length = int(op.shape[1] * (0.3 + 0.7 * float(torch.rand(1))))
        op, pv = op[:, :length], pv[:, :length]
    return _rounded(op, 0.15, 0.3), _rounded(pv, 0.25, 0.6)


def _rounded(x: Tensor, share: float, coarsest: float) -> Tensor:
    n, device = len(x), str(x.device)
    step = (x.std(1) * logarithmic(n, 0.02, coarsest, device)).clamp(min=1e-7)
    step = torch.where(chance(n, share, device), step, torch.full_like(step, 1e-9)).double()[:, None]
    return (torch.round(x.double() / step) * step).float()


def examples(loops: Loops) -> tuple[Tensor, Tensor, Tensor]:
    """One window of each loop, whether its process integrates as far as is known, and its cause."""
    op, pv = kept(loops)
    n, samples, device = len(op), op.shape[1], op.device
    period = torch.nan_to_num(period_of(op, pv), nan=1.0, posinf=1.0).clamp(1.0, float(samples))
    start = (torch.rand(n, device=device) * (samples - (samples / period).clamp(max=CYCLES) * period)).clamp(min=0.0)
    period = period * (1.0 + 0.08 * torch.randn(n, device=device)).clamp(0.7, 1.3)
    shown = (period >= FASTEST / 2) & (samples / period >= FEWEST)
    level = torch.where(chance(n, 0.9, str(device)), loops.integrating.float(), torch.zeros(n, device=device))
    return window(op, pv, start, period)[shown], level[shown], loops.cause[shown]


def period_of(op: Tensor, pv: Tensor) -> Tensor:
    """Period in samples of the largest peak of the power per octave of both signals together."""
    samples, power = op.shape[1], 0.0
    taper = torch.hann_window(samples, periodic=False, device=op.device)
    line = torch.linspace(-1.0, 1.0, samples, device=op.device)
    highest = max(SLOWEST + 2, samples // FASTEST)
    for signal in (op, pv):
        level = signal - signal.mean(1, keepdim=True)
        x = level - line * ((level * line).sum(1, keepdim=True) / (line * line).sum())
        octave = torch.fft.rfft(x * taper).abs() ** 2 * torch.arange(samples // 2 + 1, device=op.device)
        power = power + octave / (octave[:, SLOWEST:highest].sum(1, keepdim=True) + 1e-30)
    smooth = power.clone()
    smooth[:, 1:-1] = (power[:, :-2] + 2.0 * power[:, 1:-1] + power[:, 2:]) / 4.0
    at = smooth[:, SLOWEST:highest].argmax(1) + SLOWEST
    left, middle, right = (smooth.gather(1, (at + k)[:, None])[:, 0] for k in (-1, 0, 1))
    return samples / (at + (0.5 * (left - right) / (left - 2.0 * middle + right - 1e-30)).clamp(-0.5, 0.5))


def window(op: Tensor, pv: Tensor, start: Tensor, period: Tensor) -> Tensor:
    """OP, PV and which values are inside of the record; shape (windows, 3, SIZE)."""
    (a, inside), (b, _) = _means(op, start, period), _means(pv, start, period)
    return torch.stack([standard(a, inside), standard(b, inside), inside.float()], 1)


def _means(x: Tensor, start: Tensor, period: Tensor) -> tuple[Tensor, Tensor]:
    """Mean around every point of the window, over its step or one sample."""
    samples = x.shape[1]
    total = torch.cat([torch.zeros(len(x), 1, device=x.device), torch.cumsum(x.double(), 1)], 1)
    step = (period / A_CYCLE).double()[:, None]
    at = start[:, None] + (torch.arange(SIZE, device=x.device) + 0.5) * step
    half = (step / 2.0).clamp(min=0.5)

    def until(t: Tensor) -> Tensor:
        t = torch.nan_to_num(t).clamp(0.0, float(samples))
        whole = t.floor().clamp(max=samples - 1)
        low, high = total.gather(1, whole.long()), total.gather(1, whole.long() + 1)
        return low + (high - low) * (t - whole)

    inside = (at + half <= samples) & (at - half >= 0.0)
    return ((until(at + half) - until(at - half)) / (2.0 * half)).float(), inside


def standard(x: Tensor, inside: Tensor) -> Tensor:
    """Without its line, in standard deviations, 0 outside of the record."""
    mask = inside.float()
    count = mask.sum(1, keepdim=True).clamp(min=1.0)
    line = torch.linspace(-1.0, 1.0, x.shape[1], device=x.device) * mask
    line = (line - line.sum(1, keepdim=True) / count) * mask
    x = (x - (x * mask).sum(1, keepdim=True) / count) * mask
    x = x - line * ((x * line).sum(1, keepdim=True) / (line * line).sum(1, keepdim=True).clamp(min=1e-9))
    deviation = ((x * x).sum(1, keepdim=True) / count).sqrt().clamp(min=1e-9)
    return (x / deviation).clamp(-LARGEST, LARGEST) * mask


def disturbed(windows: Tensor) -> Tensor:
    """What real records have and simulated ones lack: periods and sizes that wander, more drift, noise, either sign."""
    n, device = len(windows), windows.device

    def seldom(share: float) -> Tensor:
        return (torch.rand(n, 1, 1, device=device) < share).float()

    def slow(channels: int, turns: int) -> Tensor:
        at = torch.randn(n, channels, turns + 3, device=device)
        return interpolate(at, size=SIZE, mode="linear", align_corners=True)

    sign = torch.where(torch.rand(n, 2, 1, device=device) < 0.5, 1.0, -1.0)
    windows = torch.cat([windows[:, :2] * sign, windows[:, 2:]], 1)
    clock = torch.cumsum(torch.exp(0.25 * seldom(0.5) * slow(1, 8)), 2)[:, 0]
    clock = (clock - clock[:, :1]) / (clock[:, -1:] - clock[:, :1]) * (SIZE - 1)
    whole = clock.floor().clamp(max=SIZE - 2).long()
    part = (clock - whole)[:, None]
    low, high = (windows.gather(2, (whole + k)[:, None].expand(-1, 3, -1)) for k in (0, 1))
    windows = low * (1.0 - part) + high * part
    x, mask = windows[:, :2], (windows[:, 2:] > 0.99).float()
    x = x + 0.4 * seldom(0.4) * slow(2, 3)
    x = x + 0.3 * seldom(0.4) * torch.rand(n, 2, 1, device=device) * torch.randn_like(x)
    x = x * (1.0 + 0.3 * seldom(0.3) * slow(2, 5))
    count = mask.sum(2, keepdim=True).clamp(min=1.0)
    x = x - (x * mask).sum(2, keepdim=True) / count
    x = x / ((x * x * mask).sum(2, keepdim=True) / count).sqrt().clamp(min=1e-6)
    return torch.cat([x.clamp(-LARGEST, LARGEST) * mask, mask], 1)
