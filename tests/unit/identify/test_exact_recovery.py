import numpy as np
import pytest

import lostmotion as lm

TANK = lm.platforms.level_tank()
NUMBER = 1e-6  # relative to the size of the parameters; rounding leaves far less
FIRST_ORDER = lm.LinearModel([-0.8], [0.3], 1, 1.0)


def truth(model, gain=None):
    """Named parameters of a model as `identify` reports them."""
    linear, zone = model.linear, model.nonlinearity
    expected = {"offset": model.offset}
    if isinstance(zone, lm.DeadZone):
        slope = zone.right_slope if gain is not None else 1.0
        linear = linear.scaled(zone.right_slope / slope)
        expected |= {"left": zone.left, "right": zone.right, "width": zone.width, "right_slope": slope}
        ratio = zone.left_slope / zone.right_slope
        expected |= {"left_slope": slope * ratio, "slope_ratio": ratio}
    expected |= {f"a{i + 1}": value for i, value in enumerate(linear.a)}
    expected |= {f"b{i}": value for i, value in enumerate(linear.b)}
    return expected | {"gain": linear.gain}


def check(model, u, dt, gain=None, **settings):
    """Everything is recovered: parameters, model, output."""
    y = model.simulate(u)
    fit = lm.identify(u, y, dt, gain=gain, **{"nonlinearity": "dead zone", **settings})
    expected = truth(model, gain)
    assert set(fit.parameters) == set(expected)
    for name, value in expected.items():
        assert fit.parameters[name] == pytest.approx(value, rel=NUMBER, abs=NUMBER), name
    assert fit.status is lm.Status.OK
    assert fit.fit_percent == pytest.approx(100.0, abs=1e-4)
    seen = np.isfinite(fit.simulated)
    assert seen.sum() >= u.size - 60
    np.testing.assert_allclose(fit.simulated[seen], y[seen], atol=1e-6 * np.ptp(y))
    np.testing.assert_allclose(fit.residuals, 0.0, atol=1e-6 * np.ptp(y))
    return fit


def orders_of(model):
    return len(model.linear.a), len(model.linear.b) - 1, model.linear.delay


@pytest.mark.statistics
@pytest.mark.parametrize("noise", ["auto", "white"])
@pytest.mark.parametrize("seed", [*range(15), 75])
def test_papers_tank(seed, noise):
    u = lm.signals.prs(2000, -5, 5, 10, seed)
    check(TANK, u, 0.1, gain=TANK.linear.gain, orders=(3, 2, 3), noise=noise)


def test_papers_tank_on_a_short_record():
    u = lm.signals.prs(300, -5, 5, 10, seed=0)
    check(TANK, u, 0.1, gain=TANK.linear.gain, orders=(3, 2, 3), noise="white")


@pytest.mark.statistics
@pytest.mark.parametrize("gain", [None, TANK.linear.gain])
@pytest.mark.parametrize("slopes", [(1, 1), (1, 4), (4, 1)])
@pytest.mark.parametrize("width", [0.3, 2.0])
@pytest.mark.parametrize("seed", range(3))
def test_asymmetric_tank_in_absolute_units(seed, width, slopes, gain):
    zone = lm.DeadZone(47.6, 47.6 + width, *slopes)
    u = 48.0 + lm.signals.prs(2000, -5, 5, 10, seed)
    model = lm.Hammerstein(zone, TANK.linear, offset=52.0)
    check(model, u, 0.1, gain=gain, orders=(3, 2, 3), noise="white")


@pytest.mark.statistics
@pytest.mark.parametrize("deviation", [0.0, 0.01, 0.05])
@pytest.mark.parametrize("width", [0.2, 0.3, 0.4])
@pytest.mark.parametrize("seed", range(3))
def test_narrow_dead_zone_away_from_the_middle(seed, width, deviation):
    """Two to four percent of the moves of OP, hardly any noise: the search must not stop beside it."""
    u = 48.0 + lm.signals.prs(2000, -5, 5, 10, seed)
    model = lm.Hammerstein(lm.DeadZone(47.6, 47.6 + width), TANK.linear, offset=52.0)
    y = model.simulate(u) + np.random.default_rng(seed).normal(scale=deviation, size=2000)
    fit = lm.identify(u, y, 0.1, orders=(3, 2, 3), noise="white", nonlinearity="dead zone")
    assert fit.widest is None or fit.widest >= width  # never exclude the truth
    assert fit.status is lm.Status.OK
    for name, value in {"left": 47.6, "right": 47.6 + width}.items():
        assert fit.parameters[name] == pytest.approx(value, abs=5 * fit.standard_errors[name] + 1e-6), name


