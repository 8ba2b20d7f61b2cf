"""The covariance of the recursion against the recursion itself, propagated sample by sample."""

import numpy as np
import pytest

from lostmotion.identify.recursive.iv_covariance import covariance_of_theta
from lostmotion.kernels.recursive_iv import state as iv


def situation(seed, *, share, samples, feedback=2.0, rank=4):
    """State whose averages are known: R, S, W of a random problem, and the jacobian."""
    rng = np.random.default_rng(seed)
    n = 7
    state, layout = iv.lay_out(iv.Places(2, 1, 0, 0, iv.MODEL_OUTPUT, True))
    root = rng.normal(size=(n, n))
    r = root @ root.T / n + np.eye(n) + 0.2 * rng.normal(size=(n, n))
    noise = rng.normal(size=(n, n))
    s = noise @ noise.T / n
    jacobian = rng.normal(size=(4, n))
    w = np.zeros((n, 4))
    w[:, :rank] = r @ np.linalg.pinv(jacobian)[:, :rank] * feedback
    total = samples if share == 1 else 1 / (1 - 0.99)
    total_squared = samples if share == 1 else 1 / (1 - 0.99**2)
    parts = iv.named(state, layout)
    parts["p"][:] = np.linalg.inv(r) / total
    seen, seen_squared, since = 0.7 * total, 0.6 * total_squared, 0.9
    parts["spread"][:] = s * seen_squared / since**2
    parts["rebuilt"][:] = w * seen / since
    level = 3.0
    state[iv.TOTAL : iv.SINCE + 1] = total, total_squared, seen, seen_squared, level * seen_squared, level, level, since
    return state, layout, jacobian, (r, s, w)


def propagated(r, s, w, jacobian, gains):
    """Covariance of e' = e - g R^-1 ((R + W J) e + v), v of covariance S, from no error at the start."""
    inverse = np.linalg.inv(r)
    drift, noise = inverse @ (r + w @ jacobian), inverse @ s @ inverse.T
    covariance = np.zeros_like(r)
    for gain in gains:
        keep = np.eye(len(r)) - gain * drift
        covariance = keep @ covariance @ keep.T + gain**2 * noise
    return covariance


def close(one, other, tolerance):
    assert np.abs(one - other).max() < tolerance * np.abs(other).max()


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("feedback", [0.0, 0.5, 4.0])
def test_all_samples_count_alike(seed, feedback):
    samples = 4000
    state, layout, jacobian, averages = situation(seed, share=1, samples=samples, feedback=feedback)
    expected = propagated(*averages, jacobian, 1 / np.arange(20, samples + 1))
    close(covariance_of_theta(state, layout, jacobian), expected, 0.02)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("feedback", [0.0, 0.5, 4.0])
def test_constant_forgetting(seed, feedback):
    state, layout, jacobian, averages = situation(seed, share=0.5, samples=None, feedback=feedback)
    expected = propagated(*averages, jacobian, np.full(3000, 0.01))
    close(covariance_of_theta(state, layout, jacobian), expected, 0.06)  # of the order of the gain


def test_without_feedback_it_is_the_sandwich():
    state, layout, jacobian, (r, s, _) = situation(5, share=1, samples=1000, feedback=0.0)
    inverse = np.linalg.inv(r)
    close(covariance_of_theta(state, layout, jacobian), inverse @ s @ inverse.T / 1000, 1e-9)


def test_present_noise_counts_where_the_start_is_forgotten():
    """Eight times the noise on the whole: it stays where samples count alike and goes where feedback is strong."""
    state, layout, jacobian, _ = situation(1, share=1, samples=1000, feedback=50.0)
    before = covariance_of_theta(state, layout, jacobian)
    state[iv.SQUARES] *= 8
    after = covariance_of_theta(state, layout, jacobian)
    blind = np.linalg.svd(jacobian)[2][4:]  # directions that no zone feels
    for seen, ratio in ((jacobian, 1 / 8), (blind, 1.0)):
        np.testing.assert_allclose(np.trace(seen @ after @ seen.T) / np.trace(seen @ before @ seen.T), ratio, rtol=0.01)


@pytest.mark.parametrize("share", [1, 0.5])
def test_slower_than_it_averages_is_not_known(share):
    state, layout, jacobian, _ = situation(2, share=share, samples=500, feedback=-0.9 if share == 1 else -1.1)
    assert covariance_of_theta(state, layout, jacobian) is None


@pytest.mark.parametrize("name", ["p", "spread", "rebuilt", "jacobian"])
@pytest.mark.parametrize("value", [np.inf, np.nan])
def test_numbers_beyond_floats_are_not_known(name, value):
    state, layout, jacobian, _ = situation(2, share=1, samples=500)
    (iv.named(state, layout) | {"jacobian": jacobian})[name][0, 0] = value
    assert covariance_of_theta(state, layout, jacobian) is None


def test_too_few_samples_are_not_known():
    state, layout, jacobian, _ = situation(2, share=1, samples=5)
    assert covariance_of_theta(state, layout, jacobian) is None
