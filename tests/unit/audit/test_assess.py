import json
import math
from dataclasses import asdict, replace
from functools import cache
from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest

from lostmotion.audit.assess.assess import assess, shown_once
from lostmotion.audit.assess.trace import MOST_POINTS
from lostmotion.audit.rank import ranked
from lostmotion.audit.screen.screen import screen
from lostmotion.audit.settings import AuditSettings
from lostmotion.diagnose import diagnose
from lostmotion.errors import ParameterError
from lostmotion.evaluate import random_faulty_loop
from lostmotion.models.registry import actuator_from_dict
from lostmotion.plant.loop import PlantLoop
from lostmotion.records import LoopRecord
from lostmotion.store.rows import UNDATED, Stage

LOOP = PlantLoop("FIC-1", loop_type="flow", op_span=(0.0, 100.0), pv_span=(0.0, 100.0))
SETTINGS = AuditSettings()


@cache
def sticking():
    loop = random_faulty_loop(4, 2000, "stiction", "flow")
    return LoopRecord(loop.op, loop.pv, loop.sp, dt=1.0), loop.width


@cache
def looked(rows=2000):
    record = sticking()[0].cut(0, rows)
    row, _ = screen(LOOP, record, UNDATED, UNDATED, SETTINGS)
    return row, *assess(LOOP, record, row, SETTINGS)


@pytest.mark.statistics
def test_a_fault_is_named_with_its_size_and_everything_told():
    before, row, trace = looked()
    width = sticking()[1]
    assert (row.stage, row.verdict, row.kind, row.error) == (Stage.ASSESSED, "stiction", "actuator", "")
    assert row.low <= width * 1.05
    assert row.high >= width * 0.95
    assert row.size_percent == pytest.approx(row.size)  # the span is 100
    assert row.severity in ("moderate", "high", "severe")
    assert row.probability > 0.5
    assert row.evidence
    assert row.advice
    assert row.status
    assert row.excluded_percent is None
    assert (row.fingerprint, row.reason, row.value, row.health) == (
        before.fingerprint, before.reason, before.value, before.health,
    )  # fmt: skip
    assert row.seconds > before.seconds
    assert trace.seconds == 2000.0
    assert MOST_POINTS / 2 <= np.frombuffer(trace.op, "<f4").size <= MOST_POINTS


@pytest.mark.statistics
def test_percentages_of_an_unknown_span_are_told_apart():
    record = sticking()[0]
    record = replace(record, op=record.op + 200.0)
    loop = PlantLoop("FIC-1", loop_type="flow")
    row, _ = assess(loop, record, screen(loop, record, UNDATED, UNDATED, SETTINGS)[0], SETTINGS)
    assert row.indices["op_span_known"] == 0.0
    assert looked()[1].indices["op_span_known"] == 1.0
    assert "of the OP range seen" in ranked([row], {})[0].priority_reason


@pytest.mark.statistics
def test_a_row_is_plain_numbers_only():
    row = looked()[1]
    flat = [row.size, row.low, row.high, row.confidence, row.probability, row.harris, *row.indices.values()]
    flat += [number for _, *pair in row.evidence for number in pair]
    assert all(value is None or (type(value) is float and math.isfinite(value)) for value in flat)
    json.dumps({name: value for name, value in asdict(row).items() if not name.startswith("window")}, allow_nan=False)


@pytest.mark.statistics
def test_the_picture_holds_the_actuator_with_its_interval():
    _, row, trace = looked()
    model = json.loads(trace.model)
    assert actuator_from_dict(model["actuator"]).kind == row.verdict
    low, high = model["intervals"][model["size"]]
    assert (low, high) == pytest.approx((row.low, row.high))


@pytest.mark.statistics
def test_the_same_again_to_the_last_digit():
    record, (before, row, trace) = sticking()[0], looked()
    again, picture = assess(LOOP, record, before, SETTINGS)
    assert asdict(replace(again, seconds=0.0)) == asdict(replace(row, seconds=0.0))
    assert picture == trace


@pytest.mark.statistics
def test_what_cannot_be_diagnosed_is_a_row_with_the_reason():
    record = LoopRecord(np.full(500, 50.0), np.random.default_rng(0).normal(size=500), dt=1.0)
    row, _ = screen(LOOP, record, UNDATED, UNDATED, SETTINGS)
    found, trace = assess(LOOP, record, row, SETTINGS)
    assert (found.stage, found.verdict, trace) == (Stage.ASSESSED, "cannot tell", None)
    assert found.why


@pytest.mark.statistics
@pytest.mark.parametrize(
    ("error", "said"), [(ParameterError("no\nway"), "no way"), (MemoryError("much"), "MemoryError: much")]
)
def test_a_failure_is_a_row(monkeypatch, error, said):
    def broken(*given, **_):
        raise error

    record, before = sticking()[0], looked()[0]  # kept for other tests: made before anything is broken
    monkeypatch.setattr(import_module("lostmotion.audit.assess.assess"), "diagnose_valve", broken)
    row, trace = assess(LOOP, record, before, SETTINGS)
    assert (row.stage, row.error, trace) == (Stage.FAILED, said, None)


@pytest.mark.statistics
def test_op_at_its_limit_for_long_is_what_is_wrong():
    record = sticking()[0]
    op = np.where(np.arange(2000) < 1400, 100.0, record.op)
    full = replace(record, op=op)
    row, _ = screen(LOOP, full, UNDATED, UNDATED, SETTINGS)
    found, _ = assess(LOOP, full, row, SETTINGS)
    assert (found.verdict, found.kind, found.size) == ("saturation", "actuator", None)
    assert diagnose(full).verdict == "saturation"


def test_a_fault_that_some_looks_show_and_none_denies_is_kept_with_its_size():
    def long(verdict, *looks):
        seen = tuple(SimpleNamespace(verdict=name, kind=kind, size_percent=size) for name, kind, size in looks)
        return SimpleNamespace(verdict=verdict, looks=seen, diagnosed_rows=3000)

    silent, backlash = ("cannot tell", "unknown", math.nan), ("backlash", "actuator", 2.51)
    assert shown_once(long("cannot tell", silent, backlash, silent)) == {"shown_percent": 2.51}
    assert shown_once(long("cannot tell", silent, backlash, ("stiction", "actuator", 3.5))) == {"shown_percent": 3.5}
    assert shown_once(long("cannot tell", silent, backlash, ("none", "none", math.nan))) == {}
    assert shown_once(long("cannot tell", silent, ("saturation", "actuator", math.nan))) == {}
    assert shown_once(long("backlash", backlash, backlash)) == {}
