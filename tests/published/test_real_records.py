"""Real industrial records with known truth (../shared/data, cited in its README)."""

import numpy as np
import pytest

import lostmotion as lm
from tests.support.shared_data import shared

pytestmark = pytest.mark.statistics


def test_pap4_dead_zone_preferred_by_a_wide_margin():
    """ISDB PAP4: its contributor names a dead zone (Jelali and Huang, Springer 2010)."""
    fit = lm.identify(lm.read_loop(shared("isdb26/PAP4.csv"), dt=1.0), nonlinearity="dead zone")
    assert fit.preferred == "dead zone"
    assert fit.evidence.gain_over_linear > 100
    low, high = fit.interval("width")
    assert 0 < low < high < np.ptp(fit.data.u)
    assert "Assumed" in fit.summary()


def test_dc_motor_break_points_and_reported_misfit():
    """Still at +-2 V, moving at +-4 V, extrapolation +1.7 / -1.2 V; jump at break-away."""
    fit = lm.identify(lm.read_loop(shared("dcmotor/run_minimal.csv"), op="voltage", pv="rpm"), nonlinearity="dead zone")
    assert 1.2 <= fit.parameters["right"] <= 4.0
    assert -4.0 <= fit.parameters["left"] <= -1.2
    assert abs(fit.parameters["left"]) < fit.parameters["right"]  # it breaks away earlier backwards
    assert fit.linear.gain > 0
    assert fit.status is lm.Status.MISFIT


def test_healthy_positioner_is_not_accused():
    """DAMADICS: no dead band above 2 % of travel."""
    record = lm.read_loop(
        shared("damadics/lublin_actuator3_2001-10-11_1h.csv"), op="LC74_20CV_pct", pv="LC74_20X_pct", sp=None
    )
    fit = lm.identify(record, nonlinearity="dead zone")
    assert fit.preferred == "none" or fit.parameters["width"] < 2.0
    assert fit.interval("width")[0] == 0.0
