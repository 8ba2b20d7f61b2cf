"""The gate on the way to the valve: what a fit must show before anything is built on it.

One rule for blocks, studies, exported code, tests and watches: the status says that the kind is seen (and, where a size
is used, how large), no other kind is likelier, and a diagnosis that is handed in agrees. A closed gate raises
:class:`~lostmotion.errors.GateError`; whoever knows better gives a reason, and the reason stays with what is made.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol

from lostmotion.compensate.block import CompensatorBlock
from lostmotion.errors import DataError, GateError, ParameterError, Status
from lostmotion.identify import FitFacts
from lostmotion.identify.actuators.choice import KindChoice
from lostmotion.identify.earned import like_a_slip
from lostmotion.records.compression import MadeUp

# COLOURED: kind and size hold, only the intervals are too narrow. MISFIT: no size is right (docs/compensation-study.md)
SIZED = (Status.OK, Status.COLOURED)
SHOWN = (*SIZED, Status.MISFIT, Status.WIDE, Status.FEW_CROSSINGS)  # hardly: enough to ask for a test, or to watch
PROCESS = (*SHOWN, Status.ONE_SIDED, Status.NOT_SEEN)  # of any other nothing of the model can be used
SURE = 0.9  # of 102 simulated loops 47 of 52 right kinds had more, the one wrong dead zone had 0.85
MISFIT_OF_ALL = (
    "The residuals depend on OP, whichever kind is fitted: the actuator is of none of these shapes, or the process is "
    "not linear. Record smaller moves of OP about one point of operation, or look at the valve."
)
OPEN_DIAGNOSIS = "cannot tell"
OVERRIDE = "give accept='<reason>'"


class Says(Protocol):
    """Anything with a verdict, as a ``Diagnosis`` has, which lies above this module."""

    @property
    def verdict(self) -> str:
        """A kind of fault, "none", "other oscillation" or "cannot tell"."""
        ...


Said = Says | Mapping[str, Any] | str


@dataclass(frozen=True)
class Closed:
    """Why a gate is closed: what is expected, what is there, and what opens it."""

    expected: str
    got: str
    remedy: str

    def error(self) -> GateError:
        """To be raised."""
        return GateError.expected(self.expected, self.got, f"{self.remedy.rstrip('. ')}, or {OVERRIDE}")


def closed(facts: FitFacts, diagnosis: Said | None = None, *, sized: bool = True) -> Closed | None:
    """What keeps a fit from the valve; None where the gate is open.

    Parameters
    ----------
    facts : FitFacts
    diagnosis : Diagnosis, its dictionary or its verdict, optional
        Of the same loop: it must name the kind that was fitted.
    sized : bool
        Whether the size is used, and not the kind only.
    """
    kind = facts.kind.name
    shown = "a fit that shows a lost motion" + (" and its size" if sized else "")
    drawn = _made_up(facts.made_up, facts.closed_loop) if sized and facts.made_up is not None else None
    if drawn is not None and facts.preferred == kind != "none":
        return drawn
    if facts.preferred != kind or facts.status not in (SIZED if sized else SHOWN):
        return Closed(shown, f"{facts.preferred} (status {facts.status.name})", _sentence(facts))
    if kind == "none":
        return Closed(shown, "a linear model", "no lost motion was found: there is nothing to compensate or mend")
    if sized and facts.kinds is not None and facts.kinds.best == kind and facts.kinds.confidence < SURE:
        return _doubtful(kind, facts.kinds)
    if sized and like_a_slip(facts.evidence):  # of a fit saved before there was a status for it
        return Closed(shown, f"{kind} (status {facts.status.name})", Status.FEW_CROSSINGS.value)
    return None if diagnosis is None else _contradicted(kind, verdict_of(diagnosis))


def _sentence(facts: FitFacts) -> str:
    """That of the status, less what was already done."""
    if facts.status is Status.MISFIT and facts.kinds is not None:
        return MISFIT_OF_ALL
    return facts.message


def _doubtful(kind: str, kinds: KindChoice) -> Closed:
    sure = _below(kinds.confidence, SURE)
    got = f"{sure} % that it is a {kind}; it may be a {kinds.runner_up}"
    if kinds.runner_up == "none":
        got = f"{sure} % that there is a {kind} at all"
    remedy = "record set-point moves, or steps of OP in manual, up, back, down and back"
    return Closed(f"a kind that is sure to {100.0 * SURE:.0f} %", got, remedy)


def _below(share: float, limit: float) -> str:
    """Percent with as many digits as tell it from a limit that it does not reach.

    Examples
    --------
    >>> _below(0.893, 0.9), _below(0.8996, 0.9)
    ('89', '89.96')
    """
    digits = next((n for n in range(12) if f"{100.0 * share:.{n}f}" != f"{100.0 * limit:.{n}f}"), 12)
    return f"{100.0 * share:.{digits}f}"


def _made_up(found: MadeUp, closed_loop: bool) -> Closed | None:
    """Whether a historian made up more of the record than a size may rest on."""
    remedy = "export raw values from the control system or the historian, with compression off"
    said = found.hides_size(closed_loop)
    return None if said is None else Closed(*said, remedy)


def _contradicted(kind: str, verdict: str) -> Closed | None:
    if verdict == kind:
        return None
    if verdict == OPEN_DIAGNOSIS:
        return Closed(f"a diagnosis that names the {kind}", f"{verdict!r}", "make the test that `diagnose` asks for")
    remedy = f"fit what the diagnosis says, or make a test that tells them apart ({verdict} or {kind})"
    return Closed(f"a diagnosis that names the {kind}", f"{verdict!r}", remedy)


def verdict_of(diagnosis: Said) -> str:
    """Verdict of a diagnosis, of its dictionary, or the verdict itself.

    Raises
    ------
    DataError
        Something without a verdict.
    """
    found = diagnosis.get("verdict") if isinstance(diagnosis, Mapping) else getattr(diagnosis, "verdict", diagnosis)
    if not isinstance(found, str):
        got = sorted(diagnosis) if isinstance(diagnosis, Mapping) else type(diagnosis).__name__
        raise DataError.expected("a diagnosis with its verdict", got, "use a diagnosis, or the JSON of one")
    return found


def pass_gate(facts: FitFacts, diagnosis: Said | None = None, accept: str | None = None, *, sized: bool = True) -> str:
    """Let a fit pass, or not.

    Parameters
    ----------
    facts, diagnosis, sized
        As in :func:`closed`.
    accept : str, optional
        Reason for which a closed gate is passed all the same.

    Returns
    -------
    str
        What was accepted and why, to be kept with what is made; empty where the gate is open by itself.

    Raises
    ------
    GateError
        The gate is closed and there is no reason.
    ParameterError
        A reason without a word.
    """
    reason = reason_of(accept)
    found = closed(facts, diagnosis, sized=sized)
    if found is not None and reason is None:
        raise found.error()
    return "" if found is None else accepted(found, reason)


def pass_dead_zone(facts: FitFacts, diagnosis: Said | None, accept: str | None, remedy: str) -> str:
    """The gate of what knows dead zones only, and uses no size: test designs and watches.

    Parameters
    ----------
    remedy : str
        Way out for another kind, which no reason opens.

    Raises
    ------
    GateError
        The fit is of another kind, or as in :func:`pass_gate`.
    """
    if facts.kind.name != "dead zone":
        got = f"one of a {facts.kind.name} (status {facts.status.name})"
        raise GateError.expected("a fit that shows a dead zone", got, remedy)
    return pass_gate(facts, diagnosis, accept, sized=False)


def pass_process(facts: FitFacts, accept: str | None) -> str:
    """The gate of what uses the process of a fit, and a guess instead of its actuator.

    Raises
    ------
    GateError
        The fit knows no process, and there is no reason to accept it.
    """
    reason = reason_of(accept)
    if facts.status in PROCESS:
        return ""
    found = Closed("a fit that knows the process", f"status {facts.status.name}", facts.message)
    if reason is None:
        raise found.error()
    return accepted(found, reason)


def block_behind_gate(
    block: CompensatorBlock, facts: FitFacts | None, diagnosis: Said | None, accept: str | None
) -> CompensatorBlock:
    """A block that may go out: that of an open gate as it is, another with the reason for which it goes.

    Parameters
    ----------
    block : CompensatorBlock
        One that brings its own reason passes.
    facts : FitFacts, optional
        The fit behind it.
    diagnosis, accept
        As in :func:`pass_gate`. Without a fit the diagnosis must name the kind that the block is for.

    Raises
    ------
    GateError
        The gate is closed and there is no reason.
    """
    reason, found, fault = reason_of(accept), None, block.specification.fault
    if facts is not None:
        found = closed(facts, diagnosis)
        if found is None and facts.kind.name != fault:
            found = Closed(f"a fit that shows a {fault}", facts.kind.name, "make the block from this fit")
    elif diagnosis is not None:
        found = _contradicted(fault, verdict_of(diagnosis))
    factor = block.settings["factor"]
    if found is None and factor > 1.0:
        found = Closed("a factor up to 1", f"{factor:g}", "more than the lost motion is a relay in the loop: give less")
    if found is None or (block.accepted and reason is None):
        return block
    if reason is None:
        raise found.error()
    return replace(block, accepted=accepted(found, reason))


def accepted(found: Closed, reason: str | None) -> str:
    """Sentence that stays with what is made behind a closed gate."""
    got = found.got.rstrip(". ")  # a sentence of its own elsewhere
    return f"{reason} (in spite of: {got}, where {found.expected} is expected)"


def reason_of(accept: str | None) -> str | None:
    """The reason in one line.

    Raises
    ------
    ParameterError
        It holds no word.
    """
    if accept is None:
        return None
    if not isinstance(accept, str) or not any(sign.isalpha() for sign in accept):
        raise ParameterError.expected("a reason in words", repr(accept), "say why, and who says so: accept='<reason>'")
    return " ".join(accept.split())
