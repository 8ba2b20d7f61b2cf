"""Which loops first: technical severity x economic weight x confidence, in numbers and in words.

Technical severity is 0 to 1: `LOST` of it for the size of the lost motion (half at the 2 % of span that is usual for a
control valve, severity_of), the rest for what the loop does with it: the share of the variance that is a regular swing,
or of the time with OP at a limit. The weight is that of the loop list over the largest one of the plant. Confidence is
the probability of the verdict; where none was reached it is the probability of an actuator fault, if that is more than
the prior, for a size that is not excluded, and all counts by `UNTOLD`: a test comes first. A measurement that stood
still while OP moved, or scatters over a good part of its span from row to row, is a fact, and so is an OP that never
rests: it wears the valve. These, and that a loop rings, are told of a loop that was only screened, too.
A loop that swings because another one of its group does so is looked at after that one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import datetime
from typing import NamedTuple

from lostmotion.audit.labels import Around, disturbed, label_of, makes_it_swing, split_of, swings
from lostmotion.audit.measurement import of_measurement, stuck, usual_scatter
from lostmotion.audit.row_facts import ends_percent, in_span, of_what, order
from lostmotion.audit.rules import FORCED, RINGING, RINGS_SURE, WEARING, Rule
from lostmotion.diagnose.control_error.amplitude import STEADY, WANDERS
from lostmotion.diagnose.evidence_words import probability
from lostmotion.plant import PlantLoop
from lostmotion.store.rows import AssessmentRow, GroupRow, Stage

LOST = 0.7  # share of lost motion in the technical severity
USUAL = 2.0  # % of span: a lost motion that counts half
UNSIZED = 0.5  # of a fault whose size in % of span is not known
UNTOLD = 0.5
ELSEWHERE = 0.5  # share of a swing that does not come from the actuator: a valve is mended, a loop is retuned
CARRIED = 0.25  # share of a swing that comes from another loop: it ends when that one is mended
WEAK = {"poor": 0.02, "fair": 0.01}  # severity of a class of performance where nothing is found
PRIOR = 0.25  # probability of a fault of any actuator: what is above it is what a record has said
TOLD = 0.25  # of that: less is not told
LOUD = 2.0  # % of span of PV: an error of control of this deviation matters in any loop
BUSY = 20.0  # full strokes of OP an hour: from one in three minutes on a valve wears
WORN = 0.3  # severity of a valve that never rests


class Found(NamedTuple):
    """Technical severity times confidence, what it consists of, and the rule that decides; None: the diagnosis."""

    worth: float
    words: list[str]
    rule: Rule | None = None


def ranked(
    rows: Sequence[AssessmentRow], loops: Mapping[str, PlantLoop], groups: Sequence[GroupRow] = ()
) -> list[AssessmentRow]:
    """Rows with label, split, priority and its reason, the most urgent first; those that cannot be ranked last.

    Parameters
    ----------
    rows : sequence of AssessmentRow
    loops : mapping of str to PlantLoop
        By tag; the weight of a loop that is not there is 1.
    groups : sequence of GroupRow
        Loops that swing together, with the likely source.

    Examples
    --------
    >>> from lostmotion.store.rows import UNDATED
    >>> row = AssessmentRow("FIC-1", UNDATED, UNDATED, stage=Stage.ASSESSED, verdict="stiction", kind="actuator",
    ...                     size_percent=3.1, severity="high", confidence=0.97)
    >>> first = ranked([row], {})[0]
    >>> first.label, first.split, round(first.priority)
    ('maintenance required', 'actuator', 41)
    """
    largest = max((loop.weight for loop in loops.values()), default=1.0) or 1.0
    sources = {(tag, start): one.source for one in groups if one.source for tag, start, _, _ in one.members}
    usual, steady = usual_scatter(rows, loops), _steady(rows, groups)
    found = []
    for row in rows:
        loop = loops.get(row.tag)
        weight, kind = (1.0, "") if loop is None else (loop.weight, loop.loop_type)
        key = row.tag, row.window_start
        tells = loop is not None and loop.pv_span is not None and kind != "level"
        master = loop is not None and bool(loop.slave)
        around = Around(weight / largest, sources.get(key, ""), usual.get(kind), key in steady, tells, master)
        found.append(_with_priority(row, around))
    return sorted(found, key=lambda row: (order(row), row.tag, row.window_start))


def _steady(rows: Sequence[AssessmentRow], groups: Sequence[GroupRow]) -> set[tuple[str, datetime]]:
    """Members of groups whose strongest swing keeps its amplitude."""
    known = {(row.tag, row.window_start): row for row in rows}
    found: set[tuple[str, datetime]] = set()
    for group in groups:
        keys = [(tag, start) for tag, start, _, _ in group.members if (tag, start) in known]
        strongest = max(
            (known[key] for key in keys), key=lambda row: (row.power or 0.0) if swings(row) else 0.0, default=None
        )
        if strongest is not None and strongest.indices.get("amplitude_spread", WANDERS) < STEADY:
            found.update(keys)
    return found


def _with_priority(row: AssessmentRow, around: Around) -> AssessmentRow:
    priority, reason, rule = _priority(row, around)
    row = replace(row, priority=priority, priority_reason=reason, rule=rule)
    return replace(row, label=label_of(row, around), split=split_of(row, around))


def _priority(row: AssessmentRow, around: Around) -> tuple[float | None, str, str]:
    """Priority, its reason, and the name of the rule that decides."""
    if row.stage is Stage.FAILED:
        return None, f"not judged: {row.error}", ""
    found = _found(row, around)
    if found is None and not row.fit_for_use:
        return None, f"not judged: {'; '.join(row.health) or row.reason}", ""
    if found is None:
        return None, f"not assessed: {row.reason}", ""
    weight = around.weight
    words = [*found.words, f"weight {weight:.2g} of the largest"] if weight != 1.0 else found.words
    return 100.0 * found.worth * weight, "; ".join(words), "" if found.rule is None else found.rule.name


def _found(row: AssessmentRow, around: Around) -> Found | None:
    """What speaks for looking at a loop; None: nothing can be said of it."""
    measured = of_measurement(row, around.usual)
    if measured is not None:
        found = Found(measured[0], [measured[1]], measured[2])
        return found if stuck(row) else _with_wear(row, found)
    if not row.fit_for_use:
        return None
    return _by_screen(row, around) if row.stage is Stage.SCREENED else _with_wear(row, _worth(row, around))


def _by_screen(row: AssessmentRow, around: Around) -> Found | None:
    """Of a loop that was not diagnosed: that it rings or wears its valve needs no diagnosis. None: neither."""
    found = _rings(row, around) if makes_it_swing(row, around) else Found(0.0, [])
    found = found if around.master else _with_wear(row, found)
    return None if found.rule is None else found._replace(words=[*found.words, f"only screened: {row.reason}"])


def _rings(row: AssessmentRow, around: Around) -> Found:
    """Of a loop that is to be tuned."""
    swing, about_swing = _swing(row, around.source)
    way = "the likely source of its group" if row.tag == around.source else "its amplitude comes and goes"
    return Found(ELSEWHERE * RINGS_SURE * swing, [f"{RINGING.opening} ({way})", *about_swing], RINGING)


def _worth(row: AssessmentRow, around: Around) -> Found:
    """Of a loop that was diagnosed."""
    if makes_it_swing(row, around):
        return _rings(row, around)
    source = around.source
    swing, about_swing = _swing(row, source)
    sure = row.confidence or 0.0
    if row.verdict == "cannot tell":
        error, about_error = _avoidable(row, around)
        return _untold(row, max(swing, error), [*about_swing, *about_error])
    if row.verdict == "saturation":
        at = max(row.limited or 0.0, swing)
        return Found(
            (1.0 - LOST) * at, [f"OP at a limit for {probability(row.limited or 0.0)} of the time", *about_swing]
        )
    if row.kind == "actuator":
        size = row.size_percent if in_span(row) else None
        lost = UNSIZED if size is None else size / (size + USUAL)
        return Found(sure * (LOST * lost + (1.0 - LOST) * swing), [_fault(row), *about_swing])
    if row.verdict == "other oscillation":
        return _elsewhere(row, around, swing, about_swing)
    told = row.excluded_percent is not None and math.isfinite(row.excluded_percent)
    said = [] if not told else [f"no lost motion over {row.excluded_percent:.2g} % of span"]
    weak = WEAK.get(row.performance, 0.0)
    known = [*said, *([f"control is {row.performance}"] if weak else [])] or ["nothing wrong"]
    return Found(sure * weak, [*known, *(about_swing if source else [])])


def _elsewhere(row: AssessmentRow, around: Around, swing: float, about_swing: list[str]) -> Found:
    """Of a loop that swings, and not because of its actuator."""
    ways = {"tuning": "retune", "process": "look upstream", "sensor": "look at the measurement"}
    way = ways.get(split_of(row, around), "upstream or tuning")
    way = "look at what moves SP" if row.kind == "set point" else way
    share = CARRIED if disturbed(row, around) and not around.source else ELSEWHERE
    words = [f"not the actuator: {way}, {_sure(row)}", *about_swing]
    stays = row.kind == "tuning" and way != "retune"
    words += [FORCED.opening] if stays else []
    return Found(share * (row.confidence or 0.0) * swing, words, FORCED if stays else None)


def _untold(row: AssessmentRow, moves: float, about: list[str]) -> Found:
    """Of a loop that cannot be told; `moves`: what counts of its swing and its error of control, `about`: in words.

    A fault that one stretch shows, and none denies, counts as one of the usual size at most that was found, as probable
    as all stretches are.
    """
    fault = row.probability or 0.0
    likely = f"a fault of the actuator is {probability(fault)} likely"
    shown = row.indices.get("shown_percent")
    if shown is None:
        lost = LOST * _left_open(row) * fault if fault > PRIOR else 0.0
        return Found(UNTOLD * (lost + (1.0 - LOST) * moves), ["cannot tell", likely, *about])
    size = min(shown, USUAL) if in_span(row) else USUAL  # of one stretch: it may be far too wide
    worth = fault * LOST * size / (size + USUAL) + max(UNTOLD, fault) * (1.0 - LOST) * moves
    return Found(worth, [row.why, likely, *about])


def _left_open(row: AssessmentRow) -> float:
    """Severity of a lost motion that is not known: of half of what is not excluded, the usual one at most."""
    left = row.excluded_percent if in_span(row) else None
    half = USUAL if left is None else min(0.5 * left, USUAL)
    return half / (half + USUAL)


def _avoidable(row: AssessmentRow, around: Around) -> tuple[float, list[str]]:
    """What counts of the error that a controller with the same delay would not leave, its swing aside; its words."""
    if not around.tells or row.variability is None or row.harris is None:
        return 0.0, []
    swing = (row.power or 0.0) if swings(row) else 0.0
    left = row.variability * math.sqrt(max(1.0 - row.harris, 0.0) * (1.0 - swing))
    words = f"error of control {left:.2g} % of span that could be less"
    return min(left / LOUD, 1.0), [words] if left >= TOLD * LOUD else []


def _swing(row: AssessmentRow, source: str) -> tuple[float, list[str]]:
    """What counts of its swing, and its words."""
    swing = (row.power or 0.0) if swings(row) else 0.0
    if not swing or not row.period:
        return swing, []
    words = f"swings every {_period(row.period)}, {probability(swing)} of the variance"
    if source in ("", row.tag) or row.kind == "actuator":
        return swing, [words]
    return CARRIED * swing, [words, f"with {source}, the likely source: look there first"]


def _period(seconds: float) -> str:
    """Three digits, in a unit that has them before the point."""
    for scale, unit in ((1.0, "s"), (60.0, "min")):
        if seconds < 999.5 * scale:
            return f"{seconds / scale:.3g} {unit}"
    return f"{seconds / 3600.0:.3g} h"


def _with_wear(row: AssessmentRow, found: Found) -> Found:
    """What is said of OP that never rests, first where it counts most; a lost motion that was found counts more.

    Of the range that was seen a stroke is none.
    """
    strokes = (row.travel or 0.0) / 100.0 if in_span(row) else 0.0
    if strokes < BUSY or row.kind == "actuator":
        return found
    wear, said = WORN * (1.0 - BUSY / strokes), f"{WEARING.opening} {strokes:.0f} full strokes an hour: wear"
    if wear > found.worth and found.rule in (None, FORCED):
        return Found(found.worth + wear, [said, *found.words], WEARING)
    return Found(found.worth + wear, [*found.words, said], found.rule)


def _fault(row: AssessmentRow) -> str:
    """Kind, size with interval in % of span, and how sure."""
    size = ""
    if row.size_percent is not None:
        between = ends_percent(row)
        ends = "" if between is None else f" ({between[0]:.2g} .. {between[1]:.2g})"
        size = f" of {row.size_percent:.2g} % {of_what(row)}{ends}"
    return f"{row.verdict}{size}, {_sure(row)}"


def _sure(row: AssessmentRow) -> str:
    return "sureness not known" if row.confidence is None else f"{probability(row.confidence)} sure"
