"""The table of an audit as a data frame, for CSV, Parquet and whoever goes on from there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import polars as pl

from lostmotion.audit.row_facts import ends_percent
from lostmotion.audit.rules import advice_of
from lostmotion.plant import PlantLoop
from lostmotion.store.rows import AssessmentRow

_TEXT, _NUMBER, _TIME = pl.String, pl.Float64, pl.Datetime("us", "UTC")
COLUMNS: dict[str, Any] = {
    "tag": _TEXT,
    "area": _TEXT,
    "type": _TEXT,
    "weight": _NUMBER,
    "window_start": _TIME,
    "window_end": _TIME,
    "stage": _TEXT,
    "said": _TEXT,
    "rule": _TEXT,
    "verdict": _TEXT,
    "kind": _TEXT,
    "label": _TEXT,
    "split": _TEXT,
    "priority": _NUMBER,
    "priority_reason": _TEXT,
    "size_percent": _NUMBER,
    "low_percent": _NUMBER,
    "high_percent": _NUMBER,
    "size": _NUMBER,
    "low": _NUMBER,
    "high": _NUMBER,
    "op_unit": _TEXT,
    "excluded_percent": _NUMBER,
    "excluded_dead_zone": _NUMBER,
    "excluded_backlash": _NUMBER,
    "excluded_stiction": _NUMBER,
    "confidence": _NUMBER,
    "probability": _NUMBER,
    "severity": _TEXT,
    "performance": _TEXT,
    "status": _TEXT,
    "period": _NUMBER,
    "regularity": _NUMBER,
    "power": _NUMBER,
    "harris": _NUMBER,
    "variability": _NUMBER,
    "travel": _NUMBER,
    "reversals": _NUMBER,
    "manual": _NUMBER,
    "limited": _NUMBER,
    "missing": _NUMBER,
    "rows": pl.Int64,
    "dt": _NUMBER,
    "fit_for_use": pl.Boolean,
    "health": _TEXT,
    "why": _TEXT,
    "reason": _TEXT,
    "advice": _TEXT,
    "evidence": _TEXT,
    "value": _NUMBER,
    "seconds": _NUMBER,
    "error": _TEXT,
    "fingerprint": _TEXT,
    "settings": _TEXT,
    "code": _TEXT,
    "source": _TEXT,
}
JOINED = "; "  # between the parts of a list: CSV knows no lists


def table(rows: Iterable[AssessmentRow], loops: Mapping[str, PlantLoop] | None = None) -> pl.DataFrame:
    """One line a row, in the order given; percentages of span, times in UTC, lists as text.

    Parameters
    ----------
    rows : iterable of AssessmentRow
    loops : mapping of str to PlantLoop, optional
        By tag: area, type, weight, unit and source.

    Returns
    -------
    polars.DataFrame
        Columns of COLUMNS; unknown is null. "said" is the rule or, where there is none, the verdict that decides; the
        "advice" is of the same.

    Examples
    --------
    >>> from lostmotion.store.rows import UNDATED
    >>> table([AssessmentRow("FIC-1", UNDATED, UNDATED, size=0.5, low=0.4, high=0.6, size_percent=1.0)]).select(
    ...     "tag", "size_percent", "low_percent", "high_percent"
    ... ).row(0)
    ('FIC-1', 1.0, 0.8, 1.2)
    """
    known = loops or {}
    return pl.DataFrame(
        [_cells(row, known.get(row.tag, PlantLoop(row.tag))) for row in rows], schema=COLUMNS, orient="row"
    )


def _cells(row: AssessmentRow, loop: PlantLoop) -> list[Any]:
    low, high = ends_percent(row) or (None, None)
    own = {
        "area": loop.area or None,
        "type": loop.loop_type or None,
        "weight": loop.weight,
        "stage": str(row.stage),
        "low_percent": low,
        "high_percent": high,
        "op_unit": loop.op_unit or None,
        "health": JOINED.join(row.health) or None,
        "advice": " ".join(advice_of(row)) or None,
        "evidence": JOINED.join(f"{name} {value:.3g} ({weight:+.2f})" for name, value, weight in row.evidence) or None,
        "source": loop.where or None,
    }
    return [own[name] if name in own else _plain(getattr(row, name)) for name in COLUMNS]


def _plain(value: Any) -> Any:
    """Empty texts are unknown."""
    return None if isinstance(value, str) and not value else value
