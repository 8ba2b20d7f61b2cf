"""Months of service for RecursiveML: does it stay finite, stable, honest and of constant size?

Run: ``.venv/bin/python benchmarks/endurance.py`` (10^8 samples, one thread, about 8 minutes); writes docs/endurance.md.
``benchmarks/endurance.py 1e6`` is a quick look that writes nothing.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported

import argparse  # noqa: E402
import resource  # noqa: E402
import sys  # noqa: E402
import tempfile  # noqa: E402
import time  # noqa: E402
from pathlib import Path  # noqa: E402
from typing import Any  # noqa: E402

import numpy as np  # noqa: E402

import lostmotion as lm  # noqa: E402
from pages import publish  # noqa: E402
from service import days, pages  # noqa: E402
from service.ledger import DivergedError, Ledger  # noqa: E402

OUTPUT = Path(__file__).parent.parent / "docs" / "endurance.md"
TANK = lm.platforms.level_tank()
BLOCK, PIECE = 100_000, 10_000
RESTART_EVERY = 10  # blocks
FORGETTING, EVERY = 0.9995, 1000
FULL = 100_000_000


def estimator() -> Any:
    return lm.RecursiveML(3, 2, 3, TANK.linear.gain, FORGETTING, dt=TANK.linear.dt)


class Lane:
    """One estimator in service and its checks."""

    def __init__(self, title: str, masks_repeats: bool, samples: int) -> None:
        self.title, self._masks_repeats = title, masks_repeats
        self.estimator = estimator()
        self.ledger = Ledger(days.repairs(samples))
        self.seconds = 0.0

    def block(self, block: days.Block, number: int, span: tuple[float, float]) -> None:
        """Take a block piece by piece; now and then go on from a saved state and beside it."""
        self.ledger.stuck = [*self.ledger.stuck[-10:], *block.stuck]
        use = block.use & ~days.repeats(block.y) if self._masks_repeats else block.use
        for start in range(0, BLOCK, PIECE):
            piece = slice(start, start + PIECE)
            data = (block.u[piece], block.y[piece], use[piece])
            started, before = self.estimator.started, self.estimator.to_bytes()
            twin = self.ledger.restart(self.estimator) if start == 0 and number % RESTART_EVERY == 1 else None
            trajectory = self._run(*data)
            if twin is not None:
                twin.run(*data[:2], every=EVERY, use=data[2])
                self.ledger.same(self.estimator, twin)
                self.estimator = twin
            if started:
                try:
                    self.ledger.check(self.estimator, trajectory, block, piece, span)
                except DivergedError:
                    keep(before, *data)
                    raise

    def _run(self, u: days.Array, y: days.Array, use: days.Array) -> Any:
        """One piece, timed; new events go to the ledger."""
        known = {(event.sample, event.name) for event in self.estimator.events}
        begin = time.process_time()
        trajectory = self.estimator.run(u, y, every=EVERY, use=use)
        self.seconds += time.process_time() - begin
        self.ledger.note_events([new for new in self.estimator.events if (new.sample, new.name) not in known])
        return trajectory

    def __str__(self) -> str:
        estimate = self.estimator.estimate
        zone = " .. ".join(f"{estimate.parameters[name]:.3f}" for name in ("left", "right"))
        return f"{zone} {estimate.status.name} {len(self.ledger.events)} events"


def serve(samples: int, seed: int) -> tuple[list[Lane], list[int]]:
    """Run all blocks through both lanes; largest resident memory in bytes after the first blocks and at the end."""
    warm = days.Service(seed + 1).block(BLOCK)  # compiles
    estimator().run(warm.u, warm.y, use=warm.use)
    lanes = [Lane("record as it is", False, samples), Lane("a PV equal to the last one masked", True, samples)]
    service, span, memory = days.Service(seed), (np.inf, -np.inf), [0, 0]
    for number in range(samples // BLOCK):
        block = service.block(BLOCK)
        seen = block.u[np.isfinite(block.u) & block.use]
        span = (min(span[0], seen.min()), max(span[1], seen.max()))
        for lane in lanes:
            lane.block(block, number, span)
        used = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        memory = [used, used] if number < 2 * RESTART_EVERY else [memory[0], used]
        if number % max(samples // BLOCK // 50, 1) == 0:
            print(f"{(number + 1) * BLOCK:>12,} samples:", *lanes, sep="   ", flush=True)
    return lanes, memory


def keep(before: bytes, u: days.Array, y: days.Array, use: days.Array) -> None:
    """Store what is needed to see a failed check again."""
    path = Path(tempfile.gettempdir()) / "endurance-failure.npz"
    np.savez(path, state=np.frombuffer(before, dtype=np.uint8), u=u, y=y, use=use)
    print(f"state before the failed piece, and the piece: {path}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("samples", type=float, nargs="?", default=FULL)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    if not hasattr(lm, "RecursiveML"):
        print("lostmotion has no RecursiveML yet")
        return 1
    samples = int(arguments.samples)
    lanes, memory = serve(samples, arguments.seed)
    text = pages.page(samples, arguments.seed, lanes, memory)
    print(text)
    if samples >= FULL:
        publish(OUTPUT, text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
