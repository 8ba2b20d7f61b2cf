"""From features to a verdict: what each rule does, one at a time."""

from dataclasses import fields, replace
from types import SimpleNamespace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.diagnose.features import COMMANDED, FOLLOWED, SILENT, Features, Measured, _command
from lostmotion.diagnose.loop_stability import LoopStability
from lostmotion.diagnose.shown import NOT_SHOWN, SEEN_TO_MISLEAD, not_shown
from lostmotion.diagnose.verdict import CLEARED, LIMITED, MOSTLY, SURE, decide, fault_probability, log_odds
from lostmotion.diagnose.weights import NAMES, OF_STICKING, WEIGHTS
from lostmotion.identify.actuators.choice import KindChoice
from lostmotion.identify.actuators.kind import kind_of
from lostmotion.identify.evidence import FEWEST_CROSSINGS, crossings
from lostmotion.identify.recording import Recording
from lostmotion.identify.size_interval import slips_at_rest, with_model_error
from lostmotion.identify.unseen_moves import Unseen
from tests.support.diagnoses import example
from tests.support.fits import made_fit

SWING = Features(shape=-0.2)
OWN = LoopStability(0.4, 0.1, 0.001, 0.02, 50.0)


def measured(features, integrating=False, period=50.0, driven=False):
    swings = features.shape != 0.0 or driven
    return Measured(features, SILENT, SILENT, period if swings else np.nan, integrating, {}, driven)


def fit_of(actuator, gains, status=lm.Status.OK):
    fit = made_fit("stiction") if isinstance(actuator, lm.Stiction) else example().fit
    kinds = KindChoice(max(gains, key=gains.get), gains, gains, gains, 0.9, "none")
    return replace(fit, model=replace(fit.model, nonlinearity=actuator), kinds=kinds, status=status)


LINEAR = fit_of(lm.Identity(), {"none": 0.0})


def verdict(features, fit=LINEAR, *, stability=OWN, quantised=False, limited=0.0, integrating=False):
    return decide(fit, measured(features, integrating), stability, quantised, limited)


def test_weights_belong_to_the_features():
    assert len(WEIGHTS) == len(NAMES) == len(OF_STICKING) == len(fields(Features))
    assert OF_STICKING.any()
    assert not OF_STICKING.all()


@pytest.mark.parametrize("name", NAMES)
def test_more_evidence_never_speaks_for_a_sound_actuator(name):
    weak, strong = (fault_probability(Features(**{name: value})) for value in (-0.1, 0.1))
    assert 0.0 < weak <= strong < 1.0


def test_nothing_at_all_is_no_fault():
    found = verdict(Features())
    assert (found.verdict, found.kind) == ("none", "none")
    assert found.confidence == found.probabilities["none"] > CLEARED


def test_nothing_where_op_does_not_move_pv_cannot_be_told():
    silent = replace(LINEAR, status=lm.Status.CANNOT_TELL)
    assert verdict(Features(), silent).verdict == "cannot tell"


@pytest.mark.parametrize(
    ("stability", "quantised", "kind"),
    [(OWN, False, "tuning"), (replace(OWN, damping=0.5), False, "disturbance"), (OWN, True, "sensor")],
)
def test_an_oscillation_without_a_fault(stability, quantised, kind):
    found = verdict(SWING, stability=stability, quantised=quantised)
    assert (found.verdict, found.kind) == ("other oscillation", kind)


@pytest.mark.parametrize("stability", [None, replace(OWN, unexplained=0.9)])
def test_a_command_moved_from_outside_does_not_swing_by_itself(stability):
    assert verdict(SWING, stability=stability).verdict == "none"


def test_a_swing_that_is_commanded_is_a_disturbance():
    found = decide(LINEAR, measured(Features(), driven=True), None, False, 0.0)
    assert (found.verdict, found.kind) == ("other oscillation", "disturbance")


STRONG = 9.0
TRIANGLES = Features(dead_zone=STRONG, memory=0.5, shape=0.4)
SWINGING = Features(memory=STRONG, shape=0.4)
BAND, ZONE, CLAMP = lm.Backlash(1.0), lm.DeadZone(-1, 1), lm.Saturation(-1, 1)


