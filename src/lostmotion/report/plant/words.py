"""Numbers and verdicts of rows as people read them; unknown is an empty text or a word, never a made-up number."""

from __future__ import annotations

import math
from datetime import datetime
from pathlib import Path

from lostmotion.audit.health import OPEN
from lostmotion.audit.plant_view import FAULTS, RunFacts
from lostmotion.audit.row_facts import ends_percent, of_what
from lostmotion.audit.rules import advice_of, rule_of, sure_of
from lostmotion.diagnose.evidence_words import KIND, probability
from lostmotion.files.paths import is_pattern
from lostmotion.plant import PlantLoop
from lostmotion.plant.address import parsed
from lostmotion.printable import shell_line, shell_word
from lostmotion.report.digits import FINEST, digits, plain, span
from lostmotion.store.rows import MEASUREMENT, UNDATED, AssessmentRow, Stage

NO_ANSWER = "–"
MEASURED = "measured"  # how sure a fact is that needs no diagnosis
LETTER = {  # NE 107, with the letter that stands in its symbol
    "failure": "F",
    "function check": "C",
    "out of specification": "S",
    "maintenance required": "M",
    "normal": "N",
}
FINDING, ELSEWHERE, UNDECIDED = "!", "~", "?"  # marks of loops without a label
HEADLINE = {
    "none": "Nothing wrong with the actuator",
    "other oscillation": "The loop swings, but not because of the actuator",
    "cannot tell": "Cannot tell",
}
UNITS = ((172_800.0, 86_400.0, "days"), (7200.0, 3600.0, "h"), (180.0, 60.0, "min"), (0.0, 1.0, "s"))  # from .. s on


def mark(row: AssessmentRow) -> str:
    """Letter of a loop: of its label; without one of a finding, of a loop that is none, or of one that is undecided.

    Examples
    --------
    >>> made = {"stage": Stage.ASSESSED, "verdict": "cannot tell"}
    >>> mark(AssessmentRow("FIC-1", UNDATED, UNDATED, **made))
    '?'
    >>> mark(AssessmentRow("FIC-1", UNDATED, UNDATED, rule="ringing", priority=35.0, **made))
    '!'
    """
    if row.label:
        return LETTER[row.label]
    return FINDING if row.is_finding else UNDECIDED if row.said in OPEN else ELSEWHERE


def size_words(row: AssessmentRow) -> str:
    """Size in % of span; empty where none is known."""
    ends = ends_percent(row)
    if row.size_percent is None:
        return ""
    return sized(row.size_percent, ends)[0] if ends else f"about {row.size_percent:.2g}"


def interval_words(row: AssessmentRow) -> str:
    """95 % interval in % of span; "apparent" for a size that has none."""
    ends = ends_percent(row)
    if row.size_percent is None:
        return ""
    return sized(row.size_percent, ends)[1] if ends else "apparent, no interval"


def sized(value: float, ends: tuple[float, float]) -> tuple[str, str]:
    """Value and interval with the digits that matter.

    Examples
    --------
    >>> sized(4.0321, (3.81, 4.26))
    ('4.03', '3.81 .. 4.26')
    """
    error = max((ends[1] - ends[0]) / 4.0, FINEST * abs(value), 1e-300)
    return digits(value, error)[0], span(*ends, error)


def excluded_words(row: AssessmentRow) -> str:
    """Largest size that is not excluded, in % of span; nothing of what rests on a measurement that is at fault.

    Examples
    --------
    >>> excluded_words(AssessmentRow("FIC-1", UNDATED, UNDATED, excluded_percent=0.412))
    'up to 0.41 % not excluded'
    """
    if (
        row.excluded_percent is None
        or math.isnan(row.excluded_percent)
        or row.verdict in FAULTS
        or row.rule in MEASUREMENT
    ):
        return ""
    if math.isinf(row.excluded_percent):
        return "any size not excluded"
    return f"up to {row.excluded_percent:.2g} % not excluded"


def sure_words(row: AssessmentRow) -> str:
    """Confidence of what is said of a loop, by its rule or its diagnosis; nothing where it cannot be told."""
    rule, sure = rule_of(row), sure_of(row)
    if rule is not None and sure == 1.0:
        return MEASURED
    if rule is None:
        return _sure_of_verdict(row)
    return "" if sure is None else probability(sure)


