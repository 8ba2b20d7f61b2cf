"""``solve``: the whole way from a record to a compensating block, up to the first closed gate."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.compensate import CompensatorBlock
from lostmotion.compensate.gate import Closed, accepted, closed, reason_of, verdict_of
from lostmotion.diagnose import Diagnosis, diagnose
from lostmotion.diagnose.evidence_words import probability
from lostmotion.errors import GateError, InputError
from lostmotion.evaluate.rivals import Rivals
from lostmotion.evaluate.solution import Solution, Step
from lostmotion.evaluate.study import CompensationStudy, compensation_study
from lostmotion.evaluate.study.trial import SHARES
from lostmotion.identify import HammersteinFit, identify
from lostmotion.identify.actuators.kind import NO_FAULT, faults
from lostmotion.records import LoopRecord, RecordLike
from lostmotion.records.as_record import Column, as_record
from lostmotion.records.checked import CheckedRecord
from lostmotion.simulate import PI

RETUNED = "compensate and retune"
OUTSIDE = 0.05  # of the rows beyond the span, from which on it is no stray value: it has other units than OP


def solve(
    record: RecordLike,
    *,
    controller: PI | None = None,
    gain: float | None = None,
    span: tuple[float, float] | None = None,
    loop_type: str | None = None,
    integrating: bool | None = None,
    accept: str | None = None,
    retune: bool = False,
    progress: Callable[[str], None] | None = None,
    op: str | None = None,
    pv: str | None = None,
    sp: Column = None,
    time: Column = None,
    dt: float | None = None,
    **study: Any,
) -> Solution:
    """Go the whole way from a record to a compensating block: check, diagnose, identify, simulate, block.

    It stops at the first closed gate, and the result says what opens it.

    Parameters
    ----------
    record : LoopRecord, path, data frame or dict of columns
        What is no record yet is read by :func:`lostmotion.read_loop`.
    controller : PI, optional
        Of the plant. None: estimated from the record, where a PI explains the moves of OP.
    gain : float, optional
        Known static gain of the process, as in :func:`identify`.
    span : (float, float), optional
        Smallest and largest OP. None: that of the record, else 0 .. 100.
    loop_type, integrating : optional
        As in :func:`diagnose`.
    accept : str, optional
        Reason for which closed gates are passed all the same, where there is a size to compensate; the block keeps it.
    retune : bool
        The controller is retuned together with the block, where that is what the study says; the block notes the gains.
    progress : callable, optional
        Is given a line on what is done next.
    op, pv, sp, time, dt : optional
        Columns of a path, a frame or a dict where they have other names, and the sampling time in seconds where there
        is no column of times: as in :func:`lostmotion.read_loop`, which takes more.
    **study
        Further arguments of :func:`compensation_study`, e.g. `runs`, `draws`, `factor`.

    Returns
    -------
    Solution
        `outcome` is "block", "nothing wrong" or "closed".

    Raises
    ------
    ParameterError
        A reason without a word, an unknown loop type.
    DataError
        The record cannot be identified at all.

    Examples
    --------
    >>> from lostmotion.records import LoopRecord
    >>> found = solve(LoopRecord(np.full(300, 42.0), np.arange(300) % 7, dt=1.0))
    >>> found.outcome, found.closed.name, found.closed.said
    ('closed', 'check', 'OP is constant (42).')
    """
    reason_of(accept)
    record = as_record(record, op=op, pv=pv, sp=sp, time=time, dt=dt)
    way = _Way(record, accept, progress or _silent, gain, integrating)
    way.check(span or record.op_span)
    if way.open:
        way.diagnose(loop_type)
    if way.open:
        way.identify()
    if way.open:
        way.simulate(controller, span, study, retune=retune)
    if way.open:
        way.block()
    return way.solution


def _outside(op: FloatArray, span: tuple[float, float]) -> float:
    """Share of the rows."""
    known = op[np.isfinite(op)]
    return float(np.mean((known < span[0]) | (known > span[1]))) if known.size else 0.0


def _silent(line: str) -> None: ...


@dataclass
class _Way:
    """How far it went."""

    record: LoopRecord
    accept: str | None
    tell: Callable[[str], None]
    gain: float | None
    integrating: bool | None
    steps: list[Step] = field(default_factory=list)
    fine: bool = False
    accepted: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    diagnosis: Diagnosis | None = None
    fit: HammersteinFit | None = None
    study: CompensationStudy | None = None

    @property
    def _fitted(self) -> HammersteinFit:
        """Once it has come so far."""
        assert self.fit is not None  # noqa: S101
        return self.fit

    @property
    def open(self) -> bool:
        """Whether it goes on."""
        return not self.fine and all(step.passed for step in self.steps)

    @property
    def solution(self) -> Solution:
        """What came of it."""
        ended = self.open and self.study is not None
        block = self._noted(self.study.block) if ended and self.study else None
        outcome = "block" if ended else "nothing wrong" if self.fine else "closed"
        return Solution(outcome, tuple(self.steps), self.diagnosis, self.fit, self.study, block)

    def _noted(self, block: CompensatorBlock) -> CompensatorBlock:
        return replace(block, accepted="; ".join(self.accepted), notes=(*block.notes, *self.notes))

    def _pass(self, name: str, said: str) -> None:
        self.steps.append(Step(name, True, said))

    def _stop(self, name: str, said: str, remedy: str) -> None:
        self.steps.append(Step(name, False, said, remedy))

    def _gate(self, name: str, gate: Closed, said: str = "", settings: Mapping[str, float] | None = None) -> None:
        """Stop at a closed gate, or pass it for the reason that was given."""
        said = said or f"Expected {gate.expected}, got {gate.got}."
        reason, size = reason_of(self.accept), None if self.fit is None else self.fit.kind.size
        if reason is None or size is None:
            self.steps.append(Step(name, False, said, gate.remedy, settings or {}, size is not None))
            return
        self.accepted = (*self.accepted, accepted(gate, reason))
        self._pass(name, f"{said} ACCEPTED: {reason}.")

    def check(self, span: tuple[float, float] | None) -> None:
        """Whether an identification can be tried, and OP keeps to its span: else it is that of other units."""
        found = CheckedRecord.of(self.record)
        worst = next((one for one in found.report.findings if one.level == "error"), None)
        if worst is not None:
            self._stop("check", worst.what, worst.remedy or worst.why)
        elif found.prepared.refusal is not None:
            self._stop("check", found.prepared.refusal, "use another record of this loop")
        elif span is not None and (share := _outside(self.record.op, span)) > OUTSIDE:
            said = f"OP is outside of its span, {span[0]:g} to {span[1]:g}, in {100.0 * share:.0f} % of the rows."
            low, high = np.nanmin(self.record.op), np.nanmax(self.record.op)
            remedy = f"leave the span out, or give it in the units of OP, which runs from {low:.4g} to {high:.4g}"
            self.steps.append(Step("check", False, said, remedy, {"span": None}))
        else:
            self._pass("check", f"{100.0 * found.share:.3g} % of {len(self.record)} rows can be used.")

    def diagnose(self, loop_type: str | None) -> None:
        """Whether it is the actuator, and a fault that has a block."""
        self.tell("diagnosing")
        found = diagnose(self.record, integrating=self.integrating, loop_type=loop_type)
        self.diagnosis, self.fit = found, found.fit
        said = f"{found.verdict.capitalize()}, confidence {probability(found.confidence)}."
        if found.verdict == NO_FAULT:
            self.fine = True
            self._pass("diagnose", said)
        elif found.verdict in [kind.name for kind in faults() if kind.size is not None]:
            self._pass("diagnose", said)
        else:
            gate = Closed("a diagnosis that names a lost motion", repr(found.verdict), " ".join(found.advice))
            self._gate("diagnose", gate, said)

    def identify(self) -> None:
        """Whether the fit shows what the diagnosis says."""
        if self.gain is not None:
            self.tell("identifying")
            self.fit = identify(self.record, nonlinearity="auto", gain=self.gain, integrating=self.integrating)
        facts, verdict = self._fitted.facts, verdict_of(self.diagnosis) if self.diagnosis is not None else ""
        gate = closed(facts, None if self._accepted_verdict(verdict) else verdict)
        if gate is not None:
            self._gate("identify", gate)
            return
        size = facts.kind.size
        low, high = facts.size_interval
        numbers = f"{size} {facts.parameters[size]:.4g}, 95 % {low:.4g} .. {high:.4g}" if size else ""
        self._pass("identify", f"{facts.preferred.capitalize()}: {numbers} (status {facts.status.name}).")

    def _accepted_verdict(self, verdict: str) -> bool:
        """The verdict has been accepted one step before."""
        return bool(self.accepted) and verdict not in [kind.name for kind in faults()]

    def simulate(
        self, controller: PI | None, span: tuple[float, float] | None, options: dict[str, Any], *, retune: bool
    ) -> None:
        """Whether the block is worth it, and safe with the present controller."""
        self.tell("simulating")
        given = {"record": self.record, "span": span, "accept": self.accept, **options}
        try:
            found = compensation_study(self._fitted, controller, **given)
        except InputError as error:
            expected, got, remedy = error.said or ("a loop that can be simulated", str(error), "see there")
            said, settings = f"Expected {expected}, got {got}.", next(iter(error.ways), {})
            self.steps.append(Step("simulate", False, said, remedy, settings, isinstance(error, GateError)))
            return
        self.study = found
        more = found.block.accepted
        for one in self.accepted:
            more = more.removeprefix(one).removeprefix("; ")
        self.accepted = (*self.accepted, more) if more else self.accepted
        if found.recommendation == RETUNED and retune:
            tuned = found.cases["with, retuned"].controller
            harmed = self._rivals(given).harmed(found.block, tuned)
            self._retuned(found) if not harmed else self._harmed(found, harmed)
            return
        if found.recommendation in ("compensate", RETUNED) and found.useful and found.safe:
            self._safest(found, controller, given)
            return
        remedy, settings = _way_out(found)
        gate = Closed("a block that is worth it and safe", found.reasons[0], remedy)
        self._gate("simulate", gate, " ".join(found.brief), settings)

    def _safest(self, found: CompensationStudy, controller: PI | None, given: Mapping[str, Any]) -> None:
        """What is safe on all kinds of valve that explain the record alike."""
        asked = {"factor", "block"} & given.keys()

        def smaller(factor: float) -> CompensationStudy:
            return compensation_study(self._fitted, controller, **given, factor=factor)

        rivals = self._rivals(given)
        if asked:
            study, harmed = found, rivals.harmed(found.block, controller)
        else:
            study, harmed = rivals.safest(found, controller, smaller)
        if harmed:
            self._harmed(found, harmed, smaller=() if asked else SHARES)
        else:
            self.study = study
            self._pass("simulate", " ".join(study.brief))

    def _rivals(self, given: Mapping[str, Any]) -> Rivals:
        """Kinds that explain the record as well; each is fitted once."""
        fits: dict[str, HammersteinFit] = {}

        def on(kind: str, block: CompensatorBlock, controller: PI | None) -> CompensationStudy:
            self.tell(f"simulating a valve with {kind}")
            if kind not in fits:
                fits[kind] = identify(self.record, nonlinearity=kind, gain=self.gain, integrating=self.integrating)
            options = {name: value for name, value in given.items() if name not in ("factor", "block", "accept")}
            return compensation_study(fits[kind], controller, **options, block=block, accept=f"{kind} is as likely")

        kinds = self._fitted.kinds
        return Rivals([] if kinds is None else kinds.as_likely, on)

    def _harmed(self, study: CompensationStudy, kind: str, smaller: Sequence[float] = ()) -> None:
        """The gate where a valve of another kind would take harm, of `smaller` shares of the block as well."""
        got = f"{kind} explains the record as well, and on such a valve this {study.block.kind} block is not safe"
        shares = " and ".join(f"{100.0 * share * study.block.settings['factor']:.0f} %" for share in smaller)
        got += f"; of {shares} of the lost motion none is safe on both and helps" if smaller else ""
        expected = f"a block that is safe whichever of {self._fitted.preferred} and {kind} the valve has"
        remedy = "mend the valve, or record small moves of OP up and down in manual, which tell a jump from play"
        self._gate("simulate", Closed(expected, got, remedy), " ".join(study.brief) + f" But {got}.")

    def _retuned(self, study: CompensationStudy) -> None:
        """The block with the gains that it needs."""
        said = f"only with the controller at {_said(_gains(study.cases['with, retuned'].controller))}"
        self.notes = (*self.notes, said)
        self._pass("simulate", f"{study.reasons[0].rstrip('.')}: {said}.")

    def block(self) -> None:
        """What came out."""
        assert self.study is not None  # noqa: S101
        made = self.study.block
        when = "Switch it off before the valve comes back from a service: it is made for the lost motion found."
        self._pass("block", f"{made.kind.capitalize()} block, scan time {made.scan_time:g} s. {when}")


def _way_out(study: CompensationStudy) -> tuple[str, dict[str, bool]]:
    """What to do instead of the block as it is; settings with which the way may go on."""
    word = study.recommendation
    if word == RETUNED:
        gains = _said(_gains(study.cases["with, retuned"].controller))
        return f"retune to {gains} when the block goes in, and say so with retune=True", {"retune": True}
    if word == "retune":
        return f"retune instead of compensating, to {_said(_gains(study.cases['retuned'].controller))}", {}
    ways = {"maintain": "mend the actuator", "leave": "leave the loop as it is"}
    return ways.get(word, "look at the study, or compensate a smaller share"), {}


def _gains(controller: PI) -> dict[str, float]:
    return {"kp": float(f"{controller.kp:.4g}"), "ki": float(f"{controller.ki:.4g}")}


def _said(gains: Mapping[str, float]) -> str:
    return f"Kp {gains['kp']:g}, Ki {gains['ki']:g} 1/s"
