"""Does the identified loop do what the record did? A study of one that does not says nothing."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.compensate.gate import Closed, accepted, reason_of
from lostmotion.diagnose.oscillation import Oscillation, find_oscillation
from lostmotion.errors import DataError
from lostmotion.evaluate.study.scenario import started_in_cycle
from lostmotion.evaluate.study.studied_loop import Known
from lostmotion.evaluate.study.study_plant import StudyPlant, noise_samples
from lostmotion.models import NoiseModel
from lostmotion.records import LoopRecord, prepare
from lostmotion.simulate import PI

RUNS = 3  # other noise each: the median counts
SETTLE = 600  # rows before the set point of the record, in which a cycle sets in
MOST_ROWS = 6000  # of the record
SPREAD = 2.5  # times: right fits of 40 simulated and 8 real loops stayed within 2, wrong ones were 11 to 570 away
PERIOD = 1.6  # times: the same fits stayed within 1.15 where the record swings
SWINGS = 0.5  # share of the variance from which on the record has a period to speak of


@dataclass(frozen=True)
class Reproduction:
    """Control error of the record, and of the identified loop under the same set point.

    Attributes
    ----------
    recorded, simulated : float
        Standard deviation of PV about SP (about its mean where SP is not known), units of PV.
    recorded_period, simulated_period : float or None
        Seconds, of the strongest oscillation; None where the record has no regular one.
    """

    recorded: float
    simulated: float
    recorded_period: float | None
    simulated_period: float | None

    @property
    def spread_agrees(self) -> bool:
        """Within 2.5 times either way."""
        return _within(self.simulated, self.recorded, SPREAD)

    @property
    def period_agrees(self) -> bool:
        """Within 1.6 times either way, where the record swings."""
        if self.recorded_period is None:
            return True
        return self.simulated_period is not None and _within(self.simulated_period, self.recorded_period, PERIOD)

    @property
    def closed(self) -> Closed | None:
        """Why the study of this model would say nothing; None where it reproduces the record."""
        if self.spread_agrees and self.period_agrees:
            return None
        wrong = [
            f"a {name} of {said}"
            for name, agrees, said in (
                ("spread", self.spread_agrees, f"{self.simulated:.3g} where PV has {self.recorded:.3g} about SP"),
                ("period", self.period_agrees, f"{_seconds(self.simulated_period)} where PV has "
                 f"{_seconds(self.recorded_period)}"),
            )
            if not agrees
        ]  # fmt: skip
        remedy = "check kp, ki and the span, identify another stretch or other orders"
        return Closed("a model that reproduces the record", f"a simulated loop with {' and '.join(wrong)}", remedy)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return {**asdict(self), "spread_agrees": self.spread_agrees, "period_agrees": self.period_agrees}


def _within(one: float, other: float, times: float) -> bool:
    return bool(np.isfinite(one) and other <= times * one and one <= times * other)


def _seconds(period: float | None) -> str:
    return "none" if period is None else f"{period:.3g} s"


def reproduction(
    plant: StudyPlant, noise: NoiseModel, controller: PI, record: LoopRecord, kick: float, seed: int = 0
) -> Reproduction:
    """Run the identified loop under the set point of the record, and compare.

    Parameters
    ----------
    plant, noise, controller
        Of the study.
    record : LoopRecord
        Its longest stretch that is used.
    kick : float
        Step of the set point that sets the loop swinging before it counts, in units of PV.
    seed : int
    """
    stretch = max(prepare(record).require(), key=len)
    rows = slice(max(len(stretch) - MOST_ROWS, 0), None)
    pv = stretch.pv[rows]
    known = stretch.sp is not None and bool(np.isfinite(stretch.sp).all())
    reference = stretch.sp[rows] if known and stretch.sp is not None else np.full(pv.size, float(pv.mean()))
    error = pv - reference
    runs = [
        _error(plant, controller, reference, noise_samples(noise, SETTLE + pv.size, seed + run), kick)
        for run in range(RUNS)
    ]
    swing = _swing(error)
    swings = swing is not None and swing.regular and swing.share > SWINGS
    return Reproduction(
        float(np.std(error)),
        float(np.median([np.std(one) for one in runs])),
        swing.period * record.dt if swing is not None and swings else None,
        _period(runs, record.dt) if swings else None,
    )


def _period(runs: list[FloatArray], dt: float) -> float | None:
    """Seconds, of the strongest oscillation in most runs, regular or not: noise blurs it."""
    found = [swing.period for swing in map(_swing, runs) if swing is not None]
    return float(np.median(found)) * dt if found else None


def _error(plant: StudyPlant, controller: PI, reference: FloatArray, noise: FloatArray, kick: float) -> FloatArray:
    """Control error of one run."""
    loop = plant.run(controller, None, started_in_cycle(reference, SETTLE, kick), noise)
    return np.asarray(loop.measured[SETTLE:] - reference)


def _swing(error: FloatArray) -> Oscillation | None:
    """The strongest oscillation; None in a run that came to rest or ran away."""
    try:
        return find_oscillation(error)
    except DataError:
        return None


def require_reproduction(
    found: Known, controller: PI, record: LoopRecord | None, kick: float, seed: int, accept: str | None
) -> tuple[Known, Reproduction | None]:
    """The gate of a study: the model does what the record did, or there is a reason to go on.

    Raises
    ------
    GateError
        It does not, and there is none.
    """
    if record is None:
        return found, None
    compared = reproduction(found.plant, found.noise, controller, record, kick, seed)
    reason, closed = reason_of(accept), compared.closed
    if closed is None:
        return found, compared
    if reason is None:
        raise closed.error()
    both = [said for said in (found.accepted, accepted(closed, reason)) if said]
    return replace(found, accepted="; ".join(both)), compared
