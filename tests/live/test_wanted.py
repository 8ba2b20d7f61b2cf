"""What an estimate in service would ask of its block: enough known, within limits, one step at a time."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from lostmotion.compensate import CompensatorBlock
from lostmotion.compensate.supervised import SupervisedBlock
from lostmotion.errors import Status
from lostmotion.live.supervision.settings import BlockSettings
from lostmotion.live.supervision.wanted import QUANTILE, wish
from lostmotion.simulate import PI

PASSIVE = {"force_id": 0.0, "force_first": 0.0, "force_second": 0.0}
PLAIN = CompensatorBlock.of(
    "dead zone", 0.5, {"left_break": 48.6, "right_break": 51.4, "centre": 50.0, "factor": 0.9, "ramp_step": 0.1}
)
BLOCK = SupervisedBlock.of(PLAIN)  # range 1.4, most change 0.7


def settings(**more):
    return BlockSettings("A", "A", BLOCK, {}, PI(0.5, 0.1), True, True, **more)


def estimate(left, right, error=0.02, status=Status.OK):
    return SimpleNamespace(
        status=status, parameters={"left": left, "right": right}, standard_errors={"left": error, "right": error}
    )


def asked(found):
    return None if found.tried is None else (found.tried.settings["left_break"], found.tried.settings["right_break"])


def test_the_inner_ends_of_the_intervals():
    found = wish(settings(), estimate(48.2, 51.9), PASSIVE)
    assert asked(found) == pytest.approx((48.2 + QUANTILE * 0.02, 51.9 - QUANTILE * 0.02), abs=0.0005)
    rest = {**found.tried.settings, "left_break": 48.6, "right_break": 51.4}
    assert rest == PLAIN.settings


@pytest.mark.parametrize(
    "wrong",
    [
        estimate(48.2, 51.9, status=Status.COLOURED), estimate(48.2, 51.9, error=0.5), estimate(51.9, 48.2),
        estimate(48.2, 51.9, error=float("inf")), estimate(float("nan"), 51.9), estimate(49.99, 50.01),
    ],
)  # fmt: skip
def test_what_is_not_known_well_is_not_asked(wrong):
    found = wish(settings(), wrong, PASSIVE)
    assert (found.tried, found.why) == (None, "")


def test_one_step_at_a_time_and_never_beyond_the_limits():
    unit, step = BLOCK.settings["resolution"], BLOCK.settings["most_change"]
    left, right = asked(wish(settings(), estimate(46.0, 54.0), PASSIVE))
    assert 48.6 - step <= left < 48.6 - step + 2 * unit
    assert 51.4 + step >= right > 51.4 + step - 2 * unit
    armed = {"force_id": 1.0, "force_first": left, "force_second": right}
    left, right = asked(wish(settings(), estimate(46.0, 54.0), armed))
    assert 48.6 - 1.4 <= left < 48.6 - 1.4 + 2 * unit
    at_the_limit = {"force_id": 2.0, "force_first": left, "force_second": right}
    found = wish(settings(), estimate(46.0, 54.0), at_the_limit)
    assert found.tried is None
    assert "beyond the limits" in found.why


def test_a_small_change_is_left_alone():
    armed = {"force_id": 1.0, "force_first": 48.25, "force_second": 51.85}
    assert wish(settings(least_change=0.1), estimate(48.2, 51.9), armed).tried is None
    assert asked(wish(settings(least_change=0.1), estimate(48.0, 51.9), armed)) is not None
    assert asked(wish(settings(least_change=0.1), estimate(48.6, 51.4), {**armed, "force_id": 0.0})) is not None


def test_a_break_point_stays_on_its_side_of_the_centre():
    narrow = replace(settings(), precision=1.0)
    left, right = asked(wish(narrow, estimate(49.3, 49.8, error=0.01), PASSIVE))
    assert left < 50.0 <= right
