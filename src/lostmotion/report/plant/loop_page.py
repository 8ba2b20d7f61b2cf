"""What the page of one loop shows, ready for a template."""

from __future__ import annotations

import math
from dataclasses import dataclass

from markupsafe import Markup

from lostmotion.audit.plant_view import LoopView
from lostmotion.audit.row_facts import of_what
from lostmotion.audit.rules import advice_of
from lostmotion.diagnose.evidence_words import LABEL, probability
from lostmotion.plant import PlantLoop
from lostmotion.report.digits import bracketed, plain, signed
from lostmotion.report.plant.changes import said
from lostmotion.report.plant.sizes import history_picture, history_rows
from lostmotion.report.plant.svg.actuator_chart import (
    actuator_chart,
    model_of,
    parameter_rows,
    plane_chart,
    swings,
)
from lostmotion.report.plant.svg.bars import odds_bar
from lostmotion.report.plant.svg.trend_chart import trend_charts, trend_table
from lostmotion.report.plant.words import (
    LETTER,
    NO_ANSWER,
    beside_fit,
    headline,
    next_command,
    number_words,
    second_opinion,
    seconds_words,
    share_words,
    where_from,
    window_words,
)
from lostmotion.store.rows import MEASUREMENT, AssessmentRow

MOST_WINDOWS = 30  # rows of the table of windows


@dataclass(frozen=True)
class LoopPage:
    """Texts (not escaped), rows of tables and ready SVG of one loop."""

    anchor: str
    tag: str
    headline: str
    where_from: str
    second: str
    beside_fit: str
    label: str
    letter: str
    review: str
    facts: list[tuple[str, str]]
    trend: tuple[Markup, ...]
    trend_rows: list[tuple[str, ...]]
    has_sp: bool
    plane: Markup
    actuator: Markup
    parameters: list[tuple[str, str, str]]
    sized: bool
    swings: bool
    op_unit: str
    evidence: list[tuple[str, str, str, Markup, str]]
    sums: list[tuple[str, str, Markup, str]]
    excluded: list[tuple[str, str, str]]
    of_what: str
    history: Markup
    history_rows: list[tuple[str, str, str, str]]
    has_live: bool
    growth: str
    oscillation: list[tuple[str, str]]
    performance: list[tuple[str, str]]
    windows: list[tuple[str, str, str]]
    windows_left: int
    health: tuple[str, ...]
    notes: tuple[str, ...]
    advice: tuple[str, ...]
    command: str


def loop_page(view: LoopView, anchor: str = "loop") -> LoopPage:
    """Page of a loop; `anchor` is its id in the document, letters, digits and "-"."""
    row, loop, trace = view.row, view.loop, view.trace
    model = model_of(trace) if trace else {}
    op_unit = loop.op_unit or str(model.get("op_unit", ""))
    pv_unit = loop.pv_unit or str(model.get("pv_unit", ""))
    windows = [(window_words(one), said(one), number_words(one.priority)) for one in view.windows]
    return LoopPage(
        anchor=anchor,
        tag=row.tag,
        headline=headline(row),
        where_from=where_from(row),
        second=second_opinion(row),
        beside_fit=beside_fit(row),
        label=row.label,
        letter=LETTER.get(row.label, "?"),
        review=view.review,
        facts=_facts(view),
        trend=trend_charts(trace, pv_unit, op_unit) if trace else (),
        trend_rows=trend_table(trace) if trace else [],
        has_sp=bool(trace and trace.sp),
        plane=plane_chart(trace, row, pv_unit, op_unit) if trace else Markup(""),
        actuator=actuator_chart(trace, op_unit) if trace else Markup(""),
        parameters=parameter_rows(trace) if trace else [],
        sized=row.size is not None,
        swings=swings(row),
        op_unit=bracketed(op_unit),
        evidence=_evidence(row),
        sums=_sums(row),
        excluded=_excluded(row),
        of_what=of_what(row),
        history=history_picture(view.history, of_what(row)),
        history_rows=history_rows(view.history) if len(view.history) > 1 else [],
        has_live=any(point.live for point in view.history),
        growth=view.growth,
        oscillation=_oscillation(view),
        performance=_performance(row, loop),
        windows=windows[:MOST_WINDOWS] if len(windows) > 1 else [],
        windows_left=max(len(windows) - MOST_WINDOWS, 0),
        health=row.health,
        notes=view.notes + loop.notes,
        advice=advice_of(row),
        command=view.command or next_command(loop, row, view.run),
    )


