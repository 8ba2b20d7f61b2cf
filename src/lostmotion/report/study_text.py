"""A compensation study as text: what to do, why, the figures, and what was assumed."""

from __future__ import annotations

import math

from lostmotion.evaluate import CompensationStudy
from lostmotion.evaluate.limit_cycle import LimitCycle
from lostmotion.evaluate.study.mistakes import GROUPS
from lostmotion.evaluate.study.study_result import LoopCase, MistakeCase
from lostmotion.report.digits import plain
from lostmotion.report.fit_text import WIDTH, fill

ROWS = {
    "without": "as it is",
    "with": "with the block",
    "retuned": "retuned, no block",
    "with, retuned": "block and retuned",
    "no fault": "no fault",
}
HEAD = ("", "IAE", "of as is", "variance", "travel", "reversals", "limit cycle of PV", "predicted")


def study_summary(study: CompensationStudy) -> str:
    """Report of a study as plain text."""
    first, *others = study.reasons
    parts = [
        f"Before download: {study.block.kind} block",
        "=" * WIDTH,
        *([fill(f"ACCEPTED behind a closed gate: {study.block.accepted}.")] if study.block.accepted else []),
        fill(first),
        *(fill(f"- {text}") for text in others),
        "",
        _table(study),
        "",
        _spread(study),
        "",
        *_assumed(study),
    ]
    return "\n".join(parts)


def _table(study: CompensationStudy) -> str:
    rows = [_row(case_cells(ROWS[name], case)) for name, case in study.cases.items()]
    return "\n".join([_row(HEAD), "-" * WIDTH, *rows])


def _row(cells: tuple[str, ...]) -> str:
    name, iae, ratio, variance, travel, reversals, cycle, predicted = cells
    figures = f"{iae:>9}{ratio:>9}{variance:>10}{travel:>9}{reversals:>10}"
    return f"{name:18}{figures}  {cycle:18}{predicted:14}".rstrip()


def case_cells(name: str, case: LoopCase) -> tuple[str, ...]:
    """One loop in the order of HEAD."""
    predicted = "-" if case.predicted is None else _swing(case.predicted)
    figures = (plain(case.variance), plain(case.travel), plain(case.reversals))
    return name, plain(case.iae), f"{100.0 * case.ratio:.0f} %", *figures, _swing(case.cycle), predicted


def _swing(cycle: LimitCycle) -> str:
    """Amplitude and period."""
    if not cycle.amplitude:
        return "none"
    return f"{cycle.amplitude:.2g}, {plain(float(f'{cycle.period:.2g}'))} s"


def _spread(study: CompensationStudy) -> str:
    """The block on other plants, group by group."""
    lines = [
        f"{'If the estimate is wrong by':28}{'plants':>7}  {'IAE of as is':19}{'block and retuned':19}"
        "larger limit cycle",
        "-" * WIDTH,
    ]
    for group in GROUPS:
        rows = [case for case in study.mistakes if case.group == group]
        again = [case for case in study.mistakes_retuned if case.group == group]
        if rows:
            more = [sum(case.larger_cycle for case in some) for some in (rows, again)]
            lines.append(
                f"{_named(group):28}{len(rows):>7}  {_range(rows):19}{_range(again):19}{more[0]}, retuned {more[1]}"
            )
    return "\n".join(lines)


def _named(group: str) -> str:
    return "draws from the covariance" if group == "drawn" else group


def _range(cases: list[MistakeCase]) -> str:
    ratios = [case.ratio for case in cases]
    return f"{_percent(min(ratios))} .. {_percent(max(ratios))} %"


def _percent(ratio: float) -> str:
    return f"{100.0 * ratio:.0f}" if ratio < 10.0 else f"{100.0 * ratio:.2g}".replace("e+0", "e")


def _assumed(study: CompensationStudy) -> list[str]:
    pi = study.controller
    tuned = study.cases["with, retuned"].controller
    lines = [
        f"Model: {study.model_source}. Controller: PI with Kp {plain(pi.kp)}, Ki {plain(pi.ki)} 1/s, "
        f"{study.controller_source}; retuned: SIMC (Kp {plain(tuned.kp)}, Ki {plain(tuned.ki)} 1/s with the block).",
        *_compared(study),
        f"Runs: {study.described}; noise of PV {plain(study.settings['noise_deviation'])} (deviation within the "
        "process time), from the noise model. IAE, variance: of PV about SP; travel: % of span an hour; reversals: an "
        "hour, beyond the noise of OP.",
        "Limit cycles: amplitude and period in noise-free runs, smaller ones than a tenth of the noise not counted; "
        "predicted: describing function of what the block leaves of the actuator"
        + (", which says nothing here: the block goes by the clock." if _timed(study) else ", an approximation."),
        *(f"Block: {note}." for note in study.block.notes),
    ]
    if len(set(study.responses["without"].reference[study.settle :].tolist())) == 1:
        lines.append("The set point rests here: what moves of it would gain or cost is not counted (give sp_step).")
    return [fill(line) for line in lines]


def _compared(study: CompensationStudy) -> list[str]:
    """How the identified loop and the record compare."""
    found = study.reproduction
    if found is None:
        return ["No record was given, so nothing says that this model reproduces one: give it."]
    periods = ""
    if found.recorded_period is not None:
        simulated = "none" if found.simulated_period is None else f"{plain(found.simulated_period)} s"
        periods = f", period {plain(found.recorded_period)} s and {simulated}"
    said = "reproduces the record" if found.closed is None else "does NOT reproduce the record"
    deviations = f"{plain(found.recorded)}, simulated {plain(found.simulated)}"
    return [f"The model {said}: deviation of PV about SP {deviations}{periods}."]


def _timed(study: CompensationStudy) -> bool:
    return study.cases["with"].predicted is None and math.isfinite(study.cases["with"].iae)
