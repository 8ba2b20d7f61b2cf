"""Many loops in one process: the network in the event loop, the estimators beside it."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from threading import Event

import numpy as np

from lostmotion.errors import LostMotionError
from lostmotion.identify import RecursiveML
from lostmotion.live.loop_source import LoopSource
from lostmotion.online.service import Service

TURN = 0.25  # s between turns of a loop
SAVE = 60.0  # s between states, where nothing is reported
LOOK = 0.05  # s between looks


@dataclass(eq=False)
class Watched:
    """A loop in service.

    Attributes
    ----------
    source : LoopSource
    service : Service
        Of that source.
    """

    source: LoopSource
    service: Service
    due: float = 0.0
    saved: float = field(default_factory=time.monotonic)
    failure: LostMotionError | None = None

    @property
    def heavy(self) -> bool:
        """Whether the next rows may begin the estimate, which fits a whole window."""
        monitor = self.service.monitor
        if monitor is None or monitor.estimator.started:
            return False
        every: int = getattr(monitor.estimator, "start_samples", 1)
        return self.source.waiting >= every - monitor.samples % every

    def turn(self) -> None:
        """Take all rows that are complete; what cannot go on is told once and left."""
        try:
            while self.service.turn():
                pass
            if time.monotonic() - self.saved > SAVE:
                self.service.save()
                self.saved = time.monotonic()
        except LostMotionError as error:
            self.failure = error
            self.service.emit({"kind": "failed", "message": str(error)})

    def end(self) -> None:
        """Keep what is known."""
        if self.failure is None:
            self.turn()
            self.service.save()


class Plant:
    """All loops of a link.

    Parameters
    ----------
    loops : sequence of Watched
    link : awaitable
        Feeds the sources until it is cancelled.

    Notes
    -----
    Two threads work beside the event loop, so that values are taken from the network whatever the estimators do: one
    for turns, which last a millisecond, one for first fits, which last seconds.
    """

    def __init__(self, loops: Sequence[Watched], link: Awaitable[None]) -> None:
        self.loops, self._link = loops, link
        self._busy: set[Watched] = set()
        self._fault: BaseException | None = None  # of ours: nothing may go on behind it
        self.longest_block = 0.0  # s for which the event loop came late

    async def run(self, stop: Event) -> None:
        """Work until `stop` is set, or no loop can go on."""
        link = asyncio.ensure_future(self._link)  # ends only by a fault of ours
        with ThreadPoolExecutor(1, "turns") as light, ThreadPoolExecutor(1, "first fits") as heavy:
            try:
                while not stop.is_set() and not link.done() and self._fault is None:
                    self._hand_out(light, heavy)
                    before = time.monotonic()
                    await asyncio.sleep(LOOK)
                    self.longest_block = max(self.longest_block, time.monotonic() - before - LOOK)
                    if all(loop.failure is not None for loop in self.loops):
                        break
            finally:
                link.cancel()
                with suppress(asyncio.CancelledError):
                    await link
        for loop in self.loops:
            loop.end()
        if self._fault is not None:
            raise self._fault
        if not link.cancelled():
            link.result()

    def _hand_out(self, light: ThreadPoolExecutor, heavy: ThreadPoolExecutor) -> None:
        now = time.monotonic()
        due = [loop for loop in self.loops if loop.due <= now and loop not in self._busy and loop.failure is None]
        long = [loop for loop in due if loop.heavy]
        short = [loop for loop in due if loop not in long]
        for loops, pool in [*(([one], heavy) for one in long), (short, light)]:
            if loops:
                self._busy.update(loops)
                pool.submit(self._turns, loops).add_done_callback(self._done)

    def _done(self, turns: Future[None]) -> None:
        self._fault = self._fault or turns.exception()

    def _turns(self, loops: Sequence[Watched]) -> None:
        for loop in loops:
            loop.turn()
            loop.due = time.monotonic() + TURN
            self._busy.discard(loop)


def warm() -> None:
    """Load what the estimators are compiled to, before values come: it takes seconds, the first time a minute."""
    rng = np.random.default_rng(0)
    u = np.repeat(rng.uniform(-1.0, 1.0, 60), 5)
    x = np.sign(u) * np.maximum(np.abs(u) - 0.3, 0.0)
    y = np.convolve(x, 0.5 ** np.arange(20))[: u.size] + 0.01 * rng.standard_normal(u.size)
    RecursiveML(1, 0, 0, start_samples=200).run(u, y)
