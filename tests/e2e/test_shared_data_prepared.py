"""Every real record is read, checked and prepared; the short ones are identified too, none with an exception.

The whole table, all of them identified, is made by benchmarks/shared_data.py.
"""

import numpy as np
import pytest
from benchmarks import shared_data

import lostmotion as lm
from lostmotion.records import prepare
from tests.support.shared_data import ROOT, shared

ENTRIES = list(shared_data.entries(ROOT)) if ROOT.is_dir() else []
SHORT = [entry for entry in ENTRIES if entry.name in ("CHEM4", "CHEM33", "CHEM6", "stiction-P-oilgas-DB-3", "PAP2")]
ABSENT = pytest.param(None, marks=pytest.mark.skip(reason="shared/data is not beside the repository"))


def names(entry):
    return getattr(entry, "name", "absent")


def of(name):
    shared("isdb26")  # skips, saying so, where the records are absent
    entry = next(entry for entry in ENTRIES if entry.name.startswith(name))
    return prepare(lm.read_loop(entry.path, **entry.options))


@pytest.mark.sampled(29)
@pytest.mark.parametrize("entry", ENTRIES or [ABSENT], ids=names)
def test_every_record_is_used_or_refused_with_the_reason(entry):
    if entry.refusal:
        with pytest.raises(lm.InputError, match=entry.refusal):
            lm.read_loop(entry.path, **entry.options)
        return
    prepared = prepare(lm.read_loop(entry.path, **entry.options))
    assert prepared.usable == (not entry.name.startswith("quantisation-F"))
    if not prepared.usable:
        assert "OP that moves, got the constant -1.329" in prepared.refusal
    assert prepared.share > entry.used or not prepared.usable
    left = sum(len(part) for part in prepared.left_out)
    used = sum(stop - start for start, stop in prepared.rows)
    assert not prepared.usable or left + used == len(prepared.record)


def test_every_file_is_in_the_table():
    shared("isdb26")
    files = {path for path in ROOT.glob("*/*.csv") if path.name not in ("labels.csv", "index.csv")}
    assert {entry.path for entry in ENTRIES} == files


@pytest.mark.statistics
@pytest.mark.parametrize("entry", SHORT or [ABSENT], ids=names)
def test_identified_or_refused(entry):
    outcome = shared_data.run(entry)
    assert outcome.fit is not None
    assert outcome.fit.status in lm.Status
    assert shared_data.row(outcome).count(" | ") == 9


@pytest.mark.parametrize("number", range(1, 13))
def test_halts_of_the_recorder_every_45_minutes_are_left_out(number):
    """tuning-F-chemical-DB: OP and PV freeze for about 36 rows, 2700 rows apart."""
    prepared = of(f"tuning-F-chemical-DB-{number}-")
    halts = [part for part in prepared.left_out if part.kind == "stopped" and len(part) < 60]
    assert len(halts) >= 2
    assert all(30 <= len(part) <= 45 for part in halts)
    assert all(abs(distance - 2700) < 10 for distance in np.diff([part.start for part in halts]))


def test_held_end_of_one_run_is_left_out():
    prepared = of("tuning-F-chemical-DB-12-")
    assert max(stop for _, stop in prepared.rows) <= 6412


def test_two_recordings_in_one_file():
    prepared = of("tuning-L-paper-horch")
    assert prepared.rows == ((0, 846),)
    assert [part.kind for part in prepared.left_out] == ["splice"]


@pytest.mark.parametrize(("name", "rows"), [("cascaded tanks, Est", 47), ("cascaded tanks, Val", 37)])
def test_overflow_of_the_tanks_is_clipped_pv(name, rows):
    assert sum(len(part) for part in of(name).left_out if part.kind == "clipped PV") == rows


@pytest.mark.parametrize(("name", "words"), [("saturation-L", "upper limit"), ("saturation-T", "lower limit")])
def test_op_at_its_limit_is_told(name, words):
    assert any(words in note for note in of(name).notes)


@pytest.mark.parametrize("name", ["CHEM29", "CHEM6", "stiction-L-power"])
def test_archives_that_were_compressed_are_told(name):
    assert any("made up by the historian" in note for note in of(name).notes)


@pytest.mark.parametrize(
    ("name", "step"),
    [("CHEM3", 0.05), ("CHEM16", 0.195), ("CHEM34", 1.41), ("quantisation-Q", 0.01), ("PAP2", 0.03125)],
)
def test_steps_of_pv(name, step):
    assert of(name).pv_step == pytest.approx(step, rel=0.01)


@pytest.mark.parametrize("name", ["dcmotor", "damadics", "PAP4", "CHEM1", "CHEM10", "PAP2", "MIN1"])
def test_nothing_is_left_out_of_a_sound_record(name):
    assert of(name).left_out == ()
