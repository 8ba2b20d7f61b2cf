"""The gate on the way to the valve: what keeps a fit from it, and what a reason leaves behind."""

import json
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.compensate import block_from_fit
from lostmotion.compensate.gate import closed, pass_dead_zone, pass_gate, pass_process, verdict_of
from lostmotion.design.prior import known as known_before_test
from lostmotion.errors import DataError, GateError, ParameterError, Status
from lostmotion.evaluate.study.studied_loop import known
from lostmotion.export import export
from lostmotion.identify.actuators.choice import KindChoice
from tests.support.fits import made_fit
from tests.support.refusals import refusal

OPEN = {Status.OK, Status.COLOURED}
WHY = "the stem was seen to stand still, J. Doe"
NAMED = {"name": "FY_101", "date": "2026-01-31"}


@pytest.mark.parametrize("status", Status)
def test_only_a_kind_and_a_size_that_are_seen_open_it(status):
    fit = made_fit("dead zone", status)
    assert (closed(fit.facts) is None) == (status in OPEN)
    if status in OPEN:
        assert not fit.block().accepted
        return
    for call in (fit.block, fit.compensator, lambda: known(fit, None), lambda: export(block(), "st", **NAMED, fit=fit)):
        assert status.name in refusal(GateError, call)
    assert "accept='<reason>'" in refusal(GateError, fit.block)


def test_a_misfit_of_all_kinds_is_not_sent_to_compare_them():
    fit = made_fit("backlash", Status.MISFIT)
    assert "compares all kinds" in closed(fit.facts).remedy
    every = KindChoice("backlash", {}, {}, {}, 0.99, "none")
    remedy = closed(replace(fit, kinds=every).facts).remedy
    assert "whichever kind" in remedy
    assert "nonlinearity" not in remedy


def block():
    return lm.block_from_model(lm.DeadZone(48.7, 51.9, 1.3, 1.1), 0.5, op_noise=0.05)


def test_the_error_is_of_both_classes_that_were_raised_before():
    assert issubclass(GateError, ParameterError)
    assert issubclass(GateError, DataError)


def test_a_reason_opens_it_and_stays():
    fit = made_fit("dead zone", Status.WIDE)
    made = fit.block(accept=WHY)
    assert WHY in made.accepted
    assert "WIDE" in made.accepted
    assert made.with_settings(factor=0.5).accepted == made.accepted
    assert made.changed(ramp=0.2).accepted == made.accepted
    saved = json.loads(json.dumps(made.to_dict()))
    assert lm.CompensatorBlock.from_dict(saved) == made
    assert saved["accepted"] == made.accepted
    files = export(made, "st", **NAMED, fit=fit).files
    for name in ("FY_101.st", "FY_101_commissioning.md"):
        assert f"ACCEPTED behind a closed gate: {WHY}" in files[name]


def test_a_block_from_elsewhere_gets_the_reason_at_the_export():
    done = export(block(), "c", **NAMED, fit=made_fit("dead zone", Status.WIDE), accept=WHY)
    assert all(WHY in text for text in done.code.values())
    assert WHY in done.source.block.accepted


def test_an_open_gate_leaves_everything_as_it_was():
    fit = made_fit("backlash")
    assert fit.block() == fit.block(accept=WHY) == block_from_fit(fit, diagnosis="backlash")
    assert "accepted" not in fit.block().to_dict()
    files = export(fit.block(), "st", **NAMED, fit=fit).files
    assert not any("ACCEPTED" in text for text in files.values())


@pytest.mark.parametrize("reason", ["", "   ", "\n", "--", "1", 3])
def test_a_reason_needs_words(reason):
    for status in (Status.OK, Status.WIDE):
        assert "reason in words" in refusal(ParameterError, made_fit("dead zone", status).block, accept=reason)


def test_no_reason_makes_a_block_of_what_has_none():
    for kind in ("saturation", "none"):
        assert "mend" in refusal(ParameterError, made_fit(kind).block, accept=WHY)
    unknown = made_fit("backlash", Status.NOT_SEEN, widest=2.0)
    assert "surely above 0" in refusal(ParameterError, unknown.block, accept=WHY)
    assert unknown.block(accept=WHY, factor=0.2).settings["factor"] == 0.2


