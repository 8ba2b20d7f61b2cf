"""The tables of the page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from one_ingredient.changes import CHANGES
from one_ingredient.judge import (
    ACCUSED,
    CALLED_SOUND,
    CANNOT_TELL,
    FAULTS,
    LIMIT,
    MET_OFTEN,
    OF_FAULTY,
    OF_SOUND,
    OTHER_STICKING,
    REFUSED,
    RIGHT,
    SAID_SOUND,
    Judged,
)
from pages.written import share, some, table

EDGES = ((0.5, 0.7), (0.7, 0.9), (0.9, 1.0))  # of the claimed probability


def counted(found: Sequence[Judged]) -> list[Judged]:
    """Without faults that are hardly met."""
    return [one for one in found if not one.faulty or one.findable]


def by_ingredient(found: Sequence[Judged]) -> list[tuple[str, list[Judged]]]:
    """Loops of each ingredient, and all."""
    names = [name for name in CHANGES if any(one.ingredient == name for one in found)]
    rows = [(f"{CHANGES[name].words} (`{name}`)", [one for one in found if one.ingredient == name]) for name in names]
    return [*rows, ("**all**", list(found))]


def sound_valves(found: Sequence[Judged]) -> list[str]:
    """Of each ingredient, what is said of valves without a fault."""
    rows = []
    for name, loops in by_ingredient(found):
        said = Counter(one.judgement for one in loops if not one.faulty)
        rows.append((name, said.total(), *(said[how] or "" for how in OF_SOUND)))
    return table(("what is changed", "valves without a fault", *OF_SOUND), rows)


def faulty_valves(found: Sequence[Judged]) -> list[str]:
    """Of each ingredient, what is said of valves with a fault."""
    rows = []
    for name, loops in by_ingredient(found):
        met = [one for one in loops if one.faulty and one.findable]
        said: dict[str, object] = dict(Counter(one.judgement for one in met))
        if CALLED_SOUND in said:
            said[CALLED_SOUND] = f"{said[CALLED_SOUND]} ({sum(one.cleared for one in met)})"
        rows.append((
            name, len(met), *(said.get(how, "") for how in OF_FAULTY), some(one.held for one in met if one.sized),
            some(one.hidden for one in met if one.bounded), sum(one.faulty for one in loops) - len(met) or "",
        ))  # fmt: skip
    judgements = [f"{how} (of these cleared)" if how == CALLED_SOUND else how for how in OF_FAULTY]
    head = ("intervals that hold the size", "finite bounds of the true kind below it", "left out: hardly met")
    return table(("what is changed", "valves with a fault", *judgements, *head), rows)


def claims(found: Sequence[Judged]) -> list[str]:
    """How many of the claims are right, by the probability that was claimed."""
    claimed = [one for one in counted(found) if one.verdict not in (CANNOT_TELL, REFUSED)]
    rows = []
    for low, high in EDGES:
        these = [one for one in claimed if low <= one.confidence < high or one.confidence == high == EDGES[-1][1]]
        for name, faults in (("a fault", True), ("no fault", False)):
            ones = [one for one in these if (one.verdict in FAULTS) is faults]
            mean = f"{np.mean([one.confidence for one in ones]):.2f}" if ones else "-"
            edges = f"{low:g} to {high:g}"
            rows.append((edges, name, len(ones), mean, share(map(_cause_is_right, ones)), share(map(_is_right, ones))))
    head = ("probability", "claimed", "loops", "mean", "a fault or none, as claimed", "and its kind")
    return table(head, rows)


def _cause_is_right(one: Judged) -> bool:
    return one.judgement == LIMIT or (one.verdict in FAULTS) is one.faulty


def _is_right(one: Judged) -> bool:
    return one.judgement in (RIGHT, SAID_SOUND, LIMIT)


def wrong_decisions(found: Sequence[Judged]) -> list[str]:
    """A line for each fault cleared, sound valve accused, and bound more than a tenth below the truth."""
    wrong = [one for one in found if one.judgement == ACCUSED or one.wrongly_cleared or one.well_hidden]
    if not wrong:
        return ["None.", ""]
    rows = [(one.ingredient, one.seed, truth_of(one), said_of(one)) for one in wrong]
    return table(("ingredient", "seed", "truth", "what was said"), rows)


def truth_of(one: Judged) -> str:
    """In words."""
    if not one.faulty:
        return "no fault"
    size = f" of {one.size:.3g} %" if np.isfinite(one.size) else ""
    rule = f" ({one.friction})" if one.friction else ""
    return f"{one.kind}{size}{rule}" + ("" if one.findable else f", met {one.met} times")


def said_of(one: Judged) -> str:
    """In words."""
    said = f"{one.verdict}, {one.confidence:.2f}"
    if one.verdict in FAULTS and np.isfinite(one.interval).all():
        said += f", {one.interval[0]:.3g} to {one.interval[1]:.3g} %"
    if one.bounded:
        said += f"; no {one.kind} above {one.bound:.3g} %"
    return said + ("; cleared" if one.cleared else "")


def summary(found: Sequence[Judged]) -> list[str]:
    """Totals in words and numbers."""
    loops = counted(found)
    sound, faulty = [one for one in loops if not one.faulty], [one for one in loops if one.faulty]
    judgements = [one.judgement for one in faulty]
    rows = [
        ("sound valves accused", share(one.judgement == ACCUSED for one in sound)),
        ("sound valves cleared", share(one.cleared for one in sound)),
        (f"faults met {MET_OFTEN} times and more: the kind named", share(how == RIGHT for how in judgements)),
        ("the kind or the other sticking kind named", share(how in (RIGHT, OTHER_STICKING) for how in judgements)),
        ("a fault named", share(one.verdict in FAULTS for one in faulty)),
        ("faults cleared", share(one.cleared for one in faulty)),
        ("intervals that hold the size", share(one.held for one in faulty if one.sized)),
        ("finite bounds of the true kind below the size", share(one.hidden for one in faulty if one.bounded)),
        ("of these, more than a tenth below", share(one.well_hidden for one in faulty if one.hidden)),
    ]
    return table(("totals", "loops"), rows)