@pytest.mark.parametrize(
    ("features", "actuator", "gains", "integrating", "said"),
    [
        (Features(dead_zone=STRONG), ZONE, {"dead zone": 50.0}, False, "dead zone"),
        (Features(saturation=STRONG), lm.Saturation(-1, 1), {"saturation": 50.0}, False, "saturation"),
        (Features(memory=STRONG), BAND, {"backlash": 50.0, "stiction": 49.0}, False, "backlash"),
        (Features(memory=STRONG), lm.Stiction(1, 0.5), {"backlash": 50.0, "stiction": 60.0}, False, "stiction"),
        # a dead band alone does not make a self-regulating loop swing for ever, behind a level it does
        (SWINGING, BAND, {"backlash": 50.0, "stiction": 48.0}, False, "stiction"),
        (SWINGING, BAND, {"backlash": 50.0, "stiction": 48.0}, True, "backlash"),
        # unless the likelihood says that the valve never slips
        (SWINGING, BAND, {"backlash": 50.0, "stiction": 46.0}, False, "backlash"),
        # but it may follow one that comes from outside
        (Features(memory=STRONG, shape=0.01), BAND, {"backlash": 50.0}, False, "backlash"),
        # a dead zone makes sines, no triangles
        (Features(dead_zone=STRONG, shape=-0.01), ZONE, {"dead zone": 50.0}, False, "dead zone"),
        (TRIANGLES, ZONE, {"dead zone": 50.0, "backlash": 1.0}, False, "stiction"),
        (TRIANGLES, ZONE, {"dead zone": 50.0, "stiction": 9.0}, False, "stiction"),
        # and stands where no valve that sticks explains anything: the loop may be a level that nobody called so
        (TRIANGLES, ZONE, {"dead zone": 50.0}, False, "dead zone"),
        # but behind a level; a saturation never
        (TRIANGLES, ZONE, {"dead zone": 50.0}, True, "dead zone"),
        (Features(saturation=STRONG, waveform=4.0, shape=0.4), CLAMP, {"saturation": 50.0}, True, "stiction"),
    ],
)  # fmt: skip
def test_the_kind_of_a_fault(features, actuator, gains, integrating, said):
    found = verdict(features, fit_of(actuator, {"none": 0.0, **gains}), integrating=integrating)
    assert (found.verdict, found.kind) == (said, "actuator")
    assert found.confidence == found.probabilities["actuator"]


def test_a_valve_that_sticks_whose_interval_begins_at_0_is_not_named():
    fit = fit_of(BAND, {"none": 0.0, "backlash": 50.0, "stiction": 49.0})
    moved, size = replace(fit, evidence=replace(fit.evidence, unseen_moves=fit.parameters["width"])), "width"
    told = Recording(Unseen(moves=fit.parameters[size]), fit.data.foretold)
    vague = replace(moved, data=replace(fit.data, recording=told))
    assert moved.interval(size)[0] == vague.interval(size)[0] == 0.0
    for surely in (fit, moved):  # of `moved` nobody knows whether there are any: no reason not to name it
        assert verdict(Features(memory=STRONG), surely).verdict == "backlash"
    found = verdict(Features(memory=STRONG), vague)
    assert found.verdict == "cannot tell"
    assert "of what size, if of any" in found.why


@pytest.mark.parametrize("integrating", [False, True])
def test_a_wave_that_the_kind_does_not_make_is_not_called_stiction_without_a_valve_that_sticks(integrating):
    clamp = fit_of(CLAMP, {"none": 0.0, "saturation": 50.0})
    found = verdict(Features(saturation=STRONG, shape=0.4), clamp, integrating=integrating)
    assert (found.verdict, found.kind) == ("cannot tell", "unknown")
    assert "makes no such wave" in found.why


def test_a_swing_of_which_only_pv_moves_op_does_not_say_whose_it_is():
    found = decide(LINEAR, measured(SWING), OWN, False, 0.0, fed_back=True)
    assert (found.verdict, found.kind) == ("other oscillation", "unknown")


def test_a_swing_of_the_set_point_is_no_disturbance():
    found = decide(LINEAR, replace(measured(Features(), driven=True), commanded=True), None, False, 0.0)
    assert (found.verdict, found.kind) == ("other oscillation", "set point")


