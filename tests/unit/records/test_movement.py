import numpy as np
import pytest

from lostmotion.diagnose.audit_class import LEAST_INDEX, SURVEY, AuditClass, audit_class
from lostmotion.diagnose.oscillation import Oscillation
from lostmotion.errors import DataError, ParameterError
from lostmotion.records.movement import reversals_per_hour, share_at_limits, travel_per_hour
from tests.support.refusals import refusal

SWING = Oscillation(40.0, 5.0, 0.9, 20.0)


def test_a_sine_travels_four_amplitudes_and_turns_twice_a_period():
    t = np.arange(3601)
    op = 50 + 5 * np.sin(2 * np.pi * t / 60)
    assert travel_per_hour(op, 1.0) == pytest.approx(60 * 20, rel=0.01)
    assert travel_per_hour(op, 1.0, (40.0, 60.0)) == pytest.approx(5 * 60 * 20, rel=0.01)
    assert reversals_per_hour(op, 1.0) == 120
    assert reversals_per_hour(op, 10.0) == pytest.approx(12)
    noisy = op + 0.1 * np.random.default_rng(0).normal(size=t.size)
    assert reversals_per_hour(noisy, 1.0) > 300
    assert reversals_per_hour(noisy, 1.0, band=1.0) == 120
    assert reversals_per_hour(op, 1.0, band=11.0) == 0


def test_share_at_limits():
    assert share_at_limits([0.0, 100.0, 50.0, 105.0]) == 0.75
    assert share_at_limits([4.0, 20.0, 12.0, 12.0], (4.0, 20.0)) == 0.5
    assert share_at_limits([1.0, 50.0], tolerance=0.02) == 0.5


def test_movement_refusals():
    refusal(ParameterError, travel_per_hour, [0.0, 1.0], 0.0)
    refusal(ParameterError, travel_per_hour, [0.0, 1.0], 1.0, (5.0, 5.0))
    refusal(DataError, travel_per_hour, [0.0], 1.0)
    refusal(DataError, reversals_per_hour, [0.0], 1.0)
    refusal(ParameterError, reversals_per_hour, [0.0, 1.0], 1.0, -1.0)
    refusal(ParameterError, share_at_limits, [0.0], (1.0, 0.0))
    refusal(ParameterError, share_at_limits, [0.0], tolerance=-0.1)
    refusal(DataError, share_at_limits, [])


@pytest.mark.parametrize("loop_type", sorted(LEAST_INDEX))
def test_a_better_index_never_gives_a_worse_class(loop_type):
    order = list(AuditClass)
    places = [order.index(audit_class(index, loop_type)) for index in np.linspace(0, 1, 101)]
    assert places == sorted(places, reverse=True)
    assert (places[0], places[-1]) == (3, 0)
    for least, expected in zip(LEAST_INDEX[loop_type], order, strict=False):
        assert audit_class(least, loop_type) == expected


def test_an_oscillation_costs_one_class_and_manual_all():
    assert audit_class(0.9, "flow", SWING) == "acceptable"
    assert audit_class(0.0, "flow", SWING) == "poor"
    assert audit_class(0.9, "flow", Oscillation(40.0, 0.8, 0.9, 20.0)) == "excellent"
    assert audit_class(0.9, "flow", Oscillation(40.0, 5.0, 0.3, 20.0)) == "excellent"
    assert audit_class(0.9, open_share=0.31) == "open loop"
    assert audit_class(0.9, open_share=0.3) == "excellent"


def test_the_survey_as_the_paper_cites_it():
    assert sum(SURVEY.values()) == pytest.approx(1.0)
    assert SURVEY[AuditClass.EXCELLENT] + SURVEY[AuditClass.ACCEPTABLE] == pytest.approx(0.32)


def test_audit_refusals():
    refusal(ParameterError, audit_class, 1.1)
    refusal(ParameterError, audit_class, 0.5, "speed")
    refusal(ParameterError, audit_class, 0.5, open_share=-0.1)
    refusal(ParameterError, audit_class, float("nan"))
