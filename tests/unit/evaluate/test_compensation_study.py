"""Evaluate before download: bars on the level tank, what is said, and what is refused."""

import json

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import DataError, ParameterError
from lostmotion.evaluate.study import retuning
from lostmotion.evaluate.study.mistakes import GROUPS, mistakes
from lostmotion.evaluate.study.studied_loop import Known, known
from lostmotion.evaluate.study.study_plant import StudyPlant, noise_samples
from tests.support.figure_texts import assert_readable
from tests.support.refusals import refusal

TANK = lm.platforms.level_tank()
LEVEL = lm.LinearModel.from_continuous([0.05], [1.0, 1.0, 0.0], 0.2, 0.1)
LAG = lm.LinearModel([-0.95], [0.05], 3, 1.0)
SMALL = {"samples": 150, "runs": 2, "cycle_samples": 300, "draws": 2}
SPAN = (-50.0, 50.0)


def tank_fit(n=2000, seed=3, gain=2.2222):
    loop = lm.routine_operation(n, drift="mild", seed=seed)
    record = lm.LoopRecord(loop.command, loop.measured, loop.reference, dt=0.1, op_span=SPAN, tag="LIC-7")
    return lm.identify(record, orders=(3, 2, 3), gain=gain, nonlinearity="dead zone"), record


@pytest.fixture(scope="module")
def gear():
    """Small study of a backlash given by numbers."""
    return lm.compensation_study(
        lm.Hammerstein(lm.Backlash(2.0), LAG), lm.PI(2.0, 0.1), noise=1e-4, op_now=50.0, **SMALL
    )


@pytest.mark.statistics
@pytest.mark.parametrize("seed", [3, 21])
def test_level_tank_within_two_errors_and_twenty_percent_no_larger_cycle(seed):
    fit, record = tank_fit(seed=seed)
    study = lm.compensation_study(fit, record=record, runs=6, draws=12)
    assert {case.group for case in study.mistakes} == set(GROUPS)
    assert not any(case.larger_cycle for case in study.mistakes)
    assert study.safe
    assert study.recommendation == "compensate"
    assert study.controller.kp == pytest.approx(0.5)
    assert study.controller.ki == pytest.approx(0.7)
    assert study.cases["with"].ratio < 0.8


@pytest.mark.statistics
@pytest.mark.parametrize("size", [1.0, 2.0])
def test_level_tank_with_a_known_dead_zone_is_as_good_as_without_one(size):
    study = lm.compensation_study(
        TANK, lm.PI(0.5, 0.7), noise=0.03, sp_step=size, span=SPAN, runs=30, samples=4000, draws=0
    )
    assert 0.97 < study.cases["with"].iae / study.cases["no fault"].iae < 1.01
    assert study.safe


@pytest.mark.statistics
def test_a_loop_that_only_the_dead_zone_keeps_stable_is_told():
    """Slopes of 3 in the gain of the loop: these settings are stable only as long as the valve loses motion."""
    fit, record = tank_fit(gain=None)
    study = lm.compensation_study(fit, record=record, runs=3, draws=4)
    assert not study.safe
    assert study.recommendation == "compensate and retune"
    assert any("unstable with the present controller" in text for text in study.reasons)
    assert not any(case.larger_cycle for case in study.mistakes_retuned)
    assert study.cases["with, retuned"].ratio < 0.8


@pytest.mark.statistics
def test_a_relay_made_by_a_bold_block_is_reported_beforehand():
    """Twice the width and no guard: the block is a relay, and the study says so."""
    fit, record = tank_fit()
    study = lm.compensation_study(fit, record=record, runs=2, draws=0, factor=2.0, hunt_scans=0.0, zone=0.01)
    assert not study.safe
    assert any(case.larger_cycle for case in study.mistakes)
    assert any("SHOULD THE ESTIMATE BE WRONG" in text for text in study.reasons)


@pytest.mark.statistics
def test_prediction_of_what_is_left_behind_the_block():
    study = lm.compensation_study(
        lm.Hammerstein(lm.Backlash(2.0), LEVEL), lm.PI(4.0, 0.2), noise=4e-4, op_now=50.0, runs=2, draws=0
    )
    for name in ("without", "with"):
        case = study.cases[name]
        assert case.predicted.amplitude == pytest.approx(case.cycle.amplitude, rel=0.1)
    assert study.cases["with"].cycle.amplitude < study.cases["without"].cycle.amplitude / 3
    assert study.recommendation == "compensate"


@pytest.mark.statistics
def test_nothing_is_worth_it_where_the_fault_is_small():
    plant = lm.Hammerstein(lm.Backlash(0.01), LAG)
    study = lm.compensation_study(plant, lm.PI(2.0, 0.1), noise=0.01, op_now=50.0, sp_step=2.0, draws=0, runs=4)
    assert study.recommendation in ("leave", "retune")
    assert study.cases["no fault"].ratio == pytest.approx(1.0, abs=0.03)


def test_result_is_frozen_prints_and_writes_itself(gear):
    data = json.loads(json.dumps(gear.to_dict(), allow_nan=False))
    assert data["recommendation"] == gear.recommendation
    assert set(data["cases"]) == {"without", "with", "retuned", "with, retuned", "no fault"}
    assert lm.CompensatorBlock.from_dict(data["block"]) == gear.block
    assert gear.reasons[0] in gear.summary()
    assert "given by numbers" in str(gear)
    with pytest.raises(AttributeError):
        gear.safe = True
    figure = gear.plot()
    assert len(figure.axes) >= 6
    assert_readable(figure)


