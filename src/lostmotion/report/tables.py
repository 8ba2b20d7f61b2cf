"""Tables of results as columns of numbers: what ``summary().to_frame()`` gives."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from lostmotion.actuator import ActuatorResponse
from lostmotion.compensate import CompensatorBlock
from lostmotion.design import Achievable, TestDesign
from lostmotion.diagnose import Diagnosis, PooledDiagnosis
from lostmotion.diagnose.evidence_words import LABEL
from lostmotion.evaluate import CompensationStudy, MonteCarloResult, Solution
from lostmotion.identify import FitFacts, HammersteinFit, RecursiveEstimate
from lostmotion.identify.actuators.kind import kind_of
from lostmotion.records.checked import CheckedRecord
from lostmotion.records.report import RecordReport
from lostmotion.report.actuator_text import MEANING as OF_ACTUATOR
from lostmotion.report.design_text import MEANING as DESIGNED
from lostmotion.report.fit_text import MEANING

Columns = dict[str, list[Any]]


def parameter_columns(estimate: HammersteinFit | FitFacts | RecursiveEstimate) -> Columns:
    """All parameters with standard errors and 95 % intervals, those of the linear part too."""
    meanings = {**kind_of(estimate.nonlinearity.kind).words.meanings, **MEANING}
    errors = estimate.standard_errors
    rows = (
        (name, value, errors[name], *estimate.interval(name), meanings.get(name, ""))
        for name, value in estimate.parameters.items()
    )
    return _columns(("parameter", "estimate", "standard_error", "low", "high", "meaning"), rows)


def actuator_columns(response: ActuatorResponse) -> Columns:
    """Numbers of an actuator, in units of OP and in % of span; the interval is that of the dead band."""
    ends = {"dead_band": response.interval}
    rows = (
        (name, value, value / response.percent if name != "lag" else np.nan, *ends.get(name, (np.nan, np.nan)), meaning)
        for name, meaning in OF_ACTUATOR.items()
        for value in (getattr(response, name),)
    )
    return _columns(("parameter", "estimate", "percent_of_span", "low", "high", "meaning"), rows)


def diagnosis_columns(found: Diagnosis) -> Columns:
    """Evidence, strongest first."""
    meanings = {name: meaning for name, (_, meaning) in LABEL.items()}
    rows = ((one.name, one.value, one.weight, meanings.get(one.name, one.meaning)) for one in found.evidence)
    return _columns(("evidence", "value", "log_odds", "meaning"), rows)


def pooled_columns(found: PooledDiagnosis) -> Columns:
    """What each record added."""
    rows = ((one.name, one.rows, one.alone, one.said, one.gain, one.size, *one.interval) for one in found.shares)
    return _columns(("record", "rows", "alone", "said", "gain", "size", "low", "high"), rows)


def study_columns(study: CompensationStudy) -> Columns:
    """Loop as it is, with the block, retuned."""
    rows = (
        (name, case.iae, case.ratio, case.variance, case.travel, case.reversals) for name, case in study.cases.items()
    )
    return _columns(("case", "iae", "ratio", "variance", "travel", "reversals"), rows)


def solution_columns(solution: Solution) -> Columns:
    """Gates, as far as the way went."""
    rows = ((step.name, step.passed, step.said, step.remedy) for step in solution.steps)
    return _columns(("step", "open", "found", "remedy"), rows)


def design_columns(design: TestDesign) -> Columns:
    """Half-widths of the 95 % intervals that the test will give."""
    several = (design.expected, design.expected_typical, design.expected_worst, design.prs_expected)
    return _half_widths(("model", "median", "worst", "prs"), several)


def achievable_columns(answer: Achievable) -> Columns:
    """Half-widths of the best 95 % intervals."""
    several = (answer.expected, answer.expected_best, answer.expected_worst)
    return _half_widths(("model", "best", "worst"), several)


def monte_carlo_columns(result: MonteCarloResult) -> Columns:
    """Figures of each group of cases."""
    scores = {group: figures for group, figures in result.scores.items() if figures["cases"]}
    names = list(next(iter(scores.values()), {}))
    return _columns(("group", *names), ((group, *map(figures.get, names)) for group, figures in scores.items()))


def block_columns(block: CompensatorBlock) -> Columns:
    """Settings."""
    variables = block.specification.section("parameter")
    rows = ((one.name, value, one.meaning) for one, value in zip(variables, block.values, strict=True))
    return _columns(("setting", "value", "meaning"), rows)


def report_columns(report: RecordReport) -> Columns:
    """Findings, worst first."""
    rows = ((one.level, one.what, one.why, one.remedy) for one in report.findings)
    return _columns(("level", "what", "why", "remedy"), rows)


def checked_columns(found: CheckedRecord) -> Columns:
    """Findings, worst first."""
    return report_columns(found.report)


def _half_widths(names: Sequence[str], several: Sequence[Mapping[str, float]]) -> Columns:
    rows = ((name, *(one.get(name, np.inf) for one in several), meaning) for name, meaning in DESIGNED.items())
    return _columns(("parameter", *names, "meaning"), rows)


def _columns(names: Sequence[str], rows: Iterable[Sequence[Any]]) -> Columns:
    listed = list(rows)
    return {name: [row[place] for row in listed] for place, name in enumerate(names)}
