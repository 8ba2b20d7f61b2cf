"""One valve over runs: growth, the day a limit is reached, what a repair changed."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime, timedelta

import pytest

from lostmotion.audit.history import history
from lostmotion.errors import ParameterError
from lostmotion.store.rows import AssessmentRow, Stage

BEGAN = datetime(2026, 3, 1, tzinfo=UTC)


def week(number: int, size: float | None, reach: float = 0.1, excluded: float | None = None) -> AssessmentRow:
    start = BEGAN + timedelta(days=7 * number)
    found = {"verdict": "backlash", "kind": "actuator"} if size is not None else {"verdict": "none", "kind": "none"}
    return AssessmentRow(
        "FIC-1", start, start + timedelta(days=1), stage=Stage.ASSESSED, **found,
        size=None if size is None else size / 2.0, size_percent=size, excluded_percent=excluded,
        low=None if size is None else (size - reach) / 2.0, high=None if size is None else (size + reach) / 2.0,
    )  # fmt: skip


def test_growth_and_the_day_of_the_limit_are_exact_on_a_line() -> None:
    found = history([week(number, 1.0 + 0.07 * number) for number in range(8)])
    assert found.trend.slope == pytest.approx(0.01)
    crossing = found.reaches(2.0)
    assert crossing is not None
    last = BEGAN + timedelta(days=49.5)
    assert (crossing.expected - last).total_seconds() / 86400 == pytest.approx((2.0 - 1.49) / 0.01, rel=1e-6)
    assert crossing.earliest < crossing.expected
    assert crossing.latest is None or crossing.latest > crossing.expected


def test_no_day_is_told_of_a_valve_that_does_not_surely_grow() -> None:
    sizes = [1.0, 1.3, 0.9, 1.2, 1.1]
    assert history([week(number, size) for number, size in enumerate(sizes)]).reaches(2.0) is None
    grown = history([week(number, 1.0 + 0.07 * number) for number in range(8)])
    assert grown.reaches(1.2) is None, "it is there already"
    with pytest.raises(ParameterError, match="a limit above 0"):
        grown.reaches(0.0)


@pytest.mark.parametrize(
    ("after", "verdict"),
    [
        ([week(5, None, excluded=0.5), week(6, None, excluded=0.8)], "gone"),
        ([week(5, None, excluded=4.0)], "cannot tell"),
        ([week(5, 1.0), week(6, 1.1)], "smaller"),
        ([week(5, 3.05)], "as before"),
        ([week(5, 5.0)], "larger"),
        ([], "cannot tell"),
    ],
)
def test_what_a_repair_changed(after: list[AssessmentRow], verdict: str) -> None:
    found = history([*(week(number, 3.0 + 0.02 * number) for number in range(4)), *after])
    change = found.since(BEGAN + timedelta(days=30))
    assert change.verdict == verdict
    assert change.summary().startswith(f"{verdict}: before 3")


def test_a_window_that_a_later_run_has_as_well_counts_once() -> None:
    once = [week(number, 2.0) for number in range(4)]
    assert len(history([*once, *once]).rows) == 4
    with pytest.raises(ParameterError, match="rows of one loop"):
        history([])


def test_the_size_of_all_windows_counts_no_data_twice() -> None:
    sizes = [week(number, 3.0 + 0.03 * (-1.0) ** number) for number in range(6)]
    found = history(sizes).size
    assert found is not None
    size, low, high = found
    assert size == pytest.approx(3.0)
    assert high - low == pytest.approx(0.2 / 6**0.5, rel=0.05)
    longer = replace(sizes[0], window_end=sizes[0].window_end + timedelta(days=90))
    assert history([longer]).size == pytest.approx((3.03, 2.93, 3.13))
    assert history([*sizes, longer]).size == pytest.approx(found), "what overlaps a later one is left out"
    assert history([*sizes, week(6, None, excluded=0.5)]).size is None, "cleared since"
    assert history([week(number, 1.0 + 0.07 * number) for number in range(8)]).size is None, "it grows"
    assert history([week(0, None, excluded=0.5)]).size is None