def _sure_of_verdict(row: AssessmentRow) -> str:
    if row.confidence is None or row.verdict == "cannot tell" or row.stage is not Stage.ASSESSED:
        return ""
    return probability(row.confidence)


def second_opinion(row: AssessmentRow) -> str:
    """What the diagnosis says where a rule of the audit decides; empty where the diagnosis decides.

    Examples
    --------
    >>> made = {"stage": Stage.ASSESSED, "priority": 35.0, "rule": "frozen measurement", "confidence": 0.8}
    >>> second_opinion(AssessmentRow("FIC-1", UNDATED, UNDATED, verdict="saturation", kind="actuator", **made))
    'diagnosis: saturation, 80 % sure'
    """
    if not row.rule or row.stage is not Stage.ASSESSED:
        return ""
    sure = _sure_of_verdict(row)
    return f"diagnosis: {row.verdict}" + (f", {sure} sure" if sure else "")


def headline(row: AssessmentRow) -> str:
    """What is said of it, where it comes from, size with interval, confidence, in one line."""
    if row.rule:
        return _by_rule(row)
    if row.stage is Stage.FAILED:
        return f"No result: {row.error or row.reason or 'it failed'}"
    if row.stage is Stage.SCREENED:
        return f"Not assessed: {row.reason or row.why or 'screened only'}"
    said = HEADLINE.get(row.verdict, row.verdict.capitalize())
    if row.verdict == "cannot tell":
        return f"{said}: {row.why}" if row.why else said
    if row.verdict == "other oscillation" and row.kind not in ("none", "unknown"):
        said += f": {row.kind}"
    if row.size_percent is not None:
        said += f", {size_words(row)} % {of_what(row)} ({_between(row)})"
        said += "" if row.severity == "unknown" else f", {row.severity}"
    return f"{said}, confidence {sure_words(row)}" if sure_words(row) else said


def _by_rule(row: AssessmentRow) -> str:
    sure = sure_words(row)
    end = f", confidence {sure}" if sure and sure != MEASURED else ""
    return f"{row.said.capitalize()}: {row.priority_reason.partition('; ')[0]}{end}"


def _between(row: AssessmentRow) -> str:
    between = interval_words(row)
    return between if ends_percent(row) is None else f"95 %: {between}"


def where_from(row: AssessmentRow) -> str:
    """Where it comes from, in a sentence."""
    rule = rule_of(row)
    return rule.where if rule is not None else KIND.get(row.kind, "")


def beside_fit(row: AssessmentRow) -> str:
    """Why a good fit does not contradict a verdict of "cannot tell"; empty where there are not both.

    Examples
    --------
    >>> row = AssessmentRow("FIC-1", UNDATED, UNDATED, stage=Stage.ASSESSED, status="OK", probability=0.48)
    >>> "neither shown nor excluded: its probability is 48 %" in beside_fit(row)
    True
    """
    if row.rule or row.verdict != "cannot tell" or row.status != "OK" or row.stage is not Stage.ASSESSED:
        return ""
    known = "" if row.probability is None else f": its probability is {probability(row.probability)}"
    open_ = "the evidence lacks what is said above" if row.why else f"a fault is neither shown nor excluded{known}"
    return (
        "The fit is OK, and does not contradict this: it says how well its model follows PV, and its sizes and their "
        "intervals hold if that model is true. The verdict asks whether the actuator is at fault, and weighs all that "
        f"the record shows, the fit among it; here {open_}. Take the sizes of the fit as a suspicion, not as a finding."
    )


def seconds_words(seconds: float) -> str:
    """Length of time.

    Examples
    --------
    >>> seconds_words(86_400.0), seconds_words(93.2), seconds_words(5400.0)
    ('24 h', '93.2 s', '90 min')
    """
    _, scale, unit = next(one for one in UNITS if abs(seconds) >= one[0])
    return f"{plain(seconds / scale)} {unit}"


def share_words(share: float | None) -> str:
    """Share of time in whole percent."""
    if share is None:
        return NO_ANSWER
    return "under 1 %" if 0.0 < share < 0.01 else f"{100.0 * share:.0f} %"


