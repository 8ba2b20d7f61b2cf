"""A Monte Carlo run as text: one line for each group of cases."""

from __future__ import annotations

from lostmotion.evaluate.monte_carlo import MonteCarloResult
from lostmotion.evaluate.scores import Score

COLUMNS = {
    "group": 14, "cases": 5, "ident.": 6, "success": 7, "within": 6, "cover": 6, "delay": 6, "told": 10, "bias": 6,
    "eff.": 5, "honest": 6, "s med/max": 11,
}  # fmt: skip
HEAD, WIDTHS = tuple(COLUMNS), tuple(COLUMNS.values())
LEGEND = (
    "ident.: the expected 95 % intervals of both break points are narrower than a third of the width; of these:\n"
    "success: break points within 3 expected standard errors and status usable; within: whatever the status;\n"
    "cover: reported 95 % intervals that hold the truth; delay: exact; told: exact, of those whose record tells it;\n"
    "bias, eff.: mean and RMS error in expected standard errors where within. honest: of the others, refused or\n"
    "intervals that hold the truth. All in %."
)


def monte_carlo_summary(result: MonteCarloResult) -> str:
    """Table of all groups as plain text."""
    lines = [f"{len(result.cases)} random loops of {result.samples} samples, seed {result.seed}", _line(HEAD)]
    lines += [_line(cells(group, figures)) for group, figures in result.scores.items() if figures["cases"]]
    errors = [f"case {case.index}: {case.error}" for case in result.cases if case.error is not None]
    return "\n".join([*lines, LEGEND, *errors])


def cells(group: str, figures: Score) -> tuple[str, ...]:
    """One row of the table."""
    return (
        group,
        str(figures["cases"]),
        str(figures["identifiable"]),
        *(percent(figures[name]) for name in ("success", "within", "coverage", "delay")),
        f"{percent(figures['delay_told'])} ({figures['delays_told']})",
        *("-" if figures[name] is None else f"{figures[name]:.2f}" for name in ("bias", "efficiency")),
        percent(figures["honest"]),
        f"{figures['seconds_median']:.2f}/{figures['seconds_worst']:.2f}",
    )


def percent(value: float | None) -> str:
    """Share in percent, one decimal."""
    return "-" if value is None else f"{100.0 * value:.1f}"


def _line(row: tuple[str, ...]) -> str:
    return row[0].ljust(WIDTHS[0]) + "".join(
        cell.rjust(width + 1) for cell, width in zip(row[1:], WIDTHS[1:], strict=True)
    )
