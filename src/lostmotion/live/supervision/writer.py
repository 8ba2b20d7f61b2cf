"""One block in the PLC and its supervisor, in a thread of their own: heartbeat, requests, answers."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from lostmotion.errors import InputError, LostMotionError
from lostmotion.identify import RecursiveEstimate
from lostmotion.live.audit_log import AuditLog
from lostmotion.live.link import Link, LinkError
from lostmotion.live.supervision.handed_over import Asked, Inbox
from lostmotion.live.supervision.said import Emit
from lostmotion.live.supervision.settings import BlockSettings
from lostmotion.live.supervision.studies import Running, study_of_estimate, study_of_fit
from lostmotion.live.supervision.wanted import Wish, wish
from lostmotion.live.supervisor import UNDER_WAY, Report, Supervisor

SLOWEST = 1.0  # s from beat to beat, at most an eighth of the time-out of the block
LEAVE = 10.0  # s for the last cycle: a read and a write that nobody answers
OpenLink = Callable[[], Link]


class BlockWriter:
    """Supervises one block until it is stopped.

    Parameters
    ----------
    settings : BlockSettings
    open_link : callable
        Makes the link; tried again until it can be made.
    log : AuditLog
        Of the plant.
    emit : callable
        Takes messages.
    inbox : Inbox, optional
        Where persons ask.
    clock : callable
        Seconds, monotonic.

    Notes
    -----
    There is no queue: the latest estimate takes the place of the one before, one study is under way at a time, and
    what cannot be asked now is not asked later.
    """

    def __init__(
        self,
        settings: BlockSettings,
        open_link: OpenLink,
        log: AuditLog,
        emit: Emit,
        inbox: Inbox | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.settings, self._open_link, self._log, self._emit = settings, open_link, log, emit
        self._inbox, self._clock = inbox, clock
        self.period = min(SLOWEST, settings.timeout / 8.0)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"block of {settings.tag}", daemon=True)
        self._link: Link | None = None
        self._supervisor: Supervisor | None = None
        self._estimate: RecursiveEstimate | None = None  # the latest that nobody has looked at
        self._study: Running | None = None
        self._asker = ""
        self._not_before = clock() + settings.least_interval
        self._shown: tuple[str, str, str] | None = None
        self._lost = ""
        self.failed = False

    def start(self) -> None:
        """Begin to beat."""
        self._thread.start()

    def heard(self, estimate: RecursiveEstimate) -> None:
        """Take the present estimate of the loop, from any thread."""
        if self.settings.adaptive:
            self._estimate = estimate

    def end(self) -> None:
        """Let no further beat begin: the block sheds."""
        self._stop.set()

    def wait(self) -> None:
        """Wait for the last one."""
        self._thread.join(LEAVE)

    def _run(self) -> None:
        due = time.monotonic()
        try:
            while not self._stop.wait(max(0.0, due - time.monotonic())):
                due = time.monotonic() + self.period
                self._turn()
            shed = f"the block sheds within {self.settings.timeout:g} s"
            self._note(self.settings.name, "end", f"stopped: no heartbeat from now on, {shed}")
        except BaseException as error:  # the log above all: no log, no write, and no heartbeat
            self.failed = True
            self._say("failed", f"{error}. No heartbeat from now on: the block sheds.")
            if not isinstance(error, LostMotionError):
                raise
        finally:
            if self._study is not None:
                self._study.close()
            close = getattr(self._link, "close", None)
            if close is not None:
                close()

    def _turn(self) -> None:
        """One beat, and what came since."""
        if self._supervisor is None:
            try:
                self._supervisor = self._supervised()
            except LostMotionError as error:  # nobody is there yet
                self._say_lost(str(error))
                return
        try:
            report = self._supervisor.cycle()
            self._lost = ""
            self._show(report)
            self._finish(self._supervisor)
        except LinkError as error:
            self._say_lost(str(error))
            return
        if report.seen["link_ok"]:  # not before the block sees the heartbeat: it would refuse
            self._begin(self._supervisor, report)

    def _supervised(self) -> Supervisor:
        self._link = self._open_link()
        settings = self.settings
        return Supervisor(
            settings.block, self._link, self._log, name=settings.name, write=True,
            least_interval=settings.least_interval, least_change=settings.least_change, clock=self._clock,
        )  # fmt: skip

    def _begin(self, supervisor: Supervisor, report: Report) -> None:
        """Begin a study, of what a person asks or of the latest estimate."""
        estimate, self._estimate = self._estimate, None
        asked = self._taken()
        if asked is not None:
            why = asked.why
            if not why and (self._study is not None or supervisor.state in UNDER_WAY):
                why = "another request is under way; nothing is queued"
            if why:
                self._note(asked.who, "not asked", why, ask=asked.word)
                return
            self._note(asked.who, "asked", "taken, a study begins", ask=asked.word)
            self._asker, self._study = asked.who, Running(study_of_fit, self.settings, asked.fit)
        elif estimate is not None and self._study is None and self._may_adapt(supervisor):
            self._adapt(wish(self.settings, estimate, report.seen), estimate)

    def _may_adapt(self, supervisor: Supervisor) -> bool:
        return supervisor.state not in UNDER_WAY and self._clock() >= self._not_before

    def _adapt(self, found: Wish, estimate: RecursiveEstimate) -> None:
        if found.tried is None and not found.why:
            return
        self._not_before = self._clock() + self.settings.least_interval
        if found.tried is None:
            self._note(self.settings.who, "not asked", found.why)
            return
        self._asker = self.settings.who
        self._study = Running(study_of_estimate, self.settings, estimate, found.tried)

    def _taken(self) -> Asked | None:
        if self._inbox is None:
            return None
        try:
            return self._inbox.take(self.settings.tag)
        except LostMotionError as error:
            self._note("a person", "not asked", str(error))
        return None

    def _finish(self, supervisor: Supervisor) -> None:
        """Ask for what a study that has ended allows."""
        if self._study is None or not self._study.done:
            return
        running, self._study = self._study, None
        try:
            study = running.result()
        except LostMotionError as error:
            self._note(self._asker, "not asked", str(error))
            return
        try:
            supervisor.propose(study, self._asker)
        except InputError as error:
            self._note(self._asker, "not asked", str(error))

    def _show(self, report: Report) -> None:
        now = (report.request, report.block, report.reason)
        if now != self._shown:
            self._shown = now
            lost = f", {report.reason}" if report.block == "shed" else ""
            words = f"{self.settings.name}: block {report.block}{lost}; request {report.request}."
            facts = {"block": report.block, "reason": report.reason, "request": report.request}
            self._say("block", words, **facts)

    def _say_lost(self, why: str) -> None:
        if why != self._lost:
            self._lost = why
            self._say("lost", f"{self.settings.name}: {why}")

    def _say(self, kind: str, message: str, **facts: Any) -> None:
        self._emit({"tag": self.settings.tag, "kind": kind, **facts, "message": message})

    def _note(self, who: str, event: str, answer: str, **facts: Any) -> None:
        self._log.line(who=who, block=self.settings.name, event=event, answer=answer, **facts)
