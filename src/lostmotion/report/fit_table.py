"""Identifications of several loops: a line for each, and a table with the largest lost motion first."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from lostmotion.errors import Status
from lostmotion.identify import HammersteinFit
from lostmotion.report.fit_text import finding
from lostmotion.text_table import text_table

NAME = 20
HEAD = ("loop", "status", "model", "size", "95 % interval", "% of span", "fit, %")
WIDTHS = (NAME, 14, 11, 10, 22, 10, 6)


def fit_line(name: str, fit: HammersteinFit | None, error: str | None = None) -> str:
    """Status and finding of one loop, or why there is none."""
    if fit is None:
        return f"{name:{NAME}} error: {error}"
    return f"{name:{NAME}} {fit.status.name}: {finding(fit)}"


def fit_table(rows: Sequence[tuple[str, HammersteinFit | None]]) -> str:
    """Table of several loops, largest lost motion first, and how often each status came.

    Parameters
    ----------
    rows : sequence of (name, HammersteinFit or None)
        None where there is no result.
    """
    done = [(name, fit) for name, fit in rows if fit is not None]
    counts = Counter(fit.status for _, fit in done)
    said = [f"{counts[status]} {status.name}" for status in Status if counts[status]]
    if len(done) < len(rows):
        said.append(f"{len(rows) - len(done)} without a result")
    lines = text_table(HEAD, WIDTHS, [_cells(name, fit) for name, fit in sorted(done, key=_rank)])
    return "\n".join([*lines, f"{len(rows)} loops: {', '.join(said)}."])


def _size(fit: HammersteinFit) -> tuple[float, tuple[float, float]] | None:
    """Size and its interval, where the record shows one."""
    name = fit.kind.size
    if not fit.status.ok or name is None:
        return None
    return fit.parameters[name], fit.size_interval


def _percent(fit: HammersteinFit) -> float | None:
    """Size in % of the span of OP, where both are known."""
    size, span = _size(fit), fit.data.op_span
    return None if size is None or span is None else 100.0 * size[0] / (span[1] - span[0])


def _rank(row: tuple[str, HammersteinFit]) -> tuple[bool, float]:
    """By share of the span, or of the range of OP where no span is known; those without a size last."""
    fit = row[1]
    size = _size(fit)
    if size is None:
        return True, 0.0
    percent = _percent(fit)
    return False, -(100.0 * size[0] / float(np.ptp(fit.data.u)) if percent is None else percent)


def _cells(name: str, fit: HammersteinFit) -> tuple[str, ...]:
    size, percent = _size(fit), _percent(fit)
    return (
        name,
        fit.status.name,
        fit.nonlinearity.kind,
        "-" if size is None else f"{size[0]:.4g}",
        "-" if size is None else f"{size[1][0]:.4g} .. {size[1][1]:.4g}",
        "-" if percent is None else f"{percent:.3g}",
        f"{fit.fit_percent:.3g}",
    )