@pytest.mark.statistics
def test_dictionary_of_a_fit_gives_the_same_study():
    u = lm.signals.prs(400, 44.0, 56.0, 8, seed=1)
    model = lm.Hammerstein(lm.DeadZone(49.0, 51.0), LAG, 20.0)
    y = model.simulate(u) + np.random.default_rng(0).normal(scale=0.02, size=400)
    fit = lm.identify(u[50:], y[50:], dt=1.0, orders=(1, 0, 3), noise="white", nonlinearity="dead zone")
    one, other = (
        lm.compensation_study(saved, lm.PI(2.0, 0.1), sp_step=1.0, **SMALL)
        for saved in (fit, json.loads(json.dumps(fit.to_dict())))
    )
    assert one.block.settings == pytest.approx(other.block.settings)
    assert one.cases["with"].iae == pytest.approx(other.cases["with"].iae)


def test_plants_stay_at_rest_without_noise():
    for plant, level in (
        (StudyPlant(lm.Hammerstein(lm.Backlash(2.0), LAG, -50.0)), 3.0),
        (StudyPlant(lm.Hammerstein(lm.DeadZone(40.0, 45.0, 2.0, 1.0), LAG, 7.0)), 9.0),
        (StudyPlant(lm.Hammerstein(lm.Stiction(2.0, 1.0), LEVEL), -50.0), 3.0),
    ):
        reference = np.full(60, level)
        loop = plant.run(lm.PI(2.0, 0.1, 0.0, 100.0), None, reference, np.zeros(60))
        np.testing.assert_allclose(loop.output, level, atol=1e-9)
        np.testing.assert_allclose(loop.command, plant.rest(level)[0], atol=1e-9)


def test_noise_has_its_variance():
    v = noise_samples(lm.NoiseModel((-0.9,), 0.19), 20_000, 1)
    assert np.var(v) == pytest.approx(1.0, rel=0.15)
    refusal(ParameterError, noise_samples, lm.NoiseModel((-1.03,), 1.0), 10, 0)


@pytest.mark.parametrize("root", [1.0, 1.0003, 1.01])
def test_a_drift_that_was_fitted_as_a_random_walk_can_be_studied(root):
    """It forgets within a record; the loop sees nothing of so slow a change."""
    walk = noise_samples(lm.NoiseModel((-root - 0.5, 0.5 * root), 1.0), 2000, 1)
    near = noise_samples(lm.NoiseModel((-0.9998 - 0.5, 0.5 * 0.9998), 1.0), 2000, 1)
    np.testing.assert_allclose(np.diff(walk), np.diff(near), atol=1e-6)


def test_plants_that_the_estimate_may_be_wrong_about():
    covariance = np.diag([0.01, 0.04])
    plant = StudyPlant(lm.Hammerstein(lm.DeadZone(-1.0, 1.0), LAG))
    found = mistakes(Known(plant, lm.NoiseModel(), {"left": -1.0, "right": 1.0}, covariance), 4, 0)
    corners = sorted((p.valve.left, p.valve.right) for group, _, p in found if group == GROUPS[0])
    np.testing.assert_allclose(corners, [(-1.2, 0.6), (-1.2, 1.4), (-0.8, 0.6), (-0.8, 1.4)])
    widths = [p.valve.width for group, what, p in found if group == GROUPS[1] and what.startswith("width")]
    np.testing.assert_allclose(widths, [2.0 / 1.2, 2.0 / 0.8])
    assert sum(group == "drawn" for group, _, _ in found) == 4


@pytest.mark.parametrize(
    ("kind", "arguments", "said"),
    [
        (ParameterError, {"noise": 0.0}, "controller"),
        (ParameterError, {"controller": lm.PI(1, 1)}, "noise"),
        (ParameterError, {"controller": lm.PI(1, 1), "noise": 0.0, "span": (5, 1)}, "span"),
        (ParameterError, {"controller": lm.PI(1, 1), "noise": 0.0, "op_now": 500.0}, "holds OP"),
    ],
)
def test_refusals(kind, arguments, said):
    plant = lm.Hammerstein(lm.Backlash(1.0), LAG)
    assert said in refusal(kind, lm.compensation_study, plant, **arguments)


@pytest.mark.parametrize(
    ("kp", "ki", "alike"),
    [
        (1.0, 0.1, True),
        (0.11, 0.011, True),
        (9.0, 0.9, True),
        (0.09, 0.1, False),
        (1.0, 0.009, False),
        (11.0, 0.1, False),
    ],
)
def test_a_controller_that_is_switched_off_is_not_a_retuned_one(kp, ki, alike):
    assert retuning._like(lm.PI(kp, ki), lm.PI(1.0, 0.1)) is alike
    assert retuning._like(lm.PI(-kp, ki), lm.PI(-1.0, 0.0)) is (0.1 <= kp <= 10.0)


def test_refuses_other_faults_and_other_data():
    limit = lm.Hammerstein(lm.Saturation(0.0, 1.0), LAG)
    assert "dead zone" in refusal(ParameterError, known, limit, 0.0)
    assert "fit" in refusal(DataError, known, {"a": 1}, None)
    block = lm.block_from_model(lm.Backlash(1.0), 0.5)
    plant = lm.Hammerstein(lm.Backlash(1.0), LAG)
    message = refusal(
        ParameterError, lm.compensation_study, plant, lm.PI(1, 1), noise=0.0, block=block, op_now=50.0, **SMALL
    )
    assert "scan_time" in message


def test_a_record_whose_op_no_pi_explains_is_refused():
    random = np.random.default_rng(0)
    record = lm.LoopRecord(random.normal(size=300).cumsum() + 50, random.normal(size=300), dt=1.0)
    plant = lm.Hammerstein(lm.Backlash(1.0), LAG)
    assert "kp and ki" in refusal(DataError, lm.compensation_study, plant, None, noise=0.0, record=record)
