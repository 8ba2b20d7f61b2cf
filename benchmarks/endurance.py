"""Months of service for RecursiveML: does it stay finite, stable, honest and of constant size?

Run: ``.venv/bin/python benchmarks/endurance.py`` (10^8 samples, one thread, some minutes); writes docs/endurance.md.
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


class Run:
    """The estimator in service, its checks, and what is reported of it."""

    def __init__(self, samples: int, seed: int) -> None:
        self.samples, self.seed = samples, seed
        self.service = days.Service(seed)
        warm = days.Service(seed + 1).block(BLOCK)  # compiles
        estimator().run(warm.u, warm.y, use=warm.use)
        self.estimator: Any = estimator()
        self.ledger = Ledger(days.repairs(samples))
        self.seconds, self.span = 0.0, (np.inf, -np.inf)
        self.memory = [0, 0]  # largest resident memory in bytes, after the first blocks and at the end

    def all(self) -> None:
        """Go through all blocks."""
        for number in range(self.samples // BLOCK):
            self._block(number)
            used = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            self.memory = [used, used] if number < 2 * RESTART_EVERY else [self.memory[0], used]
            if number % max(self.samples // BLOCK // 50, 1) == 0:
                self._say(number)

    def _block(self, number: int) -> None:
        block = self.service.block(BLOCK)
        self.ledger.stuck = [*self.ledger.stuck[-10:], *block.stuck]
        seen = block.u[np.isfinite(block.u) & block.use]
        self.span = (min(self.span[0], seen.min()), max(self.span[1], seen.max()))
        for start in range(0, BLOCK, PIECE):
            piece = slice(start, start + PIECE)
            twin, started, before = None, self.estimator.started, self.estimator.to_bytes()
            if start == 0 and number % RESTART_EVERY == 1:
                twin = self.ledger.restart(self.estimator)
            trajectory = self._run(self.estimator, block, piece)
            if twin is not None:
                self._run(twin, block, piece)
                self.ledger.same(self.estimator, twin)
                self.estimator = twin
            if started:
                try:
                    self.ledger.check(self.estimator, trajectory, block, piece, self.span)
                except DivergedError:
                    keep(before, block, piece)
                    raise

    def _run(self, one: Any, block: days.Block, piece: slice) -> Any:
        """One piece, timed; new events are told to the ledger by the estimator that goes on."""
        known = {id_of(event) for event in one.events}
        begin = time.process_time()
        trajectory = one.run(block.u[piece], block.y[piece], every=EVERY, use=block.use[piece])
        if one is self.estimator:
            self.seconds += time.process_time() - begin
            self.ledger.note_events([event for event in one.events if id_of(event) not in known])
        return trajectory

    def _say(self, number: int) -> None:
        estimate = self.estimator.estimate
        width = " .. ".join(f"{estimate.parameters[name]:.3f}" for name in ("left", "right"))
        print(
            f"{(number + 1) * BLOCK:>12,} samples  {width}  {estimate.status.name}  {len(self.ledger.events)} events  "
            f"{1e9 * self.seconds / ((number + 1) * BLOCK):.0f} ns a sample",
            flush=True,
        )


def keep(before: bytes, block: days.Block, piece: slice) -> None:
    """Store what is needed to see a failed check again."""
    path = Path(tempfile.gettempdir()) / "endurance-failure.npz"
    state = np.frombuffer(before, dtype=np.uint8)
    np.savez(path, state=state, u=block.u[piece], y=block.y[piece], use=block.use[piece])
    print(f"state before the failed piece, and the piece: {path}")


def id_of(event: Any) -> tuple[int, str]:
    return event.sample, event.name


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("samples", type=float, nargs="?", default=FULL)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    if not hasattr(lm, "RecursiveML"):
        print("lostmotion has no RecursiveML yet")
        return 1
    run = Run(int(arguments.samples), arguments.seed)
    run.all()
    text = pages.page(run.samples, run.seed, run.ledger, run.seconds, run.memory)
    print(text)
    if run.samples >= FULL:
        OUTPUT.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
