"""Many loops in one process: the network in the event loop, the estimators beside it."""

from __future__ import annotations

import asyncio
import gc
import time
from collections.abc import Awaitable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from threading import Event

from lostmotion.errors import LostMotionError
from lostmotion.live.loop_source import LoopSource
from lostmotion.online.service import Service, Take, at_once

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

    def turn(self, fit: Take | None = None) -> None:
        """Take all rows that are complete; what cannot go on is told once and left.

        Parameters
        ----------
        fit : callable, optional
            What takes rows that begin the estimate; without it they, and those behind them, are left.
        """
        try:
            while (take := fit if self.heavy else at_once) is not None and self.service.turn(take):
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
            self.turn(at_once)
            self.service.save()


class Plant:
    """All loops of a link.

    Parameters
    ----------
    loops : sequence of Watched
    link : awaitable
        Feeds the sources until it is cancelled.
    fit : callable, optional
        Takes rows that begin an estimate; default: here.

    Notes
    -----
    Two threads work beside the event loop, so that values are taken from the network whatever the estimators do: one
    for turns, which last a millisecond, one for first fits, which last a hundred times that.
    """

    def __init__(self, loops: Sequence[Watched], link: Awaitable[None], fit: Take = at_once) -> None:
        self.loops, self._link, self._fit = loops, link, fit
        self._busy: set[Watched] = set()
        self._fault: BaseException | None = None  # of ours: nothing may go on behind it
        self.longest_block = 0.0  # s for which the event loop came late

    async def run(self, stop: Event) -> None:
        """Work until `stop` is set, or no loop can go on."""
        link = asyncio.ensure_future(self._link)  # ends only by a fault of ours
        gc.collect()
        gc.freeze()  # modules are looked through no more: each time the event loop would stand still for that
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
                gc.unfreeze()
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
        long = {loop for loop in due if loop.heavy}
        short = [loop for loop in due if loop not in long]
        for loops, pool, fit in [*(([one], heavy, self._fit) for one in long), (short, light, None)]:
            if loops:
                self._busy.update(loops)
                pool.submit(self._turns, loops, fit).add_done_callback(self._done)

    def _done(self, turns: Future[None]) -> None:
        self._fault = self._fault or turns.exception()

    def _turns(self, loops: Sequence[Watched], fit: Take | None) -> None:
        for loop in loops:
            loop.turn(fit)
            loop.due = time.monotonic() + (0.0 if loop.heavy else TURN)
            self._busy.discard(loop)
