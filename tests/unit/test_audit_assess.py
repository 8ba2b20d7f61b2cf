import json
import math
from dataclasses import asdict, replace
from functools import cache
from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest

from lostmotion.audit.assess import stretches
from lostmotion.audit.assess.assess import _another, _pooled, _shown_once, assess, told
from lostmotion.audit.assess.stretches import EACH, ROWS, looks, recording
from lostmotion.audit.assess.trace import MOST_POINTS
from lostmotion.audit.assess.words import about_looks
from lostmotion.audit.rank import ranked
from lostmotion.audit.screen.of_loop import of_loop
from lostmotion.audit.screen.screen import screen
from lostmotion.audit.settings import AuditSettings
from lostmotion.diagnose import diagnose
from lostmotion.diagnose.control_error.rows import ScreenRows
from lostmotion.errors import DataError
from lostmotion.evaluate import random_faulty_loop
from lostmotion.identify.data import collect
from lostmotion.identify.unseen_moves import unseen_moves
from lostmotion.models.registry import actuator_from_dict
from lostmotion.plant.loop import PlantLoop
from lostmotion.records import LoopRecord, prepare
from lostmotion.store.rows import UNDATED, Stage


@pytest.fixture
def by_stretches(monkeypatch):
    """Windows of any length are looked at by their stretches."""
    monkeypatch.setattr(stretches, "WHOLE", 0)


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
    ("error", "said"), [(DataError("no\nway"), "no way"), (MemoryError("much"), "MemoryError: much")]
)
def test_a_failure_is_a_row(monkeypatch, error, said):
    def broken(*given):
        raise error

    monkeypatch.setattr(import_module("lostmotion.audit.assess.assess"), "looks", broken)
    row, trace = assess(LOOP, sticking()[0], looked()[0], SETTINGS)
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


@pytest.mark.statistics
def test_op_at_its_limit_for_long_is_what_is_wrong_where_only_the_rest_is_looked_at(by_stretches):
    record = sticking()[0]
    full = replace(record, op=np.where(np.arange(2000) < 1400, 100.0, record.op))
    row, _ = screen(LOOP, full, UNDATED, UNDATED, SETTINGS)
    found, _ = assess(LOOP, full, row, SETTINGS)
    assert (found.verdict, found.kind, found.size) == ("saturation", "actuator", None)
    assert found.evidence[0][1] == pytest.approx(0.7)