@pytest.mark.parametrize(
    "zone",
    [
        lm.DeadZone(-1, 1),
        lm.DeadZone(0.4, 0.7, 1, 4),
        lm.DeadZone(-2.5, -0.5, 4, 1),
        lm.DeadZone(-1, 1, 0.01, 0.01),
    ],
)
@pytest.mark.parametrize("offset", [0.0, 100.0, -0.3])
def test_first_order(zone, offset):
    u = lm.signals.prs(300, -5, 5, 7, seed=2)
    check(lm.Hammerstein(zone, FIRST_ORDER, offset), u, 1.0, orders=(1, 0, 1), noise="white")


@pytest.mark.parametrize("gain", [None, FIRST_ORDER.scaled(-1).gain])
def test_negative_gain(gain):
    u = lm.signals.prs(300, -5, 5, 7, seed=3)
    model = lm.Hammerstein(lm.DeadZone(0.2, 1.4, 2.0, 3.0), FIRST_ORDER.scaled(-1), 7.0)
    check(model, u, 1.0, gain=gain, orders=(1, 0, 1), noise="white")


@pytest.mark.statistics
@pytest.mark.parametrize("seed", range(3))
def test_tank_with_negative_gain(seed):
    u = lm.signals.prs(2000, -5, 5, 10, seed)
    model = lm.Hammerstein(TANK.nonlinearity, TANK.linear.scaled(-1), 3.0)
    check(model, u, 0.1, gain=model.linear.gain, orders=(3, 2, 3), noise="white")


@pytest.mark.parametrize(
    "linear",
    [
        lm.LinearModel([], [1.0, 0.5], 1),
        lm.LinearModel([-0.6], [0.5, 0.3, -0.1], 1),
        lm.LinearModel([-1.2, 0.4], [0.5], 2),
        lm.LinearModel([-0.9], [0.1], 5),
    ],
)
def test_other_orders(linear):
    u = lm.signals.prs(300, -5, 5, 5, seed=5)
    model = lm.Hammerstein(lm.DeadZone(-0.5, 1.5, 2.0, 1.0), linear, 1.0)
    check(model, u, linear.dt, orders=orders_of(model), noise="white")


@pytest.mark.parametrize("offset", [0.0, 5.0])
def test_linear_plant_as_a_linear_model(offset):
    u = 2.0 + lm.signals.prs(300, -5, 5, 7, seed=4)
    model = lm.Hammerstein(lm.Identity(), lm.LinearModel([-1.2, 0.4], [0.5, 0.2], 2), offset)
    fit = check(model, u, 1.0, nonlinearity="none", orders=(2, 1, 2), noise="white")
    assert fit.nonlinearity == lm.Identity()


@pytest.mark.statistics
def test_linear_tank_as_a_linear_model():
    u = lm.signals.prs(2000, -5, 5, 10, seed=1)
    model = lm.Hammerstein(lm.Identity(), TANK.linear, 50.0)
    check(model, u, 0.1, nonlinearity="none", orders=(3, 2, 3), noise="white")


@pytest.mark.statistics
@pytest.mark.parametrize("noise", ["auto", "white", 2])
def test_linear_plant_shows_no_dead_zone(noise):
    """Exactly linear data: no wider dead zone than rounding, and "auto" returns the linear model."""
    u = lm.signals.prs(600, -5, 5, 7, seed=6)
    y = FIRST_ORDER.simulate(u)
    settings = {"orders": (1, 0, 1), "noise": noise}
    assert lm.identify(u, y, 1.0, **settings, nonlinearity="dead zone").parameters["width"] == pytest.approx(
        0.0, abs=1e-6
    )
    assert lm.identify(u, y, 1.0, nonlinearity="auto", **settings).nonlinearity == lm.Identity()


@pytest.mark.statistics
@pytest.mark.parametrize("seed", range(4))
def test_orders_of_the_tank_need_not_be_known(seed):
    u = lm.signals.prs(2000, -5, 5, 10, seed)
    fit = lm.identify(u, TANK.simulate(u), 0.1, gain=TANK.linear.gain, noise="white", nonlinearity="dead zone")
    for name, value in {"left": -1, "right": 1, "left_slope": 3, "right_slope": 3, "offset": 0}.items():
        assert fit.parameters[name] == pytest.approx(value, abs=1e-4), name
    assert fit.linear.delay == 3


@pytest.mark.statistics
@pytest.mark.parametrize("seed", range(3))
def test_closed_loop_with_set_point_moves(seed):
    """Feedback without noise: set-point moves alone excite the loop."""
    reference = np.repeat(np.random.default_rng(seed).uniform(-2, 2, 40), 50)
    loop = lm.simulate_loop(TANK, lm.PI(0.5, 0.7), reference)
    fit = lm.identify(
        loop.command,
        loop.measured,
        0.1,
        orders=(3, 2, 3),
        gain=TANK.linear.gain,
        noise="white",
        nonlinearity="dead zone",
    )
    for name, value in truth(TANK, TANK.linear.gain).items():
        assert fit.parameters[name] == pytest.approx(value, rel=1e-5, abs=1e-5), name