@pytest.mark.parametrize("verdict", ["cannot tell", "stiction", "none", "other oscillation"])
def test_a_diagnosis_must_name_the_kind(verdict):
    fit = made_fit("backlash")
    for said in (verdict, {"verdict": verdict}, type("Found", (), {"verdict": verdict})()):
        assert repr(verdict) in refusal(GateError, fit.block, diagnosis=said)
        assert repr(verdict) in fit.block(diagnosis=said, accept=WHY).accepted
    assert repr(verdict) in refusal(GateError, export, fit.block(), "st", **NAMED, diagnosis=verdict)
    assert fit.block(diagnosis={"verdict": "backlash"}) == fit.block()


def test_what_is_no_diagnosis_is_refused():
    assert "verdict" in refusal(DataError, verdict_of, {"status": "OK"})
    assert "verdict" in refusal(DataError, verdict_of, 3)


def test_a_fit_of_another_kind_than_the_block_is_refused():
    assert "backlash" in refusal(GateError, export, block(), "st", **NAMED, fit=made_fit("backlash"))


def test_a_test_or_a_watch_asks_for_the_kind_only():
    for status in (*OPEN, Status.MISFIT, Status.WIDE):
        assert pass_dead_zone(made_fit("dead zone", status).facts, None, None, "guess") == ""
        assert known_before_test(made_fit("dead zone", status), None, 0.3).accepted == ""
    for status in (Status.NOT_SEEN, Status.CANNOT_TELL, Status.NOT_CONVERGED, Status.ONE_SIDED):
        fit = made_fit("dead zone", status)
        assert status.name in refusal(GateError, known_before_test, fit, None, 0.3)
        assert WHY in known_before_test(fit, None, 0.3, accept=WHY).accepted
    assert "guess" in refusal(GateError, pass_dead_zone, made_fit("backlash").facts, None, WHY, "guess")
    assert "process" in refusal(GateError, pass_process, made_fit("backlash", Status.NOT_CONVERGED).facts, None)
    assert pass_process(made_fit("backlash", Status.NOT_SEEN).facts, None) == ""


def compared(confidence, runner_up="stiction"):
    """Fit of a backlash that was compared with the other kinds."""
    likelihoods = {"none": 0.0, "backlash": 20.0, "stiction": 18.0}
    return replace(
        made_fit("backlash"), kinds=KindChoice("backlash", likelihoods, likelihoods, likelihoods, confidence, runner_up)
    )


def test_a_kind_that_may_be_another_is_no_ground_for_a_block(tmp_path):
    assert closed(compared(0.9).facts) is None
    for form in (compared(0.89), lm.read_fit(compared(0.89).save(tmp_path / "fit.json"))):
        assert "89 % that it is a backlash; it may be a stiction" in refusal(GateError, form.block)
        assert "89 %" in form.block(accept=WHY).accepted
    assert "at all" in refusal(GateError, compared(0.6, "none").block)
    nearly = refusal(GateError, compared(0.8996).block)
    assert "sure to 90 %, got 89.96 %" in nearly, "what is refused is less than what is expected, in print too"
    assert closed(compared(0.6).facts, sized=False) is None


def test_the_comparison_of_kinds_is_saved(tmp_path):
    fit = compared(0.97)
    read = lm.read_fit(fit.save(tmp_path / "fit.json"))
    assert read.kinds == fit.kinds == fit.facts.kinds
    assert read.to_dict()["kinds"] == fit.to_dict()["kinds"]
    assert lm.FitFacts.from_dict({k: v for k, v in fit.to_dict().items() if k != "kinds"}).kinds is None
    assert "kinds" in refusal(DataError, lm.FitFacts.from_dict, fit.to_dict() | {"kinds": {"best": "backlash"}})


def test_the_study_keeps_the_reason():
    fit = made_fit("backlash", Status.WIDE)
    assert "WIDE" in refusal(GateError, lm.compensation_study, fit, lm.PI(1.0, 0.1))
    found = known(fit, None, accept=WHY)
    assert WHY in found.accepted
    assert pass_gate(fit.facts, None, WHY) == found.accepted


# Slopes


def zone(ratio, error, gain=None, width=1.0):
    """Fit of a dead zone around 50 with a slope ratio of this error."""
    valve = lm.DeadZone(50.0 - width / 2, 50.0 + width / 2, ratio * (gain or 1.0), gain or 1.0)
    fit = made_fit("dead zone")
    parameters = fit.parameters | {
        name: getattr(valve, name) for name in ("left", "right", "left_slope", "right_slope")
    }
    parameters |= {"width": width, "slope_ratio": ratio}
    errors = [error if name in ("slope_ratio", "left_slope") else 0.01 * width for name in parameters]
    model = lm.Hammerstein(valve, fit.linear, 20.0)
    settings = fit.settings | {"gain": gain}
    data = replace(fit.data, u=np.clip(fit.data.u, 45.0, 55.0))
    return replace(
        fit, model=model, parameters=parameters, covariance=np.diag(np.square(errors)), settings=settings, data=data
    )


