"""The search over structures, and what is known beforehand: delays told, the integrator, actuators begun elsewhere."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.evaluate import random_loop
from lostmotion.identify.likelihood.poles import simpler
from tests.support.shared_data import shared

TANK = lm.platforms.level_tank()


@pytest.mark.statistics
@pytest.mark.parametrize("index", [1, 144, 295, 417, 469])
def test_a_delay_that_the_record_tells_is_found(index):
    """Loops in which a longer model with another delay was refined and the true one was not."""
    loop = random_loop(index, 0)
    assert loop.delay_told
    assert lm.identify(loop.u, loop.y, loop.dt, nonlinearity="dead zone").linear.delay == loop.orders[2]


@pytest.mark.statistics
def test_a_dead_zone_that_is_asked_for_is_not_behind_the_linear_model():
    """ISDB PAP4 (Jelali and Huang, Springer 2010): its contributor names a dead zone."""
    fit = lm.identify(lm.read_loop(shared("isdb26/PAP4.csv"), dt=1.0), nonlinearity="dead zone")
    assert fit.evidence.gain_over_linear > 50.0
    assert fit.parameters["width"] > 2.0
    assert not fit.chosen.integrating


@pytest.mark.statistics
@pytest.mark.parametrize("known", [True, False])
def test_a_known_integrator_is_kept(known):
    loop = random_loop(16, 0)
    assert loop.process == "integrating"
    fit = lm.identify(loop.u, loop.y, loop.dt, integrating=known, nonlinearity="dead zone")
    assert fit.chosen.integrating is known
    assert fit.settings["integrating"] is known


@pytest.mark.statistics
def test_an_integrator_is_found_with_and_without_orders():
    loop = random_loop(16, 0)
    for orders in ("auto", loop.orders):
        assert lm.identify(loop.u, loop.y, loop.dt, orders=orders, nonlinearity="dead zone").chosen.integrating


@pytest.mark.parametrize(
    "options", [{"integrating": 1.5}, {"integrating": True, "gain": 2.0}, {"integrating": True, "orders": (0, 1, 1)}]
)
def test_what_contradicts_an_integrator_is_refused(options):
    u = lm.signals.prs(300, -5, 5, hold=10, seed=1)
    with pytest.raises(lm.ParameterError, match="expected"):
        lm.identify(u, TANK.simulate(u), 0.1, **options, nonlinearity="dead zone")


def test_simpler_polynomials_keep_pairs_and_the_integrator():
    pair = [0.8 + 0.3j, 0.8 - 0.3j]
    found = simpler(np.real(np.poly([*pair, 0.5]))[1:], integrating=False)
    assert sorted(a.size for a in found) == [1, 2, 3]
    level = simpler(np.real(np.poly([1.0, 0.9, 0.4]))[1:], integrating=True)
    assert sorted(a.size for a in level) == [1, 2, 2, 3]
    assert all(abs(1.0 + a.sum()) < 1e-12 for a in level)


def test_a_pole_next_to_an_integrator_is_tried_as_one():
    found = simpler(np.array([-0.9995]), integrating=False)
    assert [float(a[0]) for a in found] == [-0.9995, -1.0]


@pytest.mark.statistics
def test_a_pole_slower_than_the_record_is_no_process():
    """Drift of PV may be a pole at 1 or noise; with a known gain such a pole makes any slope of it."""
    loop = lm.routine_operation(2000, drift="mild", seed=6)
    record = lm.LoopRecord(loop.command, loop.measured, loop.reference, dt=0.1)
    fit = lm.identify(record, nonlinearity="dead zone", orders=(3, 2, 3), gain=2.2222)
    assert fit.status.ok
    assert np.abs(fit.linear.poles).max() < 1.0 - 1.0 / 2000
    assert fit.parameters["right_slope"] == pytest.approx(3.0, abs=1.0)
    assert (fit.parameters["left"], fit.parameters["right"]) == (pytest.approx(-1, abs=0.1), pytest.approx(1, abs=0.1))
