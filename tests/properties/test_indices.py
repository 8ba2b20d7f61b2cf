import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lostmotion.evaluate import control_variance, mean_absolute_error, reversals, travel
from tests.properties.strategies import signals

whole = st.lists(st.integers(-50, 50), min_size=1, max_size=40).map(lambda values: np.array(values, dtype=float))
bands = st.integers(0, 60).map(lambda value: value / 2)
scales = st.integers(-8, 8).map(lambda power: 2.0**power)  # exact, so that no move changes sides of the band
offsets = st.integers(-1000, 1000)


@given(whole, bands, offsets, scales)
def test_reversals_do_not_depend_on_the_unit(command, band, offset, scale):
    expected = reversals(command, band)
    assert reversals(command + offset, band) == expected
    assert reversals(scale * command, scale * band) == expected
    assert reversals(-command, band) == expected


@given(signals, st.floats(0, 10))
def test_monotone_commands_never_turn(command, band):
    assert reversals(np.sort(command), band) == 0
    assert reversals(np.sort(command)[::-1], band) == 0


@given(whole)
def test_reversals_without_a_band_are_sign_changes(command):
    moves = np.sign(np.diff(command))
    moves = moves[moves != 0]
    assert reversals(command) == np.count_nonzero(np.diff(moves))


@given(whole, bands)
def test_reversals_need_room(command, band):
    count = reversals(command, band)
    assert 0 <= count <= max(0, command.size - 2)
    assert count * band <= travel(command)
    if np.ptp(command) < band:  # one as large as the band counts
        assert count == 0


@given(whole, bands, st.integers(1, 4))
def test_held_commands_turn_as_often(command, band, hold):
    assert reversals(np.repeat(command, hold), band) == reversals(command, band)


@given(signals)
def test_travel_is_no_shorter_than_the_way(command):
    way, room = travel(command), 1e-9 * np.abs(command).max()
    assert way >= abs(command[-1] - command[0]) - room
    assert way >= np.ptp(command) - room
    assert travel(command[::-1]) == pytest.approx(way, rel=1e-12, abs=1e-12)
    assert travel(np.sort(command)) == pytest.approx(np.ptp(command), rel=1e-12, abs=1e-12)


@given(whole, offsets, scales)
def test_travel_and_variance_in_other_units(command, offset, scale):
    assert travel(scale * command + offset) == pytest.approx(scale * travel(command))
    assert control_variance(scale * command + offset) == pytest.approx(
        scale**2 * control_variance(command), rel=1e-6, abs=1e-9
    )


@given(signals)
def test_variance_bounds(u):
    assert 0.0 <= control_variance(u) <= np.ptp(u) ** 2 / 4 * (1 + 1e-9) + 1e-18 + 1e-30 * np.square(u).max()


@given(st.lists(st.tuples(*[st.floats(-100, 100)] * 3), min_size=1, max_size=30).map(np.array))
def test_mean_absolute_error_is_a_distance(rows):
    r, y, other = rows.T
    error = mean_absolute_error(r, y)
    assert mean_absolute_error(r, r) == 0.0
    assert error == mean_absolute_error(y, r)
    assert error <= mean_absolute_error(r, other) + mean_absolute_error(other, y) + 1e-9
    assert error >= abs(np.mean(r) - np.mean(y)) - 1e-9
