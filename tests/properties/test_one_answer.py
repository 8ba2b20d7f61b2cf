"""Whichever way a record is asked about, the answer is the same: verdict, size, interval, what to do."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lostmotion as lm
from lostmotion.audit.rules import FROZEN, RINGING, advice_of
from lostmotion.diagnose.long_record.any_length import LONG
from lostmotion.evaluate import random_faulty_loop
from lostmotion.store.rows import Stage

CAUSES = ("none", "stiction", "backlash", "dead zone", "saturation", "tuning", "disturbance")


def ringing(seed, rows=1500):
    """A flow loop whose gain is near the limit of stability, driven by noise."""
    random = np.random.default_rng(seed)
    load = np.zeros(rows)
    for k in range(1, rows):
        load[k] = 0.95 * load[k - 1] + 0.3 * random.normal()
    loop = lm.Hammerstein(lm.Identity(), lm.LinearModel((-0.9,), (0.1,), 4, 1.0))
    found = lm.simulate_loop(loop, lm.PI(3.7, 0.15), np.zeros(rows), noise=load)
    op, pv, sp = (50.0 + signal for signal in (found.control, found.measured, found.reference))
    return lm.LoopRecord(op, pv, sp, dt=1.0)


def write(record, folder):
    """A file of it as a historian would export it, alone in a folder."""
    folder.mkdir(exist_ok=True)
    file = folder / "FIC-101.csv"
    columns = (np.arange(len(record)) * record.dt, record.sp, record.pv, record.op)
    rows = zip(*(column.tolist() for column in columns), strict=True)
    file.write_text("\n".join(["time,SP,PV,OP", *(",".join(map(repr, row)) for row in rows), ""]))
    return file


def audited(folder, store):
    """Its row in the store of an audit of the folder; None where a diagnosis was not worth it."""
    (row,) = lm.audit(folder, store, engine="inline").rows
    assert not row.error
    return row if row.stage is Stage.ASSESSED else None


def answer(found):
    known = {name: getattr(found, name) for name in ("verdict", "size", "size_percent", "confidence", "why")}
    return known | dict(zip(("low", "high"), found.interval, strict=True))


def assert_one_answer(record, folder):
    file = write(record, folder)
    alone = lm.diagnose(file)
    listed = lm.diagnose([lm.read_loop(file)])
    np.testing.assert_equal(answer(listed), answer(alone))
    assert (listed.kind, listed.advice, listed.fingerprint) == (alone.kind, alone.advice, alone.fingerprint)
    row = audited(folder, folder.parent / f"{folder.name}.db")
    if row is None:
        return alone, None
    kept = {name: np.nan if getattr(row, name) is None else getattr(row, name) for name in answer(alone)}
    np.testing.assert_equal(kept, answer(alone))
    assert (row.fingerprint, advice_of(row)[0]) == (alone.fingerprint, alone.advice[0])
    assert (row.rule == RINGING.name) == (alone.source == RINGING.where)
    return alone, row


@pytest.mark.long
@pytest.mark.statistics
@pytest.mark.parametrize("cause", CAUSES)
def test_diagnose_and_audit_say_the_same(tmp_path_factory, cause):
    @given(seed=st.integers(0, 10_000), rows=st.sampled_from([600, 1500, 3500]))
    @settings(max_examples=2, deadline=None, derandomize=True, database=None)
    def same(seed, rows):
        loop = random_faulty_loop(seed, samples=rows, cause=cause)
        record = lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=5.0)
        assert_one_answer(record, tmp_path_factory.mktemp(cause.replace(" ", "_")) / "loops")

    same()


@pytest.mark.statistics
def test_a_loop_that_rings_is_to_be_retuned_for_diagnose_as_for_audit(tmp_path):
    found, row = assert_one_answer(ringing(1), tmp_path / "loops")
    assert (found.verdict, found.kind) == ("cannot tell", "tuning")
    assert (row.rule, row.split) == (RINGING.name, "tuning")
    assert "Retune" in found.summary()
    assert "comes from the tuning: the loop rings" in " ".join(found.summary().split())


@pytest.mark.statistics
def test_a_measurement_that_stands_still_is_to_be_looked_at_for_both(tmp_path):
    record = ringing(1)
    pv = record.pv.copy()
    pv[600:700] = pv[600]
    found, row = assert_one_answer(lm.LoopRecord(record.op, pv, record.sp, dt=1.0), tmp_path / "loops")
    assert (found.kind, row.rule, row.split) == ("sensor", FROZEN.name, "sensor")
    assert "PV stood still while OP moved" in found.summary()


@pytest.mark.statistics
def test_rows_in_manual_and_at_a_limit_are_the_same_for_both(tmp_path):
    loop = random_faulty_loop(4, samples=1500, cause="stiction", process="flow")
    op, pv = loop.op.copy(), loop.pv.copy()
    op[200:500], op[900:1000] = op[200], 100.0
    record = lm.LoopRecord(op, pv, loop.sp, dt=1.0)
    assert assert_one_answer(record, tmp_path / "loops")[1] is not None


@pytest.mark.long
@pytest.mark.statistics
@pytest.mark.parametrize("cause", ["none", "stiction"])
def test_a_record_of_more_rows_than_are_read_whole_has_one_answer(tmp_path, cause):
    loop = random_faulty_loop(1005, samples=LONG + 1000, cause=cause)
    record = lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=5.0)
    found, row = assert_one_answer(record, tmp_path / "loops")
    assert row is not None
    assert isinstance(found, lm.LongDiagnosis)
    assert row.indices["looks"] == len(found.looks)