def _facts(view: LoopView) -> list[tuple[str, str]]:
    loop, row = view.loop, view.row
    data = f"{row.rows} samples" + (f" every {plain(row.dt)} s" if row.dt else "") if row.rows else ""
    priority = "" if row.priority is None else f"{row.priority:.0f} of 100"
    reason = f": {row.priority_reason}" if row.priority_reason else ""
    found = [
        ("Priority", priority + reason if priority else ""),
        ("Cause in", row.split if row.split not in ("none", "cannot tell") else ""),
        ("Area", loop.area),
        ("Type", loop.loop_type),
        ("Weight", f"{loop.weight:g}" if loop.weight != 1.0 else ""),
        ("Window", window_words(row)),
        ("Data", data),
        ("Source", loop.where),
        ("Fit", row.status.replace("_", " ").lower()),
        ("Fingerprint", row.fingerprint),
    ]
    return [(name, text) for name, text in found if text]


def _evidence(row: AssessmentRow) -> list[tuple[str, str, str, Markup, str]]:
    """Name, value, log-odds, bar and meaning of each line."""
    found = []
    for name, value, weight in row.evidence:
        label, meaning = LABEL.get(name, (name.replace("_", " "), ""))
        found.append((label, f"{value:.2f}", signed(weight), odds_bar(weight), meaning))
    return found


def _sums(row: AssessmentRow) -> list[tuple[str, str, Markup, str]]:
    """Name, log-odds, bar and meaning of what stands before the evidence, and of both together; as far as known."""
    total = row.indices.get("log_odds")
    if total is None or not row.evidence:
        return []
    before = total - sum(weight for _, _, weight in row.evidence)
    chance = probability(1.0 / (1.0 + math.exp(-total)))
    return [
        ("before evidence", signed(before), odds_bar(before), "without any of these lines"),
        ("together", signed(total), odds_bar(total), f"a fault of the actuator is {chance} likely"),
    ]


def _excluded(row: AssessmentRow) -> list[tuple[str, str, str]]:
    """Kind, size in units of OP and in % of each that is not excluded, by a measurement that is not at fault."""
    if row.rule in MEASUREMENT:
        return []
    sizes = (
        ("dead zone", row.excluded_dead_zone),
        ("backlash", row.excluded_backlash),
        ("stiction", row.excluded_stiction),
    )
    width = row.indices.get("op_span")
    known = [(kind, size) for kind, size in sizes if size is not None]
    return [(kind, *_open_size(size, width)) for kind, size in known]


def _open_size(size: float, width: float | None) -> tuple[str, str]:
    if size == float("inf"):
        return "any size", "any size"
    return plain(size), f"{100.0 * size / width:.2g}" if width else NO_ANSWER


def _oscillation(view: LoopView) -> list[tuple[str, str]]:
    row, group = view.row, view.group
    if row.period is None:
        found = [("Period", "no oscillation was measured")]
    else:
        regular = swings(row)
        found = [
            ("Swings regularly", "yes" if regular else "no"),
            ("Period" if regular else "Strongest near", seconds_words(row.period)),
            ("Regularity", _with(row.regularity, "(above 1: regular)")),
            ("Share of the variance", share_words(row.power)),
        ]
    if group is not None:
        source = f"likely source {group.source}" if group.source else "source: cannot tell"
        found.append(("Swings together with", f"group {group.number}, {len(group.members)} loops, {source}"))
    return found


def _performance(row: AssessmentRow, loop: PlantLoop) -> list[tuple[str, str]]:
    known = row.indices.get("pv_span_known", float(loop.pv_span is not None))
    return [
        ("Class", row.performance),
        ("Harris index", _with(row.harris, "(1 is best)")),
        ("Deviation of SP - PV", _with(row.variability, f"% of the {'span of PV' if known else 'range of PV seen'}")),
        ("Travel of OP", _with(row.travel, f"% {of_what(row)} an hour")),
        ("Turns of OP", _with(row.reversals, "an hour")),
        ("Not in automatic", share_words(row.manual)),
        ("OP at a limit", share_words(row.limited)),
        ("Without good values", share_words(row.missing)),
    ]


def _with(value: float | None, unit: str) -> str:
    """A number with what it is of; nothing stands behind one that is not known."""
    return NO_ANSWER if value is None else f"{number_words(value)} {unit}"