def rarely_moved(every=900, rows=8000, scans=5):
    """A flow that settles between its rows, each of so many scans; SP moves every 900 rows."""
    random = np.random.default_rng(1)
    n = rows * scans
    sp = np.repeat(random.uniform(-8.0, 8.0, rows // every + 1), every * scans)[:n]
    load, noise = 0.01 * random.normal(size=n).cumsum(), 0.05 * random.normal(size=n)
    op, pv = np.zeros(n), np.zeros(n)
    state = integral = 0.0
    for k in range(n):
        state += 0.5 * (1.2 * (op[k - 1] if k else 0.0) + load[k] - state)
        pv[k] = state + noise[k]
        integral += 0.125 * (sp[k] - pv[k])
        op[k] = 0.17 * (sp[k] - pv[k]) + integral
    at = slice(None, None, scans)
    return LoopRecord(50.0 + op[at], 50.0 + pv[at], 50.0 + sp[at], dt=float(scans))


def test_how_a_loop_is_recorded_is_told_by_the_whole_window(by_stretches, monkeypatch):
    """Two moves of SP in a stretch leave open whether the loop settles between the rows; nine tell it."""
    record = rarely_moved()
    rows = ScreenRows(of_loop(LOOP, record))
    whole, part = recording(rows, None), next(looks(rows, None)).record
    assert unseen_moves(collect(prepare(part), None, None)).untold
    assert not whole.unseen.untold
    assert whole.unseen.settled
    assert whole.unseen.mostly
    assert recording(ScreenRows(of_loop(LOOP, record.cut(0, 3000))), None) is None, "looked at whole"
    known = replace(collect(prepare(part), None, None), recording=whole)
    assert (known.unseen, known.foretold) == (whole.unseen, whole.foretold)
    given = []

    def refused(part, known, **_):
        given.append(known)
        raise DataError("no more is asked here")

    monkeypatch.setattr(import_module("lostmotion.audit.assess.assess"), "diagnose_part", refused)
    row, _ = screen(LOOP, record, UNDATED, UNDATED, SETTINGS)
    assess(LOOP, record, row, SETTINGS)
    assert given
    assert recording(rows, row.period) is not None
    again = recording(rows, row.period)
    assert all(one.unseen == again.unseen for one in given)
    assert all(np.array_equal(one.foretold.errors, again.foretold.errors) for one in given)


def test_that_op_foretells_pv_is_told_by_the_whole_window(by_stretches):
    """A controller that sees PV a row earlier than the historian: three thousand rows hardly show it, all do."""
    random = np.random.default_rng(1)
    n = 19_000
    load, noise = 0.05 * random.normal(size=n).cumsum(), 0.1 * random.normal(size=n)
    pv, op = np.zeros(n), np.zeros(n)
    for now in range(1, n):
        pv[now] = 0.8 * pv[now - 1] + 0.2 * op[now - 1] + 0.02 * load[now] + noise[now]
        op[now] = op[now - 1] - 0.02 * (pv[now] - pv[now - 1]) - 0.01 * pv[now] + 0.02 * random.normal()
    record = LoopRecord(50.0 + op[1:], 50.0 + pv[:-1], np.full(n - 1, 50.0), dt=1.0)
    rows = ScreenRows(of_loop(LOOP, record))
    whole, part = recording(rows, None), next(looks(rows, None)).record
    assert whole.foretold.against(0.2)
    assert np.min(whole.foretold.errors) < 1.5 * np.min(collect(prepare(part), None, None).foretold.errors)


def long_rows(**more):
    random = np.random.default_rng(1)
    n = 20_000
    wave = np.sin(np.arange(n) / 9.0)
    record = LoopRecord(50.0 + wave, wave + 0.1 * random.normal(size=n), np.zeros(n), dt=1.0, **more)
    return ScreenRows(of_loop(LOOP, record))


def test_looks_are_apart_and_short(by_stretches):
    found = list(looks(long_rows(), None))
    assert len(found) == 20_000 // ROWS // EACH
    places = np.sort(np.concatenate([look.places for look in found]))
    assert (np.diff(places) >= ROWS).all()
    assert all(len(look.record) == EACH * ROWS and look.record.gaps == (ROWS,) for look in found)


def test_looks_leave_manual_and_limits_alone(by_stretches):
    mode = np.where(np.arange(20_000) < 12_000, "MAN", "AUTO")
    places = [place for look in looks(long_rows(mode=mode), None) for place in look.places]
    assert places
    assert min(places) >= 12_000 - 0.1 * ROWS
    assert not list(looks(long_rows(mode=np.full(20_000, "MAN")), None))


def test_a_slow_swing_is_thinned(by_stretches):
    look = next(looks(long_rows(), 1000.0))
    assert look.record.dt == 4.0
    assert look.rows == 4 * ROWS


@pytest.mark.statistics
def test_looks_that_disagree_name_no_fault():
    class One:
        def __init__(self, kind, verdict, probability):
            self.alarm, self.probability = kind == "actuator", probability
            self.found = type("Found", (), {"verdict": verdict})()

    fault, other = One("actuator", "stiction", 0.9), One("tuning", "other oscillation", 0.3)
    silent = One("unknown", "cannot tell", 0.2)
    assert told([fault, other]) is other
    assert told([silent, other]) is other
    assert told([fault, silent]) is silent
    assert told([fault, One("actuator", "stiction", 0.7)]) is fault
    assert told([silent, fault, One("actuator", "stiction", 0.7)]) is fault
    weak = One("actuator", "stiction", 0.6)
    assert told([weak, silent, weak]) is silent  # together not likelier than none
    assert told([weak, weak]) is weak
    assert told([fault, One("actuator", "stiction", 0.7), other]) is other
    assert [_another(seen, 0.1) for seen in ([fault], [silent], [other], [fault, silent], [fault, other])] == [
        True, False, False, True, False,
    ]  # fmt: skip
    assert _another([silent], 0.9)
    assert _another([One("unknown", "cannot tell", 0.4)], 0.1)
    assert not _another([fault, silent, fault], 0.9)


class Look:
    """One that was diagnosed, of an OP with a span."""

    def __init__(self, kind, verdict, size=np.nan, probability=0.9):
        self.alarm, self.probability = kind == "actuator", probability
        record = LoopRecord(np.arange(10.0), np.arange(10.0), dt=1.0, op_span=(0.0, 100.0))
        self.found = SimpleNamespace(verdict=verdict, kind=kind, size_percent=size, record=record)


def test_a_look_that_cannot_tell_contradicts_none():
    fault, silent = Look("actuator", "backlash", 2.51), Look("unknown", "cannot tell")
    said = "one of three stretches shows a backlash of 2.5 % of span, the others cannot tell"
    assert about_looks([fault, silent, silent]) == said
    assert about_looks([silent, fault]) == said.replace("three", "two").replace("others", "other")
    assert _shown_once([silent, fault, silent]) == {"shown_percent": 2.51}
    denied = [fault, silent, Look("none", "none")]
    assert about_looks(denied) == "stretches of the window disagree: 'backlash' and 'none'"
    assert _shown_once(denied) == {}
    weak = [fault, Look("actuator", "stiction", 3.5), silent]
    said = (
        "two of three stretches show a backlash and a stiction, the other cannot tell: together not likelier than none"
    )
    assert about_looks(weak) == said
    assert about_looks([fault, silent, fault]).startswith("two of three stretches show a backlash, the other")
    assert _shown_once(weak) == {"shown_percent": 3.5}
    unsized = Look("actuator", "saturation")
    assert about_looks([unsized, silent]) == "one of two stretches shows a saturation, the other cannot tell"
    assert _shown_once([unsized, silent]) == {}


def test_sizes_of_two_looks_are_weighed_and_no_narrower_than_they_differ():
    class One:
        confidence = 0.9

        def __init__(self, size, half):
            self.size, self.interval = size, (size - half, size + half)

    size, low, high = _pooled([One(2.0, 0.1), One(2.6, 0.3)])
    assert size == pytest.approx(2.06)
    assert (low, high) == pytest.approx((1.76, 2.36))


@pytest.mark.statistics
def test_records_of_many_stretches_are_told_apart(by_stretches):
    found = {}
    for seed, cause in ((1002, "none"), (1005, "stiction"), (1008, "tuning")):
        loop = random_faulty_loop(seed, 7000, cause)
        record = LoopRecord(loop.op, loop.pv, loop.sp, dt=1.0)
        own = replace(LOOP, loop_type=loop.process)
        row, _ = screen(own, record, UNDATED, UNDATED, SETTINGS)
        found[cause] = assess(own, record, row, SETTINGS)[0]
    assert found["stiction"].verdict == "stiction"
    assert found["stiction"].indices["looks"] == 2.0  # a fault is confirmed
    assert found["none"].kind != "actuator"
    assert found["tuning"].kind != "actuator"
