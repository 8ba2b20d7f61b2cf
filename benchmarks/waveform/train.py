"""Train the network of the waveform index on simulated loops.

``python benchmarks/waveform/train.py --minutes 5.5`` on a GPU writes ``src/lostmotion/diagnose/waveform.npz``.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from pathlib import Path

import numpy as np
import torch
from torch import nn
from torch.nn.functional import cross_entropy, max_pool1d

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import itertools

from waveform.loops import STICKS, Tensor, simulate
from waveform.windows import disturbed, examples

NETWORKS = 3  # their mean counts: on real loops single ones gave Brier scores of 0.122 to 0.127
CHANNELS = (3, 10, 20, 40, 40)  # twice as wide told simulated loops better, real ones not
WIDTH, HIDDEN, CAUSES = 7, 32, 4
AT_ONCE, BATCH, TIMES = 49152, 512, 2  # loops simulated, windows of a step, uses of each window
RATE = 3e-3
TARGET = Path(__file__).resolve().parents[2] / "src" / "lostmotion" / "diagnose" / "waveform.npz"


class Network(nn.Module):
    """Four convolutions, each halving the time, the mean and largest of what is left, and two dense layers."""

    def __init__(self) -> None:
        super().__init__()
        pairs = list(itertools.pairwise(CHANNELS))
        self.convolutions = nn.ModuleList(nn.Conv1d(a, b, WIDTH, padding=WIDTH // 2) for a, b in pairs)
        self.norms = nn.ModuleList(nn.BatchNorm1d(b) for _, b in pairs)
        self.hidden = nn.Linear(2 * CHANNELS[-1] + 1, HIDDEN)
        self.out = nn.Linear(HIDDEN, CAUSES)
        self.dropout = nn.Dropout(0.2)

    def forward(self, windows: Tensor, level: Tensor) -> Tensor:
        """Logits of the causes."""
        x, mask = windows, windows[:, 2:]
        for convolution, norm in zip(self.convolutions, self.norms, strict=True):
            x, mask = max_pool1d(torch.relu(norm(convolution(x))), 2), max_pool1d(mask, 2)
        x = x * mask
        mean = x.sum(2) / mask.sum(2).clamp(min=1.0)
        seen = torch.cat([mean, x.amax(2), level[:, None]], 1)
        return self.out(self.dropout(torch.relu(self.hidden(seen))))

    def weights(self, number: int) -> dict[str, np.ndarray]:
        """As the index reads them: the norms folded into the convolutions, single precision halved."""
        found = {}
        for k, (convolution, norm) in enumerate(zip(self.convolutions, self.norms, strict=True)):
            scale = norm.weight / torch.sqrt(norm.running_var + norm.eps)
            found[f"{number}_convolution_{k}"] = convolution.weight * scale[:, None, None]
            found[f"{number}_bias_{k}"] = (convolution.bias - norm.running_mean) * scale + norm.bias
        for name, layer in (("hidden", self.hidden), ("out", self.out)):
            found[f"{number}_{name}"], found[f"{number}_{name}_bias"] = layer.weight, layer.bias
        return {name: value.detach().cpu().numpy().astype(np.float16) for name, value in found.items()}


def main() -> None:
    """Train for some minutes, telling how well loops are told that were not learned from."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=5.5)
    parser.add_argument("--device", default="cuda")
    parser.add_argument("--output", type=Path, default=TARGET)
    chosen = parser.parse_args()
    torch.manual_seed(1)
    networks = [Network().to(chosen.device) for _ in range(NETWORKS)]
    optimizers = [torch.optim.AdamW(one.parameters(), RATE, weight_decay=1e-3) for one in networks]
    unseen = examples(simulate(AT_ONCE, chosen.device))
    begun, rounds = time.monotonic(), 0
    while (spent := (time.monotonic() - begun) / (60.0 * chosen.minutes)) < 1.0:
        for optimizer in optimizers:
            optimizer.param_groups[0]["lr"] = 0.5 * RATE * (1.0 + math.cos(math.pi * spent)) + 1e-5
        _learn(networks, optimizers, examples(simulate(AT_ONCE, chosen.device)))
        rounds += 1
        if rounds % 10 == 0:
            print(f"{spent:4.0%} {_area(networks, unseen):.3f} area of unseen simulated loops", flush=True)
    print(f"{rounds} rounds of {AT_ONCE} loops; area {_area(networks, unseen):.3f}")
    weights = [one.weights(number) for number, one in enumerate(networks)]
    np.savez_compressed(chosen.output, **{name: value for each in weights for name, value in each.items()})


def _learn(networks: list[Network], optimizers: list[torch.optim.Optimizer], seen: tuple[Tensor, ...]) -> None:
    windows, level, cause = seen
    for _ in range(TIMES):
        order = torch.randperm(len(windows), device=windows.device)
        for start in range(0, len(order), BATCH):
            rows = order[start : start + BATCH]
            x = disturbed(windows[rows])
            for network, optimizer in zip(networks, optimizers, strict=True):
                optimizer.zero_grad()
                cross_entropy(network(x, level[rows]), cause[rows]).backward()
                optimizer.step()


@torch.no_grad()
def _area(networks: list[Network], unseen: tuple[Tensor, ...], most: int = 6000) -> float:
    """Area under the curve of sticking against the rest."""
    windows, level, cause = (x[:most] for x in unseen)
    odds = torch.zeros(len(windows), device=windows.device)
    for network in networks:
        network.eval()
        logits = network(windows, level)
        odds += logits[:, STICKS] - torch.logsumexp(logits[:, STICKS + 1 :], 1)
        network.train()
    sticks = cause == STICKS
    return float((odds[sticks][:, None] > odds[~sticks]).float().mean())


if __name__ == "__main__":
    main()
