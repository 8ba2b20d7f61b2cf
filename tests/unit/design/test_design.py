"""The test design: limits are kept, figures are the Cramer-Rao bound, a PRS is beaten, requests are checked."""

import json

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.design.coarse import coarser_linear, coarser_noise
from lostmotion.design.design_criterion import Z95
from lostmotion.design.plausible_plants import drawn_around_guess
from lostmotion.design.staircase import Staircase
from lostmotion.errors import DataError, ParameterError
from lostmotion.evaluate import cramer_rao
from tests.support.figure_texts import assert_readable
from tests.support.refusals import refusal

pytestmark = pytest.mark.statistics  # hundreds of likelihoods each, and no kernel of its own
TANK = lm.platforms.level_tank()
LAG = lm.LinearModel.from_continuous([1.5], [30.0, 1.0], 4.0, 1.0)
SLOW = lm.Hammerstein(lm.DeadZone(48.0, 52.0), LAG, offset=30.0)
QUICK = {"op_limits": (-5.0, 5.0), "shortest_hold": 1.0, "duration": 15.0, "effort": 0.01}
PI = lm.PI(0.5, 0.02)


def made(**changes):
    return lm.design(TANK, 0.03, **{**QUICK, **changes})


def holds(test):
    """Samples between moves, the last until the end."""
    return np.diff([*(round(start / test.dt) for start, _ in test.steps), len(test.signal)])


# A staircase and its clock


def test_staircase_with_ramps():
    stairs = Staircase(np.array([2.0, 2.0, -1.0]), np.array([3, 2, 4]))
    np.testing.assert_array_equal(stairs.signal(0.0), [2, 2, 2, 2, 2, -1, -1, -1, -1])
    np.testing.assert_array_equal(stairs.signal(0.0, 1.0), [1, 2, 2, 2, 2, 1, 0, -1, -1])
    np.testing.assert_array_equal(stairs.ramps(0.0, 1.0), [1, 0, 2])
    assert stairs.merged().lengths.tolist() == [5, 4]


@pytest.mark.parametrize(
    ("samples", "lengths"),
    [(2, [3]), (3, [3]), (4, [3, 2]), (6, [3, 2, 3]), (8, [3, 2, 3]), (9, [3, 2, 4]), (50, [3, 2, 4])]
)  # fmt: skip
def test_cut_staircase_ends_with_a_whole_hold(samples, lengths):
    assert Staircase(np.array([2.0, 0.0, -1.0]), np.array([3, 2, 4])).until(samples, 3).lengths.tolist() == lengths


@pytest.mark.parametrize("factor", [2, 3, 7])
def test_slower_clock_gives_the_same_samples(factor):
    u = np.repeat(np.random.default_rng(factor).uniform(-1, 1, 30), factor)
    for linear in (TANK.linear, LAG):
        slow = coarser_linear(linear, factor).simulate(u[::factor])
        np.testing.assert_allclose(slow, linear.simulate(u)[::factor], atol=1e-9)


def test_slower_clock_averages_the_noise():
    assert coarser_noise(lm.NoiseModel((), 0.6), 3).variance == pytest.approx(0.2)
    d, factor = -0.9, 4
    series = np.zeros(400_000)
    white = np.random.default_rng(0).normal(size=series.size)
    for k in range(1, series.size):
        series[k] = -d * series[k - 1] + white[k]
    means = series.reshape(-1, factor).mean(axis=1)
    coarse = coarser_noise(lm.NoiseModel((d,), 1.0), factor)
    lag1 = np.dot(means[1:], means[:-1]) / np.dot(means, means)
    assert -coarse.d[0] == pytest.approx(lag1, abs=0.01)
    assert coarse.variance / (1.0 - coarse.d[0] ** 2) == pytest.approx(means.var(), rel=0.05)


# What the operator allows is kept


def test_levels_holds_and_length():
    test = made()
    assert len(test.signal) == 150
    assert test.signal.min() >= -5.0
    assert test.signal.max() <= 5.0
    assert holds(test).min() >= 10
    np.testing.assert_array_equal(np.repeat([level for _, level in test.steps], holds(test)), test.signal)


