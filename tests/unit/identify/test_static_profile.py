"""Dead zones that hold few levels of a quantised OP, and such as are seen but not known."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import Status
from lostmotion.evaluate import random_loop
from lostmotion.identify.actuators import static_profile
from lostmotion.identify.likelihood.arx_gram import Lags
from lostmotion.identify.scaled import ScaledData

STEP = 0.5
TANK = lm.platforms.level_tank()


def record(seed, levels=1, noise=0.03**0.5, samples=2000):
    """As in benchmarks/small_zones.py."""
    random = np.random.default_rng(seed)
    u = np.round(lm.signals.prs(samples, -5, 5, hold=10, seed=seed) / STEP) * STEP
    first = STEP * random.integers(-4, 3)
    left = first - STEP * random.uniform(0.02, 0.98)
    right = first + STEP * (levels - 1 + random.uniform(0.02, 0.98))
    y = lm.Hammerstein(lm.DeadZone(left, right, 3.0, 3.0), TANK.linear).simulate(u)
    return u, y + random.normal(scale=noise, size=samples), (left, right)


@pytest.mark.statistics
@pytest.mark.parametrize("seed", [0, 6, 26, 37])
def test_a_zone_about_one_level_is_not_left_between_two(seed):
    """Found between two levels before: a zone that holds none slides there unseen."""
    u, y, (left, right) = record(seed)
    fit = lm.identify(u, y, 0.1, orders=(3, 2, 3), nonlinearity="dead zone")
    assert abs(fit.parameters["left"] - left) < 0.05
    assert abs(fit.parameters["right"] - right) < 0.05
    assert {"left", "right", "width"} <= set(fit.profiled)
    low, high = fit.interval("width")
    assert low <= right - left <= high


def test_many_levels_inside_leave_the_interval_to_curvature():
    u = lm.signals.prs(2000, -5, 5, hold=10, seed=1)
    y = TANK.simulate(u) + np.random.default_rng(1).normal(scale=0.03**0.5, size=2000)
    fit = lm.identify(u, y, 0.1, orders=(3, 2, 3), nonlinearity="dead zone")
    assert not fit.profiled
    low, high = fit.interval("right")
    assert high - low == pytest.approx(2 * 1.96 * fit.standard_errors["right"], rel=1e-3)


@pytest.mark.statistics
def test_intervals_hold_with_one_level_inside():
    """Nominal 95 %: 50 of 60 or fewer have a probability of 1e-4."""
    held = 0
    for seed in range(60):
        u, y, (left, right) = record(seed)
        fit = lm.identify(u, y, 0.1, orders=(3, 2, 3), nonlinearity="dead zone")
        low, high = fit.interval("width")
        held += low <= right - left <= high
    assert held > 50


@pytest.mark.statistics
def test_a_break_point_known_to_no_better_than_half_the_width_is_no_number_to_build_on():
    loop = random_loop(86, 0)
    assert not loop.identifiable
    fit = lm.identify(loop.u, loop.y, loop.dt, nonlinearity="dead zone")
    assert fit.status is Status.WIDE
    assert not fit.status.ok
    assert fit.preferred == "dead zone"  # seen it is
    assert fit.shown_size is None
    with pytest.raises(lm.ParameterError, match="interval of a break point"):
        fit.block()


@pytest.mark.statistics
def test_a_small_gap_that_two_slopes_without_one_explain_as_well_is_not_seen(tmp_path):
    loop = random_loop(172, 0)
    assert not loop.identifiable
    fit = lm.identify(loop.u, loop.y, loop.dt, nonlinearity="dead zone")
    assert fit.status is Status.NOT_SEEN
    assert fit.evidence.gain_over_healthy < 0.0 < fit.evidence.gain_over_linear
    saved = fit.save(tmp_path / "fit.json")
    assert lm.read_fit(saved).evidence == fit.evidence


@pytest.mark.parametrize(("width", "looked"), [(6.0, 0), (0.3, 1)])
def test_narrow_zones_are_sought_where_no_wide_one_is_beyond_doubt(width, looked, monkeypatch):
    calls = []
    sought = static_profile.narrow_zones

    def counted(*arguments):
        calls.append(arguments)
        return sought(*arguments)

    monkeypatch.setattr(static_profile, "narrow_zones", counted)
    u = lm.signals.prs(3000, -5, 5, hold=10, seed=1)
    x = np.sign(u) * np.maximum(np.abs(u) - 0.5 * width, 0.0)
    y = np.zeros(3000)
    for k in range(1, 3000):
        y[k] = 0.9 * y[k - 1] + 0.1 * x[k - 1]
    y += np.random.default_rng(0).normal(scale=0.02, size=3000)
    best = static_profile.profile(ScaledData(u, y, np.array([[0, 3000]])), Lags(15, 12, 1), -5.0, 5.0)[0]
    assert len(calls) == looked
    assert (best.left, best.right) == (pytest.approx(-0.5 * width, abs=0.1), pytest.approx(0.5 * width, abs=0.1))
