"""What is remembered of data is found once, and goes with them."""

from dataclasses import dataclass, field, replace

import numpy as np

from lostmotion.identify.likelihood.remembered import remembered, remembered_of_signals
from lostmotion.identify.scaled import ScaledData


@dataclass(frozen=True)
class Data:
    """As unhashable as scaled data."""

    values: list[int] = field(default_factory=list)


def test_found_once_for_each_data_and_value():
    asked = []

    @remembered
    def total(data, more=0):
        asked.append(data)
        return sum(data.values) + more

    one, other = Data([1, 2]), Data([1, 2])
    assert [total(one), total(one), total(one, 4), total(other)] == [3, 3, 7, 3]
    assert len(asked) == 3


def test_other_data_in_the_same_place_are_other_data():
    @remembered
    def first(data):
        return data.values[0]

    found = []
    for value in range(50):
        data = Data([value])
        found.append(first(data))
        del data  # freed at once: the next takes its place
    assert found == list(range(50))


def test_data_made_anew_from_the_same_arrays_are_the_same():
    asked = []

    @remembered_of_signals
    def total(data, more=0.0):
        asked.append(data)
        return float(data.u.sum() + data.y.sum()) + more

    one = ScaledData(np.ones(3), np.ones(3), np.array([[0, 3]]))
    again, other = ScaledData(one.u, one.y, one.segments), replace(one, y=2.0 * one.y)
    assert [total(one), total(again), total(again, 1.0), total(other)] == [6.0, 6.0, 7.0, 9.0]
    assert len(asked) == 3


def test_other_arrays_in_the_same_place_are_other_data():
    @remembered_of_signals
    def first(data):
        return float(data.y[0])

    u, segments, found = np.zeros(1000), np.array([[0, 1000]]), []
    for value in range(50):
        data = ScaledData(u, np.full(1000, float(value)), segments)
        found.append(first(data))
        del data
    assert found == list(range(50))
