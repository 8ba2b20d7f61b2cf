"""Verdicts of the diagnosis on loops from a simulation that shares nothing with the package.

Run: ``.venv/bin/python benchmarks/other_simulation.py`` prints Markdown tables for 192 loops, drawn for each of
``--seeds 0 10000``. ``--only NAME``: classes of loops whose name begins so, as "stiction"; ``--workers N``.

A faulty valve is right where its kind is named; backlash and stiction named for each other are the right family.
Without a fault "none" and "other oscillation" are right, "saturation" where OP stands at an end of its range. In a
saturated loop all but a kind of lost motion is right. "cannot tell" and refusals are counted apart.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported, also in workers

import argparse  # noqa: E402
import warnings  # noqa: E402
from collections import Counter  # noqa: E402
from collections.abc import Sequence  # noqa: E402
from dataclasses import dataclass, field  # noqa: E402

import numpy as np  # noqa: E402

import lostmotion as lm  # noqa: E402
from lostmotion.evaluate.workers import run_all  # noqa: E402
from pages.written import share, table  # noqa: E402
from verdicts.other_loops import FIRST_SEED, LOOPS, loop_of  # noqa: E402
from verdicts.other_simulation import RecordedLoop  # noqa: E402
from verdicts.other_specification import KINDS, STICKING, LoopSpec  # noqa: E402

SEEDS = (0, 10_000)
CLEARED = ("none", "other oscillation")
RIGHT, FAMILY, CANNOT_TELL, REFUSED, WRONG = JUDGEMENTS = (
    "right",
    "right family, other sticking kind",
    "cannot tell",
    "refused",
    "wrong",
)
AT_THE_END = 0.02  # share of rows at the highest or lowest OP from which a saturation is none of the diagnosis's making
SURE = 0.9
SAME_OP = 1e-9  # %
LEEWAY = 0.005  # of the width: what the steps of the simulation may make of it


@dataclass(frozen=True)
class Verdict:
    """What was said of a loop."""

    number: int
    offset: int
    tuning: str
    course: str
    scans: int
    share_at_end: float  # of rows at the highest or lowest OP
    verdict: str
    confidence: float = float("nan")
    size: float = float("nan")
    interval: tuple[float, float] = (float("nan"), float("nan"))
    excluded: dict[str, float] = field(default_factory=dict)
    cleared: bool = False

    @property
    def spec(self) -> LoopSpec:
        """What the loop is."""
        return LOOPS[self.number]

    @property
    def judgement(self) -> str:
        """One of `JUDGEMENTS`."""
        truth = self.spec.truth
        if self.verdict == REFUSED:
            return REFUSED
        if truth == "saturation":
            return WRONG if self.verdict in KINDS else RIGHT
        if self.verdict == CANNOT_TELL:
            return CANNOT_TELL
        if truth not in KINDS:
            saturates = self.verdict == "saturation" and self.share_at_end > AT_THE_END
            return RIGHT if self.verdict in CLEARED or saturates else WRONG
        if self.verdict == truth:
            return RIGHT
        return FAMILY if truth in STICKING and self.verdict in STICKING else WRONG

    @property
    def hides(self) -> bool:
        """Whether the lost motion is larger than the size that is said to be excluded."""
        return self.spec.width > self.excluded.get(self.spec.truth, np.inf)


def diagnosed(job: tuple[int, int]) -> Verdict:
    """Simulate and diagnose the loop of this number, at this offset of the seeds."""
    number, offset = job
    loop = loop_of(number, offset)
    at_end = (loop.op <= loop.op.min() + SAME_OP) | (loop.op >= loop.op.max() - SAME_OP)
    facts = (number, offset, loop.tuning, loop.course, loop.scans, float(at_end.mean()))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = lm.diagnose(record_of(loop))
    except lm.InputError:
        return Verdict(*facts, REFUSED)
    return Verdict(*facts, found.verdict, found.confidence, found.size, found.interval, found.excluded, found.cleared)


def record_of(loop: RecordedLoop) -> lm.LoopRecord:
    """Record with the operator's modes where there are any."""
    mode = np.where(loop.manual, "MAN", "AUTO") if loop.manual.any() else None
    return lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=loop.seconds, op_span=(0, 100), mode=mode)


def by_class(verdicts: list[Verdict]) -> list[str]:
    """How many of each class are judged how."""
    counts: dict[str, Counter[str]] = {}
    for one in verdicts:
        fault = "**faulty**" if one.spec.lost_motion else "**sound**"
        for group in (one.spec.group, fault):
            counts.setdefault(group, Counter())[one.judgement] += 1
    rows = [(group, found.total(), *(found[how] or "" for how in JUDGEMENTS)) for group, found in counts.items()]
    return table(("class", "loops", *JUDGEMENTS), sorted(rows, key=lambda row: str(row[0]).startswith("**")))


def alarms(verdicts: list[Verdict]) -> list[str]:
    """False alarms in valves without a fault, by what is going on there."""
    sound = [one for one in verdicts if not one.spec.lost_motion]
    truths = dict.fromkeys(one.spec.truth for one in sound)
    rows = [(truth, share(one.judgement == WRONG for one in sound if one.spec.truth == truth)) for truth in truths]
    return table(("valve without a fault, and", "false alarms"), [*rows, ("all", share(_wrong(sound)))])


def _wrong(verdicts: list[Verdict]) -> list[bool]:
    return [one.judgement == WRONG for one in verdicts]