def test_rate_limit():
    test = made(rate_limit=10.0)
    assert np.abs(np.diff(test.signal, prepend=test.op_now)).max() <= 1.0 + 1e-12
    assert (np.diff(test.signal) != 0).any()


@pytest.mark.statistics
@pytest.mark.parametrize("loop", ["open", "closed"])
def test_pv_limits_are_kept_on_plants_that_the_design_has_not_seen(loop):
    common = {"op_limits": (40.0, 60.0), "shortest_hold": 20.0, "duration": 900.0, "pv_limits": (24.0, 36.0)}
    more = {} if loop == "open" else {"loop": "closed", "controller": PI, "sp_limits": (27.0, 33.0)}
    test = lm.design(SLOW, 0.04, **common, **more, effort=0.3)
    assert test.reached
    beyond = []
    for seed, plant in enumerate(drawn_around_guess(SLOW, 40, 99)):
        seen = test.simulate(seed, plant)
        beyond.append(max(seen.pv.max() - 36.0, 24.0 - seen.pv.min()))
        if loop == "closed":
            assert seen.op.min() >= 38.0
            assert seen.op.max() <= 62.0
    # three deviations of the noise (0.6) are kept free: a few of 36,000 samples may pass by a little
    assert np.median(beyond) <= 0.0
    assert max(beyond) < 0.4


def test_same_seed_same_test():
    first, again, other = made(seed=3), made(seed=3), made(seed=4)
    np.testing.assert_array_equal(first.signal, again.signal)
    assert first.to_dict() == again.to_dict()
    assert not np.array_equal(first.signal, other.signal)


# What is promised


def test_expected_is_the_cramer_rao_bound():
    test = made(op_now=0.0)
    bound = cramer_rao(TANK, test.signal, 0.03)
    for name in ("left", "right", "width"):
        assert test.expected[name] == pytest.approx(Z95 * bound[name], rel=1e-5)
    answer = lm.achievable(test.signal, TANK, 0.03)
    assert answer.expected["width"] == pytest.approx(Z95 * bound["width"], rel=1e-5)
    assert answer.sees


@pytest.mark.sampled(4)
@pytest.mark.parametrize("target", ["width", "break points"])
@pytest.mark.parametrize(
    ("plant", "noise", "limits", "hold", "duration"),
    [
        (TANK, 0.03, (-5.0, 5.0), 1.0, 200.0),
        (TANK, 0.03, (-5.0, 5.0), 1.0, 60.0),
        (SLOW, 0.04, (40.0, 60.0), 20.0, 1200.0),
        (lm.Hammerstein(lm.DeadZone(2.0, 4.3, 4.0, 1.0), TANK.linear, 12.0), 0.03, (-2.0, 9.0), 1.0, 100.0),
    ],
)
@pytest.mark.statistics
def test_narrower_than_a_prs(plant, noise, limits, hold, duration, target):
    test = lm.design(plant, noise, op_limits=limits, shortest_hold=hold, duration=duration, target=target, effort=0.5)
    assert test.gain_over_prs > 1.5
    assert test.gain_over_best_prs > 1.2


@pytest.mark.statistics
def test_simulation_confirms_that_it_is_narrower():
    test = lm.design(TANK, 0.03, op_limits=(-5, 5), shortest_hold=1.0, duration=60.0)
    own, rival = [], []
    for seed, plant in enumerate(drawn_around_guess(TANK, 16, 5)):
        prs = lm.signals.prs(600, -5, 5, hold=10, seed=seed)
        noise = np.random.default_rng(seed).normal(scale=0.03**0.5, size=600)
        for found, record in ((own, test.simulate(seed, plant)), (rival, (prs, plant.simulate(prs) + noise, 0.1))):
            given = record if isinstance(record, tuple) else (record,)
            fit = lm.identify(*given, orders=(3, 2, 3), nonlinearity="dead zone")
            low, high = fit.interval("width")
            found.append((fit.parameters["width"] - plant.nonlinearity.width, 0.5 * (high - low)))
    (error, half), (rival_error, rival_half) = np.array(own).T, np.array(rival).T
    assert rival_half.mean() > 1.5 * half.mean()
    assert np.sqrt(np.mean(rival_error**2)) > 1.5 * np.sqrt(np.mean(error**2))
    assert np.mean(np.abs(error) <= half) >= 0.75  # 16 records, 95 % nominal
    assert half.mean() == pytest.approx(test.expected_typical["width"], rel=0.3)


