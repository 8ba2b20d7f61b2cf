"""Supervisor of a compensating block: asks, reads back, waits for the operator, and keeps the heartbeat.

The states are those of NAMUR NE 178, verification of request: requested (written), verified (the PLC has checked it and
shows exactly what was asked), accepted (the operator's word, in the PLC); or refused. Nothing is queued and nothing is
repeated: where a write fails, or nobody knows whether it arrived, the request is over, and the block sheds what it had
if the heartbeat cannot get through either. Time for decisions is monotonic; the wall clock only stamps the log.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from lostmotion.arguments import positive
from lostmotion.compensate.request import LARGEST, Request
from lostmotion.compensate.supervised import SupervisedBlock
from lostmotion.compensate.supervision_variables import REASONS, REFUSALS, STATES
from lostmotion.errors import GateError
from lostmotion.evaluate import CompensationStudy
from lostmotion.live.audit_log import AuditLog
from lostmotion.live.link import Link, LinkError
from lostmotion.live.proposal import Proposal, proposal

READ = (
    "supervision", "refusal", "shed_reason", "waiting", "link_ok", "heartbeat", "request_id", "echo_id", "echo_factor",
    "echo_first", "echo_second", "force_id", "force_factor", "force_first", "force_second",
)  # fmt: skip
UNDER_WAY = ("requested", "verified")
BEATS = 1_000_000
EXTRA = 2.0  # times the scans that an answer takes, before it is too late


@dataclass(frozen=True)
class Report:
    """What one cycle saw: state of the request, of the block in words, and why, where something was lost."""

    request: str
    block: str
    reason: str
    seen: Mapping[str, float]


class Supervisor:
    """One block behind one link; :meth:`cycle` is called some times within the block's time-out.

    Parameters
    ----------
    block : SupervisedBlock
        As it was commissioned: what it is in the PLC.
    link : Link
    log : AuditLog
    name : str
        Of the block in the PLC, for the log.
    write : bool
        False, as everywhere by default: nothing is written, not even a heartbeat.
    least_interval : float
        Seconds from one request to the next; the block has an interval of its own besides.
    least_change : float
        Units of OP: by less than this no width is asked to change. 0: any change is asked for.
    answer_within : float
        Seconds in which the block must show a request.
    clock : callable
        Seconds, monotonic.

    Examples
    --------
    See ``docs/supervised.md``.
    """

    def __init__(
        self,
        block: SupervisedBlock,
        link: Link,
        log: AuditLog,
        *,
        name: str,
        write: bool = False,
        least_interval: float = 3600.0,
        least_change: float = 0.0,
        answer_within: float = 10.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.block, self.link, self.log, self.name, self.write = block, link, log, name, write
        self.least_interval = positive("least_interval", least_interval)
        self.least_change = least_change
        self.answer_within = positive("answer_within", answer_within)
        self.clock = clock
        self.request: Request | None = None
        self.state = "idle"
        self._who = name
        self._asked_at: float | None = None
        self._force_id: int | None = None
        self._withdrawn: int | None = None

    def propose(self, study: CompensationStudy, who: str) -> Request:
        """Ask the block for the widths that `study` has passed; once, now.

        Raises
        ------
        GateError
            Not allowed to write, not passed, a request under way, too soon after the last, too small a change, or the
            block is not ready.
        LinkError
            It did not get through, or nobody knows: the request is over.
        FileAccessError
            The log cannot be written: nothing was sent.
        """
        asked = proposal(self.block, study)
        now = self.clock()
        self._refuse_early(now)
        seen = self.link.read(READ)
        self._refuse_unready(seen, asked)
        last = max(int(seen["echo_id"]), 0 if self.request is None else self.request.id)
        if last >= LARGEST:
            raise GateError.expected(f"ids below {LARGEST}", last, "restart the block in the PLC: its ids begin anew")
        request = Request(last + 1, asked.factor, asked.first, asked.second, int(self.block.settings["block_key"]))
        self.request, self.state, self._who, self._asked_at = request, "failed", who, now
        old = {name: seen[f"force_{name}"] for name in ("id", "factor", "first", "second")}
        self._note("request", "about to be sent", old=old, new=asked.to_dict(), study=asked.study)
        self._send(request.values)
        self.state = "requested"
        return request

    def withdraw(self, who: str, why: str = "withdrawn") -> None:
        """Take a request back that nobody has accepted yet."""
        if self.state in UNDER_WAY:
            self._who = who
            self._drop("withdrawn", why)

    def cycle(self) -> Report:
        """Read, follow the request, beat. A link that fails ends a request that is under way; nothing is repeated.

        Raises
        ------
        LinkError
            The block cannot be read or the heartbeat not written: it will shed by itself.
        """
        try:
            seen = self.link.read(READ)
        except LinkError as error:
            if self.state in UNDER_WAY:
                self.state = "failed"
                self._note("lost", str(error))
            raise
        if self.write:
            self._follow(seen)
            self._watch(seen)
            beat = int(seen["heartbeat"]) + 1 if 0 <= seen["heartbeat"] < BEATS else 0
            self.link.write({"heartbeat": beat})
        shown = STATES[int(seen["supervision"])]
        return Report(self.state, shown, REASONS[int(seen["shed_reason"])], dict(seen))

    def _refuse_early(self, now: float) -> None:
        if not self.write:
            raise GateError.expected("a block with write = true", "write = false", "a person sets it, for each block")
        if self.state in UNDER_WAY:
            raise GateError.expected("no request under way", self.state, "wait for its answer, or withdraw it")
        if self._asked_at is not None and now - self._asked_at < self.least_interval:
            got = f"{now - self._asked_at:.0f} s"
            raise GateError.expected(f"{self.least_interval:g} s since the last request", got, "nothing is queued")

    def _refuse_unready(self, seen: Mapping[str, float], asked: Proposal) -> None:
        if not seen["link_ok"]:
            raise GateError.expected("a block that sees the heartbeat", "link_ok false", "call cycle() first")
        if seen["waiting"]:
            raise GateError.expected(
                "a block without a waiting request", f"id {seen['echo_id']:g}", "wait, or withdraw"
            )
        unit = self.block.settings["resolution"]
        present = (seen["force_factor"], seen["force_first"], seen["force_second"])
        changes = [abs(now - unit * new) for now, new in zip(present, asked.to_dict().values(), strict=True)]
        if seen["force_id"] and max(changes[1:]) < max(self.least_change, unit / 2) and changes[0] < unit / 2:
            got = f"{max(changes[1:]):g}"
            raise GateError.expected(f"a width that changes by {self.least_change:g}", got, "leave it as it is")

    def _follow(self, seen: Mapping[str, float]) -> None:
        """State of the request that is under way."""
        if self.request is None or self.state not in UNDER_WAY or self._asked_at is None:
            return
        mine = int(seen["echo_id"]) == self.request.id and int(seen["request_id"]) == self.request.id
        if int(seen["force_id"]) == self.request.id:
            self.state = "accepted"
            self._note("accept", "accepted by the operator", new=self.request.to_dict())
        elif not mine:
            if self.state == "verified" or self.clock() - self._asked_at > self.answer_within:
                self._drop("failed", "another id, or none, stands in the block")
        elif seen["refusal"]:
            self.state = "refused"
            self._note("refusal", REFUSALS[int(seen["refusal"])], new=self.request.to_dict())
        elif not seen["waiting"]:
            self._drop("failed", "neither waiting nor in force: the block has begun anew")
        elif any(int(seen[f"echo_{name}"]) != getattr(self.request, name) for name in ("factor", "first", "second")):
            self._drop("failed", "the block shows something else than was asked")
        elif self.state == "requested":
            self.state = "verified"
            self._note("verify", "shown as asked, waits for the operator", new=self.request.to_dict())

    def _watch(self, seen: Mapping[str, float]) -> None:
        """Note what is in force when that changes, and withdraw a request that nobody follows.

        It is one of a supervisor before this one, one that arrived after it was given up, or another hand's.
        """
        force = int(seen["force_id"])
        if self._force_id is not None and force != self._force_id and not force:
            self._note("shed", REASONS[int(seen["shed_reason"])], old={"id": self._force_id})
        if self._force_id is None:
            self._note("begin", f"found {STATES[int(seen['supervision'])]}", old={"id": force})
        self._force_id = force
        waiting = int(seen["echo_id"])
        if seen["waiting"] and self.state not in UNDER_WAY and waiting != self._withdrawn:
            self._withdrawn = waiting  # once: it is gone with the next scan, or somebody looks
            self._note("withdraw", "about to be sent: found waiting", old={"id": waiting})
            self.link.write({"request_id": 0})

    def _drop(self, state: str, why: str) -> None:
        """End a request: the block forgets it."""
        self.state, self._withdrawn = state, None if self.request is None else self.request.id
        self._note("withdraw", f"about to be sent: {why}", new=None if self.request is None else self.request.to_dict())
        self._send({"request_id": 0})

    def _send(self, values: Mapping[str, int]) -> None:
        """Write in order, the id last and by itself; what fails is noted and never tried again."""
        numbers = {name: value for name, value in values.items() if name != "request_id"}
        try:
            if numbers:
                self.link.write(numbers)
            self.link.write({"request_id": values["request_id"]})
        except LinkError as error:
            self.state = "failed"
            self._note("failed", str(error))
            raise

    def _note(self, event: str, answer: str, **facts: Any) -> None:
        number = None if self.request is None else self.request.id
        self.log.line(who=self._who, block=self.name, event=event, answer=answer, id=number, **facts)
