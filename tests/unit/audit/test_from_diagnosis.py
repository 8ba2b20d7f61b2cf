"""Rows of the store from a diagnosis say what the diagnosis says."""

from __future__ import annotations

import json
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from lostmotion.audit.assess.from_diagnosis import row_of, trace_of
from lostmotion.audit.assess.trace import MOST_POINTS
from lostmotion.errors import Status
from lostmotion.plant import PlantLoop
from lostmotion.report.plant.of_diagnosis import diagnosis_report, diagnosis_view
from lostmotion.store.rows import Stage
from tests.support.diagnoses import CASES, example, variant

LOOP = PlantLoop("FC7", stamp="s1")
START = datetime(2026, 3, 1, tzinfo=UTC)
END = START + timedelta(seconds=2000)


def test_a_row_is_the_diagnosis():
    found = example()
    row = row_of(LOOP, START, END, found)
    assert (row.tag, row.stamp, row.stage, row.verdict, row.kind) == (
        "FC7",
        "s1",
        Stage.ASSESSED,
        "dead zone",
        "actuator",
    )
    assert (row.size, row.low, row.high) == (found.size, *found.interval)
    assert (row.size_percent, row.confidence, row.probability) == (found.size_percent, 0.93, 0.93)
    assert (row.rows, row.dt, row.fingerprint) == (400, 5.0, found.record.fingerprint)
    assert row.evidence == (("dead_zone", 3.71, 5.2), ("shape", -0.31, -1.2))
    assert row.harris == 0.3
    assert row.indices["op_span"] == 100.0
    assert all(np.isfinite(value) for value in row.indices.values())


@pytest.mark.parametrize(("verdict", "kind"), CASES)
def test_unknown_is_none_and_never_nan(verdict, kind):
    row = row_of(LOOP, START, END, variant(verdict, kind))
    numbers = [value for value in vars(row).values() if isinstance(value, float)]
    assert not any(np.isnan(value) for value in numbers)
    assert (row.size is None) == (verdict not in ("dead zone", "backlash", "stiction"))
    assert (row.excluded_percent == 0.6) == (verdict in ("none", "other oscillation"))
    assert "nan" not in diagnosis_report(variant(verdict, kind)).lower().split()


def test_any_size_that_is_not_excluded_is_inf_and_said():
    found = variant("none", "none", excluded={"dead zone": np.inf, "backlash": 0.2})
    row = row_of(LOOP, START, END, found)
    assert (row.excluded_dead_zone, row.excluded_percent, row.excluded_stiction) == (np.inf, np.inf, None)
    assert "any size" in diagnosis_report(found)


def test_a_trace_holds_few_points_and_the_model():
    found = example()
    trace = trace_of(LOOP, START, found)
    signals = [np.frombuffer(data, "<f4") for data in (trace.sp, trace.pv, trace.op)]
    assert len({signal.size for signal in signals}) == 1
    assert signals[0].size <= MOST_POINTS
    assert 0.0 <= trace.start <= 2000.0
    model = json.loads(trace.model)
    assert model["actuator"]["kind"] == "dead zone"
    assert model["intervals"]["width"] == pytest.approx(list(found.interval))
    assert trace_of(LOOP, START, variant("stiction", "actuator")).model == ""


def test_the_window_is_that_of_the_record():
    found = replace(example(), record=replace(example().record, start="2026-03-01 06:00+01:00"))
    view = diagnosis_view(found, "FC7.csv")
    assert view.row.window_start == datetime(2026, 3, 1, 5, tzinfo=UTC)
    assert view.row.window_end == view.row.window_start + timedelta(seconds=399 * 5)
    assert "1 Mar 2026 05:00 UTC" in diagnosis_report(found, "FC7.csv")
    assert "not dated" in diagnosis_report(example())


@pytest.mark.parametrize(
    ("changes", "open_"),
    [
        ({}, 1.0),
        ({"stability": replace(example().stability, unexplained=0.14)}, 0.0),
        ({"stability": None}, 0.0),
        ({"fit": replace(example().fit, status=Status.MISFIT)}, 0.0),
        ({"verdict": "stiction"}, 0.0),
        ({"verdict": "cannot tell", "kind": "unknown"}, 0.0),
    ],
)
def test_a_row_knows_whether_a_study_would_take_its_fit(changes, open_):
    """The gate and the study decide, not the name of the verdict."""
    found = replace(example(), **changes)
    assert row_of(LOOP, START, END, found).indices["gate_open"] == open_