@pytest.mark.statistics
def test_shortest_test_for_a_wanted_interval():
    def wanted(half_width):
        return lm.design(SLOW, 0.04, op_limits=(40, 60), shortest_hold=20.0, wanted={"width": half_width}, effort=0.3)

    rough, fine = wanted(0.1), wanted(0.04)
    for test, goal in ((rough, 0.1), (fine, 0.04)):
        assert test.reached
        assert test.advice == ()
        assert test.expected["width"] <= goal
        assert test.reached_by >= 0.8
        assert holds(test).min() >= 20
    assert 1.5 < fine.duration / rough.duration < 8.0  # 6.25 by the square law; a short test spends more on finding out


@pytest.mark.statistics
def test_out_of_reach_says_what_to_relax():
    test = made(wanted={"left": 0.02, "right": 0.02}, op_limits=(-2, 2), effort=0.3)
    assert not test.reached
    assert any("it would take about" in sentence for sentence in test.advice)
    assert any("OP limits" in sentence for sentence in test.advice)
    assert "NOT REACHED" in test.summary()


def test_range_inside_the_dead_zone_tells_nothing():
    test = made(op_limits=(-0.5, 0.5))
    assert not test.reached
    assert np.isinf(test.expected["width"])
    assert test.to_dict()["expected_95"]["width"] is None
    assert "NOT POSSIBLE" in test.summary()


def test_integrating_process_in_open_loop_starts_where_its_load_is():
    level = lm.Hammerstein(lm.DeadZone(48.0, 52.0), lm.LinearModel((-1.0,), (0.01,), 2, 1.0), offset=50.0)
    test = lm.design(
        level, 0.01, op_limits=(40, 60), pv_limits=(40, 60), shortest_hold=10.0, duration=150.0, effort=0.01
    )
    assert test.op_now == 50.0
    assert test.prediction.pv.min() > 40.0
    assert test.prediction.pv.max() < 60.0
    assert "gain" not in test.expected


# From a fit


@pytest.mark.statistics
def test_from_a_fit_and_from_its_json():
    u = lm.signals.prs(1500, -5, 5, hold=10, seed=0)
    fit = lm.identify(
        u,
        TANK.simulate(u) + np.random.default_rng(1).normal(scale=0.2, size=1500),
        0.1,
        orders=(3, 2, 3),
        nonlinearity="dead zone",
    )
    read = json.loads(json.dumps(fit.to_dict(), allow_nan=False))
    one, two = lm.design(fit, **QUICK), lm.design(read, **QUICK)
    np.testing.assert_array_equal(one.signal, two.signal)
    assert one.settings["roughness"] == "drawn from the covariance of the fit"
    assert one.expected_worst["width"] < made().expected_worst["width"]
    refusal(ParameterError, lm.design, fit, 0.03, **QUICK)


@pytest.mark.statistics
def test_a_fit_without_dead_zone_is_refused():
    u = lm.signals.prs(1500, -5, 5, hold=10, seed=0)
    noise = np.random.default_rng(1).normal(scale=0.2, size=1500)
    fit = lm.identify(u, TANK.linear.simulate(u) + noise, 0.1, orders=(3, 2, 3), nonlinearity="dead zone")
    assert "dead zone" in refusal(DataError, lm.design, fit, **QUICK)


# What it hands over


def test_columns_and_json():
    test = made()
    assert list(test.columns()) == ["time_s", "OP"]
    np.testing.assert_array_equal(test.columns()["OP"], test.signal)
    steps = test.columns(every_sample=False)
    assert steps["time_s"].tolist() == [start for start, _ in test.steps]
    data = json.loads(json.dumps(test.to_dict(), allow_nan=False))
    assert data["samples"] == 150
    assert data["gain_over_prs"] == pytest.approx(test.gain_over_prs)
    assert str(test) == test.summary()
    assert max(len(line) for line in str(test).splitlines()) <= 96


