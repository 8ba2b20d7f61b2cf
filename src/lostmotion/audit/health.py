"""Health of the audit itself: what could be judged, what could not, and why."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from lostmotion.audit.plant_view import PlantView
from lostmotion.audit.rules import findings_words
from lostmotion.plant import Unread
from lostmotion.store.judged import Judged
from lostmotion.store.rows import AssessmentRow, Stage
from lostmotion.store.run_rows import UnreadRow

OPEN = ("cannot tell", "not assessed", "failed")  # said of loops that were not judged
BY_RULE = "Of those judged {} are told by a rule (measurement, tuning, travel, swing), which clears no valve."
EXAMPLES = 3  # tags that are named with a reason
_NUMBER = re.compile(r"(?<![\w.])-?\d+(?:[.,]\d+)*(?:e[+-]?\d+)?|\d+")


@dataclass(frozen=True)
class Reason:
    """Why loops could not be judged, or what is wrong with their data.

    Attributes
    ----------
    text : str
        Numbers that differ from loop to loop as "least to most".
    tags : tuple of str
    """

    text: str
    tags: tuple[str, ...]

    @property
    def examples(self) -> str:
        """First tags, and how many more."""
        more = len(self.tags) - EXAMPLES
        return ", ".join(self.tags[:EXAMPLES]) + (f" and {more} more" if more > 0 else "")


@dataclass(frozen=True)
class Health:
    """Counts and reasons.

    Attributes
    ----------
    loops, judged, by_rule, screened, failed, cannot_tell, unfit, without_row : int
        Loops: all; of which something is said; of these by a rule of the audit; screened only; failed; diagnosed
        without an answer; with data that allow no judgement; not reached at all.
    not_judged, data : tuple of Reason
        Most frequent first.
    files, files_failed : int
        Of the source that gave no loop; of these, those with something wrong.
    """

    loops: int
    judged: int
    by_rule: int
    screened: int
    failed: int
    cannot_tell: int
    unfit: int
    without_row: int
    not_judged: tuple[Reason, ...]
    data: tuple[Reason, ...]
    files: int
    files_failed: int

    def sentence(self) -> str:
        """In one line."""
        said = f"{self.judged} of {self.loops} loops could be judged"
        parts = [
            (self.cannot_tell, "cannot be told from these records"),
            (self.screened, "not assessed"),
            (self.failed, "failed"),
            (self.without_row, "not reached"),
        ]
        rest = ", ".join(f"{count} {what}" for count, what in parts if count)
        said = f"{said}; {rest}: they are not cleared." if rest else f"{said}."
        return f"{said} {BY_RULE.format(self.by_rule)}" if self.by_rule else said

    def findings(self, said: Mapping[str, int]) -> str:
        """Findings in words, from counts of what was said; that there are none is said of judged loops only."""
        return findings_words(said) if self.judged else "none, as no loop could be judged"

    @property
    def all_well(self) -> str:
        """What is said where no loop has a priority; empty where nothing was judged."""
        if not self.judged:
            return ""
        if self.judged == self.loops:
            return "No loop needs a hand, as far as the data tell."
        one = self.judged == 1
        which = (
            "The one loop that could be judged needs no hand"
            if one
            else (f"None of the {self.judged} loops that could be judged needs a hand")
        )
        return f"{which}, as far as the data tell."


def health_of(view: PlantView) -> Health:
    """Health of a run."""
    return health_of_rows(view.leading, set(view.by_tag), view.unread)


def health_of_rows(
    rows: Sequence[AssessmentRow | Judged], tags: set[str], unread: Sequence[Unread | UnreadRow]
) -> Health:
    """The same from one row a loop, the tags of all loops, and what gave no loop."""
    said = Counter(row.said for row in rows)
    seen = {row.tag for row in rows}
    open_rows = [row for row in rows if row.said in OPEN]
    return Health(
        loops=len(tags),
        judged=len(rows) - len(open_rows),
        by_rule=sum(bool(row.rule) for row in rows),
        screened=said["not assessed"],
        failed=said["failed"],
        cannot_tell=said["cannot tell"],
        unfit=sum(not row.fit_for_use for row in rows),
        without_row=len(tags - seen),
        not_judged=reasons_of((row.tag, why_not(row)) for row in open_rows),
        data=reasons_of((row.tag, text) for row in rows for text in row.health),
        files=len(unread),
        files_failed=sum(one.failed for one in unread),
    )


def why_not(row: AssessmentRow | Judged) -> str:
    """Why a loop was not judged, in words."""
    if row.stage is Stage.FAILED:
        return f"failed: {row.error or 'no reason was kept'}"
    if row.stage is Stage.SCREENED:
        return f"not assessed: {row.reason or 'no reason was kept'}"
    return f"cannot tell: {row.why or 'no cause is probable enough'}"


@lru_cache(maxsize=4096)
def _form(text: str) -> str:
    return _NUMBER.sub("\0", text.replace("\0", ""))


def reasons_of(pairs: Iterable[tuple[str, str]]) -> tuple[Reason, ...]:
    """Texts about loops, the most frequent first; those that differ in their numbers only are one.

    Examples
    --------
    >>> reasons_of([("FIC-1", "move SP by 2 %"), ("FIC-2", "retune"), ("FIC-3", "move SP by 4 %")])[0]
    Reason(text='move SP by 2 to 4 %', tags=('FIC-1', 'FIC-3'))
    """
    tags: dict[str, list[str]] = defaultdict(list)
    texts: dict[str, set[str]] = defaultdict(set)
    for tag, text in pairs:
        form = _form(text)
        tags[form].append(tag)
        texts[form].add(text)
    found = [Reason(_joined(form, texts[form]), tuple(mine)) for form, mine in tags.items()]
    return tuple(sorted(found, key=lambda one: -len(one.tags)))


def _joined(form: str, texts: set[str]) -> str:
    """Texts of one form as one, with the least and the most of each number.

    Examples
    --------
    >>> texts = {f"steps of {step} in a range of 2" for step in ("0.5", "0.1", "1.2")}
    >>> _joined(_form("steps of 1 in a range of 2"), texts)
    'steps of 0.1 to 1.2 in a range of 2'
    """
    if len(texts) == 1:
        return next(iter(texts))
    each = zip(*(_NUMBER.findall(text) for text in texts), strict=True)
    parts = form.split("\0")
    return parts[0] + "".join(_between(numbers) + part for numbers, part in zip(each, parts[1:], strict=True))


def _between(numbers: Sequence[str]) -> str:
    ordered = sorted(set(numbers), key=_value)
    return ordered[0] if len(ordered) == 1 else f"{ordered[0]} to {ordered[-1]}"


def _value(number: str) -> tuple[float, str]:
    try:
        return float(number.replace(",", "")), number
    except ValueError:  # a version, or a date with points
        return 0.0, number
