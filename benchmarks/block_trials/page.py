"""The tables of the page."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np

from block_trials.judge import (
    AS_IT_IS,
    BLOCK,
    FAR_OFF,
    LARGER,
    REFUSED,
    REPAIRED,
    SIZES_AT_REST,
    SMALLER,
    VALVES,
    WORSE,
    Judged,
)
from block_trials.measures import CYCLE_NOISE
from block_trials.valves import KINDS, STICKING

WORDS = {
    "sound": "sound",
    "slow": "sound, slow actuator",
    "nonlinear": "sound, curved characteristic",
    **{kind: f"stiction, {kind}" for kind in STICKING},
}
STEPS = ("check", "diagnose", "identify", "simulate")  # at which the way may close
NOTHING_WRONG = "nothing wrong"
NONE = ["None.", ""]
INNER = (0.05, 0.95)  # quantiles
MADE_FOR = (AS_IT_IS, SMALLER, LARGER)  # valves on which a block is to do no harm


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> list[str]:
    """Markdown, with an empty line behind."""
    lines = [head, ["---"] * len(head), *rows]
    return [*("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines), ""]


def by_kind(found: Sequence[Judged]) -> list[tuple[str, list[Judged]]]:
    """Loops of each kind of valve that there are, and all."""
    rows = [(WORDS.get(kind, kind), [one for one in found if one.kind == kind]) for kind in KINDS]
    return [*((name, loops) for name, loops in rows if loops), ("**all**", list(found))]


def blocked(found: Iterable[Judged]) -> list[Judged]:
    """Loops with a block."""
    return [one for one in found if one.blocked]


def median(values: Iterable[float]) -> str:
    """Of what is known."""
    known = [value for value in values if np.isfinite(value)]
    return f"{np.median(known):.2f}" if known else ""


def from_to(values: Sequence[float]) -> str:
    """Smallest and largest."""
    return f"{min(values):.2f} .. {max(values):.2f}"


def inner(values: Sequence[float]) -> str:
    """Quantiles of 5 and 95 %."""
    low, high = np.quantile(values, INNER)
    return f"{low:.2f} .. {high:.2f}"


def number(hits: Iterable[bool]) -> int | str:
    """How many; nothing where there are none."""
    return sum(hits) or ""


def ways(found: Sequence[Judged]) -> list[str]:
    """How the way ended, by kind of valve."""
    rows = []
    for name, loops in by_kind(found):
        ends = Counter(one.gate or one.outcome for one in loops)
        rows.append((name, len(loops), *(ends[end] or "" for end in (BLOCK, *STEPS, NOTHING_WRONG, REFUSED))))
    closed = (f"closed at {step}" for step in STEPS)
    return table(("valve", "loops", "a block", *closed, NOTHING_WRONG, REFUSED), rows)


def gains(found: Sequence[Judged]) -> list[str]:
    """What the blocks do on the valves that they were made for."""
    rows = []
    for name, loops in by_kind(blocked(found)):
        if not loops:
            continue
        errors, travels = [one.error for one in loops], [one.measured[AS_IT_IS].travel for one in loops]
        rows.append((
            name, len(loops), median(errors), from_to(errors), median(one.ideal for one in loops),
            median(one.share_of_gain for one in loops), median(travels), f"{max(travels):.2f}",
            number(error > WORSE for error in errors), number(one.misplaced for one in loops),
        ))  # fmt: skip
    head = ("error ratio", "from .. to", "of an ideal valve", "share of the ideal gain", "stem travel ratio", "largest")
    wrong = ("made worse", "no fault, or one of another kind")
    return table(("valve", "blocks", *head, *wrong), rows) if rows else NONE


def other_valves(found: Sequence[Judged]) -> list[str]:
    """The same blocks on valves that have changed since."""
    blocks = blocked(found)
    if not blocks:
        return NONE
    rows = []
    for name in VALVES:
        errors = [one.measured[name].error for one in blocks]
        travels = [one.measured[name].travel for one in blocks]
        rows.append((
            name, len(blocks), median(errors), number(error > WORSE for error in errors), f"{max(errors):.2f}",
            median(travels), f"{max(travels):.2f}",
        ))  # fmt: skip
    head = ("error ratio", "made worse", "worst error ratio", "stem travel ratio", "largest stem travel ratio")
    return table(("true valve", "blocks", *head), rows)


def promises(found: Sequence[Judged]) -> list[str]:
    """What the study foretold beside what was measured."""
    blocks = blocked(found)
    if not blocks:
        return NONE
    kinds = {
        "foretold error ratio": [one.foretold for one in blocks],
        "measured error ratio": [one.error for one in blocks],
        "measured over foretold": [one.over_foretold for one in blocks],
    }
    rows = [(name, len(blocks), median(values), inner(values)) for name, values in kinds.items()]
    off = sum(one.far_off for one in blocks)
    said = f"Measured and foretold are more than {FAR_OFF:g} times apart in {off} of {len(blocks)} loops."
    return [*table(("promise", "blocks", "median", "5 .. 95 %"), rows), said, ""]


def cycles(found: Sequence[Judged]) -> list[str]:
    """Limit cycles that blocks begin, by what the lost motion is times that they were made for."""
    blocks, rows = blocked(found), []
    if not blocks:
        return NONE
    for size in SIZES_AT_REST:
        pairs = [one.cycles[size] for one in blocks]
        without = sum(pair.without > CYCLE_NOISE for pair in pairs)
        left = sum(pair.compensated > CYCLE_NOISE for pair in pairs)
        rows.append((f"{size:.2f}", len(blocks), without, left, sum(pair.begun for pair in pairs)))
    head = ("cycles without the block", "cycles with it", "begun or made larger by it")
    return table(("lost motion, times the true one", "blocks", *head), rows)


def bad_cases(found: Sequence[Judged]) -> list[str]:
    """A line for each block that does harm, or other than was foretold."""
    rows = [
        (one.kind, one.seed, truth_of(one), one.block_kind, f"{one.foretold:.2f}", f"{one.error:.2f}", "; ".join(wrong))
        for one in blocked(found)
        if (wrong := faults_of(one))
    ]
    head = ("valve", "seed", "truth", "block", "foretold", "measured", "what is wrong")
    return table(head, rows) if rows else NONE


def faults_of(one: Judged) -> list[str]:
    """What is wrong with a block, in words."""
    kind = ["another kind" if one.faulty else "no fault"] if one.misplaced else []
    errors = {name: one.measured[name].error for name in MADE_FOR}
    worse = [f"error {error:.2f}, valve {name}" for name, error in errors.items() if error > WORSE]
    begun = [
        f"cycle of {cycle.without:.1f} to {cycle.compensated:.1f} deviations of the noise at {size:.2f} of the size"
        for size, cycle in one.cycles.items()
        if cycle.begun
    ]
    return [*kind, *worse, *begun, *(["foretold otherwise"] if one.far_off else [])]


def truth_of(one: Judged) -> str:
    """Process and fault, in words."""
    if not one.faulty:
        return f"{one.process}, no fault"
    jump = f", J {one.jump:.2f} %" if one.kind in STICKING else ""
    return f"{one.process}, S {one.size:.2f} %{jump}"


def missed(found: Sequence[Judged]) -> list[str]:
    """Faulty loops without a block, by the gate that closed and what it said."""
    without = [one for one in found if one.faulty and not one.blocked]
    if not without:
        return NONE
    rows = []
    for end in (*STEPS, NOTHING_WRONG, REFUSED):
        here = [one for one in without if (one.gate or one.outcome) == end]
        if here:
            rows.append((end, "all of these", len(here), number(one.missed for one in here)))
        for said, _ in Counter(wording(one.said) for one in here if one.said).most_common():
            such = [one for one in here if wording(one.said) == said]
            rows.append(("", said, len(such), number(one.missed for one in such)))
    rows.append(("**all**", "", len(without), number(one.missed for one in without)))
    return table(("closed at", "with the words", "faulty loops", "of these a true block is worth having"), rows)


def wording(said: str) -> str:
    """A sentence without its numbers."""
    return re.sub(r"\d+(?:\.\d+)?", "#", said)


def repaired_harm(found: Sequence[Judged]) -> str:
    """How many blocks harm a valve that came back from a service, in a sentence."""
    blocks = blocked(found)
    worse = sum(one.measured[REPAIRED].error > WORSE for one in blocks)
    return f"{worse} of {len(blocks)} blocks make a repaired valve worse by more than {100 * (WORSE - 1):.0f} %"
