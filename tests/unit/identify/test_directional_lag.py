"""A process that is faster in one direction is no fault, and does not move the dead zone in front of it."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identify.facts import FitFacts

ROWS, DT = 2000, 0.1
ZONE = (-5.0, 9.0)


def record(ratio, seed, zone=(0.0, 0.0), by_speed=False, time_constant=0.8):
    """Levels held for some time, and a lag in fine steps that is `ratio` times as fast in one direction."""
    rng = np.random.default_rng(seed)
    op = np.repeat(rng.uniform(-60.0, 60.0, ROWS // 40), 40)
    x = np.where(op > zone[1], op - zone[1], np.where(op < zone[0], op - zone[0], 0.0))
    pv, z, root = np.empty(ROWS), 0.0, np.sqrt(ratio)
    for k in range(ROWS):
        pv[k] = z
        for _ in range(10):
            d = x[k] - z
            fast = d * z > 0.0 if by_speed else d > 0.0
            z += 0.1 * DT / (time_constant / root if fast else time_constant * root) * d
    return op, pv + 0.6 * rng.normal(size=ROWS)


@pytest.mark.parametrize("by_speed", [False, True])
def test_a_healthy_one_is_not_accused(by_speed):
    fit = lm.identify(*record(2.0, 3, by_speed=by_speed), DT)
    assert fit.preferred == "none"
    assert fit.nuisances == ("direction-dependent lag",)
    up, outward = fit.chosen.asymmetry
    assert [up, outward] == pytest.approx([0.0, 1.0 / 3.0] if by_speed else [1.0 / 3.0, 0.0], abs=0.05)
    assert any("times as fast" in remark for remark in fit.remarks)
    assert FitFacts.from_dict(fit.to_dict()).nuisances == fit.nuisances


@pytest.mark.statistics
@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(2, 8))
@pytest.mark.parametrize("by_speed", [False, True])
def test_a_dead_zone_stays_where_it_is(seed, by_speed):
    fit = lm.identify(*record(1.5, seed, ZONE, by_speed), DT)
    assert fit.preferred == "dead zone"
    for name, place in zip(("left", "right"), ZONE, strict=True):
        low, high = fit.interval(name, 0.999)
        assert low <= place <= high
        assert high - low < 1.0


def test_a_linear_process_needs_none():
    assert lm.identify(*record(1.0, 5, ZONE), DT).nuisances == ()
