"""What holds for every figure: no text over another, words and units at the axes, no number nobody can read."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import ParameterError
from tests.support.diagnoses import example, loop_record, variant
from tests.support.figure_texts import assert_readable, overlaps
from tests.support.fits import VALVES, made_fit

pytest.importorskip("matplotlib")
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure


def simulated(compensator=None):
    sp = np.repeat([0.0, -1.0, 1.0], 100)
    return lm.simulate_loop(lm.platforms.level_tank(), lm.PI(0.4, 0.1), sp, noise=0.03, seed=1, compensator=compensator)


VERDICTS = {"dead zone": "actuator", "stiction": "actuator", "none": "none", "cannot tell": "unknown"}
FIGURES = {
    "record": loop_record,
    "loop": simulated,
    "compensated loop": lambda: simulated(lm.DeadZoneCompensator.from_dead_zone(lm.DeadZone(-1.0, 1.0, 3.0, 3.0))),
    **{f"fit of {kind}": lambda kind=kind: made_fit(kind) for kind in VALVES},
    "level": lambda: made_fit("stiction", integrating=True),
    **{f"diagnosis {verdict}": lambda case=(verdict, kind): variant(*case) for verdict, kind in VERDICTS.items()},
}
SIZES = {"wide": None, "page": (8.0, 6.5)}


@pytest.mark.sampled(5)
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", FIGURES)
def test_no_text_lies_over_another(name, size):
    given = None if SIZES[size] is None else Figure(figsize=SIZES[size])
    assert_readable(FIGURES[name]().plot(figure=given))


def test_heading_and_panel_of_a_fit_say_what_was_found():
    fit = made_fit("dead zone")
    axes = fit.plot().axes
    assert fit.plot().get_suptitle().startswith("FIC-101: dead zone, width 3.2")
    assert fit.plot().get_suptitle().endswith("; status OK")
    assert axes[0].get_title(loc="left").startswith("Dead zone: width 3.2")
    unseen = made_fit("dead zone", lm.Status.NOT_SEEN, widest=0.4).plot()
    assert "no lost motion seen, none above 0.4 (95 %)" in unseen.get_suptitle()
    wide = made_fit("dead zone", lm.Status.WIDE).plot()
    assert "width not determined (95 %: " in wide.get_suptitle()
    open_ended = made_fit("stiction", lm.Status.NOT_REPRODUCED).plot()
    assert "cannot tell" in open_ended.get_suptitle()
    assert open_ended.axes[0].get_title(loc="left").startswith("Not reliable: stiction, band 2.30")


@pytest.mark.parametrize("kind", ["backlash", "stiction"])
def test_figure_and_repr_show_the_interval_of_the_report(kind):
    fit = made_fit(kind)
    low, high = fit.size_interval
    assert fit.interval(fit.kind.size) != (low, high)
    assert f"(95 %: {low:.2f} .. {high:.2f})" in fit.plot().get_suptitle()
    assert f"{kind} {low:.4g}..{high:.4g}" in repr(fit)


def test_size_is_in_percent_of_a_known_span():
    fit = made_fit("backlash")
    spanned = replace(fit, data=replace(fit.data, op_span=(4.0, 20.0), op_unit="mA"))
    assert "width 1.70 mA" in spanned.plot().get_suptitle()
    assert "10.6 % of span" in spanned.plot().get_suptitle()


def test_a_fit_shows_sp_and_op_on_the_clock_of_the_record():
    record = replace(loop_record(), start="2026-03-01 06:00", gaps=(150,), gap_seconds=(600.0,))
    fit = lm.identify(record, orders=(1, 0, 1), noise="white", nonlinearity="dead zone")
    _, _, pv, op, *_ = fit.plot().axes
    assert [text.get_text() for text in pv.get_legend().get_texts()] == ["PV", "model", "SP"]
    assert op.get_xlabel() == "time"
    times = op.lines[0].get_xdata()
    assert times[0] == np.datetime64("2026-03-01T06:00")
    assert times[-1] == np.datetime64("2026-03-01T06:00") + np.timedelta64(399 * 5 + 600, "s")
    clockless = lm.identify(replace(record, start=None, gap_seconds=()), orders=(1, 0, 1), noise="white")
    assert clockless.plot().axes[3].get_xlabel() == "time, min"


def test_records_out_of_order_have_no_clock():
    late, early = (replace(loop_record(), start=f"2026-03-0{day} 06:00") for day in (2, 1))
    fit = lm.identify([late, early], orders=(1, 0, 1), noise="white", nonlinearity="dead zone")
    assert fit.plot().axes[3].get_xlabel() == "time, min"


def test_a_model_that_does_not_reproduce_pv_is_not_drawn():
    poor = replace(made_fit("backlash"), fit_percent=-2420.9)
    poor = replace(poor, simulated=np.random.default_rng(0).normal(scale=1e4, size=poor.simulated.size))
    title = poor.plot().axes[2].get_title(loc="left")
    assert title == "Measurement (the model does not reproduce it from OP alone)"
    drifting = replace(poor, simulated=poor.data.y + np.linspace(0.0, 1e3, poor.data.y.size))
    assert "drifts away from PV" in drifting.plot().axes[2].get_title(loc="left")
    for figure in (poor.plot(), drifting.plot()):
        assert "model" not in [line.get_label() for line in figure.axes[2].lines]


def test_an_integrator_has_a_slope_and_no_gain():
    fit = made_fit("backlash", integrating=True)  # 0.05 of PV in 0.5 s
    assert "integrates 0.1 PV/s per unit of OP" in fit.plot().axes[1].get_title(loc="left").replace("\n", " ")
    slow = replace(fit, model=replace(fit.model, linear=lm.LinearModel([-1.0 + 1e-5], [0.05], 2, 0.5)))
    assert "does not settle within the record, 0.1 PV/s" in slow.plot().axes[1].get_title(loc="left").replace("\n", " ")


@pytest.mark.parametrize("kind", ["backlash", "stiction"])
def test_a_valve_with_memory_has_a_loop_that_closes(kind):
    rising, falling = made_fit(kind).plot().axes[0].lines[:2]
    assert (rising.get_label(), falling.get_label()) == ("OP rising", "OP falling")
    up, down = (np.array([line.get_xdata(), line.get_ydata()]) for line in (rising, falling))
    np.testing.assert_allclose(up[:, [0, -1]], down[:, [-1, 0]], atol=1e-9)
    behind = np.interp(50.0, up[0], up[1]), np.interp(50.0, down[0][::-1], down[1][::-1])
    assert behind[0] < behind[1]


def test_a_loop_is_wide_enough_for_the_valve_to_break_away():
    fit = made_fit("stiction")
    stuck = replace(fit, model=replace(fit.model, nonlinearity=lm.Stiction(12.0, 11.0, "he")))
    assert np.ptp(stuck.plot().axes[0].lines[0].get_ydata()) > 1.0


def test_long_records_are_drawn_with_few_points():
    n = 100_000
    fit = made_fit("backlash")
    data = replace(fit.data, u=np.resize(fit.data.u, n), y=np.resize(fit.data.y, n), segments=np.array([[0, n]]))
    long = replace(fit, data=data, simulated=np.resize(fit.simulated, n), residuals=np.resize(fit.residuals, n))
    for axes in long.plot().axes:
        assert all(len(line.get_xdata()) < 10_000 for line in axes.lines)


def test_drawing_into_a_figure_a_subfigure_and_an_axes():
    fit, found = made_fit("backlash"), example()
    whole = Figure(figsize=(20.0, 9.0), layout="constrained")
    left, right = whole.subfigures(1, 2)
    assert fit.plot(figure=left) is left
    assert found.plot(figure=right) is right
    assert len(left.axes), len(right.axes) == (6, 4)
    assert left.get_suptitle().startswith("FIC-101")
    one = Figure(layout="constrained").subplots(1, 3)
    assert fit.plot(ax=one[0]) is one[0].figure
    assert one[0].get_title(loc="left").startswith("Backlash")
    found.plot(ax=one[1])
    found.record.plot(ax=one[2])
    for axes in one[1:]:
        names = [text.get_text() for text in axes.get_legend().get_texts()]
        assert names == ["PV", "SP", "OP, right scale"]
    assert len(one[0].figure.axes) == 5  # two scales for OP


@pytest.mark.parametrize("result", [lambda: made_fit("none"), example, loop_record])
def test_figure_and_axes_together_or_something_else_are_refused(result):
    figure = Figure()
    with pytest.raises(ParameterError, match=r"expected figure= or ax=, got both"):
        result().plot(figure=figure, ax=figure.subplots())
    with pytest.raises(ParameterError, match="expected a matplotlib figure, got Axes"):
        result().plot(figure=figure.subplots())
    with pytest.raises(ParameterError, match="expected a matplotlib Axes, got Figure"):
        result().plot(ax=figure)


def test_an_overlap_is_found():
    figure = Figure(figsize=(4.0, 3.0))
    axes = figure.subplots()
    axes.plot([0, 1], label="a name as long as the panel is wide")
    axes.set_title("A title that begins at the left", loc="left")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0))
    assert overlaps(figure)


@pytest.mark.parametrize(
    ("seconds", "ticks"), [(7200.0 * 2, ["0:00", "0:30"]), (36_000.0, ["0:00", "2:00"]), (1200.0, ["0", "5"])]
)
def test_elapsed_time_is_in_units_of_a_clock(seconds, ticks):
    record = lm.LoopRecord(np.arange(400.0), np.arange(400.0), dt=seconds / 400)
    figure = record.plot()
    FigureCanvasAgg(figure).draw()
    labels = [tick.get_text() for tick in figure.axes[1].get_xticklabels()]
    first = labels.index(ticks[0])
    assert labels[first : first + 2] == ticks
