"""A study is of a loop that does what the record did, or it says nothing."""

import json
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import GateError, ParameterError
from lostmotion.evaluate.study.reproduced import PERIOD, SPREAD, Reproduction, reproduction, require_reproduction
from lostmotion.evaluate.study.scenario import started_in_cycle
from lostmotion.evaluate.study.studied_loop import Known
from lostmotion.evaluate.study.study_plant import StudyPlant, noise_samples
from tests.support.refusals import refusal

LAG = lm.LinearModel([-0.95], [0.05], 3, 1.0)
CONTROLLER = lm.PI(2.0, 0.1, 0.0, 100.0)
NOISE = lm.NoiseModel((), 1e-4)
MOVES = np.repeat([0.0, 1.0, -1.0, 0.5, -0.5], 300)


def loop(valve, reference=MOVES, noise=NOISE, controller=CONTROLLER):
    """Record of a plant around OP 50."""
    plant = StudyPlant(lm.Hammerstein(valve, LAG, -50.0))
    whole = started_in_cycle(reference, 600, 3.0)
    run = plant.run(controller, None, whole, noise_samples(noise, whole.size, 9))
    return plant, lm.LoopRecord(run.command[600:], run.measured[600:], reference, dt=1.0)


@pytest.mark.parametrize("valve", [lm.Backlash(2.0), lm.Stiction(2.0, 1.0), lm.Backlash(0.1)])
def test_the_true_model_reproduces_its_record(valve):
    plant, record = loop(valve)
    found = reproduction(plant, NOISE, CONTROLLER, record, 1.0)
    assert found.closed is None
    assert found.simulated == pytest.approx(found.recorded, rel=0.3)
    assert json.loads(json.dumps(found.to_dict(), allow_nan=False))["spread_agrees"]


def test_a_set_point_that_is_not_known_is_the_mean():
    plant, record = loop(lm.Stiction(2.0, 1.0), np.zeros(1500))
    found = reproduction(plant, NOISE, CONTROLLER, replace(record, sp=None), 1.0)
    assert found.period_agrees
    assert found.recorded_period is not None
    assert found.simulated_period == pytest.approx(found.recorded_period, rel=0.2)
    assert found.spread_agrees


@pytest.mark.parametrize(
    ("valve", "controller", "said"),
    [
        (lm.Stiction(30.0, 30.0), CONTROLLER, "spread"),
        (lm.Backlash(0.0), CONTROLLER, "spread"),
        (lm.Stiction(2.0, 1.0), lm.PI(0.5, 0.005, 0.0, 100.0), "period"),
    ],
)
def test_another_model_or_controller_does_not(valve, controller, said):
    _, record = loop(lm.Stiction(2.0, 1.0), np.zeros(1500))
    plant = StudyPlant(lm.Hammerstein(valve, LAG, -50.0))
    closed = reproduction(plant, NOISE, controller, record, 1.0).closed
    assert closed is not None
    assert f"a {said} of" in closed.got


def test_limits_on_either_side():
    base = Reproduction(1.0, 1.0, 10.0, 10.0)
    assert base.closed is None
    for factor in (SPREAD, 1.0 / SPREAD):
        assert replace(base, simulated=0.99 * factor if factor > 1.0 else 1.01 * factor).spread_agrees
        assert not replace(base, simulated=1.01 * factor if factor > 1.0 else 0.99 * factor).spread_agrees
    assert not replace(base, simulated=np.nan).spread_agrees
    assert not replace(base, simulated_period=1.01 * 10.0 * PERIOD).period_agrees
    assert not replace(base, simulated_period=None).period_agrees
    assert replace(base, recorded_period=None, simulated_period=None).period_agrees


def test_the_gate_and_its_reason():
    plant, record = loop(lm.Stiction(2.0, 1.0), np.zeros(1500))
    wrong = Known(StudyPlant(lm.Hammerstein(lm.Stiction(30.0, 30.0), LAG, -50.0)), NOISE)
    assert require_reproduction(wrong, CONTROLLER, None, 1.0, 0, None) == (wrong, None)
    message = refusal(GateError, require_reproduction, wrong, CONTROLLER, record, 1.0, 0, None)
    assert "reproduces the record" in message
    found, compared = require_reproduction(wrong, CONTROLLER, record, 1.0, 0, "a new packing since")
    assert "a new packing since" in found.accepted
    assert not compared.spread_agrees
    right, compared = require_reproduction(Known(plant, NOISE), CONTROLLER, record, 1.0, 0, "no need")
    assert right.accepted == ""
    assert compared.closed is None


@pytest.mark.statistics
def test_a_study_is_refused_or_keeps_the_reason():
    _, record = loop(lm.Stiction(2.0, 1.0), np.zeros(1500))
    plant = lm.Hammerstein(lm.Stiction(30.0, 30.0), LAG, -50.0)
    given = {"noise": NOISE, "record": record, "runs": 1, "draws": 0, "cycle_samples": 300}
    refusal(GateError, lm.compensation_study, plant, CONTROLLER, **given)
    refusal(ParameterError, lm.compensation_study, plant, CONTROLLER, **given, accept="")
    study = lm.compensation_study(plant, CONTROLLER, **given, accept="a new packing since")
    assert "a new packing since" in study.block.accepted
    assert "ACCEPTED behind a closed gate" in study.summary()
    assert "does NOT reproduce the record" in " ".join(study.summary().split())
    assert study.to_dict()["reproduction"]["spread_agrees"] is False
