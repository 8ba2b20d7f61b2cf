"""Rules of the audit that decide about a loop whatever its diagnosis sees: what is said, how sure, what to do."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from lostmotion.diagnose import frozen, ringing
from lostmotion.errors import DataError
from lostmotion.store.rows import FAULTS, AssessmentRow

SENSOR, VALVE, ENDED = "sensor to look at", "valve at fault", "valve at its limits"
RINGS_SURE = 0.8  # that a loop is to be tuned whose swing comes and goes


@dataclass(frozen=True)
class Rule:
    """What is said of a loop where a rule decides its priority; the diagnosis is a second opinion there.

    Attributes
    ----------
    opening : str
        First words of what the reason of the priority tells of it.
    name : str
        In the place of a verdict; stands in the rows that it decides.
    where : str
        Where it comes from, a sentence.
    advice : tuple of str
        Most important first.
    finding : str
        What it finds, in the singular; empty: nothing that is wrong with the loop itself.
    sure : float, optional
        How sure it is: 1: it is measured. None: as sure as the diagnosis is that it is not the actuator.
    """

    opening: str
    name: str
    where: str
    advice: tuple[str, ...]
    finding: str = ""
    sure: float | None = 1.0


FROZEN = Rule(
    "PV stood still",
    "frozen measurement",
    frozen.FROZEN.where,
    frozen.FROZEN.advice,
    SENSOR,
)
NOISY = Rule(
    "PV scatters over",
    "noisy measurement",
    "It comes from the measurement: PV scatters from row to row.",
    (
        "Look at the measurement and its damping: mounting, earthing, impulse line, filter time of the transmitter.",
        "Record the loop again with less noise: the valve cannot be told behind it.",
    ),
    SENSOR,
)
RINGING = Rule(
    "hardly settles: retune",
    "ringing",
    ringing.RINGING.where,
    ringing.RINGING.advice,
    "loop to retune",
    RINGS_SURE,
)
FORCED = Rule(
    "its amplitude stays: not its tuning",
    "forced swing",
    ringing.DRIVEN.where,
    ringing.DRIVEN.advice,
    sure=None,
)
WEARING = Rule(
    "OP travels",
    "wear by travel",
    "It comes from what drives OP: the valve never rests, and wears.",
    ("Calm OP: filter the measurement, lower the gain or the derivative action, or widen the dead band of the PI.",),
    "valve that never rests",
)
RULES = {rule.name: rule for rule in (FROZEN, NOISY, RINGING, FORCED, WEARING)}


def rule_of(row: AssessmentRow) -> Rule | None:
    """Rule that decides the priority of a row; None: its diagnosis does, or it has none.

    Raises
    ------
    DataError
        A rule that this version does not know.

    Examples
    --------
    >>> from lostmotion.store.rows import UNDATED
    >>> rule_of(AssessmentRow("PIC-1", UNDATED, UNDATED, priority=35.0, rule="frozen measurement")) is FROZEN
    True
    >>> rule_of(AssessmentRow("PIC-1", UNDATED, UNDATED, priority=35.0)) is None
    True
    """
    if not row.rule:
        return None
    if row.rule not in RULES:
        raise DataError.expected(f"one of {', '.join(RULES)}", repr(row.rule), "run the audit with this version")
    return RULES[row.rule]


def finding_of(said: str) -> str:
    """What is found where this is said of a loop, by a rule or a diagnosis, in the singular; empty: nothing.

    Examples
    --------
    >>> finding_of("saturation"), finding_of("frozen measurement"), finding_of("forced swing"), finding_of("none")
    ('valve at its limits', 'sensor to look at', '', '')
    """
    if said in RULES:
        return RULES[said].finding
    return (ENDED if said == "saturation" else VALVE) if said in FAULTS else ""


def findings_counted(said: Mapping[str, int]) -> list[tuple[str, int]]:
    """How often each finding came, the most frequent first, from how often what was said.

    Examples
    --------
    >>> findings_counted({"ringing": 2, "frozen measurement": 1, "noisy measurement": 2, "none": 9})
    [('sensor to look at', 3), ('loop to retune', 2)]
    """
    counted: Counter[str] = Counter()
    for word, count in said.items():
        counted[finding_of(word)] += count
    return [(found, count) for found, count in counted.most_common() if found]


def findings_words(said: Mapping[str, int]) -> str:
    """The same in words; "none" where there is none.

    Examples
    --------
    >>> findings_words({"ringing": 2, "frozen measurement": 1}), findings_words({})
    ('2 loops to retune, 1 sensor to look at', 'none')
    """
    return ", ".join(f"{n} {_many(one) if n > 1 else one}" for one, n in findings_counted(said)) or "none"


def _many(found: str) -> str:
    first, _, rest = found.partition(" ")
    return f"{first}s {rest.replace('its', 'their').replace('rests', 'rest')}"


def sure_of(row: AssessmentRow) -> float | None:
    """How sure is what is said of a row: by its rule, or by its diagnosis."""
    rule = rule_of(row)
    return row.confidence if rule is None or rule.sure is None else rule.sure


def advice_of(row: AssessmentRow) -> tuple[str, ...]:
    """What to do about a row: by its rule, or by its diagnosis."""
    rule = rule_of(row)
    return row.advice if rule is None else rule.advice
