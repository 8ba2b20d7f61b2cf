"""Noise D(q) v = (1 - c q^-1) e: the likelihood against a twin with SciPy's filters, results, and what it is for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lfilter

import lostmotion as lm
from lostmotion.identify.actuators.dead_zone import DeadZoneFamily
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.coloured import as_autoregression, with_best_zero
from lostmotion.identify.likelihood.criterion import per_row
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem, Structure
from lostmotion.identify.likelihood.refinement import refine
from lostmotion.kernels.smoothed import roughen, smooth, smooth_rows
from lostmotion.models import NoiseModel
from pooled import records_of

ZERO, D = 0.95, np.array([-1.29, 0.297])
INITIAL = np.array([0.7, -0.4])  # of the process and of the zero
SEGMENTS = np.array([[0, 1400], [1400, 3000]])


def problem_of(seed: int = 0, zero: float = ZERO) -> tuple[Problem, np.ndarray]:
    """A dead zone before a process of first order with noise that has a zero, and the true parameters."""
    rng = np.random.default_rng(seed)
    n = int(SEGMENTS[-1, 1])
    u = np.repeat(rng.normal(scale=2.0, size=n // 10), 10)
    x = np.maximum(u - 0.6, 0.0) + np.minimum(u + 0.4, 0.0)
    z = lfilter([0.0, 0.0, 0.3], [1.0, -0.8], x)
    v = lfilter([1.0, -ZERO], [1.0, *D], 0.1 * rng.normal(size=n + 500))[500:]
    structure = Structure(1, 0, 2, 2, 4, zero=zero)
    problem = Problem(u, 0.5 + z + v, SEGMENTS, DeadZoneFamily(-9.0, 9.0), structure)
    return problem, problem.pack(np.array([-0.8]), np.array([0.3]), np.array([-0.4, 0.6, 0.0]), D, 0.5)


def test_the_sum_of_squares_is_that_of_plain_filters():
    problem, theta = problem_of()
    theta[problem.initial_at :] = np.tile(INITIAL, len(SEGMENTS))
    total = 0.0
    for start, stop in SEGMENTS:
        seen = [
            lfilter([1 - ZERO], [1.0, -ZERO], s[start:stop], zi=[ZERO * s[start]])[0]
            for s in (problem.y - 0.5, np.maximum(problem.u - 0.6, 0.0) + np.minimum(problem.u + 0.4, 0.0))
        ]
        first, delay = problem.structure.first, problem.structure.delay
        z = lfilter([0.3], [1.0, -0.8], seen[1][first - delay : stop - start - delay])
        pulse = np.append(INITIAL, np.zeros(z.size - INITIAL.size))
        z += lfilter([1.0], np.convolve([1.0, -0.8], [1.0, -ZERO]), pulse)
        errors = lfilter([1.0, *D], [1.0], seen[0][first:] - z)[2:] / (1 - ZERO)
        total += float(errors @ errors)
    cost, _, _ = problem.evaluate(theta)
    assert cost == pytest.approx(total, rel=1e-9)
    assert problem.squares(theta, problem.internal(theta)[0]) == pytest.approx(total, rel=1e-9)
    assert sum(float(e @ e) for e in problem.predict(theta)[1]) == pytest.approx(total, rel=1e-9)


def test_gradients_are_those_of_differences():
    problem, theta = problem_of()
    problem = replace(problem, early=0.3)
    theta[problem.initial_at :] = np.tile(INITIAL, len(SEGMENTS))
    _, gradient, _ = problem.evaluate(theta)
    for at in range(problem.size):
        step = np.zeros(theta.size)
        step[at] = 1e-5
        costs = [problem.squares(theta + s, problem.internal(theta + s)[0]) for s in (step, -step)]
        assert 2.0 * gradient[at] == pytest.approx((costs[0] - costs[1]) / 2e-5, rel=2e-4, abs=1e-4)


def test_simulated_and_residual_are_of_the_measured_signals():
    problem, theta = problem_of()
    plain = replace(problem, structure=replace(problem.structure, zero=0.0))
    same = np.append(theta[: problem.initial_at], np.zeros(len(SEGMENTS)))
    for mine, other in zip(problem.predict(theta)[0], plain.predict(same)[0], strict=True):
        assert np.abs(mine - other)[200:].max() < 1e-2  # the first rows know nothing of what was before
    v = problem.output_residual(theta)[0]
    assert np.allclose(v, problem.y[problem.structure.first : 1400] - problem.predict(theta)[0][0])


@given(st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=60), st.floats(0.0, 0.99))
def test_roughening_undoes_smoothing(values, zero):
    x, seen = np.array(values), np.empty(len(values))
    smooth(x, zero, np.array([[0, x.size]]), seen)
    again = roughen(seen, zero)
    assert np.allclose(again[1:], x[1:], atol=1e-7 * (1 + np.abs(x).max()) / (1 - zero))
    assert again[0] == (again[1] if zero > 0.0 and x.size > 1 else x[0])  # what was before is not known


@pytest.mark.parametrize("rows", range(1, 8))
def test_many_signals_are_smoothed_like_each(rows):
    x = np.random.default_rng(rows).normal(size=(rows, 70))
    segments, found, each = np.array([[0, 40], [45, 70]]), np.zeros(x.shape), np.zeros(x.shape)
    smooth_rows(x, 0.8, segments, found)
    for signal, out in zip(x, each, strict=True):
        smooth(signal, 0.8, segments, out)
    np.testing.assert_array_equal(found, each)


@pytest.mark.statistics
def test_the_zero_is_found_and_pays():
    problem, _ = problem_of(zero=0.0)
    longer = Structure(1, 0, 2, 12, 14)
    start = problem.pack(np.array([-0.8]), np.array([0.3]), np.array([-0.4, 0.6, 0.0]), np.zeros(12), 0.5)
    plain = replace(problem, structure=longer)
    fitted = Fitted(plain, refine(plain, start))
    found = with_best_zero(fitted, Asked())
    assert found.problem.structure.zero >= 0.8
    assert per_row(found) < per_row(fitted)
    assert with_best_zero(fitted, Asked(zero=False)) is fitted
    assert with_best_zero(fitted, Asked(noise=12)) is fitted


@pytest.mark.statistics
def test_a_long_autoregression_predicts_the_same():
    problem, theta = problem_of()
    fitted = Fitted(problem, refine(problem, theta))
    long = as_autoregression(fitted)
    assert long.problem.structure.zero == 0.0
    assert long.fit.cost / long.problem.errors == pytest.approx(fitted.fit.cost / problem.errors, rel=0.02)
    assert as_autoregression(long) is long


def test_noise_models_with_a_zero():
    noise = NoiseModel((-1.3, 0.32), 0.01, 0.9)
    long = noise.autoregression()
    impulse = np.append(1.0, np.zeros(40))
    exact = lfilter([1.0, -0.9], [1.0, -1.3, 0.32], impulse)
    assert np.allclose(lfilter([1.0], [1.0, *long.d], impulse), exact, atol=1e-12)
    assert long.zero == 0.0
    assert long.autoregression() is long
    assert noise.to_dict()["zero"] == 0.9
    with pytest.raises(lm.ParameterError, match=r"a zero in \[0, 1\)"):
        NoiseModel((), 1.0, 1.0)


@pytest.mark.statistics
@pytest.mark.parametrize(("seed", "record"), [(0, 0), (3, 3)])
def test_drift_behind_fast_noise_does_not_move_the_break_points(seed, record):
    """Level loops of 16,000 samples; with noise that is autoregressive alone the widths are 19 and 25 % too large."""
    records, size = records_of(seed, "dead zone", record + 1, 16_000)
    fit = lm.identify(records[record], nonlinearity="dead zone")
    low, high = fit.interval("width")
    assert fit.noise.zero > 0.8
    assert abs(fit.parameters["width"] / size - 1.0) < 0.1
    assert high - low < 0.15 * size


@pytest.mark.statistics
def test_fits_keep_the_zero(tmp_path):
    record = records_of(0, "dead zone", 1, 16_000)[0][0]
    fit = lm.identify(record, nonlinearity="dead zone")
    assert fit.noise.zero == fit.chosen.noise_zero > 0.0
    fit.save(tmp_path / "fit.json")
    again = lm.read_fit(tmp_path / "fit.json")
    assert again.noise == fit.noise
    assert again.chosen == fit.chosen
    assert "ARMA" in fit.summary()
    ahead = fit.predict(record, horizon=1)
    known = np.isfinite(ahead)
    assert np.std(ahead[known] - record.pv[known]) == pytest.approx(np.sqrt(fit.noise.variance), rel=0.1)