def test_closed_loop_moves_the_set_point():
    test = lm.design(
        SLOW, 0.04, loop="closed", controller=PI, sp_limits=(27, 33), shortest_hold=20.0, duration=250.0, effort=0.005
    )
    assert list(test.columns()) == ["time_s", "SP"]
    assert test.signal.min() >= 27.0
    assert test.signal.max() <= 33.0
    record = test.simulate(1)
    np.testing.assert_array_equal(record.sp, test.signal)
    assert not np.array_equal(record.op, test.simulate(2).op)


def test_progress_is_told():
    lines = []
    made(progress=lines.append)
    assert lines == ["searching", "working out what it tells"]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"op_limits": None}, "op_limits"),
        ({"op_limits": (5.0, -5.0)}, "low < high"),
        ({"op_limits": (-np.inf, 5.0)}, "finite op_limits"),
        ({"op_limits": "wide"}, "op_limits"),
        ({"op_now": 7.0}, "op_now inside op_limits"),
        ({"pv_limits": (1.0, 2.0)}, "pv_limits that hold PV at rest"),
        ({"duration": None}, "duration"),
        ({"duration": 5.0}, "duration of at least 12 s"),
        ({"shortest_hold": 0.0}, "shortest_hold"),
        ({"rate_limit": -1.0}, "rate_limit"),
        ({"wanted": {"slope": 0.1}}, "wanted"),
        ({"wanted": {"width": 0.0}}, "wanted width"),
        ({"target": "gain"}, "target"),
        ({"loop": "half"}, "loop"),
        ({"loop": "closed"}, "a controller and sp_limits"),
        ({"controller": PI}, "no controller"),
        ({"spread": 1.5}, "spread"),
        ({"effort": 0.0}, "effort"),
        ({"seed": -1}, "seed"),
    ],
)
def test_bad_requests(changes, said):
    assert said in refusal(ParameterError, made, **changes)


def test_bad_models():
    assert "noise" in refusal(ParameterError, lm.design, TANK, **QUICK)
    assert "noise variance" in refusal(ParameterError, lm.design, TANK, 0.0, **QUICK)
    assert "stationary" in refusal(ParameterError, lm.design, TANK, lm.NoiseModel((-1.0,), 1.0), **QUICK)
    nothing = lm.Hammerstein(lm.Identity(), TANK.linear)
    assert "DeadZone" in refusal(ParameterError, lm.design, nothing, 0.03, **QUICK)
    closed = lm.Hammerstein(lm.DeadZone(0.0, 0.0), TANK.linear)
    assert "width" in refusal(ParameterError, lm.design, closed, 0.03, **QUICK)


# What data at hand can give


def test_achievable_of_pieces_of_a_record():
    u = lm.signals.prs(900, -5, 5, hold=10, seed=0)
    y = TANK.simulate(u)
    whole = lm.achievable(lm.LoopRecord(u, y, dt=0.1), TANK, 0.03)
    gap = y.copy()
    gap[400:450] = np.nan
    pieces = lm.achievable(lm.LoopRecord(u, gap, dt=0.1), TANK, 0.03)
    assert whole.samples == 900
    assert pieces.settings["pieces"] == 2
    assert whole.expected["width"] < pieces.expected["width"] < 1.5 * whole.expected["width"]
    assert whole.samples_for(whole.expected["width"] / 2.0) == pytest.approx(3600.0)
    assert whole.expected_best["width"] <= whole.expected_worst["width"]


def test_one_sided_data_cannot_tell_the_width():
    u = np.abs(lm.signals.prs(900, -5, 5, hold=10, seed=0))
    answer = lm.achievable(u, TANK, 0.03)
    assert not answer.sees
    assert answer.beyond[0] == 0
    assert "never beyond the left break point" in answer.sentence
    assert answer.to_dict()["expected_95"]["width"] is None
    assert "cannot be told from none" in answer.summary()


def test_achievable_refuses_what_it_cannot_use():
    u = np.zeros(500)
    assert "dt" in refusal(ParameterError, lm.achievable, lm.LoopRecord(u, u, dt=0.2), TANK, 0.03)
    assert "without a gap" in refusal(DataError, lm.achievable, u[:10], TANK, 0.03)


def test_texts_of_its_figure_do_not_overlap():
    pytest.importorskip("matplotlib")
    for test in (made(), made(wanted={"width": 1e-6})):
        assert_readable(test.plot())
