"""Does it look as if the valve stuck? A small neural network's opinion of the trend of OP and PV, without a model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import as_file, files

import numpy as np
import numpy.typing as npt
import scipy.fft

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.filters import standard_signal
from lostmotion.errors import DataError

LEAST = 64  # samples
A_CYCLE, CYCLES = 32, 8  # values a cycle, cycles in a window
SIZE = A_CYCLE * CYCLES
FASTEST = 8  # samples a cycle
SLOWEST = 3  # cycles in a record
LARGEST = 5.0  # standard deviations
MOST_WINDOWS = 12  # spread over the record
NETWORKS, LAYERS = 3, 4
SIGNS = ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0))  # neither the action nor the direction matters

Single = npt.NDArray[np.float32]


@dataclass(frozen=True)
class Waveform:
    """What the network says.

    Attributes
    ----------
    log_odds : float
        Of a valve that sticks against none, in the mixture of simulated loops that it was trained on: about half of
        them stick. On real loops it is worth less than it claims; `lostmotion.diagnose` weighs it by what it is worth.
    period : float
        In samples: of what was taken for a cycle.
    windows : int
        Of eight cycles, that were looked at.
    """

    log_odds: float
    period: float
    windows: int


def waveform_index(op: FloatArray, pv: FloatArray, integrating: bool = False) -> Waveform:
    """Log-odds that the valve sticks, from the form of OP and PV alone.

    Parameters
    ----------
    op, pv : ndarray, shape (n,)
        Finite, uniformly sampled, in any units and with any sign of the process or the controller.
    integrating : bool
        Whether the process is known to integrate (a level).

    Returns
    -------
    Waveform
        The odds of every window, its signs both ways, and three networks, averaged as logarithms.

    Raises
    ------
    DataError
        Fewer than 64 samples, another number of PV, or a constant.

    Notes
    -----
    A window is eight cycles of the strongest swing (largest power per octave of both signals together), 32 means a
    cycle, each signal without its line and in standard deviations. The networks (four convolutions, 21,000 numbers
    each) were trained on 2.5 million simulated loops (``benchmarks/waveform``): valves that stick (He et al. 2007, "A
    curve fitting method for detecting valve stiction in oscillating control loops", Ind. Eng. Chem. Res. 46) or do
    not, tight tuning, swings from outside in four forms, drift, steps, rounding; no real record was among them. Neural
    networks for this: Amiruddin et al. (2019), "Valve stiction detection through improved pattern recognition using
    neural networks", Control Eng. Practice 90; convolutional ones: Kamaruddin et al. (2020), J. Process Control 87.

    Examples
    --------
    >>> t = np.arange(2000) / 50
    >>> square, triangle = np.sign(np.sin(2 * np.pi * t)), np.arcsin(np.sin(2 * np.pi * t - np.pi / 2))
    >>> waveform_index(triangle, square).log_odds > 2.0 > -2.0 > waveform_index(np.sin(6 * t), np.cos(6 * t)).log_odds
    True
    """
    op, pv = standard_signal("op", op, LEAST), standard_signal("pv", pv, LEAST)
    if op.size != pv.size:
        raise DataError.expected(f"{op.size} samples of pv, as of op", pv.size, "pass both of the same rows")
    period = _period(op, pv)
    windows = _windows(op, pv, period)
    odds = [_log_odds(network, windows, integrating) for network in _networks()]
    return Waveform(float(np.mean(odds)), period, len(windows))


def _period(op: FloatArray, pv: FloatArray) -> float:
    """Of the largest peak of the power per octave of both signals together, in samples."""
    octave = _power_per_octave(op) + _power_per_octave(pv)
    smooth = octave.copy()
    smooth[1:-1] = (octave[:-2] + 2.0 * octave[1:-1] + octave[2:]) / 4.0
    at = int(np.argmax(smooth[SLOWEST : _highest(op.size)])) + SLOWEST
    left, middle, right = smooth[at - 1 : at + 2]
    shift = 0.5 * (left - right) / (left - 2.0 * middle + right - 1e-30)
    return float(op.size / (at + np.clip(shift, -0.5, 0.5)))


def _highest(samples: int) -> int:
    """Cycles in a record, up to which a cycle has a form."""
    return max(SLOWEST + 2, samples // FASTEST)


def _power_per_octave(x: FloatArray) -> FloatArray:
    line = np.linspace(-1.0, 1.0, x.size)
    level = x - x.mean()
    still = level - line * (level @ line / (line @ line))
    octave = np.abs(scipy.fft.rfft(still * np.hanning(x.size))) ** 2 * np.arange(x.size // 2 + 1)
    return np.asarray(octave / (octave[SLOWEST : _highest(x.size)].sum() + 1e-30))


def _windows(op: FloatArray, pv: FloatArray, period: float) -> Single:
    """OP, PV and which values are inside of the record; shape (windows, 3, SIZE)."""
    longest = min(CYCLES * period, float(op.size))
    starts = np.arange(0.0, max(1.0, op.size - longest + 1.0), CYCLES * period / 2.0)
    if len(starts) > MOST_WINDOWS:
        starts = starts[np.linspace(0, len(starts) - 1, MOST_WINDOWS).astype(int)]
    at = starts[:, None] + (np.arange(SIZE) + 0.5) * (period / A_CYCLE)
    half = max(period / A_CYCLE / 2.0, 0.5)
    inside = (at - half >= 0.0) & (at + half <= op.size)
    means = (_standard(_means(x, at, half), inside) for x in (op, pv))
    return np.stack([*means, inside.astype(np.float64)], axis=1).astype(np.float32)


def _means(x: FloatArray, at: FloatArray, half: float) -> FloatArray:
    """Of x within `half` samples around each point."""
    total = np.append(0.0, np.cumsum(x - x.mean()))
    edges = np.arange(total.size)
    return np.asarray((np.interp(at + half, edges, total) - np.interp(at - half, edges, total)) / (2.0 * half))


def _standard(x: FloatArray, inside: npt.NDArray[np.bool_]) -> FloatArray:
    """Each row without its line, in standard deviations, 0 outside of the record."""
    count = np.maximum(inside.sum(axis=1, keepdims=True), 1)
    line = np.linspace(-1.0, 1.0, x.shape[1]) * inside
    line = (line - line.sum(axis=1, keepdims=True) / count) * inside
    level = (x - (x * inside).sum(axis=1, keepdims=True) / count) * inside
    slope = (level * line).sum(axis=1, keepdims=True) / np.maximum((line**2).sum(axis=1, keepdims=True), 1e-9)
    still = level - line * slope
    deviation = np.maximum(np.sqrt((still**2).sum(axis=1, keepdims=True) / count), 1e-9)
    return np.asarray(np.clip(still / deviation, -LARGEST, LARGEST) * inside)


def _log_odds(network: Mapping[str, Single], windows: Single, integrating: bool) -> float:
    """Mean over the windows and their signs."""
    signs = np.array([(a, b, 1.0) for a, b in SIGNS], dtype=np.float32)
    x = (windows[None] * signs[:, None, :, None]).reshape(-1, *windows.shape[1:])
    mask = x[:, 2:]
    for k in range(LAYERS):
        x = _halved(np.maximum(_convolved(x, network[f"convolution_{k}"], network[f"bias_{k}"]), 0.0))
        mask = _halved(mask)
    x = x * mask
    mean = x.sum(axis=2) / np.maximum(mask.sum(axis=2), 1.0)
    level = np.full((len(x), 1), integrating, dtype=np.float32)
    hidden = np.maximum(np.hstack([mean, x.max(axis=2), level]) @ network["hidden"].T + network["hidden_bias"], 0.0)
    logits = hidden @ network["out"].T + network["out_bias"]  # sticks, tuning, outside, neither
    return float(np.mean(logits[:, 0] - np.logaddexp.reduce(logits[:, 1:], axis=1)))


def _convolved(x: Single, kernels: Single, bias: Single) -> Single:
    """Correlation with zeros around, as in networks; x of shape (windows, channels, values)."""
    width = kernels.shape[2]
    padded = np.pad(x, ((0, 0), (0, 0), (width // 2, width // 2)))
    shifted = np.lib.stride_tricks.sliding_window_view(padded, width, axis=2)  # windows, channels, values, width
    columns = shifted.transpose(0, 2, 1, 3).reshape(len(x) * x.shape[2], -1)
    out = columns @ kernels.reshape(len(kernels), -1).T + bias
    return np.asarray(out.reshape(len(x), x.shape[2], -1).transpose(0, 2, 1))


def _halved(x: Single) -> Single:
    """The larger one of every two values."""
    return np.asarray(np.maximum(x[:, :, 0::2], x[:, :, 1::2]))


@cache
def _networks() -> tuple[dict[str, Single], ...]:
    """Weights of each network by name."""
    with as_file(files("lostmotion.diagnose") / "waveform.npz") as path, np.load(path, allow_pickle=False) as kept:
        named = {name: kept[name].astype(np.float32) for name in kept.files}
    return tuple(
        {name.removeprefix(f"{k}_"): value for name, value in named.items() if name.startswith(f"{k}_")}
        for k in range(NETWORKS)
    )
