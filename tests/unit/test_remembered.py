"""What is remembered of data is found once, and goes with them."""

from dataclasses import dataclass, field

from lostmotion.identify.likelihood.remembered import remembered


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
