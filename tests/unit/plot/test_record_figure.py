"""The figure of a record, and what it says of itself."""

import io
import json
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

import lostmotion as lm
from lostmotion.cli import app
from lostmotion.records import check, prepare
from lostmotion.records.outline import outline
from tests.support.diagnoses import example, loop_record

pytest.importorskip("matplotlib")
RECORD = replace(loop_record(), op_unit="%", pv_unit="m3/h")


def panels(record):
    figure = record.plot()
    figure.savefig(buffer := io.BytesIO(), dpi=40)
    assert buffer.getvalue()[:4] == b"\x89PNG"
    return figure.axes


def test_trend_and_plane_with_units():
    above, below, plane = panels(RECORD)
    assert (above.get_ylabel(), below.get_ylabel()) == ("PV [m3/h]", "OP [%]")
    assert (plane.get_xlabel(), plane.get_ylabel()) == ("OP [%]", "PV [m3/h]")
    assert below.get_xlabel() == "time, min"
    assert [line.get_label() for line in above.lines] == ["PV", "SP"]
    np.testing.assert_array_equal(above.lines[0].get_ydata(), RECORD.pv)
    np.testing.assert_array_equal(plane.lines[0].get_xdata(), RECORD.op)
    assert RECORD.plot().get_suptitle() == "FC7: 400 samples every 5 s"
    assert RECORD.plot(title="mine").get_suptitle() == "mine"


def test_without_units():
    above, below, plane = panels(loop_record())
    assert {axes.get_ylabel() for axes in (above, plane)} == {"PV"}
    assert below.get_ylabel() == plane.get_xlabel() == "OP"


def test_what_does_not_move_has_no_plane():
    assert len(panels(replace(RECORD, op=np.full(400, 40.0)))) == 2
    assert len(panels(replace(RECORD, pv=np.full(400, np.nan)))) == 2


def test_dates_and_the_length_of_gaps():
    record = replace(RECORD, start="2026-03-01 06:00", gaps=(100,), gap_seconds=(3600.0,))
    above, below, _ = panels(record)
    times = above.lines[0].get_xdata()
    assert times[0] == np.datetime64("2026-03-01T06:00")
    assert times[-1] - times[0] == np.timedelta64(399 * 5 + 3600, "s")
    assert np.isnan(above.lines[0].get_ydata()[100])
    assert below.get_xlabel() == "time"


def test_gaps_of_unknown_length_are_marked():
    above, below, _ = panels(replace(RECORD, gaps=(100,), start="2026-03-01 06:00"))
    assert [line.get_linestyle() for line in above.lines] == ["-", "--", ":"]
    assert below.lines[-1].get_xdata() == [100 * 5 / 60] * 2


def test_position_and_a_far_set_point():
    above, below, _ = panels(replace(RECORD, position=RECORD.op - 1.0, sp=RECORD.sp + 500.0))
    assert [line.get_label() for line in below.lines] == ["OP", "position"]
    assert "set point far away" in above.get_title(loc="left")


def test_long_records_keep_their_peaks():
    values = np.random.default_rng(0).normal(size=1_000_003)
    values[345_678], values[999_999] = 50.0, -50.0
    values[500_000:510_000] = np.nan
    rows = outline(values, 8000)
    assert rows.size < 10_000
    assert (np.diff(rows) >= 0).all()
    assert {345_678, 999_999} <= set(rows.tolist())
    assert np.isnan(values[rows]).any()
    record = lm.LoopRecord(values, values + 0.1, dt=1.0)
    assert "last 2000 rows" in panels(record)[2].get_title(loc="left")


def test_the_figure_of_a_diagnosis_has_units_too():
    axes = replace(example(), record=RECORD).plot().axes
    assert (axes[0].get_ylabel(), axes[1].get_ylabel(), axes[2].get_ylabel()) == ("PV [m3/h]", "OP [%]", "PV [m3/h]")
    assert axes[2].get_xlabel() == "OP [%]"
    assert axes[2].get_legend().get_texts()[0].get_text() == "dead zone"


def test_check_is_that_of_the_command(tmp_path):
    """Figure by figure what `lostmotion check --json` prints."""
    path = tmp_path / "FC7.csv"
    columns = np.column_stack([5.0 * np.arange(400), RECORD.op, RECORD.pv, RECORD.sp])
    np.savetxt(path, columns, delimiter=",", header="t_s,OP,PV,SP", comments="", fmt="%.9g")
    printed = json.loads(CliRunner().invoke(app, ["check", str(path), "--json"]).stdout)
    record = lm.read_loop(path)
    assert json.loads(json.dumps(record.check().to_dict())) == {key: printed[key] for key in record.check().to_dict()}
    assert record.check().report.to_dict() == check(record).to_dict()
    assert record.check().prepared.rows == prepare(record).rows
    assert record.check().usable
