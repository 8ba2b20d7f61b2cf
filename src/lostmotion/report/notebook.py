"""Results as panels, for notebooks and papers: the headline and a small table of each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from lostmotion.actuator import ActuatorResponse
from lostmotion.compensate import CompensatorBlock
from lostmotion.design import Achievable, TestDesign
from lostmotion.diagnose import Diagnosis, PooledDiagnosis
from lostmotion.diagnose.diagnosis import Item
from lostmotion.diagnose.evidence_words import LABEL
from lostmotion.evaluate import CompensationStudy, MonteCarloResult, Solution
from lostmotion.identify import FitFacts, HammersteinFit, RecursiveEstimate
from lostmotion.identify.rated_estimate import HIDDEN
from lostmotion.panel import Panel, Table
from lostmotion.records.checked import CheckedRecord
from lostmotion.records.report import Finding, RecordReport
from lostmotion.report import (
    actuator_text,
    design_text,
    diagnosis_text,
    fit_text,
    pooled_text,
    recursive_text,
    solution_text,
    study_text,
)
from lostmotion.report.digits import bracketed, digits, error_of, plain, signed, span
from lostmotion.report.facts_text import found_in
from lostmotion.report.tables import achievable_columns, design_columns, monte_carlo_columns

PARAMETERS = ("", "estimate", "std. error", "95 % interval", "")
MOST_SHARES = 20  # records of a pooled diagnosis that are shown
STEP = ("step", "gate", "found")


def fit_panel(fit: HammersteinFit) -> Panel:
    """Finding and parameters of a fit."""
    data = fit.data
    name = data.tag or data.source or "record"
    said = (fit_text.sentence(fit), fit_text.dynamics(fit))
    table = Table(fit_text.parameter_rows(fit), PARAMETERS)
    return Panel(f"{name}: {fit.status.name}. {fit_text.finding(fit)}", table, said=said)


def facts_panel(facts: FitFacts) -> Panel:
    """Finding and parameters of a saved fit."""
    name = facts.tag or facts.source or "record"
    rows = []
    for parameter, meaning in {**facts.kind.words.meanings, **fit_text.MEANING}.items():
        if parameter not in facts.parameters or parameter in facts.unvisited or facts.status in HIDDEN:
            continue
        error, interval = facts.standard_errors[parameter], facts.interval(parameter)
        error = error_of(interval, error) if parameter == facts.kind.size else error
        shown, deviation = digits(facts.parameters[parameter], error)
        rows.append((parameter, shown, deviation, span(*interval, error), meaning))
    table = Table(rows, PARAMETERS)
    return Panel(f"{name}: {facts.status.name}, {found_in(facts)}", table, said=(facts.message,))


def recursive_panel(estimate: RecursiveEstimate) -> Panel:
    """Status and parameters of a recursive estimate."""
    headline = f"After {estimate.samples} samples: {estimate.status.name}"
    table = Table(recursive_text.parameter_rows(estimate), PARAMETERS)
    return Panel(headline, table, said=(recursive_text.words(estimate), *recursive_text.since(estimate)))


def actuator_panel(response: ActuatorResponse) -> Panel:
    """Finding and numbers of an actuator."""
    name = response.record.tag or response.record.source or "record"
    table = Table(actuator_text.actuator_rows(response), ("", "value", "of span"))
    return Panel(f"{name}: {response.finding}", table, said=(response.message,))


def diagnosis_panel(found: Diagnosis) -> Panel:
    """Verdict, evidence and advice."""
    data = found.fit.data
    headline = f"{data.tag or data.source or 'record'}: {diagnosis_text.verdict_sentence(found)}"
    table = Table([_evidence(item) for item in found.evidence], ("evidence", "value", "log-odds", ""))
    head = ("not excluded (95 %)", f"of OP{bracketed(found.record.op_unit)}")
    open_sizes = Table([(kind, _size(size)) for kind, size in found.excluded.items()], head)
    return Panel(headline, table, open_sizes, found.advice, said=(diagnosis_text.where_from(found),))


def _size(size: float) -> str:
    return plain(size) if np.isfinite(size) else "any size"


def _evidence(item: Item) -> tuple[str, str, str, str]:
    name, meaning = LABEL.get(item.name, (item.name, item.meaning))
    return name, f"{item.value:.2f}", signed(item.weight), meaning


def pooled_panel(found: PooledDiagnosis) -> Panel:
    """Verdict of many records, and what each said."""
    headline = f"One valve, {len(found.shares)} records: {diagnosis_text.verdict_sentence(found)}"
    rows = [pooled_text.share_cells(share) for share in found.shares[:MOST_SHARES]]
    more = len(found.shares) - len(rows)
    table = Table(rows, pooled_text.HEAD)
    said = (pooled_text.rests_on(found), f"The first {len(rows)} are shown, {more} more are not." if more else "")
    return Panel(headline, table, found.advice, said=said)


def study_panel(study: CompensationStudy) -> Panel:
    """Recommendation and the loop as it is, with the block, retuned."""
    rows = [study_text.case_cells(study_text.ROWS[name], case) for name, case in study.cases.items()]
    accepted = f"ACCEPTED behind a closed gate: {study.block.accepted}." if study.block.accepted else ""
    table = Table(rows, study_text.HEAD)
    return Panel(study.reasons[0], table, study.reasons[1:], said=(accepted,))


def solution_panel(solution: Solution) -> Panel:
    """Outcome and the gates that were passed."""
    rows = [(step.name, "open" if step.passed else "CLOSED", step.said) for step in solution.steps]
    opens = f"What opens it: {solution.closed.remedy}" if solution.closed is not None else ""
    return Panel(solution_text.outcome(solution), Table(rows, STEP), said=(opens,))


def block_panel(block: CompensatorBlock) -> Panel:
    """Kind and settings of a block."""
    variables = block.specification.section("parameter")
    rows = [
        (variable.name, plain(value) if np.isfinite(value) else f"{value}", variable.meaning)
        for variable, value in zip(variables, block.values, strict=True)
    ]
    accepted = f"ACCEPTED behind a closed gate: {block.accepted}." if block.accepted else ""
    headline = f"{block.kind.capitalize()} block, one scan every {block.scan_time:g} s"
    table = Table(rows, ("setting", "value", ""))
    return Panel(headline, table, block.notes, said=(accepted,))


def report_panel(report: RecordReport) -> Panel:
    """What was found in a record, worst first."""
    rows = [*map(_finding, report.findings), *(("note", note) for note in report.notes)]
    return Panel(f"{report.title}: {_usable(report.usable)}", Table(rows))


def checked_panel(found: CheckedRecord) -> Panel:
    """The same, and how much of the record would be used."""
    report, prepared = found.report, found.prepared
    rows = [*map(_finding, report.findings), *(("note", note) for note in (*report.notes, *prepared.notes))]
    said = prepared.refusal or f"{100 * found.share:.3g} % of the rows would be used"
    return Panel(f"{report.title}: {_usable(found.usable)}", Table(rows), said=(said,))


def _finding(one: Finding) -> tuple[str, str]:
    return one.level, " ".join(part for part in (one.what, one.why, one.remedy) if part)


def _usable(usable: bool) -> str:
    return "usable" if usable else "NOT USABLE"


def figures_panel(headline: str, columns: Mapping[str, Sequence[Any]]) -> Panel:
    """Any table of numbers."""
    rows = [[cell if isinstance(cell, str) else "-" if cell is None else plain(cell) for cell in row]
            for row in zip(*columns.values(), strict=True)]  # fmt: skip
    return Panel(headline, Table(rows, tuple(columns)))


def design_panel(design: TestDesign) -> Panel:
    """What a test will give."""
    return figures_panel(design_text.headline(design), design_columns(design))


def achievable_panel(answer: Achievable) -> Panel:
    """What data can give."""
    return figures_panel(answer.sentence, achievable_columns(answer))


def monte_carlo_panel(result: MonteCarloResult) -> Panel:
    """Figures of all groups."""
    headline = f"{len(result.cases)} random loops of {result.samples} samples, seed {result.seed}"
    return figures_panel(headline, monte_carlo_columns(result))
