"""Trend: known answers, memory, and intervals that hold."""

import json

import numpy as np
import pytest

from lostmotion.errors import DataError, ParameterError
from lostmotion.online import Trend
from tests.support.refusals import refusal


def points(times, values, errors, **settings):
    trend = Trend(**settings)
    for time, value, error in np.broadcast(times, values, errors):
        trend.add(time, value, error)
    return trend


def test_line_is_weighted_least_squares():
    rng = np.random.default_rng(0)
    times, errors = np.sort(rng.uniform(0, 50, 12)), rng.uniform(0.05, 0.3, 12)
    values = 2.0 + 0.1 * times + errors * rng.normal(size=12)
    line = points(times, values, errors).line
    design = np.column_stack([np.ones(12), times]) / errors[:, None]
    covariance = np.linalg.inv(design.T @ design)
    start, slope = covariance @ design.T @ (values / errors)
    widen = max(1.0, np.sqrt(line.chi_square / 10))
    assert line.slope == pytest.approx(slope)
    assert line.slope_error == pytest.approx(widen * covariance[1, 1] ** 0.5)
    value, error = line.at(80.0)
    assert value == pytest.approx(start + 80 * slope)
    direction = np.array([1.0, 80.0])
    assert error == pytest.approx(widen * (direction @ covariance @ direction) ** 0.5)
    assert line.freedom == 10


def test_time_to_a_limit():
    line = points(np.arange(10.0), 1.0 + 0.1 * np.arange(10), 0.02).line
    reach = line.reach(3.0)
    assert reach.state == "approaching"
    assert reach.time == pytest.approx(20.0)
    assert reach.earliest < 20.0 < reach.latest
    for end in (reach.earliest, reach.latest):  # Fieller: the limit is at the edge of the band there
        value, error = line.at(end)
        assert abs(value - 3.0) == pytest.approx(1.959964 * error, rel=1e-5)


def test_without_a_significant_slope_there_is_no_time():
    reach = points(np.arange(10.0), 1.0 + 0.001 * np.arange(10), 0.05).line.reach(3.0)
    assert (reach.state, reach.time, reach.latest) == ("level", None, None)
    assert reach.earliest > 50.0


def test_states_of_a_line():
    def state(slope, limit, error=0.01):
        return points(np.arange(10.0), 1.0 + slope * np.arange(10), error).line.reach(limit).state

    assert state(-0.1, 3.0) == "away"
    assert state(0.1, 1.5) == "reached"
    assert state(0.0, 0.5) == "reached"
    assert state(0.0, 1.5) == "level"


def test_what_is_no_line_is_not_extrapolated():
    line = points(np.arange(4.0), [1.0, 1.0, 2.0, 1.0], 0.01).line
    assert not line.fits
    assert not line.significant
    assert line.reach(3.0) is None


def test_old_points_that_no_common_line_fits_are_left_out():
    values = np.concatenate([np.full(20, 1.0), 1.0 + 0.2 * np.arange(1, 11)])
    line = points(np.arange(30.0), values, 0.05).line
    assert line.fits
    assert line.since >= 18
    assert line.left_out >= 18
    assert line.slope == pytest.approx(0.2, abs=0.02)


def test_few_points_say_nothing():
    assert points(np.arange(3.0), 1.0, 0.1).line is None


def test_memory_is_constant_and_the_line_stays():
    rng = np.random.default_rng(1)
    times = np.arange(5000.0)
    values = 1.0 + 1e-4 * times + 0.1 * rng.normal(size=5000)
    trend = points(times, values, 0.1)
    assert len(trend) == 64
    whole = points(times, values, 0.1, most=5000).line
    assert trend.line.slope == pytest.approx(whole.slope, abs=0.2 * whole.slope_error)
    assert trend.line.value == pytest.approx(whole.value, rel=1e-12)
    assert trend.line.slope_error == pytest.approx(whole.slope_error, rel=0.1)


def test_merging_does_not_prefer_old_or_new_points():
    trend = points(np.arange(1000.0), 1.0, 0.1)
    gaps = np.diff([time for time, _, _ in trend._points])
    assert gaps.max() <= 4 * np.median(gaps)


def test_survives_json():
    rng = np.random.default_rng(2)
    trend = points(np.arange(100.0), rng.normal(size=100), 0.1)
    other = Trend.from_dict(json.loads(json.dumps(trend.to_dict(), allow_nan=False)))
    assert other.line == trend.line
    for each in (trend, other):
        each.add(100.5, 0.3, 0.2)
    assert other.to_dict() == trend.to_dict()


def test_refusals():
    trend = points([0.0], [1.0], [0.1])
    refusal(DataError, trend.add, 0.0, 1.0, 0.1)
    refusal(DataError, trend.add, 1.0, np.nan, 0.1)
    refusal(DataError, trend.add, 1.0, 1.0, 0.0)
    refusal(ParameterError, Trend, 3)


@pytest.mark.parametrize("n", [6, 20, 150])
def test_intervals_hold(n):
    """95 % intervals of slope and time; a level line is called significant in 1 %; a true line is refused in 1 %."""
    rng = np.random.default_rng(n)
    inside = times = significant = refused = left_out = 0
    runs = 400
    spread = 0.1
    slope = 8 * spread * np.sqrt(12 / n) / n  # 8 standard errors
    for _ in range(runs):
        noise = spread * rng.normal(size=n)
        line = points(np.arange(n), 1.0 + slope * np.arange(n) + noise, spread).line
        inside += abs(line.slope - slope) < 1.96 * line.slope_error
        reach = line.reach(1.0 + slope * 2 * n)
        times += reach is not None and reach.time is not None and reach.earliest <= 2 * n <= reach.latest
        left_out += line.left_out > 0
        level = points(np.arange(n), 1.0 + noise, spread).line
        significant += level.significant
        refused += not level.fits
    assert 0.92 * runs <= inside
    assert 0.92 * runs <= times
    assert significant <= 0.03 * runs
    assert refused <= 0.01 * runs
    assert left_out <= 0.04 * runs
