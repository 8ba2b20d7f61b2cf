"""An audit in a notebook: its table as a frame, the first of its ranking as a panel."""

from __future__ import annotations

from typing import Any

from lostmotion.audit.health import health_of
from lostmotion.audit.plant_view import PlantView
from lostmotion.panel import Panel, Table

RANKING = ("", "verdict", "priority", "because")
MOST_LOOPS = 20  # of a ranking that are shown


def audit_frame(view: PlantView) -> Any:
    """Table of an audit as a Polars frame."""
    from lostmotion.report.plant.table import table  # noqa: PLC0415  Polars is heavy, and other reports need none

    return table(view.rows, view.by_tag)


def audit_panel(view: PlantView) -> Panel:
    """What could be judged, and the first of the ranking."""
    first = [row for row in view.leading if row.priority][:MOST_LOOPS]
    rows = [(row.tag, row.said, f"{row.priority or 0.0:.0f}", row.priority_reason) for row in first]
    headline = f"Audit of {view.run.plant or 'a plant'}, run {view.run.number}"
    return Panel(headline, Table(rows, RANKING), said=(health_of(view).sentence(),))