def hiding(verdicts: list[Verdict]) -> list[str]:
    """Of the faulty valves that were cleared: how many have more lost motion than was said to be possible."""
    missed = [one for one in verdicts if one.spec.lost_motion and one.verdict in CLEARED]
    rows = [(kind, share(one.hides for one in missed if one.spec.truth == kind)) for kind in KINDS]
    return table(
        ("faulty, but cleared", "with a lost motion larger than the size said excluded"),
        [*rows, ("all", share(one.hides for one in missed))],
    )


def bounds(verdicts: list[Verdict]) -> list[str]:
    """Of the faulty valves that were not named: how often a size was excluded, and how often one that is there."""
    rows = []
    for name, groups in (*AHEAD.items(), ("all others", None)):
        mine = [one for one in verdicts if _is_of(one, groups)]
        told = [one for one in mine if one.spec.lost_motion and np.isfinite(one.excluded.get(one.spec.truth, np.inf))]
        sound = [one for one in mine if not one.spec.lost_motion]
        rows.append((
            name, share(one.hides for one in told), sum(one.cleared for one in told),
            share(one.cleared for one in sound),
        ))  # fmt: skip
    head = (
        "the controller, or PV",
        "excluded although it is there, of finite bounds",
        "of these cleared",
        "sound, cleared",
    )
    return table(head, rows)


AHEAD = {name: (name, f"backlash, {name}", f"stiction, {name}") for name in ("feedforward", "derivative", "PV late")}


def _is_of(one: Verdict, groups: Sequence[str] | None) -> bool:
    known = [group for some in AHEAD.values() for group in some]
    return one.spec.group not in known if groups is None else one.spec.group in groups


def claims(verdicts: list[Verdict]) -> list[str]:
    """How many of the claims made with confidence are right."""
    sure = [one for one in verdicts if one.confidence >= SURE and one.verdict != CANNOT_TELL]
    rows = []
    for name, said in (("a lost motion", KINDS), ("no fault of the valve", CLEARED), ("saturation", ("saturation",))):
        of_these = [one for one in sure if one.verdict in said]
        family = share(one.judgement in (RIGHT, FAMILY) for one in of_these)
        rows.append((name, share(one.judgement == RIGHT for one in of_these), family))
    return table((f"claimed with {SURE} and more", "right", "right, or right family"), rows)


def coverage(verdicts: list[Verdict]) -> list[str]:
    """How often the 95 % interval holds the width, where the family is right and there is one width."""
    sized = [
        one
        for one in verdicts
        if one.spec.one_width and one.judgement in (RIGHT, FAMILY) and np.isfinite([one.size, *one.interval]).all()
    ]
    rows = []
    for scans in (*sorted({one.scans for one in sized}), None):
        these = [one for one in sized if scans in (one.scans, None)]
        errors = [100.0 * abs(one.size / one.spec.width - 1.0) for one in these]
        median = f"{np.median(errors):.1f} %" if errors else "-"
        rows.append((scans or "all", share(_covered(these, 0.0)), share(_covered(these, LEEWAY)), median))
    leeway = f"to {100.0 * LEEWAY:g} % of the width"
    return table(("scans a row", "width in the 95 % interval", leeway, "median error of the size"), rows)


def _covered(verdicts: list[Verdict], leeway: float) -> list[bool]:
    spare = [leeway * one.spec.width for one in verdicts]
    return [
        one.interval[0] - more <= one.spec.width <= one.interval[1] + more
        for one, more in zip(verdicts, spare, strict=True)
    ]


def wrong_ones(verdicts: list[Verdict]) -> list[str]:
    """A line for each loop that is judged wrong."""
    rows = []
    for one in verdicts:
        if one.judgement == WRONG:
            spec = one.spec
            width = f"{spec.width:g} (J {spec.valve.jump:g})" if spec.valve.jump else f"{spec.width:g}"
            truth = f"{spec.truth} {width}" if spec.lost_motion else spec.truth
            drawn = f"{spec.process.kind}, {one.tuning}, set point {one.course}, {one.scans} scans a row"
            size = f"{one.size:.3g} ({one.interval[0]:.3g} to {one.interval[1]:.3g})" if np.isfinite(one.size) else "-"
            if spec.lost_motion and spec.truth in one.excluded:
                size = f"excluded above {one.excluded[spec.truth]:.3g}"
            seed = FIRST_SEED + one.number + one.offset
            rows.append((one.number, seed, spec.group, drawn, truth, one.verdict, f"{one.confidence:.2f}", size))
    if not rows:
        return ["No verdict is wrong."]
    return table(("loop", "seed", "class", "drawn", "truth", "verdict", "confidence", "size, %"), rows)


def main() -> None:
    """Diagnose and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=SEEDS, help="offsets of the seeds")
    parser.add_argument("--only", default="", metavar="CLASS", help="classes whose name begins so")
    parser.add_argument("--from", type=int, default=0, dest="first", metavar="NUMBER", help="loops from this number on")
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    numbers = [
        number for number, spec in enumerate(LOOPS) if spec.group.startswith(given.only) and number >= given.first
    ]
    if not numbers:
        names = ", ".join(dict.fromkeys(spec.group for spec in LOOPS))
        parser.error(f"expected the beginning of a class, got {given.only!r}; one of: {names}")
    jobs = [(number, offset) for offset in given.seeds for number in numbers]
    verdicts = run_all(diagnosed, jobs, "loops of the other simulation", given.workers)
    parts = (by_class, alarms, hiding, bounds, claims, coverage, wrong_ones)
    print("\n".join(line for part in parts for line in part(verdicts)))


if __name__ == "__main__":
    main()
