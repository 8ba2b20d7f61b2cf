import io
from dataclasses import replace

import numpy as np
import pytest

from lostmotion.diagnose.shown_rows import FEWEST_ROWS, MOST_ROWS, PERIODS, shown_rows
from tests.support.diagnoses import CASES, example, loop_record, variant

pytest.importorskip("matplotlib")


@pytest.mark.parametrize(("verdict", "kind"), CASES)
def test_every_verdict_is_drawn(verdict, kind):
    figure = variant(verdict, kind).plot()
    figure.savefig(buffer := io.BytesIO(), dpi=40)
    assert buffer.getvalue()[:4] == b"\x89PNG"
    assert figure.get_suptitle().startswith("FC7: ")
    assert "What to do: Check the range." in figure.get_supxlabel()
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert titles[:3] == ["Measurement and set point", "Controller output", "PV over OP"]
    assert titles[3].startswith("Evidence")


def test_heading_says_what_and_how_much():
    figure = example().plot()
    assert "Dead zone, " in figure.get_suptitle()
    assert "confidence 93 %" in figure.get_suptitle()
    assert example().plot(title="mine").get_suptitle() == "mine"


def test_the_dead_zone_is_drawn_where_it_is():
    zone = example().fit.nonlinearity
    (band,) = example().plot().axes[2].patches
    assert (band.get_x(), band.get_x() + band.get_width()) == pytest.approx((zone.left, zone.right))
    (other,) = variant("stiction", "actuator", size=1.5).plot().axes[2].patches
    assert other.get_width() == pytest.approx(1.5)
    assert not variant("none", "none").plot().axes[2].patches


def test_bars_are_the_weights_and_what_they_come_to():
    found = example()
    bars = [patch.get_width() for patch in found.plot().axes[3].patches]
    assert bars[:2] == pytest.approx([item.weight for item in found.evidence])
    assert sum(bars[:-1]) == pytest.approx(bars[-1])


def test_without_set_point_and_without_period():
    measured = replace(example().measured, period=float("nan"))
    for sp in (None, np.full(400, np.nan)):
        figure = replace(example(), record=replace(loop_record(), sp=sp), measured=measured).plot()
        assert figure.axes[0].get_title(loc="left") == "Measurement"
        assert len(figure.axes[0].lines) == 1


def test_a_set_point_in_other_units_does_not_squash_the_measurement():
    record = loop_record()
    figure = replace(example(), record=replace(record, sp=record.sp + 500.0)).plot()
    assert "set point far away" in figure.axes[0].get_title(loc="left")
    assert np.diff(figure.axes[0].get_ylim())[0] < 2.0 * np.ptp(record.pv)


def test_the_last_periods_are_shown():
    record = loop_record(2000)
    swinging = replace(example(), record=record, measured=replace(example().measured, period=20.0))
    rows, start = shown_rows(swinging)
    assert len(rows) == PERIODS * 20
    np.testing.assert_array_equal(rows.op, record.op[start:])
    quiet = replace(swinging, measured=replace(example().measured, period=float("nan")))
    assert len(shown_rows(quiet)[0]) == MOST_ROWS
    fast = replace(swinging, measured=replace(example().measured, period=2.0))
    assert len(shown_rows(fast)[0]) == FEWEST_ROWS
