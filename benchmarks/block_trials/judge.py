"""One loop: recorded, solved, and what its block then does in the loop."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

import lostmotion as lm
from block_trials.closed_loop import Block
from block_trials.draw import Loop, loop_of
from block_trials.measures import Compared, Cycle, compared, cycle_of, error_of, in_use
from block_trials.record import recorded
from block_trials.valves import FAULTLESS, STICKING

AS_IT_IS, SMALLER, LARGER, REPAIRED = "as it is", "0.8 of the size", "1.2 of the size", "repaired"
VALVES = {AS_IT_IS: 1.0, SMALLER: 0.8, LARGER: 1.2, REPAIRED: 0.0}  # times the lost motion
SIZES_AT_REST = (1 / 1.2, 1.0, 1.2)  # at which limit cycles are sought
BLOCK, REFUSED = "block", "refused"  # how the way may end, beside "closed" and "nothing wrong"
WORSE, WORTH = 1.05, 0.8  # of the error without a block: beyond what runs differ by; worth having
FAR_OFF = 1.5  # times between foretold and measured
ENOUGH = 0.95  # of the error: an ideal valve that gains less is nothing to share
SENTENCE = re.compile(r"(?<=[^.\s]\.)\s")  # its end; two dots are "to"


@dataclass(frozen=True)
class Judged:
    """What came out for a loop; error ratios by the mean absolute error of PV, over that without a block.

    Attributes
    ----------
    size, jump : float
        Of the true valve, %.
    outcome, gate, said : str
        How the way ended, at which step it was closed, and the first sentence there.
    block_kind : str
        Empty: no block.
    ideal : float
        Error ratio of a valve without fault.
    foretold : float
        Error ratio by the study of the package.
    measured : dict of Compared
        By the names of `VALVES`.
    cycles : dict of Cycle
        By `SIZES_AT_REST`.
    true_block : float
        Where a faulty loop got no block: error ratio of one made from the true valve.
    """

    kind: str
    seed: int
    process: str
    size: float
    jump: float
    outcome: str
    gate: str = ""
    said: str = ""
    block_kind: str = ""
    ideal: float = math.nan
    foretold: float = math.nan
    measured: dict[str, Compared] = field(default_factory=dict)
    cycles: dict[float, Cycle] = field(default_factory=dict)
    true_block: float = math.nan

    @property
    def faulty(self) -> bool:
        """Whether there is a lost motion."""
        return self.kind not in FAULTLESS

    @property
    def blocked(self) -> bool:
        """Whether a block came out."""
        return self.outcome == BLOCK

    @property
    def misplaced(self) -> bool:
        """Whether the block is of another kind than the fault, or there is no fault."""
        family = "stiction" if self.kind in STICKING else self.kind
        return self.blocked and not (self.faulty and self.block_kind.startswith(family))

    @property
    def error(self) -> float:
        """Error ratio of the block on the valve that it was made for."""
        return self.measured[AS_IT_IS].error

    @property
    def share_of_gain(self) -> float:
        """Part of what an ideal valve gains; NaN where that is hardly anything."""
        return (1 - self.error) / (1 - self.ideal) if self.ideal < ENOUGH else math.nan

    @property
    def over_foretold(self) -> float:
        """Measured over foretold error ratio."""
        return self.error / self.foretold

    @property
    def far_off(self) -> bool:
        """Whether the study foretold something else."""
        return max(self.over_foretold, 1 / self.over_foretold) > FAR_OFF

    @property
    def missed(self) -> bool:
        """Whether a block of the true size would have been worth having."""
        return self.true_block < WORTH


def judged(job: tuple[str, int]) -> Judged:
    """Simulate, solve and measure the loop of this kind and seed."""
    loop = loop_of(*job)
    truth = (loop.kind, loop.seed, loop.process_name, loop.valve.size, loop.valve.jump)
    try:
        found = lm.solve(recorded(loop))
    except lm.InputError as error:
        return Judged(*truth, REFUSED, said=first_sentence(str(error)), true_block=with_true_block(loop))
    if found.block is None or found.study is None:
        gate, said = ("", "") if found.closed is None else (found.closed.name, first_sentence(found.closed.said))
        return Judged(*truth, found.outcome, gate, said, true_block=with_true_block(loop))
    cases = found.study.cases
    return Judged(
        *truth,
        found.outcome,
        block_kind=found.block.kind,
        ideal=compared(in_use(loop, valve=loop.valve.ideal()), in_use(loop)).error,
        foretold=cases["with"].iae / cases["without"].iae,
        measured={name: beside(loop, found.block, size) for name, size in VALVES.items()},
        cycles={size: cycle_of(loop, found.block, loop.valve.scaled(size)) for size in SIZES_AT_REST},
    )


def first_sentence(said: str) -> str:
    """Of a text."""
    return SENTENCE.split(said.strip(), maxsplit=1)[0]


def beside(loop: Loop, block: Block, size: float) -> Compared:
    """The block on a valve of so many times the lost motion, beside the loop without."""
    valve = loop.valve.scaled(size)
    return compared(in_use(loop, block, valve), in_use(loop, None, valve))


def with_true_block(loop: Loop) -> float:
    """Error ratio with a block for the true valve, made with the true noise and lags; NaN where there is no fault."""
    fault = true_fault(loop)
    if fault is None:
        return math.nan
    process = loop.process
    rows = process.dead_time + process.lag + process.second_lag + loop.valve.lag
    noise = abs(loop.controller.gain) * loop.instrument.noise
    block = lm.block_from_model(fault, loop.seconds, op_noise=noise, process_time=rows * loop.seconds)
    return error_of(in_use(loop, block)) / error_of(in_use(loop))


def true_fault(loop: Loop) -> lm.DeadZone | lm.Backlash | lm.Stiction | None:
    """As the package describes it."""
    valve = loop.valve
    if loop.kind in FAULTLESS:
        return None
    if loop.kind == "dead zone":
        return lm.DeadZone(valve.rest - valve.size / 2, valve.rest + valve.size / 2)
    return lm.Backlash(valve.size) if loop.kind == "backlash" else lm.Stiction(valve.size, valve.jump)