@pytest.mark.parametrize(("runner_up", "share"), [("dead zone", 0.9), ("none", 1.0)])
def test_a_limit_is_no_surer_than_its_kind(runner_up, share):
    clamp = fit_of(CLAMP, {"none": 0.0, "saturation": 50.0})
    found = verdict(Features(saturation=STRONG), replace(clamp, kinds=replace(clamp.kinds, runner_up=runner_up)))
    assert found.verdict == "saturation"
    assert found.confidence == pytest.approx(share * found.probabilities["actuator"])


@pytest.mark.parametrize(("low", "said"), [(0.0, "cannot tell"), (0.4, "dead zone")])
def test_a_dead_zone_that_may_have_no_width_is_not_named(monkeypatch, low, said):
    wide = fit_of(ZONE, {"none": 0.0, "dead zone": 50.0}, lm.Status.WIDE)
    monkeypatch.setattr(type(wide), "_interval", lambda fit, name, level, moves: (low, 3.0))
    found = verdict(Features(dead_zone=STRONG), wide)
    assert found.verdict == said
    assert ("of what size, if of any" in found.why) == (low == 0.0)


@pytest.mark.parametrize(("period", "said"), [(50.0, "stiction"), (5.0, "dead zone")])
def test_behind_a_process_slower_than_its_swing_a_dead_zone_swings_as_behind_a_level(period, said):
    zone = fit_of(ZONE, {"none": 0.0, "dead zone": 50.0, "stiction": 9.0})
    slow = replace(zone, model=replace(zone.model, linear=lm.LinearModel([-0.9], [0.1], 1, 1.0)))  # 9.5 samples
    assert decide(slow, measured(TRIANGLES, period=period), OWN, False, 0.0).verdict == said


def test_between_fault_and_none_nothing_is_said():
    between = 0.5 * (SURE + 1.0 - CLEARED)
    value = next(value for value in np.linspace(0, 9, 9001) if fault_probability(Features(memory=value)) > between)
    assert verdict(Features(memory=float(value))).verdict == "cannot tell"


def test_a_fault_that_does_not_stick_counts_by_itself():
    """That the trend does not look stuck says nothing of a dead zone."""
    zone, sine = Features(dead_zone=STRONG), Features(dead_zone=STRONG, waveform=-4.0)
    assert log_odds(zone)[1] == log_odds(sine)[1]
    assert log_odds(zone)[0] > log_odds(sine)[0]


def test_the_likelier_group_says_the_kind():
    """A limit that fits behind what looks stuck in every other way."""
    clamp = fit_of(CLAMP, {"none": 0.0, "saturation": 50.0, "stiction": 20.0})
    stuck = Features(memory=2.0, shape=0.05, waveform=4.0, saturation=1.0)
    assert verdict(stuck, clamp).verdict == "stiction"
    assert verdict(replace(stuck, saturation=STRONG), clamp).verdict == "saturation"


def test_a_controller_at_its_limit_is_a_saturation():
    assert verdict(SWING, limited=2 * LIMITED).verdict == "saturation"
    assert verdict(SWING, limited=0.5 * LIMITED).verdict == "other oscillation"


def test_a_valve_does_not_stick_where_op_stands_at_its_limit():
    sticking = fit_of(BAND, {"none": 0.0, "backlash": 50.0})
    assert verdict(Features(memory=STRONG), sticking, limited=0.5 * MOSTLY).verdict == "backlash"
    assert verdict(Features(memory=STRONG), sticking, limited=1.1 * MOSTLY).verdict == "saturation"


def test_a_wave_alone_does_not_make_a_valve_stick():
    wave, level = Features(shape=0.5, waveform=3.0), {"none": 0.0}
    found = verdict(wave)
    assert (found.verdict, found.kind) == ("cannot tell", "unknown")
    assert "wave" in found.why
    assert found.limit > 0.0
    assert (
        verdict(wave, fit_of(lm.Identity(), level), integrating=True).verdict == "stiction"
    )  # behind a level it hides


def test_a_dead_zone_in_a_loop_that_looks_stuck_is_not_named():
    """Each line of evidence would do by itself, and they name different faults."""
    fit = fit_of(ZONE, {"none": 0.0, "dead zone": 50.0})
    assert verdict(Features(dead_zone=STRONG), fit).verdict == "dead zone"
    found = verdict(Features(dead_zone=STRONG, shape=0.3, waveform=4.0), fit)
    assert (found.verdict, found.kind) == ("cannot tell", "unknown")
    assert "dead zone" in found.why
    assert "sticks" in found.why


