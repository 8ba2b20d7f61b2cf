"""The tables of the page."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from pages.written import share, some, table
from published_loops.judge import FAULTS, Judged

SURE = 0.9
EDGES = ((0.5, 0.7), (0.7, SURE), (SURE, 1.0))  # of the claimed probability
MODELS = {
    "Play": "backlash (Hägglund 2007)",
    "Stenman": "one parameter (Stenman et al. 2003)",
    "Kano": "S and J (Kano et al. 2004)",
    "Choudhury": "S and J (Choudhury et al. 2005)",
    "He": "fS and fD (He et al. 2007)",
    "Chen": "fS and fD, slides on (Chen et al. 2008)",
    "Karnopp": "mass and spring, Karnopp 1985 (Kayihan and Doyle 2000)",
    "LuGre": "bristles, LuGre (Canudas de Wit et al. 1995)",
    "Behind": "Kano's, He's or backlash behind a lag",
    "DeadZone": "dead zone",
}


def summary(found: Sequence[Judged]) -> list[str]:
    """Totals."""
    told = [one for one in found if one.faulty and one.counted]
    sound = [one for one in found if not one.faulty]
    sized = [one for one in told if one.sized]
    claims = [one for one in found if _is_sure(one)]
    rows = [
        ("faults that the record can tell: named as a fault of the actuator", share(one.named for one in told)),
        ("of these named ones, the right kind", share(one.right_kind for one in told if one.named)),
        ("sizes within 15 % of the truth", share(one.near for one in sized)),
        ("intervals that hold the true size", share(one.held for one in sized)),
        ("faults left open", share(one.open for one in told)),
        ('faults called "none" or "other oscillation"', share(one.called_sound for one in told)),
        ("faults cleared", share(one.cleared for one in told)),
        ("faults whose true size is said to be excluded", share(one.hidden for one in told)),
        ("faults that the record cannot tell: named", share(one.named for one in found if one.reason)),
        ("the same: cleared", share(one.cleared for one in found if one.reason)),
        ("sound valves accused", share(one.accused for one in sound)),
        ("sound valves cleared", share(one.cleared for one in sound)),
        ("sound valves left open", share(one.open for one in sound)),
        (f"claims with {SURE:g} and more, right about a fault or none", share(one.cause_is_right for one in claims)),
    ]
    return table(("totals", "loops"), rows)


def _is_sure(one: Judged) -> bool:
    return one.counted and not one.open and one.confidence >= SURE


def faulty(found: Sequence[Judged], what: str, group: Callable[[Judged], str]) -> list[str]:
    """A line for each group of faulty valves; `what` the groups are."""
    loops = [one for one in found if one.faulty]
    rows = []
    for name in (*dict.fromkeys(map(group, loops)), "**all**"):
        mine = [one for one in loops if name in ("**all**", group(one))]
        told = [one for one in mine if one.counted]
        sized = [one for one in told if one.sized]
        rows.append((
            name, len(mine), len(mine) - len(told) or "", sum(one.named for one in told),
            sum(one.right_kind for one in told), some(one.near for one in sized), some(one.held for one in sized),
            sum(one.open for one in told) or "", sum(one.called_sound for one in told) or "",
            sum(one.cleared for one in told) or "",
        ))  # fmt: skip
    head = (
        what, "loops", "of these not to be told", "named as a fault", "right kind", "size within 15 %",
        "interval holds the size", "left open", 'called "none" or "other oscillation"', "cleared",
    )  # fmt: skip
    return table(head, rows)


def sound(found: Sequence[Judged]) -> list[str]:
    """A line for each cause of what moves a sound loop."""
    loops = [one for one in found if not one.faulty]
    rows = []
    for name in (*dict.fromkeys(one.course for one in loops), "**all**"):
        mine = [one for one in loops if name in ("**all**", one.course)]
        counts = [sum(hits) for hits in zip(*(_of_sound(one) for one in mine), strict=True)]
        rows.append((name, len(mine), *(count or "" for count in counts)))
    head = ("what moves the loop", "loops", "cleared", "called sound, not cleared", "saturation, OP at its end", "open")
    return table((*head, "accused"), rows)


def _of_sound(one: Judged) -> tuple[bool, bool, bool, bool, bool]:
    limit = one.verdict == "saturation" and not one.accused
    return one.cleared, one.called_sound and not one.cleared and not limit, limit, one.open, one.accused


def claims(found: Sequence[Judged]) -> list[str]:
    """How many of the claims are right, by the probability that was claimed."""
    claimed = [one for one in found if one.counted and not one.open]
    rows = []
    for low, high in EDGES:
        these = [one for one in claimed if low <= one.confidence < high or one.confidence == high == EDGES[-1][1]]
        for name, named in (("a fault", True), ("no fault", False)):
            ones = [one for one in these if one.named is named]
            mean = f"{np.mean([one.confidence for one in ones]):.2f}" if ones else "-"
            rows.append((f"{low:g} to {high:g}", name, len(ones), mean, share(one.cause_is_right for one in ones)))
    return table(("probability", "claimed", "loops", "mean", "a fault or none, as claimed"), rows)


def gravity(one: Judged) -> tuple[float, ...]:
    """How bad a case is, the worst lowest; of the same sort the surest claim first, or the size furthest off."""
    sorts = (
        one.faulty and one.cleared,
        one.accused,
        one.hidden,
        one.faulty and one.called_sound,
        one.named and one.faulty and one.verdict not in ("backlash", "stiction", one.kind),
        one.sized and not one.held and not one.near,
        one.named and one.faulty and not one.right_kind,
        one.sized and not (one.held and one.near),
    )
    sort = next((k for k, hit in enumerate(sorts) if hit), len(sorts))
    return sort, -_off(one) if sort in (5, 7) else -one.confidence


def _off(one: Judged) -> float:
    """Error of the size, of the true one."""
    return abs(one.said / one.size - 1) if one.sized else 0.0


def worst(found: Sequence[Judged], most: int) -> list[str]:
    """A line for each of the worst cases."""
    bad = sorted((one for one in found if one.counted and gravity(one)[0] < 8), key=gravity)
    if not bad:
        return ["None.", ""]
    rows = [(f"`{one.name}`", truth_of(one), said_of(one)) for one in bad[:most]]
    left = [f"And {len(bad) - most} more, of which each has the wrong kind, or a size off.", ""]
    return [*table(("loop", "truth", "what was said"), rows), *(left if len(bad) > most else [])]


def not_told(found: Sequence[Judged]) -> list[str]:
    """A line for each loop that cannot be told."""
    rows = [(f"`{one.name}`", truth_of(one), one.reason, said_of(one)) for one in found if one.reason]
    return table(("loop", "truth", "why not", "what was said"), rows)


def truth_of(one: Judged) -> str:
    """In words."""
    if not one.faulty:
        return "no fault"
    jump = f", J {one.jump:.3g}" if one.jump else ""
    return f"{one.kind} of {one.size:.3g} %{jump}, {one.turns} turns"


def said_of(one: Judged) -> str:
    """In words."""
    said = f"{one.verdict}, {one.confidence:.2f}"
    if one.verdict in FAULTS and np.isfinite(one.said):
        said += f", {one.said:.3g} ({one.interval[0]:.3g} to {one.interval[1]:.3g}) %"
    if one.faulty and np.isfinite(one.bound):
        said += f"; no {one.kind} above {one.bound:.3g} %"
    return said + ("; cleared" if one.cleared else "")
