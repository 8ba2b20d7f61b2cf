"""Least squares on the first 1, 2, .. columns: one factor for all against a solution of each."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lostmotion.identify.likelihood.noise_order import _of_all_orders, autoregressions
from lostmotion.kernels.nested import _nested, _nested_plain


def both(gram, right):
    found = []
    for way in (_nested, _nested_plain):
        gains, explained = np.zeros(gram.shape), np.zeros(right.size)
        assert way(gram, right, gains, explained)
        found.append((gains, explained))
    return found


@given(st.integers(1, 20), st.integers(0, 2**32 - 1))
def test_one_factor_serves_all_orders(n, seed):
    table = np.random.default_rng(seed).normal(size=(3 * n + 5, n + 1))
    gram, right = table[:, :n].T @ table[:, :n], table[:, :n].T @ table[:, n]
    (gains, explained), (plain, by_each) = both(gram, right)
    np.testing.assert_allclose(gains, plain, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(explained, by_each, rtol=1e-9, atol=1e-11)
    assert not np.triu(gains, 1).any()
    for order in (1, n):
        best = np.linalg.lstsq(table[:, :order], table[:, n], rcond=None)[0]
        np.testing.assert_allclose(gains[order - 1, :order], best, rtol=1e-8, atol=1e-10)


def test_what_has_no_factor_is_said():
    gram = np.array([[1.0, 2.0], [2.0, 1.0]])
    assert not _nested(gram, np.ones(2), np.zeros((2, 2)), np.zeros(2))
    for way in (_nested, _nested_plain):
        assert not way(-np.ones((2, 2)), np.ones(2), np.zeros((2, 2)), np.zeros(2))


def test_products_that_are_singular_have_coefficients():
    gram = np.array([[1.0, -1.0], [-1.0, 1.0 - 1e-16]]) - 1e-15 * np.eye(2)
    gains, explained = _of_all_orders(gram, np.array([1.0, -1.0]))
    np.testing.assert_allclose(gram @ gains[1], [1.0, -1.0], atol=1e-9)
    assert np.isfinite(explained).all()
    gains, _ = _of_all_orders(-np.ones((2, 2)), np.array([1.0, 1.0]))
    np.testing.assert_allclose(gains[1], [-0.5, -0.5])


@pytest.mark.parametrize("signal", [np.zeros(300), np.ones(300), np.arange(300.0), np.sin(np.arange(300) / 9.0)])
def test_autoregressions_of_signals_without_noise_are_numbers(signal):
    found = autoregressions([signal])
    assert [found.model(order).size for order in range(found.most + 1)] == list(range(21))
    assert np.isfinite(found.gains).all()
    assert (found.variances >= 0.0).all()
    assert (found.variances[1:] >= 1e-300).all()