@pytest.mark.parametrize(
    ("closed", "stay", "reach", "said"),
    [(True, 60, 9.0, "saturation"), (True, 20, 9.0, "cannot tell"), (True, 60, 4.0, "cannot tell"),
     (False, 20, 9.0, "saturation")],
)  # fmt: skip
def test_a_controller_winds_up_at_a_stop(closed, stay, reach, said):
    clamp = fit_of(CLAMP, {"none": 0.0, "saturation": 50.0})
    op = np.tile(np.r_[np.full(stay, 1.5), np.zeros(100 - stay)], 5)
    op[0] = 1.5 - reach
    data = replace(clamp.data, u=op, y=np.zeros(500), segments=np.array([[0, 500]]))
    clamp = replace(clamp, data=data, evidence=replace(clamp.evidence, closed_loop=closed))
    found = verdict(Features(saturation=STRONG), clamp)
    assert found.verdict == said
    assert ("runs far beyond" in found.why) == (said == "cannot tell")


def test_stops_that_leave_no_stroke_are_none():
    clamp = fit_of(CLAMP, {"none": 0.0, "saturation": 50.0})
    op = np.tile(np.r_[np.full(60, 1.5), np.zeros(40)], 5)
    op[0] = -200.0
    data = replace(clamp.data, u=op, y=np.zeros(500), segments=np.array([[0, 500]]))
    found = verdict(Features(saturation=STRONG), replace(clamp, data=data))
    assert found.verdict == "cannot tell"
    assert "no stroke" in found.why


@pytest.mark.parametrize(("foreknown", "gain", "named"), [(True, 10.0, False), (True, 50.0, True), (False, 10.0, True)])
def test_a_dead_zone_of_little_gain_is_not_named_where_the_controller_knows_more(foreknown, gain, named):
    fit = fit_of(ZONE, {"none": 0.0, "dead zone": gain})
    fit = replace(fit, evidence=replace(fit.evidence, foreknown=foreknown))
    found = verdict(Features(dead_zone=STRONG), fit)
    assert (found.verdict == "dead zone") is named
    assert ("knows more than the rows" in found.why) is not named


@pytest.mark.parametrize("status", NOT_SHOWN)
def test_a_dead_zone_that_is_not_shown_whole_is_not_named(status):
    found = verdict(Features(dead_zone=STRONG), fit_of(ZONE, {"none": 0.0, "dead zone": 50.0}, status))
    assert (found.verdict, found.kind) == ("cannot tell", "unknown")
    assert found.limit == example().fit.parameters["width"]
    assert "whole" in found.why


