"""An audit as text: what could be judged, what was found, where to look first, what is new."""

from __future__ import annotations

from collections import Counter

from lostmotion.audit.health import Health, health_of
from lostmotion.audit.plant_view import PlantView
from lostmotion.audit.row_facts import in_span
from lostmotion.audit.rules import FORCED
from lostmotion.printable import printable, shell_word
from lostmotion.report.fit_text import fill
from lostmotion.report.plant.changes import changes
from lostmotion.report.plant.words import (
    interval_words,
    moment_words,
    next_command,
    seconds_words,
    size_words,
    sure_words,
)
from lostmotion.store.rows import FINDINGS, AssessmentRow, Stage
from lostmotion.text_table import text_table

FIRST = 10  # rows of the ranking
WORTH_A_LOOK = 5.0  # priority: a suspicion that is hardly over the prior of any valve has 4.4
SHORT = 5  # rows of everything else
HEAD = ("#", "loop", "area", "verdict", "% of span", "95 %", "sure", "priority", "")
WIDTHS = (3, 18, 14, 18, 9, 16, 9, 8, 0)
ORDER = (*FINDINGS, FORCED.name, "other oscillation", "cannot tell", "none")


def audit_summary(view: PlantView) -> str:
    """What ``lostmotion audit`` prints."""
    health = health_of(view)
    parts = [
        _head(view),
        _health(health),
        _counts(view, health),
        _ranking(view, health),
        _groups(view),
        _new(view),
        _next(view),
    ]
    return printable("\n".join(part for part in parts if part))


def _head(view: PlantView) -> str:
    run = view.run
    when = moment_words(run.started)
    line = ", ".join(
        part for part in (f"Audit of {run.plant or 'a plant'}", f"run {run.number}" if run.number else "", when) if part
    )
    note = "" if run.complete else "\nNOT COMPLETE: the run was stopped or its budget was spent."
    return f"{line}\n{'=' * len(line)}{note}"


def _health(health: Health) -> str:
    lines = [fill(health.sentence())]
    if health.unfit:
        lines.append(fill(f"The data of {health.unfit} loops allow no judgement."))
    if health.files:
        lines.append(fill(f"{health.files} files gave no loop, {health.files_failed} of them with something wrong."))
    both = (*health.not_judged[:SHORT], *health.data[:SHORT])
    lines += [fill(f"- {len(one.tags)} x {one.text} ({one.examples})") for one in both]
    more = max(len(health.not_judged) - SHORT, 0) + max(len(health.data) - SHORT, 0)
    return "\n".join(lines + ([f"- and {more} more reason{'s' if more > 1 else ''}"] if more else []))


def _counts(view: PlantView, health: Health) -> str:
    rows = [row for row in view.leading if row.stage is Stage.ASSESSED or row.rule]
    verdicts = Counter(row.said for row in rows)
    said = [f"{verdicts[name]} {name}" for name in ORDER if verdicts[name]]
    labels = Counter(row.label or "no label" for row in rows)
    named = [f"{count} {label}" for label, count in labels.most_common()]
    if not rows:
        return ""
    found = fill(f"Findings: {health.findings(verdicts)}.")
    return "\n".join(["", found, fill(f"Verdicts: {', '.join(said)}."), fill(f"NE 107: {', '.join(named)}.")])


def _ranking(view: PlantView, health: Health) -> str:
    ranked = [row for row in view.leading if row.priority]
    if not ranked:
        return f"\n{health.all_well}" if health.all_well else ""
    rows = [_cells(view, row, place) for place, row in enumerate(ranked[:FIRST], 1)]
    lines = ["", "Where to look first", *text_table(HEAD, WIDTHS, rows)]
    worth = sum((row.priority or 0.0) >= WORTH_A_LOOK for row in ranked)
    left = f"; {len(ranked) - len(rows)} more are in the report" if len(ranked) > len(rows) else ""
    said = f"{worth} of the {len(ranked)} with a priority are worth a look (priority {WORTH_A_LOOK:g} and more){left}."
    return "\n".join([*lines, fill(said)])


def _cells(view: PlantView, row: AssessmentRow, place: int) -> tuple[str, ...]:
    return (
        str(place),
        _cut(row.tag, WIDTHS[1]),
        _cut(view.by_tag[row.tag].area or "-", WIDTHS[2]),
        row.said,
        (size_words(row) if in_span(row) else "") or "-",  # else the reason has it, and says of what it is
        _interval(row),
        sure_words(row) or "-",
        f"{row.priority:.0f}",
        row.priority_reason,
    )


def _interval(row: AssessmentRow) -> str:
    between = interval_words(row) if in_span(row) else ""
    return "apparent" if between.startswith("apparent") else between or "-"


def _cut(text: str, width: int) -> str:
    """Text that fits a column."""
    return text if len(text) <= width else f"{text[: width - 2]}.."


def _groups(view: PlantView) -> str:
    if not view.groups:
        return ""
    lines = ["", "Loops that swing together"]
    for group in view.groups[:SHORT]:
        source = f"likely source {group.source}" if group.source else "source: cannot tell"
        members = ", ".join(_cut(member[0], WIDTHS[1]) for member in group.members[:SHORT])
        more = f" and {len(group.members) - SHORT} more" if len(group.members) > SHORT else ""
        lines.append(fill(f"- {seconds_words(group.period)}: {members}{more}; {source}. {group.why}"))
    left = len(view.groups) - SHORT
    return "\n".join(lines + ([f"- and {left} more groups"] if left > 0 else []))


def _new(view: PlantView) -> str:
    if not view.previous:
        return ""
    found = changes(view)
    when = moment_words(view.run.previous)
    title = f"What is new since the run of {when}" if when else "What is new since the last run"
    if not found:
        return f"\n{title}: nothing."
    lines = [
        fill(f"- {_cut(one.tag, 40)}: {one.what}; before {one.before or '-'}, now {one.now or '-'}")
        for one in found[:SHORT]
    ]
    left = len(found) - SHORT
    return "\n".join(["", title, *lines] + ([f"- and {left} more"] if left > 0 else []))


def _next(view: PlantView) -> str:
    ranked = [row for row in view.leading if row.priority]
    lines = []
    if ranked:
        lines.append(f"  {next_command(view.by_tag[ranked[0].tag], ranked[0], view.run)}")
    if view.run.store:
        lines.append(f"  lostmotion audit --show {shell_word(view.run.store)} --report plant.html")
    return "\n".join(["", "Next", *lines]) if lines else ""
