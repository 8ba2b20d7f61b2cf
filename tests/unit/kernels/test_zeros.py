"""Noise seen through several zeros at once."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lostmotion.identify.likelihood.noise_order import ZEROS, Left, autoregressions
from lostmotion.kernels import zeros as kernel

RNG = np.random.default_rng(3)


@pytest.mark.parametrize("size", [90, 300_000])  # memory that is given back at once, used too late, is a fault
@pytest.mark.parametrize("lags", [1, 3, 7, 9, 21])
def test_products_behind_four_zeros_are_those_of_each(lags, size):
    v, zeros = RNG.normal(size=size) + 0.5, np.array(ZEROS[1:5])
    fast, plain = np.ones((lags, lags, 4)), np.ones((lags, lags, 4))
    kernel.add_products_behind(v, zeros, fast)
    kernel._add_products_behind_plain(v, zeros, plain)
    assert_allclose(fast, plain, rtol=1e-11)


def test_one_zero_alone_is_an_autoregression_of_the_filtered_noise():
    e = RNG.normal(size=4000)
    v = np.zeros(4000)
    for k in range(1, 4000):  # slow drift behind fast noise: (1 - 0.99 q^-1) v = (1 - 0.92 q^-1) e
        v[k] = 0.99 * v[k - 1] + e[k] - 0.92 * e[k - 1]
    assert Left([v[:2000], v[2000:]]).likeliest_zero == pytest.approx(0.92, abs=0.06)


@pytest.mark.parametrize("size", [5, 30, 60])
def test_of_short_noise_a_zero_is_found_or_none(size):
    assert Left([RNG.normal(size=size)]).likeliest_zero in ZEROS
    assert autoregressions([RNG.normal(size=size)]).most == (20 if size > 42 else 0)
