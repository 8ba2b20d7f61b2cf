"""A lag in front of the lost motion: the size behind it, its interval, and the sizes that it leaves open."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lostmotion as lm
from lostmotion.identify.actuators import excluded
from lostmotion.identify.actuators.actuator_lag import (
    NO_LAG,
    PRICE,
    SLOWEST,
    Lag,
    gain_by_lag,
    lagged,
    op_noise,
    rise_behind,
)
from lostmotion.identify.actuators.excluded import largest_sizes
from lostmotion.identify.actuators.fit_kind import fit_linear
from lostmotion.identify.actuators.lagged_backlash import LaggedBacklash
from lostmotion.identify.data import collect
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.family import LinearFamily
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem, Structure
from lostmotion.identify.likelihood.refinement import LocalFit
from lostmotion.identify.scaled import ScaledData, Scaling
from tests.naive.backlash import backlash
from tests.support.fits import made_fit

SEGMENTS = np.array([[0, 120], [120, 300]])
STEP = 1e-6


def commands(seed):
    """A wandering command: no two samples alike, so that no kink is met by chance."""
    return np.cumsum(np.random.default_rng(seed).normal(scale=0.5, size=300))


def slow_lagged(u, segments, pole):
    """Twin of ``lagged``, row by row."""
    found = []
    for start, stop in segments:
        v = u[start]
        for command in u[start:stop]:
            v = pole * v + (1.0 - pole) * command
            found.append(v)
    return np.array(found)


def loop(lag, *, width=2.0, noise=0.3, rows=1500, seed=1):
    """Record of a loop whose actuator lags by so many rows before its play; `noise` is that of OP over the width."""
    random = np.random.default_rng(seed)
    gain, integral = 1.0, 0.04
    sp = np.repeat(random.uniform(-6.0, 6.0, rows // 100 + 1), 100)[:rows]
    op, pv = np.zeros(rows), np.zeros(rows)
    pole = float(np.exp(-1.0 / lag)) if lag > 0.0 else 0.0
    stem = valve = state = total = 0.0
    for k in range(rows):
        state += 0.12 * (valve - state)
        pv[k] = state + noise * width / gain * random.standard_normal()
        total += integral * (sp[k] - pv[k])
        op[k] = gain * (sp[k] - pv[k]) + total
        stem = pole * stem + (1.0 - pole) * op[k]
        valve = min(max(valve, stem - width / 2), stem + width / 2)
    return lm.LoopRecord(50 + op, 50 + pv, 50 + sp, dt=2.0, op_span=(0.0, 100.0))


@pytest.mark.parametrize("pole", [0.0, 0.3, 0.9])
def test_the_lag_is_that_of_its_twin(pole):
    u = commands(1)
    np.testing.assert_allclose(lagged(u, SEGMENTS, pole), slow_lagged(u, SEGMENTS.tolist(), pole), atol=1e-12)


@given(st.integers(0, 1000), st.floats(0.0, SLOWEST))
def test_what_is_lagged_stays_between_the_commands_and_no_pole_leaves_them(seed, pole):
    u = commands(seed)
    v = lagged(u, SEGMENTS, pole)
    for start, stop in SEGMENTS:
        assert v[start] == u[start]  # at rest there
        low, high = np.minimum.accumulate(u[start:stop]), np.maximum.accumulate(u[start:stop])
        assert np.all((v[start:stop] >= low - 1e-9) & (v[start:stop] <= high + 1e-9))
    np.testing.assert_allclose(lagged(u, SEGMENTS, 0.0), u, atol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_the_family_is_a_play_of_what_comes_out_of_the_lag(seed):
    u, family = commands(seed), LaggedBacklash(9.0, SEGMENTS, rests=(0.5, -0.2))
    x, dx = np.empty(300), np.empty((2, 300))
    family.act(np.array([1.3, 0.6]), u, x, dx)
    driven = slow_lagged(u, SEGMENTS.tolist(), 0.6)
    parts = [backlash(driven[a:b], 1.3, u[a] + 0.5 * r * 1.3) for (a, b), r in zip(SEGMENTS, (0.5, -0.2), strict=True)]
    np.testing.assert_allclose(x, np.concatenate(parts), atol=1e-12)
    path = np.empty(300)
    family.path(np.array([1.3, 0.6]), u, path)
    np.testing.assert_allclose(path, x, atol=1e-12)
    family = LaggedBacklash(9.0, SEGMENTS)
    family.act(np.array([1.3, 0.6]), u, x, dx)
    for row in range(2):
        ends = np.empty((2, 300))
        for end, sign in zip(ends, (1.0, -1.0), strict=True):
            family.path(np.array([1.3, 0.6]) + sign * STEP * np.eye(2)[row], u, end)
        np.testing.assert_allclose(dx[row], (ends[0] - ends[1]) / (2.0 * STEP), atol=1e-5)


def test_width_and_pole_stay_in_their_range():
    family = LaggedBacklash(9.0, SEGMENTS)
    assert family.valid(np.array([10.0, 1.2])).tolist() == [9.0, SLOWEST]
    assert family.valid(np.array([-1.0, -0.2])).tolist() == [0.0, 0.0]


def test_intervals_are_joined_unless_an_actuator_without_lag_is_rejected():
    plain = {"width": (4.0, 6.0), "other": (0.0, 1.0)}
    own = np.array([1.0])
    assert Lag(0.0, own, {"width": (1.0, 2.5)}).joined(plain, 2.0) == {"width": (2.0, 6.0), "other": (0.0, 1.0)}
    assert Lag(0.5, own, {"width": (1.0, 2.5)}).joined(plain, 2.0) == {"width": (2.0, 5.0), "other": (0.0, 1.0)}
    assert NO_LAG.joined(plain, 2.0) == plain
    assert NO_LAG.rows == 0.0
    assert Lag(float(np.exp(-0.5)), own).rows == pytest.approx(2.0)


def test_a_saved_fit_keeps_its_lag_and_none_below_zero(tmp_path):
    plain = made_fit("backlash")
    fit = replace(plain, evidence=replace(plain.evidence, actuator_lag=1.5))
    assert lm.read_fit(fit.save(tmp_path / "fit.json")).evidence.actuator_lag == 1.5
    assert any("lags by about 1.5 s" in remark for remark in fit.remarks)
    assert not any("lags by" in remark for remark in plain.remarks)
    saved = fit.to_dict()
    saved["evidence"]["actuator_lag"] = -1.0
    path = tmp_path / "wrong.json"
    path.write_text(json.dumps(saved))
    with pytest.raises(lm.DataError, match="actuator_lag"):
        lm.read_fit(path)


@pytest.mark.statistics
def test_the_width_behind_a_lag_is_found_and_the_lag_is_said():
    held = 0
    for seed in range(6):
        fit = lm.identify(loop(2.0, seed=seed), nonlinearity="backlash")
        low, high = fit.interval("width")
        held += low <= 2.0 <= high
        assert fit.parameters["width"] == pytest.approx(2.0, rel=0.25)
        assert fit.evidence.actuator_lag == pytest.approx(4.0, rel=0.4)
        assert fit.model.nonlinearity.width == fit.parameters["width"]
    assert held >= 5


@pytest.mark.statistics
def test_without_a_lag_none_is_said_and_the_width_stays():
    held = said = 0
    for seed in range(6):
        fit = lm.identify(loop(0.0, seed=seed), nonlinearity="backlash")
        low, high = fit.interval("width")
        held += low <= 2.0 <= high
        said += fit.evidence.actuator_lag > 0.0
        assert fit.parameters["width"] == pytest.approx(2.0, rel=0.2)
    assert held >= 5
    assert said == 0


@pytest.mark.statistics
def test_a_size_behind_a_lag_is_not_excluded(monkeypatch):
    kept = 0
    for seed in range(4):
        data = collect(loop(2.0, width=1.0, noise=1.0, seed=seed), None, None)
        scaled = ScaledData.of(data, Scaling(data.u_centre, data.u_scale, data.y_centre, data.y_scale))
        linear = fit_linear(scaled, Asked())
        with_lag = largest_sizes(linear, {})
        with monkeypatch.context() as patched:
            patched.setattr(excluded, "POLES", ())
            without = largest_sizes(linear, {})
        assert with_lag["dead zone"] == without["dead zone"]  # it has no memory
        assert all(with_lag[kind] >= without[kind] for kind in without)
        kept += data.u_scale * with_lag["backlash"] >= 1.0
    assert kept >= 3  # of bounds of 95 %


def test_noise_of_op_is_what_a_lag_takes_away():
    random = np.random.default_rng(3)
    slow = np.sin(np.arange(300.0) / 50.0)
    problem = Problem(slow, slow, SEGMENTS, LinearFamily(), Structure(1, 0, 1, 0, 1))
    assert op_noise(problem) < 0.02
    noisy = replace(problem, u=slow + random.normal(scale=0.3, size=300))
    assert 0.1 < op_noise(noisy) < 0.3


def test_a_perfect_fit_gains_nothing_by_a_lag():
    fit = Fitted(
        Problem(commands(1), commands(2), SEGMENTS, LinearFamily(), Structure(1, 0, 1, 0, 1)),
        LocalFit(np.zeros(5), 1.0, np.eye(5), 1, True),
    )
    exact, better = replace(fit, fit=replace(fit.fit, cost=0.0)), replace(fit, fit=replace(fit.fit, cost=0.9))
    assert gain_by_lag(exact, exact) == -np.inf
    gain = gain_by_lag(fit, better)
    assert gain == pytest.approx(0.5 * fit.problem.errors * -np.log(0.9))
    assert rise_behind(better, PRICE) == pytest.approx(rise_behind(better, 1e3))
    assert rise_behind(better, 0.0) == pytest.approx(0.0)
    assert 0.0 < rise_behind(better, 1.0) < rise_behind(better, PRICE)