def number_words(value: float | None) -> str:
    """Three digits, or a dash where it is not known."""
    return NO_ANSWER if value is None or not math.isfinite(value) else plain(value)


def moment_words(moment: datetime | None) -> str:
    """Date and time, in UTC where the zone is known; of a record without dates nothing."""
    if moment is None or moment.year <= UNDATED.year:
        return ""
    return f"{moment.day} {moment:%b %Y %H:%M}{' UTC' if moment.tzinfo else ''}"


def window_words(row: AssessmentRow) -> str:
    """From when to when; of a record without dates how long."""
    if row.window_start.year <= UNDATED.year:
        return f"{seconds_words((row.window_end - row.window_start).total_seconds())}, not dated"
    return f"{moment_words(row.window_start)} to {moment_words(row.window_end)}"


def other_reasons(row: AssessmentRow) -> str:
    """Reason of the priority without fault, size and certainty, which have columns of their own.

    Examples
    --------
    >>> reason = "backlash of 14 % of span (14 .. 15), 96 % sure; swings every 902 s"
    >>> made = {"stage": Stage.ASSESSED, "verdict": "backlash", "priority_reason": reason}
    >>> other_reasons(AssessmentRow("FIC-1", UNDATED, UNDATED, **made))
    'swings every 902 s'
    """
    first, _, rest = row.priority_reason.partition("; ")
    return rest if row.said in FAULTS and first.startswith(row.said) else row.priority_reason


def next_step(row: AssessmentRow) -> str:
    """First thing to do, short; empty where none is known."""
    if advice_of(row):
        return advice_of(row)[0]
    return "Mend the source, or say what is missing in a loop list." if row.stage is Stage.FAILED else ""


def typed_place(loop: PlantLoop, run: RunFacts) -> str:
    """Where the data of a loop lie, as a command takes it."""
    files, name = files_of(loop, run)
    return shell_line([*files, *(["--loop", name] if name else [])]) if files else shell_word(f"{loop.tag}.csv")


def files_of(loop: PlantLoop, run: RunFacts) -> tuple[list[str], str]:
    """Files of a loop as they are found from where the audit ran, and what it is called in them."""
    if not loop.where:
        return [], ""
    places = parsed(loop.where)
    root = Path(run.sources[0]) if len(run.sources) == 1 and ", " not in run.sources[0] else Path()
    while is_pattern(root):
        root = root.parent
    inside = root.parent if root.is_file() else root
    return [str(inside / file) for place in places for file in place.files], places[0].loop


def next_command(loop: PlantLoop, row: AssessmentRow, run: RunFacts) -> str:
    """What to type next about this loop; quoted for a shell."""
    file = typed_place(loop, run)
    if row.stage is Stage.FAILED and loop.where:
        return f"lostmotion check {file}"
    if row.stage is not Stage.ASSESSED and not row.rule and run.store:
        return f"lostmotion audit {shell_line(run.sources)} --store {shell_word(run.store)}"
    untellable = row.stage is Stage.SCREENED and not row.value  # a diagnosis would tell nothing
    if row.rule in MEASUREMENT or not row.fit_for_use or untellable:
        return f"lostmotion check {file}"
    if not row.rule and may_be_studied(row):
        return f"lostmotion simulate {file}"
    if (
        not run.number and row.verdict in FAULTS and row.size is not None
    ):  # it is diagnosed already: what closes the gate, and what opens it
        return f"lostmotion solve {file}"
    return f"lostmotion diagnose {file} --figure {shell_word(loop.tag + '.png')}"


def may_be_studied(row: AssessmentRow) -> bool:
    """Whether the gate and the study let the fit of a row pass, as far as its stretches tell.

    Examples
    --------
    >>> row = AssessmentRow("FIC-1", UNDATED, UNDATED, verdict="stiction", size=1.0, indices={"gate_open": 1.0})
    >>> may_be_studied(row), may_be_studied(AssessmentRow("FIC-1", UNDATED, UNDATED, verdict="stiction", size=1.0))
    (True, False)
    """
    return row.verdict in FAULTS and row.size is not None and row.indices.get("gate_open", 0.0) > 0.0
