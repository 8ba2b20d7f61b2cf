import json

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from lostmotion.models import Backlash, Saturation, Stiction, actuator_from_dict
from tests.naive import stiction as slow

eighths = st.integers(-800, 800).map(lambda number: number / 8)  # sums and differences are exact
widths = st.integers(0, 400).map(lambda number: number / 8)
signals = st.lists(eighths, min_size=1, max_size=40).map(np.array)
any_signals = st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=40).map(np.array)
any_widths = st.floats(0, 1e5)
backlashes = widths.map(Backlash)
models = st.sampled_from(["choudhury", "kano", "he"])
bounded = st.sampled_from(["kano", "he"])
EPS = np.finfo(float).eps


@given(any_widths, any_signals)
def test_backlash_keeps_within_half_its_width(width, u):
    reach = 4 * EPS * (np.abs(u).max() + width)
    assert np.all(np.abs(u - Backlash(width)(u)) <= 0.5 * width + reach)


@given(backlashes, signals, st.lists(st.integers(1, 4), min_size=40, max_size=40))
def test_backlash_does_not_see_the_rate(gear, u, holds):
    times = holds[: u.size]
    np.testing.assert_array_equal(gear(np.repeat(u, times)), np.repeat(gear(u), times))
    fine = np.interp(np.arange(4 * u.size - 3) / 4, np.arange(u.size), u)
    np.testing.assert_array_equal(gear(fine)[::4], gear(u))


@given(backlashes, signals)
def test_backlash_of_its_inverse_is_exact(gear, v):
    np.testing.assert_array_equal(gear(gear.inverse()(v)), v)


@given(any_widths, any_signals)
def test_backlash_of_its_inverse_to_rounding(width, v):
    gear = Backlash(width)
    np.testing.assert_allclose(gear(gear.inverse()(v)), v, atol=4 * EPS * (np.abs(v).max() + width))


@given(backlashes, signals, st.sampled_from([-1, 1]))
def test_backlash_of_its_inverse_that_goes_on(gear, v, side):
    np.testing.assert_array_equal(gear.run(gear.inverse().run(v, side=side), start=v[0]), v)


@given(backlashes, signals, st.floats(-1, 1))
def test_backlash_of_its_inverse_from_a_wrong_start(gear, v, share):
    """Exact from the first move of v past the start on."""
    start = v[0] + np.round(4 * share * gear.width) / 8
    x = gear.run(gear.inverse()(v), start=start)
    rising, falling = np.diff(v, prepend=v[0]) > 0, np.diff(v, prepend=v[0]) < 0
    caught = np.flatnonzero((rising & (v >= start)) | (falling & (v <= start)))
    assume(caught.size > 0)
    np.testing.assert_array_equal(x[caught[0] :], v[caught[0] :])


@given(backlashes, signals, st.lists(st.integers(0, 80), min_size=40, max_size=40), eighths)
def test_backlash_is_monotone(gear, u, more, start):
    higher = u + np.array(more[: u.size]) / 8
    assert np.all(gear.run(u, start=start) <= gear.run(higher, start=start))
    assert np.all(gear.run(u, start=start) <= gear.run(u, start=start + 1.0))


@given(backlashes, signals, st.floats(-10, 10))
def test_backlash_is_odd_and_moves_with_its_origin(gear, u, start):
    np.testing.assert_array_equal(gear(-u), -gear(u))
    np.testing.assert_array_equal(gear(u + 100.0), gear(u) + 100.0)
    assert np.all(np.abs(gear.run(u, start=start) - gear(u)) <= abs(start - u[0]) + 1e-12)  # it forgets


@given(any_signals, models)
def test_stiction_without_width_is_the_identity(u, model):
    np.testing.assert_array_equal(Stiction(0, 0, model)(u), u)


