"""What a record tells of a size, and what it does not."""

from types import SimpleNamespace

import pytest

from lostmotion.diagnose.drawn_rows import hidden_size
from lostmotion.diagnose.shown import MANY_LOADS, only_one_step_ahead


def fit(loads, percent, sticks=True):
    return SimpleNamespace(
        kind=SimpleNamespace(sticks=sticks),
        chosen=SimpleNamespace(loads=({"step_at": 10},) * loads),
        fit_percent=percent,
        data=SimpleNamespace(made_up=None, unseen=SimpleNamespace(hides_size=False)),
        evidence=SimpleNamespace(closed_loop=True),
    )


@pytest.mark.parametrize(
    ("loads", "percent", "sticks", "hidden"),
    [(7, -900.0, True, True), (7, 20.0, True, False), (MANY_LOADS, -900.0, True, False), (7, -900.0, False, False)],
)
def test_no_size_is_told_beside_many_loads_where_op_reproduces_nothing(loads, percent, sticks, hidden):
    said = hidden_size(fit(loads, percent, sticks))
    assert bool(said) == hidden
    assert not hidden or "with 7 swings and steps of load" in said


def test_a_record_is_not_described_by_more_loads_still():
    assert not only_one_step_ahead(fit(12, -1.0))
    assert only_one_step_ahead(fit(13, -1.0))
