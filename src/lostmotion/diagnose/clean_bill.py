"""Whether a record clears the actuator: only sizes that it excludes are not there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.excitation import FED_BACK_ONLY, FOREKNOWN, NO_ANSWER, what_moves_op
from lostmotion.diagnose.features import CARRIES, Measured, swing_of
from lostmotion.diagnose.op_span import OpSpan, checked_tolerance
from lostmotion.diagnose.shown import loads_at_moves, only_one_step_ahead
from lostmotion.diagnose.verdict import OUTSIDE, Verdict
from lostmotion.errors import Status
from lostmotion.identify import HammersteinFit
from lostmotion.identify.actuators.kind import NEEDED, NO_FAULT, faults

# probability of no fault of the actuator, from which on the form of a swing says that no valve makes it, whatever sizes
# the likelihood leaves open: of such claims on real loops left out seven in eight were right (docs/diagnosis.md)
FORM_CLEARS = 0.9
# of log-likelihood: where a valve that bends is ahead of a dead zone with two slopes by more, these slopes are not its
# bend, and no width beside them is excluded. In three loops of an independent simulation, with 1.2 to 2.2 % of span, it
# was ahead by 50 to 156, and down to 0.3 % was excluded; of two sound ones (a positioner of DAMADICS) by 12 and 16
BENDS = 30.0
UNTOLD = "the moves in this record do not tell"
MOST_RECORDS = 30  # times as much of the same record: more is not worth telling


@dataclass(frozen=True)
class CleanBill:
    """What a record leaves open.

    Attributes
    ----------
    excluded : dict of float
        Largest size of every kind that the record does not exclude (95 %), in units of OP; inf where a valve that never
        moves would look the same. Of a fault that is not to be denied the upper end of its interval alone.
    tolerance : float
        Largest size that does not matter, in units of OP.
    span : OpSpan
    why : str
        Why nothing is excluded; empty where something is.
    """

    excluded: dict[str, float]
    tolerance: float
    span: OpSpan
    why: str = ""

    @property
    def largest(self) -> tuple[str, float]:
        """Kind and size of the largest; inf where none was looked for."""
        if not self.excluded:
            return "a lost motion", float(np.inf)
        kind = max(self.excluded, key=lambda name: self.excluded[name])
        return kind, self.excluded[kind]

    def weigh(self, verdict: Verdict, measured: Measured, op: float) -> Verdict:
        """The verdict, or "cannot tell" where it clears an actuator that the record does not clear.

        Parameters
        ----------
        op : float
            Deviation of OP.
        """
        if verdict.verdict not in (NO_FAULT, "other oscillation") or _from_outside(verdict, measured):
            return verdict
        swings = verdict.verdict != NO_FAULT and not measured.commanded  # PV that follows SP is no complaint
        if swings and verdict.confidence >= FORM_CLEARS:
            return verdict
        kind, size = self.largest
        unit = self.span.percent
        limit, what = self.tolerance, f"the tolerance is {self.tolerance / unit:.2g} %"
        if swings:
            swing = swing_of(measured.op, op)
            limit = CARRIES * swing
            what = f"one of {limit / unit:.2g} % could carry this swing"
        if size < limit:
            return verdict
        said = f"up to {size / unit:.2g} % {self.span.words}" if np.isfinite(size) else "of any size"
        why = self.why or f"{kind} {said} is not excluded; {what}{self._narrower_span()}"
        return replace(verdict, verdict="cannot tell", kind="unknown", why=why, limit=limit)

    def _narrower_span(self) -> str:
        """That the tolerance is of a narrower span, which OP may have."""
        ends = [f"{low:g} .. {high:g}" for low, high in self.span.others]
        return f", as the span of OP may be {' or '.join(ends)}: give op_span=(low, high)" if ends else ""


def _from_outside(verdict: Verdict, measured: Measured) -> bool:
    """Whether the process needs a swing of this period whatever the actuator does."""
    return verdict.verdict != NO_FAULT and measured.driven and not measured.commanded


def clean_bill(fit: HammersteinFit, tolerance: float, span: OpSpan, fed_back: bool = False) -> CleanBill:
    """What the record of a fit of all kinds leaves open; `fed_back`: PV foretells all that moves OP in it.

    Sizes are excluded beside the process that was found: where that is not the plant, none is.

    Raises
    ------
    ParameterError
        A tolerance outside (0, 1).
    """
    excluded, why = _excluded(fit) | dict.fromkeys(_bent_away(fit), float(np.inf)), ""
    if fed_back:
        why = FED_BACK_ONLY.format(what_moves_op(fit.data.sp))
    elif not fit.evidence.answered:
        why = NO_ANSWER
    elif fit.evidence.foreknown:
        why = FOREKNOWN
    elif stops := _for_a_slow_valve(fit, excluded):
        why = f"a {stops} predicts PV better, but so does a valve that is slow, beside which no size is excluded"
    elif loads_at_moves(fit):
        why = "steps of load stand where SP moves: they may be what the valve does not do, and hide any lost motion"
    elif _is_not_described(fit):
        why = "the model does not describe this record, so that it excludes no lost motion"
    if why:
        excluded = dict.fromkeys([kind.name for kind in faults() if kind.size is not None], float(np.inf))
    return CleanBill(excluded, 100.0 * checked_tolerance(tolerance) * span.strictest_percent, span, why)


def _for_a_slow_valve(fit: HammersteinFit, excluded: dict[str, float]) -> str:
    """The fault that was set aside for a valve that is slow, because of which nothing is excluded."""
    if fit.kinds is None or fit.kinds.best != NO_FAULT or not excluded or np.isfinite(list(excluded.values())).any():
        return ""
    firm = fit.kinds.firm
    sizeless = [kind.name for kind in faults() if kind.size is None]
    gains = {
        kind: gain for kind, gain in fit.kinds.likelihoods.items() if kind in sizeless and gain > NEEDED >= firm[kind]
    }
    return max(gains, key=lambda kind: gains[kind], default="")


def _bent_away(fit: HammersteinFit) -> list[str]:
    """Kinds that a valve which bends explains so much better that the record excludes no size of them."""
    if fit.kinds is None or fit.kinds.best != NO_FAULT:
        return []
    gains, firm = fit.kinds.likelihoods, fit.kinds.firm
    sized = [kind.name for kind in faults() if kind.size is not None and not kind.sticks]
    return [name for name in sized if gains.get(name, 0.0) > NEEDED and firm.get(name, 0.0) < -BENDS]


def _is_not_described(fit: HammersteinFit) -> bool:
    """Whether the model is none of this record; errors that depend on OP matter where the loop itself moves OP."""
    if only_one_step_ahead(fit):
        return True
    tested = fit.status is Status.MISFIT and fit.evidence.free_moves >= OUTSIDE
    return fit.preferred == "cannot tell" and fit.status is not Status.CANNOT_TELL and not tested


def _excluded(fit: HammersteinFit) -> dict[str, float]:
    if fit.kinds is not None and fit.kinds.excluded:
        return dict(fit.kinds.excluded)
    size = fit.kind.size
    return {} if size is None else {fit.kind.name: float(fit.interval(size)[1])}


def untold(sp: FloatArray | None) -> str:
    """Why a record does not tell, by its SP."""
    if sp is None:
        return "this record holds no SP, and its moves of OP do not tell"
    return UNTOLD if np.ptp(sp) > 0.0 else "SP does not move in this record"


def how_to_tell(size: float, limit: float, reason: str = UNTOLD) -> tuple[str, ...]:
    """What would settle it, most useful first.

    Parameters
    ----------
    size, limit : float
        Largest size that is not excluded, and that which must be, in units of OP.
    reason : str
        Why what is there does not.
    """
    advice = [
        f"Move SP up and down, or OP in manual up, back, down and back, several times, so that OP moves by clearly "
        f"more than {limit:.2g}, the size to be excluded: {reason}. Do not wait for a level to settle."
    ]
    more = min(size / max(limit, 1e-300), MOST_RECORDS) ** 2
    if 1.0 < more <= MOST_RECORDS:
        advice.append(f"Or give about {np.ceil(more):.0f} times as much of the same operation.")
    return tuple(advice)