@given(widths, widths, signals, models, eighths)
def test_stiction_is_its_twin(band, jump, u, model, start):
    found = Stiction(band, jump, model).run(u, start=start)
    np.testing.assert_array_equal(found, slow.MODELS[model](u, band, jump, start))


@given(widths, widths, signals, bounded, eighths)
def test_stiction_is_bounded_by_its_static_friction(band, jump, u, model, start):
    gap = np.abs(u - Stiction(band, jump, model).run(u, start=start))
    assert np.all(gap <= (band + jump) / 2)


@given(widths, widths, st.lists(st.floats(0.1, 50), min_size=2, max_size=20), st.integers(1, 9), eighths)
def test_choudhury_is_bounded_and_kano_where_runs_are_long(band, jump, further, pieces, start):
    runs = (np.array(further) + max(band, 0.5 * (band + jump))) * (-1.0) ** np.arange(len(further))
    turns = start + np.concatenate([[0.0], np.cumsum(runs)])
    u = np.interp(np.arange((turns.size - 1) * pieces + 1) / pieces, np.arange(turns.size), turns)
    valve = Stiction(band, jump, "choudhury")(u)
    assert np.all(np.abs(u - valve) <= (band + jump) / 2 + 1e-9)
    near = np.abs(np.abs(u - valve) - (band + jump) / 2).min()
    assume(near > 1e-9)  # a tie is decided by rounding
    np.testing.assert_allclose(valve, Stiction(band, jump, "kano")(u), atol=1e-9)


@given(widths, signals, st.sampled_from(["kano", "he"]), eighths)
def test_stiction_without_jump_is_backlash(band, u, model, start):
    found = Stiction(band, 0, model).run(u, start=start)
    np.testing.assert_array_equal(found, Backlash(band).run(u, start=start))


@given(widths, widths, signals, st.lists(st.integers(1, 4), min_size=40, max_size=40))
def test_he_does_not_see_held_samples(band, jump, u, holds):
    valve, times = Stiction(band, jump, "he"), holds[: u.size]
    np.testing.assert_array_equal(valve(np.repeat(u, times)), np.repeat(valve(u), times))


@given(widths, widths, signals, models)
def test_stiction_is_odd_and_moves_with_its_origin(band, jump, u, model):
    valve = Stiction(band, jump, model)
    np.testing.assert_array_equal(valve(-u), -valve(u))
    np.testing.assert_array_equal(valve(u + 100.0), valve(u) + 100.0)


@given(widths, widths, signals, models, st.data())
def test_missing_samples_change_nothing_for_the_others(band, jump, u, model, data):
    lost = np.array(data.draw(st.lists(st.booleans(), min_size=u.size, max_size=u.size)))
    assume(not lost.all())
    holes = np.where(lost, np.nan, u)
    for actuator in (Stiction(band, jump, model), Backlash(band)):
        x = actuator(holes)
        np.testing.assert_array_equal(np.isnan(x), lost)
        np.testing.assert_array_equal(x[~lost], actuator(u[~lost]))


@given(eighths, widths, any_signals)
def test_saturation_is_a_projection(low, span, u):
    valve = Saturation(low, low + span)
    x = valve(u)
    np.testing.assert_array_equal(valve(x), x)
    assert np.all((x >= low) & (x <= low + span))
    np.testing.assert_array_equal(valve.inverse()(x), x)


@given(widths, widths, models)
def test_description_survives_json(band, jump, model):
    for actuator in (Stiction(band, jump, model), Backlash(band), Saturation(-band, jump)):
        assert actuator_from_dict(json.loads(json.dumps(actuator.to_dict()))) == actuator


@pytest.mark.parametrize("model", ["choudhury", "kano"])
def test_a_held_sample_stops_a_moving_valve(model):
    """Why the two are left out of the test of held samples above."""
    valve = Stiction(2.0, 1.0, model)
    assert valve([0.0, 2.0, 2.5]).tolist() != valve([0.0, 2.0, 2.0, 2.5])[[0, 1, 3]].tolist()
