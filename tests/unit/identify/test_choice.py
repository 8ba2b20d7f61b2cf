"""Which kind: equal slopes, a limit that looks like a dead zone, and how sure the choice is."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.evaluate import random_faulty_loop
from lostmotion.identify.actuators.fit_kind import fit_kind
from lostmotion.identify.actuators.kind import kind_of
from lostmotion.identify.actuators.slopes import with_equal_slopes
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.scaled import ScaledData

pytestmark = pytest.mark.statistics  # whole fits
PROCESS = lm.LinearModel([-0.8], [0.3], 1, 1.0)


def driven(valve, n=1200, seed=0, deviation=0.05):
    """A command that wanders about zero, and what it does."""
    rng = np.random.default_rng(seed)
    u = np.zeros(n)
    for k in range(1, n):
        u[k] = 0.97 * u[k - 1] + rng.normal(scale=0.5)
    return u, PROCESS.simulate(np.asarray(valve(u))) + rng.normal(scale=deviation, size=n)


def fitted(kind, u, y):
    data, asked = ScaledData(u, y, np.array([[0, u.size]])), Asked((1, 0, 1), 0, integrating=False)
    return fit_kind(kind_of(kind).sought(data, asked), data, asked)


def dead_zone_fit(valve):
    u, y = driven(valve)
    return fitted("dead zone", u, y)


def test_equal_slopes_cost_a_parameter_less():
    free = dead_zone_fit(lm.DeadZone(-0.6, 0.6))
    equal = with_equal_slopes(free)
    ratio = equal.problem.eta_at + 2
    assert equal.fit.theta[ratio] == 0.0
    assert equal.parameters == free.parameters - 1
    assert equal.fit.theta[ratio - 2 : ratio] == pytest.approx([-0.6, 0.6], abs=0.03)


def test_slopes_that_differ_stay_free():
    free = dead_zone_fit(lm.DeadZone(-0.6, 0.6, 1.0, 2.0))
    assert with_equal_slopes(free) is free


def test_other_kinds_have_no_slopes():
    u, y = driven(lm.Backlash(1.0), n=300)
    backlash = fitted("backlash", u, y)
    assert kind_of("backlash").simplest(backlash) is backlash


@pytest.mark.parametrize("limits", [(-9.0, 0.5), (-0.4, 9.0)])
def test_a_dead_zone_that_is_left_on_one_side_only_is_a_limit(limits):
    u, y = driven(lm.Saturation(*limits), seed=1)
    fit = lm.identify(u, y, 1.0, nonlinearity="auto")
    assert fit.kinds.best == "saturation"
    near = fit.parameters["high" if limits[1] < 1.0 else "low"]
    assert near == pytest.approx(min(limits, key=abs), abs=0.05)


def test_backlash_begun_at_a_stiction_without_jump():
    u, y = driven(lm.Backlash(1.0), seed=3)
    stiction = fitted("stiction", u, y)
    backlash = kind_of("stiction").simplified(stiction)
    at = backlash.problem.eta_at
    assert backlash.problem.family.kind == "backlash"
    assert backlash.fit.theta[at] == pytest.approx(1.0, abs=0.03)
    assert backlash.parameters == stiction.parameters - 1


@pytest.mark.statistics
@pytest.mark.parametrize("seed", [357, 400])
def test_stiction_begun_at_a_backlash_whose_jump_the_profile_passes_by(seed):
    loop = random_faulty_loop(seed)
    fit = lm.identify(loop.op, loop.pv, loop.dt, nonlinearity="auto")
    assert loop.cause == fit.kinds.best == "stiction"
    assert fit.parameters["band"] == pytest.approx(loop.actuator.band, rel=0.02)
    assert fit.parameters["jump"] == pytest.approx(loop.actuator.jump, rel=0.05)


def test_the_more_evidence_the_surer():
    confidence = []
    for deviation in (1.0, 0.1):
        u, y = driven(lm.Backlash(1.0), seed=2, deviation=deviation)
        fit = lm.identify(u, y, 1.0, nonlinearity="auto")
        assert fit.kinds.best == "backlash"
        assert fit.kinds.runner_up in fit.kinds.gains
        confidence.append(fit.kinds.confidence)
    assert 0.5 < confidence[0] < confidence[1] <= 1.0
    assert fit.kinds.gains["backlash"] > 100.0  # what was left out is predicted better as well
