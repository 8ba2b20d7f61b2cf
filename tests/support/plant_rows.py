"""A small plant for tests of reports: rows made by hand, no data."""

from __future__ import annotations

import json
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np

from lostmotion.audit.plant_view import PlantView, RunFacts, SizePoint
from lostmotion.plant import PlantLoop, Unread
from lostmotion.store.rows import AssessmentRow, GroupRow, Stage, TraceRow

START = datetime(2026, 11, 15, 6, tzinfo=UTC)
END = START + timedelta(days=1)
HOSTILE = (
    "<script>alert(1)</script>\"'&",
    "T" * 200,
    "\u202eמשאבה 😀 FIC",
    "] ]> </style></title><img src=x onerror=alert(2)>",
    "{{ 7 * 7 }}{% raw %}",
)


def finding(tag: str = "FIC-1", priority: float = 60.0, size: float = 3.0, **other: object) -> AssessmentRow:
    """Stiction with an interval."""
    made = AssessmentRow(
        tag, START, END, stage=Stage.ASSESSED, status="OK", verdict="stiction", kind="actuator", size=size,
        low=0.9 * size, high=1.1 * size, size_percent=size, confidence=0.93, probability=0.93, severity="high",
        performance="poor", label="out of specification", split="actuator", priority=priority,
        priority_reason="severity x weight x confidence", rows=8640, dt=10.0, manual=0.0, limited=0.02, missing=0.0,
        travel=12.0, reversals=30.0, variability=2.1, harris=0.3, period=600.0, regularity=5.0, power=0.8,
        advice=("Repack the valve.", "Or try `lostmotion simulate`."),
        evidence=(("memory", 3.2, 3.1), ("shape", -0.2, -0.4)),
        indices={"op_span": 100.0, "gate_open": 1.0},
    )  # fmt: skip
    return replace(made, **other)


def sound(tag: str = "FIC-2", excluded: float = 0.4, **other: object) -> AssessmentRow:
    """Nothing wrong."""
    made = AssessmentRow(
        tag, START, END, stage=Stage.ASSESSED, verdict="none", kind="none", confidence=0.9, severity="none",
        excluded_percent=excluded, excluded_backlash=excluded, label="normal", split="none", priority=0.0,
        indices={"op_span": 100.0},
    )  # fmt: skip
    return replace(made, **other)


def trace(tag: str = "FIC-1", points: int = 300) -> TraceRow:
    """A swing, with the stiction that was fitted."""
    angle = np.linspace(0.0, 20.0, points)
    op, pv = 50.0 + 3.0 * np.sin(angle), 20.0 + np.sign(np.sin(angle - 1.0))
    model = {
        "actuator": {"kind": "stiction", "band": 3.0, "jump": 1.0, "model": "choudhury"},
        "size": "band",
        "intervals": {"band": [2.7, 3.3]},
        "op_unit": "%",
        "pv_unit": "t/h",
    }
    stored = [values.astype("<f4").tobytes() for values in (np.full(points, 20.0), pv, op)]
    return TraceRow(tag, START, 600.0, 10.0 * points, *stored, model=json.dumps(model))


def history(tag: str = "FIC-1") -> tuple[SizePoint, ...]:
    """It grows."""
    months = [START - timedelta(days=30 * ago) for ago in (2, 1, 0)]
    sizes = (1.0, 2.0, 3.0)
    return tuple(
        SizePoint(tag, run, when, "stiction", size, 0.9 * size, 1.1 * size)
        for run, (when, size) in enumerate(zip(months, sizes, strict=True), 1)
    )


def plant(tags: tuple[str, ...] = ("FIC-1", "FIC-2", "FIC-3", "FIC-4", "FIC-5")) -> PlantView:
    """A finding, a sound loop, one that cannot be told, one that was screened only, one that failed."""
    first, second, third, fourth, fifth = tags
    doubtful = replace(finding(third, 8.0), verdict="cannot tell", kind="unknown", size=None, low=None, high=None)
    doubtful = replace(doubtful, size_percent=None, why="OP hardly moves", label="", excluded_percent=float("inf"))
    screened = AssessmentRow(
        fourth, START, END, reason="in manual for 97 % of the time", health=("stale for 31 % of it",)
    )
    failed = AssessmentRow(fifth, START, END, stage=Stage.FAILED, error="expected a column 'OP', got none; name it")
    rows = (sound(second), failed, finding(first), screened, doubtful)
    return PlantView(
        run=RunFacts(3, "North", ("data/*.csv",), START, END, "0.1.0", (("Tolerance", "1 %"),), 60.0, True, "plant.db"),
        loops=tuple(PlantLoop(tag, loop_type="flow", area=f"Unit {tag}", where=f"{tag}.csv") for tag in tags),
        rows=rows,
        groups=(
            GroupRow(1, 600.0, first, 0.8, "Its valve sticks.", ((first, START, 0.9, 0.8), (second, START, 0.8, 0.2))),
        ),
        traces=(trace(first),),
        history=history(first),
        previous=(sound(first), sound(second)),
        unread=(Unread(f"{first}.txt", "no columns"),),
    )
