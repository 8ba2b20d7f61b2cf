"""Results in a notebook: the headline and a small table of each, as HTML."""

from __future__ import annotations

import numpy as np

from lostmotion.compensate import CompensatorBlock
from lostmotion.diagnose import Diagnosis, PooledDiagnosis
from lostmotion.diagnose.diagnosis import Item
from lostmotion.diagnose.evidence_words import LABEL
from lostmotion.evaluate import CompensationStudy, Solution
from lostmotion.html_table import html_list, html_panel, html_table
from lostmotion.identify import FitFacts, HammersteinFit, RecursiveEstimate
from lostmotion.identify.rated_estimate import HIDDEN
from lostmotion.report import diagnosis_text, fit_text, pooled_text, recursive_text, solution_text, study_text
from lostmotion.report.digits import bracketed, digits, error_of, plain, signed, span
from lostmotion.report.facts_text import found_in

PARAMETERS = ("", "estimate", "std. error", "95 % interval", "")
MOST_SHARES = 20  # records of a pooled diagnosis that are shown
STEP = ("step", "gate", "found")


def fit_html(fit: HammersteinFit) -> str:
    """Finding and parameters of a fit."""
    data = fit.data
    name = data.tag or data.source or "record"
    said = (fit_text.sentence(fit), fit_text.dynamics(fit))
    table = html_table(fit_text.parameter_rows(fit), PARAMETERS, named=True)
    return html_panel(f"{name}: {fit.status.name}. {fit_text.finding(fit)}", table, said=said)


def facts_html(facts: FitFacts) -> str:
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
    table = html_table(rows, PARAMETERS, named=True)
    return html_panel(f"{name}: {facts.status.name}, {found_in(facts)}", table, said=(facts.message,))


def recursive_html(estimate: RecursiveEstimate) -> str:
    """Status and parameters of a recursive estimate."""
    headline = f"After {estimate.samples} samples: {estimate.status.name}"
    table = html_table(recursive_text.parameter_rows(estimate), PARAMETERS, named=True)
    return html_panel(headline, table, said=(recursive_text.words(estimate), *recursive_text.since(estimate)))


def diagnosis_html(found: Diagnosis) -> str:
    """Verdict, evidence and advice."""
    data = found.fit.data
    headline = f"{data.tag or data.source or 'record'}: {diagnosis_text.verdict_sentence(found)}"
    table = html_table(map(_evidence, found.evidence), ("evidence", "value", "log-odds", ""), named=True)
    head = ("not excluded (95 %)", f"of OP{bracketed(found.record.op_unit)}")
    open_sizes = html_table([(kind, _size(size)) for kind, size in found.excluded.items()], head, named=True)
    return html_panel(headline, table, open_sizes, html_list(found.advice), said=(diagnosis_text.where_from(found),))


def _size(size: float) -> str:
    return plain(size) if np.isfinite(size) else "any size"


def _evidence(item: Item) -> tuple[str, str, str, str]:
    name, meaning = LABEL.get(item.name, (item.name, item.meaning))
    return name, f"{item.value:.2f}", signed(item.weight), meaning


def pooled_html(found: PooledDiagnosis) -> str:
    """Verdict of many records, and what each said."""
    what = "windows" if found.of_windows else "records"
    headline = f"One valve, {len(found.shares)} {what}: {diagnosis_text.verdict_sentence(found)}"
    rows = [pooled_text.share_cells(share) for share in found.shares[:MOST_SHARES]]
    more = len(found.shares) - len(rows)
    table = html_table(rows, pooled_text.HEAD, named=True)
    said = (pooled_text.rests_on(found, what), f"The first {len(rows)} are shown, {more} more are not." if more else "")
    return html_panel(headline, table, html_list(found.advice), said=said)


def study_html(study: CompensationStudy) -> str:
    """Recommendation and the loop as it is, with the block, retuned."""
    rows = [study_text.case_cells(study_text.ROWS[name], case) for name, case in study.cases.items()]
    accepted = f"ACCEPTED behind a closed gate: {study.block.accepted}." if study.block.accepted else ""
    table = html_table(rows, study_text.HEAD, named=True)
    return html_panel(study.reasons[0], table, html_list(study.reasons[1:]), said=(accepted,))


def solution_html(solution: Solution) -> str:
    """Outcome and the gates that were passed."""
    rows = [(step.name, "open" if step.passed else "CLOSED", step.said) for step in solution.steps]
    opens = f"What opens it: {solution.closed.remedy}" if solution.closed is not None else ""
    return html_panel(solution_text.outcome(solution), html_table(rows, STEP, named=True), said=(opens,))


def block_html(block: CompensatorBlock) -> str:
    """Kind and settings of a block."""
    variables = block.specification.section("parameter")
    rows = [
        (variable.name, plain(value) if np.isfinite(value) else f"{value}", variable.meaning)
        for variable, value in zip(variables, block.values, strict=True)
    ]
    accepted = f"ACCEPTED behind a closed gate: {block.accepted}." if block.accepted else ""
    headline = f"{block.kind.capitalize()} block, one scan every {block.scan_time:g} s"
    table = html_table(rows, ("setting", "value", ""), named=True)
    return html_panel(headline, table, html_list(block.notes), said=(accepted,))