@pytest.mark.parametrize(("times", "said"), [(0, "never"), (1, "once"), (2, "twice"), (3, "3 times"), (4, "")])
def test_a_dead_zone_that_op_hardly_crosses_is_not_named(times, said):
    fit = fit_of(ZONE, {"none": 0.0, "dead zone": 50.0})
    left, right = fit.parameters["left"], fit.parameters["right"]
    ends = np.resize([right + 1.0, left - 1.0], times + 1)
    op = np.resize(np.repeat(ends, -(-fit.data.u.size // (times + 1))), fit.data.u.size)
    op[: fit.data.u.size // (2 * times + 2)] = 0.5 * (left + right)  # inside is no side
    counted = crossings(op, fit.data.segments, left, right)
    crossed = replace(fit, evidence=replace(fit.evidence, crossings=counted))
    found = verdict(Features(dead_zone=STRONG), crossed)
    assert (found.verdict == "dead zone") == (times >= FEWEST_CROSSINGS)
    assert said in found.why


def test_contributions_are_weight_times_value():
    found = verdict(Features(memory=2.0, dead_zone=0.5))
    assert found.contributions["memory"] == (2.0, 2.0 * WEIGHTS[NAMES.index("memory")])
    assert found.contributions["dead_zone"] == (0.5, 0.0)  # of the fault that is less likely: only shown
    assert "sine" not in found.contributions
    total = sum(part for _, part in found.contributions.values())
    assert total == pytest.approx(log_odds(Features(memory=2.0))[0] - log_odds(Features())[0])
    sticking, other = np.exp(log_odds(Features(memory=2.0, dead_zone=0.5)))
    assert found.probabilities["none"] == pytest.approx(1.0 / (1.0 + sticking + other))


def test_pv_that_follows_sp_swings_by_command_and_one_that_is_disturbed_does_not():
    rng, k = np.random.default_rng(2), np.arange(2000)
    sp = np.sin(2.0 * np.pi * k / 50.0 + 0.3 * np.sin(k / 300.0))
    follows = lm.LinearModel([-0.7], [0.3], 1).simulate(sp) + 0.05 * rng.normal(size=k.size)
    disturbed = follows + np.sin(2.0 * np.pi * k / 49.0)
    amplitude, coherence = _command(sp, follows, 50.0)
    assert amplitude > COMMANDED
    assert coherence > FOLLOWED
    assert _command(sp, disturbed, 50.0)[1] < FOLLOWED
    assert _command(sp, follows, np.nan) == (0.0, 0.0)
    assert _command(np.zeros(2000), follows, 50.0) == (0.0, 0.0)


@pytest.mark.parametrize("features", [Features(), SWING], ids=["none", "other oscillation"])
@pytest.mark.parametrize("status", [lm.Status.COLOURED, lm.Status.MISFIT])
def test_a_large_gain_that_is_no_evidence_is_not_denied(features, status):
    def found(gain):
        return verdict(features, fit_of(ZONE, {"dead zone": gain, "none": 0.0}, status))

    assert found(SEEN_TO_MISLEAD - 1.0).verdict in ("none", "other oscillation")
    assert (found(SEEN_TO_MISLEAD + 1.0).verdict, found(SEEN_TO_MISLEAD + 1.0).kind) == ("cannot tell", "unknown")
    assert found(112.0).why.startswith("a dead zone predicts PV far better (+112), too much to deny it")


def test_a_limit_is_seen_but_not_whose_fault_it_is():
    found = verdict(Features(waveform=-4.0), limited=2 * LIMITED)
    assert found.verdict == "saturation"
    assert found.confidence == SURE > found.probabilities["actuator"]


def test_a_swing_from_outside_does_not_deny_a_valve_that_sticks():
    weak = Features(memory=0.9)
    for actuator, said in ((BAND, "cannot tell"), (lm.Identity(), "other oscillation")):
        fit = fit_of(actuator, {actuator.kind: 7.3, "none": 0.0})
        found = decide(fit, measured(weak, driven=True), OWN, False, 0.0)
        assert found.probabilities["actuator"] < 1.0 - CLEARED
        assert found.verdict == said


@pytest.mark.parametrize(
    ("name", "excluded", "cleared"),
    [
        ("none", 0.5, True),
        ("other oscillation", 0.5, True),
        ("other oscillation", 1.5, False),
        ("cannot tell", 0.5, False),
        ("backlash", 0.5, False),
    ],
)
def test_cleared_is_what_leaves_nothing_open_that_matters(name, excluded, cleared):
    found = replace(example(), verdict=name, excluded={"backlash": excluded, "stiction": 0.1}, tolerance=1.0)
    assert found.cleared is cleared
    assert not replace(found, excluded={}).cleared


@pytest.mark.parametrize(
    ("model", "status", "names"),
    [("he", lm.Status.MISFIT, True), ("he ramp", lm.Status.OK, True), ("he ramp", lm.Status.MISFIT, False)],
)
def test_slips_between_the_rows_that_leave_a_structure_over_name_no_valve_where_only_pv_moves_op(model, status, names):
    fit = SimpleNamespace(
        status=status,
        model=SimpleNamespace(nonlinearity=lm.Stiction(3.0, 1.0, model)),
        evidence=SimpleNamespace(only_fed_back=True, closed_loop=True),
        kind=kind_of("stiction"),
        data=SimpleNamespace(unseen=SimpleNamespace(settled=False), sp=None),
        least_known=2.8,
    )
    assert (not_shown(fit) == "") == names


@pytest.mark.parametrize(
    ("model", "fed_back", "expected"),
    [("he ramp", True, (2.24, 3.34)), ("he ramp", False, (2.75, 3.25)), ("he", True, (2.75, 3.25))],
)
def test_the_size_of_a_valve_that_slips_between_the_rows_is_as_vague_as_the_delay(model, fed_back, expected):
    slips = slips_at_rest(lm.Stiction(3.0, 1.0, model=model), SimpleNamespace(only_fed_back=fed_back))
    assert with_model_error((2.9, 3.1), 3.0, kind_of("stiction"), slips) == pytest.approx(expected)
