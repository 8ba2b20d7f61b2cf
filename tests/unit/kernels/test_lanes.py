"""The machine's form of each function does what its Python body says."""

import numpy as np
import pytest
from numba import njit

from lostmotion.kernels import lanes
from lostmotion.kernels.lanes import (
    address,
    less,
    load,
    load_eight,
    load_widest,
    newest,
    over,
    plus_product,
    root_above,
    second_newest,
    spread,
    spread_eight,
    spread_widest,
    store,
    third_newest,
    times,
    total,
    where_above,
    whole,
    widest,
)


def floats(size=16, seed=0):
    return np.random.default_rng(seed).normal(size=size)


@njit
def through_address(array, i, value):
    place = address(array)
    place[i] = value + place[i - 1]
    return place[i]


@njit
def copy_quad(array, source, target):
    store(address(array), target, load(address(array), source))


@njit
def fuse(array):
    place = address(array)
    store(place, 12, plus_product(load(place, 0), load(place, 4), load(place, 8)))


@njit
def scale(array, factor):
    place = address(array)
    store(place, 4, times(spread(factor), load(place, 1)))


@njit
def divide_and_take_away(array):
    place = address(array)
    store(place, 8, less(over(load(place, 0), load(place, 4)), load(place, 8)))


@njit
def roots(array, floor):
    place = address(array)
    store(place, 4, root_above(load(place, 0), spread(floor)))


@njit
def choose_and_round(array):
    place = address(array)
    store(place, 8, where_above(load(place, 0), load(place, 4), load(place, 12), spread(3.0)))
    store(place, 4, whole(times(load(place, 0), spread(5.0))))


@njit
def add_up(array, rounds):
    place = address(array)
    values = spread(0.0)
    for i in range(rounds):
        values = plus_product(values, spread(1.0), load(place, 4 * i))
    return total(values)


@njit
def eight_at_once(array):
    place = address(array)
    values = load_eight(place, 3)
    values = plus_product(times(newest(values), second_newest(values)), third_newest(values), spread_eight(0.5))
    store(place, 1, less(values, load_eight(place, 8)))


@njit
def as_wide_as_can_be(array, factor):
    widest()
    place = address(array)
    store(place, 2, times(load_widest(place, 1), spread_widest(factor)))
    for k in range(array.size):
        array[k] *= 2.0


@njit
def inner(array, one, other, size):
    return lanes.dot(address(array), one, other, size)


@pytest.mark.parametrize(
    ("function", "arguments"),
    [
        (through_address, (3, 0.5)),
        (copy_quad, (1, 7)),
        (copy_quad, (3, 5)),
        (fuse, ()),
        (scale, (-2.5,)),
        (scale, (3,)),
        (divide_and_take_away, ()),
        (choose_and_round, ()),
        (roots, (0.1,)),
        (roots, (9.0,)),
        (add_up, (0,)),
        (add_up, (4,)),
        (eight_at_once, ()),
        (as_wide_as_can_be, (1.5,)),
    ],
)
def test_compiled_is_the_python_body(function, arguments):
    array, expected = floats(), floats()
    given = function(array, *arguments)
    wanted = getattr(function, "py_func", function)(expected, *arguments)
    np.testing.assert_allclose(array, expected, rtol=1e-15, atol=1e-15)
    assert given is None or given == pytest.approx(wanted, rel=1e-14, abs=1e-14)


def test_what_they_mean():
    array = floats()
    expected = array.copy()
    expected[12:] = array[:4] + array[4:8] * array[8:12]
    fuse(array)
    np.testing.assert_allclose(array, expected, rtol=1e-14, atol=1e-15)
    assert add_up(array, 4) == pytest.approx(array.sum(), rel=1e-13)
    assert inner(array, 0, 8, 8) == pytest.approx(array[:8] @ array[8:], rel=1e-13)
    assert through_address(array, 2, 1.0) == 1.0 + array[1] == array[2]
    first = array.copy()
    scale(array, 2.0)
    np.testing.assert_array_equal(array[4:8], 2.0 * first[1:5])
    first = array.copy()
    eight_at_once(array)
    np.testing.assert_allclose(array[1:9], first[10] * first[9] + 0.5 * first[8] - first[8:16], rtol=1e-14)


def test_integers_keep_their_type():
    @njit
    def turn(array):
        place = address(array)
        place[0] = place[1] + 1
        return place[0]

    whole = np.array([0, 2**60], dtype=np.int64)
    assert turn(whole) == 2**60 + 1
    assert whole[0] == 2**60 + 1
