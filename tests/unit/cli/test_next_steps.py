"""What comes next after a diagnosis or a fit: commands that take the kind at hand, or a test that is safe."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.cli.next_steps import after_diagnosis, after_fit
from lostmotion.cli.options import RecordOptions
from lostmotion.diagnose.manual_test import manual_test, pv_limits
from lostmotion.diagnose.oscillation import Oscillation
from lostmotion.diagnose.sampling import sampling_advice
from tests.support.diagnoses import example, variant
from tests.support.fits import made_fit

FILE, SPAN = Path("a b.csv"), (0.0, 100.0)
COLUMNS = RecordOptions(op="CO")


def next_of(found):
    return after_diagnosis(FILE, found, columns=COLUMNS, known={"loop_type": "flow", "integrating": None})


def next_of_fit(fit, saved=None):
    return after_fit(FILE, fit, columns=COLUMNS, integrating=False, gain=None, saved=saved)


@pytest.mark.parametrize("verdict", ["dead zone", "backlash", "stiction"])
def test_a_lost_motion_leads_to_solve(verdict):
    assert next_of(variant(verdict, "actuator")) == ["lostmotion solve 'a b.csv' --op CO --loop-type flow"]


@pytest.mark.parametrize(("verdict", "kind"), [("none", "none"), ("other oscillation", "tuning")])
def test_nothing_comes_after_a_sound_valve(verdict, kind):
    assert next_of(variant(verdict, kind)) == []


def test_a_record_that_does_not_tell_leads_to_a_test_in_words():
    (said,) = next_of(variant("cannot tell", "unknown"))
    assert said.startswith("With the controller in manual, step OP from ")
    assert "lostmotion" not in said


def test_a_fit_that_is_shown_leads_to_solve_and_another_to_the_diagnosis():
    for kind in ("dead zone", "backlash", "stiction"):
        assert next_of_fit(made_fit(kind)) == ["lostmotion solve 'a b.csv' --op CO --self-regulating"]
    for kind in ("backlash", "stiction"):
        assert next_of_fit(made_fit(kind, lm.Status.WIDE)) == [
            "lostmotion diagnose 'a b.csv' --op CO --self-regulating"
        ]
    assert next_of_fit(made_fit("none")) == next_of_fit(made_fit("saturation")) == []


def test_a_dead_zone_of_unknown_size_leads_to_a_design_from_the_present_pv():
    fit = made_fit("dead zone", lm.Status.WIDE)
    identify, design = next_of_fit(fit)
    assert identify.endswith("--out 'a b.fit.json'")
    assert next_of_fit(fit, Path("fit.json")) == [design.replace("'a b.fit.json'", "fit.json")]
    words = design.replace("'a b.fit.json'", "x").split()
    low, high = (float(words[words.index("--pv-limits") + place]) for place in (1, 2))
    assert (low, high) == pv_limits(fit.data)
    assert float(words[words.index("--pv-now") + 1]) == pytest.approx(fit.data.y[-10:].mean(), rel=1e-3)


def test_a_level_is_never_waited_for():
    fit = made_fit("backlash", integrating=True)
    said = manual_test(fit, 2.0, True, SPAN)
    assert "hold at most" in said
    assert "Do not wait for PV to settle" in said
    assert "settle" not in manual_test(made_fit("backlash"), 2.0, False, SPAN)


def test_the_excursion_of_a_level_stays_within_the_record():
    fit = made_fit("backlash", integrating=True)
    seconds = float(manual_test(fit, 2.0, True, SPAN).split("hold at most ")[1].split(" s")[0])
    moved = fit.linear.step_response(round(seconds / fit.data.dt) + 1)[-1] * 3.0
    assert moved == pytest.approx(0.5 * np.ptp(fit.data.y), rel=0.05)


def test_steps_stay_within_the_span():
    fit = made_fit("backlash")
    high = replace(fit, data=replace(fit.data, u=fit.data.u + 49.0))
    start, step = (manual_test(high, 2.0, False, SPAN).split(word)[1].split()[0] for word in ("from ", "by "))
    assert float(start) + float(step.rstrip(",")) <= 100.0


def swinging(period):
    found = variant("cannot tell", "unknown")
    one = Oscillation(period, 5.0, 0.9, 100.0)
    return replace(found, measured=replace(found.measured, op=one, pv=one))


def test_a_record_that_is_too_slow_is_told_how_often_to_record():
    said = sampling_advice(swinging(2.5))
    assert "every 5 s is too slow" in said
    assert "a period of 2.5 samples" in said
    assert "one sample every 1.2 s at most" in said or "one sample every 1.3 s at most" in said
    assert next_of(swinging(2.5)) == [said]
    assert sampling_advice(swinging(30.0)) == ""
    flow = replace(swinging(30.0), fit=made_fit("none"), record=replace(example().record, loop_type="flow"))
    assert sampling_advice(flow) == "", "every 0.5 s is enough"


def test_a_design_starts_from_the_present_pv():
    tank = lm.platforms.level_tank()
    limits = {"op_limits": (-5, 5), "shortest_hold": 1.0, "duration": 60.0, "effort": 0.02}
    test = lm.design(tank, 0.03, pv_now=50.0, pv_limits=(40.0, 60.0), **limits)
    assert 40.0 < test.prediction.pv.min() < 50.0 < test.prediction.pv.max() < 60.0
    with pytest.raises(lm.ParameterError, match="pv_limits that hold PV at rest"):
        lm.design(tank, 0.03, pv_now=50.0, pv_limits=(41.7, 46.4), **limits)
