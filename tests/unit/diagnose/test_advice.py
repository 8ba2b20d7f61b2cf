import math

import pytest

from lostmotion.diagnose.advice import advise
from lostmotion.diagnose.diagnosis import verdicts
from lostmotion.diagnose.severity import severity_of
from lostmotion.identify.actuators.kind import faults
from tests.support.diagnoses import CASES


@pytest.mark.parametrize(
    ("percent", "severity"),
    [
        (0.0, "low"), (1.0, "low"), (1.001, "moderate"), (2.0, "moderate"), (2.001, "high"), (4.0, "high"),
        (4.001, "severe"), (60.0, "severe"), (math.nan, "unknown"), (math.inf, "unknown"),
    ],
)  # fmt: skip
def test_severity_limits(percent, severity):
    assert severity_of(percent) == severity


def test_the_cases_hold_every_verdict():
    assert {verdict for verdict, _ in CASES} == set(verdicts())


@pytest.mark.parametrize(("verdict", "kind"), CASES)
@pytest.mark.parametrize("severity", ["none", "low", "moderate", "high", "severe", "unknown"])
@pytest.mark.parametrize("integrating", [False, True])
def test_there_is_advice_for_everything_in_whole_sentences(verdict, kind, severity, integrating):
    advice = advise(verdict, kind, severity, integrating)
    assert advice
    assert all(sentence[0].isupper() and sentence.endswith(".") for sentence in advice)


def test_causes_differ_in_their_advice():
    assert len({advise(verdict, kind, "high", False) for verdict, kind in CASES}) == len(CASES)


@pytest.mark.parametrize("verdict", sorted(kind.name for kind in faults()))
def test_little_lost_motion_is_watched_and_not_mended(verdict):
    (sentence,) = advise(verdict, "actuator", "low", False)
    assert "do not mend" in sentence
    assert advise(verdict, "actuator", "moderate", False)[0] != sentence


def test_backlash_behind_a_level_is_known_to_cycle():
    assert any("level" in sentence for sentence in advise("backlash", "actuator", "high", True))
    assert not any("level" in sentence for sentence in advise("backlash", "actuator", "high", False))
