"""What an audit tells of a run: strict JSON, and one thing of each loop."""

from __future__ import annotations

import json

from lostmotion.audit.audit_run import AuditRun
from tests.plant_rows import plant
from tests.plant_stores import plant_store


def test_a_size_of_which_any_is_possible_is_null_in_json(tmp_path) -> None:
    run = AuditRun.of(plant_store(tmp_path, view=plant(), data=False))
    assert any(row.excluded_percent == float("inf") for row in run.rows)
    found = json.loads(json.dumps(run.to_dict(), allow_nan=False))
    assert next(one for one in found["assessments"] if one["tag"] == "FIC-3")["excluded_percent"] is None
    assert next(one for one in found["assessments"] if one["tag"] == "FIC-1")["window_start"].startswith("2026-11-15")