@pytest.mark.parametrize("ratio", [0.05, 0.3, 0.8, 1.3, 4.0, 20.0])
@pytest.mark.parametrize("error", [0.01, 5.0])
def test_the_offset_is_about_half_of_the_lost_motion_whatever_the_slopes(ratio, error):
    made = zone(ratio, error * ratio).block()
    assert made.settings["cap"] <= 1.1 * 0.5
    wanted = made.run(np.r_[np.full(5000, 50.0), np.linspace(0.0, 100.0, 5000)])
    assert np.abs(wanted.offset).max() <= 1.1 * 0.5 + 1e-12
    assert (made.settings["left_slope"] == 1.0) == (error > 1.0)


def test_slopes_that_may_be_equal_are_taken_equal():
    made = zone(1.1, 0.2).block()
    assert made.settings["left_slope"] == made.settings["right_slope"] == 1.0
    assert any("slopes equal" in note for note in made.notes)
    known_gain = zone(1.1, 0.4, gain=3.0).block()
    assert known_gain.settings["left_slope"] == pytest.approx(3.0 * 1.1**0.5)
    assert known_gain.settings["left_slope"] == known_gain.settings["right_slope"]


def test_known_slopes_are_undone_exactly_as_far_as_op_has_been():
    fit = zone(1.0, 0.1, gain=3.0)
    made = fit.block(factor=1.0, op_noise=0.0)
    low, high = fit.facts.op_range
    farthest = max(3.0 * (high - 50.5), 3.0 * (49.5 - low))
    ideal = lm.DeadZoneCompensator(lm.DeadZone(49.5, 50.5, 3.0, 3.0), 50.0)
    inputs = 50.0 + np.linspace(0.2, farthest, 2000)
    answer = made.run(np.r_[np.full(3000, inputs[0]), inputs]).op_out[3000:]
    np.testing.assert_allclose(answer, np.asarray(ideal(inputs)), atol=0.05)
    assert answer.max() >= high - 0.05
    assert made.settings["cap"] < 1.2 * (farthest - (high - 50.0))


def test_a_model_by_numbers_is_inverted_as_it_is():
    made = lm.block_from_model(lm.DeadZone(49.0, 51.0, 2.0, 3.0), 1.0)
    assert (made.settings["left_slope"], made.settings["right_slope"]) == (2.0, 3.0)
    assert made.settings["cap"] > 30.0


@pytest.mark.parametrize(("crossed", "open_"), [(None, True), (4, True), (3, False), (0, False)])
def test_a_dead_zone_that_was_hardly_crossed_is_no_ground_for_a_block(crossed, open_):
    facts = made_fit("dead zone").facts
    moved = replace(facts, evidence=replace(facts.evidence, closed_loop=True, crossings=crossed, free_moves=0.1))
    assert closed(moved) is None  # SP was moved: the process is known by that
    facts = replace(facts, evidence=replace(moved.evidence, free_moves=1e-9))
    assert (closed(facts) is None) == open_
    assert closed(facts, sized=False) is None  # to ask for a test, or to watch
    assert lm.FitFacts.from_dict(json.loads(json.dumps(facts.to_dict()))).evidence.crossings == crossed
    if not open_:
        assert "fewer than four times" in refusal(GateError, facts.block)


def test_crossings_of_a_fit_saved_before_are_there_and_back():
    saved = json.loads(json.dumps(made_fit("dead zone").facts.to_dict()))
    saved["evidence"]["crossings"] = [1, 9]
    assert lm.FitFacts.from_dict(saved).evidence.crossings == 2


def test_two_moves_need_a_jump_that_the_record_shows():
    fit = made_fit("stiction")
    fit = replace(fit, model=replace(fit.model, nonlinearity=replace(fit.model.nonlinearity, model="he ramp")))
    with pytest.raises(lm.ParameterError, match="slips between the rows"):
        block_from_fit(fit, method="two moves", accept="a test", span=(0.0, 100.0))
    assert block_from_fit(fit, accept="a test", span=(0.0, 100.0)).kind == "stiction knocker"


def test_two_moves_are_not_given_to_a_process_that_integrates():
    fit = made_fit("stiction", integrating=True)
    asked = {"method": "two moves", "accept": "a test", "span": (0.0, 100.0)}
    assert "got an integrating one; take method='knocker'" in refusal(ParameterError, block_from_fit, fit, **asked)
