import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from typer.testing import CliRunner

import lostmotion as lm
from lostmotion.cli import app
from lostmotion.diagnose.pooled.overlap import without_repeats
from lostmotion.diagnose.pooled.settings import DiagnosisSettings
from lostmotion.errors import DataError, ParameterError
from tests.support.figure_texts import assert_readable

WIDTH = 2.0


def response(seed, rows, width=WIDTH):
    """A flow loop with a backlash and moves of SP, as a record in % of span."""
    rng = np.random.default_rng(seed)
    plant = lm.LinearModel((-0.8,), (0.2 * rng.uniform(0.9, 1.1),), 2, 1.0)
    moves = np.repeat(rng.normal(scale=4.0, size=rows // 40 + 1), 40)[:rows]
    valve = lm.Backlash(width) if width else lm.Identity()
    found = lm.simulate_loop(lm.Hammerstein(valve, plant), lm.PI(0.8, 0.18), moves, noise=0.1 * rng.normal(size=rows))
    op, pv, sp = (50.0 + signal for signal in (found.control, found.measured, found.reference))
    return lm.LoopRecord(op, pv, sp, dt=1.0, op_span=(0.0, 100.0), tag=f"run {seed}")


@cache
def of_three():
    return lm.diagnose([response(seed, 500) for seed in (1, 2, 3)], starts=[0.0, 86400.0, 5 * 86400.0])


@pytest.mark.long
@pytest.mark.statistics
def test_three_records_of_one_valve_are_one_answer():
    found = of_three()
    assert isinstance(found, lm.PooledDiagnosis)
    assert found.verdict == "backlash"
    assert found.size == pytest.approx(WIDTH, rel=0.03)
    assert found.interval[0] < WIDTH < found.interval[1]
    assert [share.said for share in found.shares] == ["for"] * 3
    assert [share.place for share in found.shares] == [0.0, 1.0, 5.0]
    assert found.carried_by == ""
    assert found.kind_confidence > 0.9
    assert [one.record.tag for one in found.diagnoses] == ["run 1", "run 2", "run 3"]


@pytest.mark.statistics
def test_it_prints_and_is_json():
    found = of_three()
    text = found.summary()
    assert "BACKLASH of" in text
    assert "3 speak for backlash" in text
    assert "of OP a day" in text
    data = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert [one["said"] for one in data["pooled"]["records"]] == ["for"] * 3
    assert data["size"] == pytest.approx(found.size)


@pytest.mark.statistics
def test_it_is_drawn():
    pytest.importorskip("matplotlib")
    figure = of_three().plot()
    assert_readable(figure)
    sizes, gains = figure.axes
    assert sizes.get_ylim()[0] == 0.0
    assert len(gains.patches) == 3


def test_rows_that_two_records_share_count_once():
    record = response(4, 600)
    kept, lost = without_repeats([record.cut(0, 400), record.cut(200, 600), record.cut(100, 300)])
    assert lost == [0, 200, 200]
    assert len(kept[0]) == 400
    assert np.array_equal(kept[1].op, record.op[400:])
    assert kept[2] is None


def test_records_that_stand_still_are_not_the_same_record():
    still = lm.LoopRecord(np.full(300, 50.0), np.full(300, 20.0), dt=1.0)
    kept, lost = without_repeats([still, still])
    assert lost == [0, 0]
    assert kept == [still, still]


@pytest.mark.statistics
def test_a_record_that_is_refused_is_left_out_with_the_reason():
    refused = lm.LoopRecord(np.full(300, 50.0), np.full(300, 20.0), dt=1.0, op_span=(0.0, 100.0), tag="dead")
    found = lm.diagnose([response(1, 400), refused])
    last = found.shares[1]
    assert (last.said, last.rows) == ("left out", 0)
    assert last.note
    assert any(note.startswith("dead: ") for note in found.notes)
    with pytest.raises(DataError, match="a record that can be used"):
        lm.diagnose([refused, refused])


def test_op_in_other_units_is_refused():
    record = response(1, 300)
    other = replace(record, op=record.op / 100.0, op_span=(0.0, 1.0))
    with pytest.raises(ParameterError, match="OP in the same units"):
        lm.diagnose([record, other])


def test_bad_arguments_are_refused():
    record = response(1, 300)
    with pytest.raises(ParameterError, match="start times"):
        lm.diagnose([record], starts=[0.0, 1.0])
    with pytest.raises(ParameterError, match="many records"):
        lm.diagnose(record, starts=[0.0])
    with pytest.raises(ParameterError, match="tolerance"):
        lm.diagnose([record], tolerance=2.0)
    with pytest.raises(ParameterError, match="records"):
        lm.diagnose([])


@pytest.mark.long
@pytest.mark.statistics
def test_the_command_pools_files_of_one_loop(tmp_path):
    paths = []
    for seed in (1, 2):
        record = response(seed, 400)
        paths.append(tmp_path / f"run{seed}.csv")
        rows = np.column_stack([np.arange(400), record.op, record.pv, record.sp])
        np.savetxt(paths[-1], rows, delimiter=",", header="Time,OP,PV,SP", comments="")
    out = tmp_path / "found.json"
    done = CliRunner().invoke(
        app, ["diagnose", "--same-loop", *map(str, paths), "--out", str(out), "--op-span", "0", "100"]
    )
    assert done.exit_code == 1
    assert "BACKLASH" in done.stdout
    data = json.loads(out.read_text())
    assert data["files"] == [str(path) for path in paths]
    assert [one["name"] for one in data["pooled"]["records"]] == ["run1", "run2"]


def test_the_type_of_the_loop_is_what_most_tags_say():
    one = lm.LoopRecord(np.arange(5.0), np.arange(5.0), dt=1.0)
    records = [replace(one, loop_type=kind) for kind in ("", "flow", "flow", "level", "")]
    asked = DiagnosisSettings(None, None, 0.01)
    assert asked.of(records).loop_type == "flow"
    assert asked.of([one]) is asked
    assert replace(asked, loop_type="level").of(records).loop_type == "level"
