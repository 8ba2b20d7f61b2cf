"""What one-step predictions forgive and a simulation from OP does not."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import Status
from tests.support.places import SHARED

WHEELS = SHARED / "actuators" / "wheels"


def wheel(number, every):
    path = WHEELS / f"wheel{number}.csv"
    if not path.exists():
        pytest.skip(f"no {path.name} in ../shared/actuators")
    table = np.genfromtxt(path, delimiter=",", skip_header=1)[::every]
    return table[:, 1], table[:, 2], 0.002 * every


@pytest.mark.parametrize(
    ("number", "every"),
    [
        (4, 10),
        *(
            pytest.param(n, k, marks=pytest.mark.long)
            for n in (1, 2, 3, 4)
            for k in (1, 10, 50, 100)
            if (n, k) != (4, 10)
        ),
    ],
)
def test_real_motors_have_a_dead_zone_at_any_sampling_rate(number, every):
    """Still to 8.8 to 9 %, then lines that reach zero at 12.0 to 12.5 % from each other."""
    fit = lm.identify(*wheel(number, every))
    assert fit.preferred == "dead zone"
    low, high = fit.size_interval
    assert 9.7 < fit.parameters["width"] < 13.5
    assert low < 12.5
    assert high > 11.0
    assert fit.fit_percent > 92.5


def test_a_kind_that_was_asked_for_is_told_which_one_simulates_better():
    fit = lm.identify(*wheel(4, 10), nonlinearity="backlash")
    assert fit.status is Status.OTHER_KIND
    assert fit.preferred == "dead zone"


def test_a_model_that_is_right_is_left_alone():
    tank = lm.platforms.level_tank()
    u = lm.signals.prs(3000, -5, 5, hold=10, seed=1)
    y = tank.simulate(u) + np.random.default_rng(1).normal(scale=0.17, size=3000)
    fit = lm.identify(u, y, dt=0.1)
    assert fit.evidence.by_prediction is None
    assert fit.status is Status.OK


def test_a_few_steps_deny_no_lost_motion():
    """As of a servo of which 17 of 200 ticks are play: it takes a reversed load to see it."""
    op = np.repeat([0.0, 100.0, 0.0, -100.0, 0.0, 100.0], 60)
    pv = np.zeros(op.size)
    for k in range(1, op.size):
        pv[k] = 0.7 * pv[k - 1] + 0.3 * op[k - 1]
    fit = lm.identify(op, pv + np.random.default_rng(2).normal(size=op.size), 0.1)
    assert fit.status is Status.CANNOT_TELL
    assert fit.preferred == "cannot tell"
