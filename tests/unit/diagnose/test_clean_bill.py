"""What a record excludes, and what that makes of a verdict."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.diagnose.clean_bill import CARRIES, CleanBill, clean_bill, how_to_tell, untold
from lostmotion.diagnose.excitation import ONLY_PV, SMOOTH_SP, only_fed_back
from lostmotion.diagnose.features import SILENT, Features, Measured
from lostmotion.diagnose.op_span import OpSpan, op_span
from lostmotion.diagnose.shown import loads_at_moves
from lostmotion.diagnose.verdict import Verdict
from lostmotion.identify.actuators.kind import kind_of
from lostmotion.report import fit_text
from tests.support.diagnoses import example, loop_record, variant

PERCENT = OpSpan(0.0, 100.0, known=True)
FLOW = lm.LinearModel([-0.9], [0.1], 2)


def bill(**excluded):
    return CleanBill({name.replace("_", " "): size for name, size in excluded.items()}, 1.0, PERCENT)


def said(verdict, kind="none"):
    return Verdict(verdict, kind, 0.8, {"none": 0.8, "actuator": 0.2}, {})


def measured(share=0.0, driven=False, commanded=False):
    swing = replace(SILENT, share=share)
    return Measured(Features(), swing, SILENT, 50.0 if share else np.nan, False, {}, driven, commanded)


def loop(valve, seed, noise=0.05, n=1500, step=4.0):
    """Flow loop with moves of its set point every 100 samples."""
    sp = step * np.repeat(np.random.default_rng(seed).choice([-1.0, 0.0, 1.0], n // 100), 100)
    made = lm.simulate_loop(lm.Hammerstein(valve, FLOW), lm.PI(0.5, 0.1), sp, noise=noise, seed=seed)
    return lm.LoopRecord(50 + made.control, 50 + made.measured, 50 + sp, dt=1.0, op_span=(0.0, 100.0))


def excluded(record):
    return lm.identify(record, nonlinearity="auto").kinds.excluded


@pytest.mark.parametrize(
    ("open_sizes", "verdict"),
    [
        ({"dead_zone": 0.5, "backlash": 0.2}, "none"),
        ({"dead_zone": 0.5, "backlash": 1.2}, "cannot tell"),
        ({"dead_zone": np.inf, "backlash": 0.2}, "cannot tell"),
        ({}, "cannot tell"),  # nothing was looked for
    ],
)
def test_none_is_said_only_where_all_sizes_are_below_the_tolerance(open_sizes, verdict):
    found = bill(**open_sizes).weigh(said("none"), measured(), 2.0)
    assert found.verdict == verdict
    assert bool(found.why) == (verdict == "cannot tell")


def test_a_swing_is_not_from_outside_while_a_fault_could_carry_it():
    op = 3.0 / np.sqrt(8.0)  # all of it a sine of 3 from end to end
    small, large = bill(backlash=0.9 * CARRIES * 3.0), bill(backlash=1.1 * CARRIES * 3.0)
    other = said("other oscillation", "tuning")
    assert small.weigh(other, measured(1.0), op) is other
    assert large.weigh(other, measured(1.0), op).verdict == "cannot tell"
    assert large.weigh(other, measured(1.0, driven=True), op) is other  # a load swings so: OP answers it


def test_pv_that_follows_sp_says_nothing_of_the_valve():
    commanded, other = measured(1.0, driven=True, commanded=True), said("other oscillation", "set point")
    assert bill(backlash=0.9).weigh(other, commanded, 50.0) is other
    found = bill(backlash=1.1).weigh(replace(other, confidence=0.95), commanded, 50.0)
    assert (found.verdict, found.kind, found.limit) == ("cannot tell", "unknown", 1.0)


def test_no_dead_zone_is_excluded_where_a_valve_that_bends_is_far_ahead():
    fit = example().fit
    kinds = replace(
        fit.kinds, best="none", excluded={"dead zone": 0.3, "backlash": 0.2, "stiction": 0.2},
        likelihoods={"none": 0.0, "dead zone": 276.0}, firm={"none": 0.0, "dead zone": -50.0},
    )  # fmt: skip
    evidence = replace(fit.evidence, answered=True, foreknown=False)

    def of(kinds):
        return clean_bill(replace(fit, kinds=kinds, evidence=evidence, status=lm.Status.OK), 0.01, PERCENT).excluded

    assert of(kinds) == {"dead zone": np.inf, "backlash": 0.2, "stiction": 0.2}
    small = replace(kinds, firm={"none": 0.0, "dead zone": -12.0})
    assert of(small)["dead zone"] == 0.3


@pytest.mark.parametrize("verdict", ["dead zone", "stiction", "saturation", "cannot tell"])
def test_other_verdicts_stay(verdict):
    one = said(verdict, "actuator")
    assert bill(backlash=50.0).weigh(one, measured(), 1.0) is one


def test_advice_names_the_test_and_how_much_more_of_the_same():
    test, more = how_to_tell(2.0, 1.0, untold(np.zeros(9)))
    assert "SP does not move" in test
    assert "4 times as much" in more
    assert len(how_to_tell(np.inf, 1.0)) == 1


def test_a_record_without_sp_is_not_said_to_have_one_that_rests():
    assert untold(None) == "this record holds no SP, and its moves of OP do not tell"
    assert untold(np.arange(3.0)) == "the moves in this record do not tell"


@pytest.mark.parametrize("tolerance", [0.0, 1.0, -0.1, np.nan])
def test_a_tolerance_is_a_share(tolerance):
    with pytest.raises(lm.ParameterError, match="share of the span"):
        clean_bill(example().fit, tolerance, PERCENT)


def test_span_of_op():
    record = loop_record()
    assert op_span(record).ends == (0.0, 100.0)
    assert op_span(replace(record, op=record.op / 100.0)).ends == (0.0, 1.0)
    assert not op_span(replace(record, op=record.op + 80.0)).known
    assert op_span(replace(record, op_span=(-5.0, 105.0))).note == ""


def test_report_names_the_largest_size():
    text = variant("none", "none").summary()
    assert "no lost motion over 0.6 % of span" in text
    assert "does not exclude (95 %)" in text
    why = variant("cannot tell", "unknown", why="backlash up to 5 % of span is not excluded").summary()
    assert "CANNOT TELL: backlash up to 5 % of span is not excluded." in why


@pytest.mark.statistics
def test_a_sound_valve_that_is_moved_is_cleared():
    found = lm.diagnose(loop(lm.Identity(), 3))
    assert found.verdict == "none"
    assert max(found.excluded.values()) < found.tolerance == 1.0
    assert lm.diagnose(loop(lm.Identity(), 3), tolerance=1e-4).verdict == "cannot tell"


@pytest.mark.statistics
def test_a_record_in_which_op_does_nothing_excludes_nothing():
    random = np.random.default_rng(1)
    op, pv = np.repeat(random.normal(size=40), 25), random.normal(size=1000)
    assert max(excluded(lm.LoopRecord(op, pv, dt=1.0)).values()) == np.inf


@pytest.mark.statistics
@pytest.mark.parametrize("kind", ["backlash", "dead zone"])
def test_a_size_too_small_to_be_seen_is_below_the_bound(kind):
    """In 95 of 100; 8 loops of each kind for CI."""
    size, held, counted = 0.12, 0, 0
    valve = lm.Backlash(size) if kind == "backlash" else lm.DeadZone(-size / 2, size / 2)
    for seed in range(8):
        sizes = excluded(loop(valve, seed, noise=0.3))
        if sizes:
            counted, held = counted + 1, held + (sizes[kind] >= size)
    assert counted >= 6
    assert held >= counted - 1


SET_POINT = np.repeat([0.0, 1.0], 50)


@pytest.mark.parametrize(
    ("closed", "free", "sp", "said"),
    [
        (True, 0.0, None, True),
        (True, 0.005, np.zeros(100), True),
        (True, 0.02, np.zeros(100), False),  # something else moves OP as well
        (True, 0.005, SET_POINT, False),
        (True, 1e-4, SET_POINT, True),  # it moves, but that is not what moves OP
        (False, 0.0, None, False),
    ],
)
def test_whether_nothing_but_pv_moves_op(closed, free, sp, said):
    assert only_fed_back(closed, free, sp) is said


def held(valve, seed, n=2000):
    """Loop at a constant set point: loads move it, and OP is the controller's answer to PV and nothing else."""
    rng = np.random.default_rng(seed)
    load = lm.LinearModel([-0.98], [0.2], 1).simulate(rng.normal(size=n))
    plant = lm.Hammerstein(valve, lm.LinearModel([-1.6, 0.64], [0.04], 3))
    moved = FLOW.simulate(load)
    made = lm.simulate_loop(plant, lm.PI(0.5, 0.02), np.zeros(n), disturbance=moved, noise=0.05, seed=seed)
    return lm.LoopRecord(50 + made.control, 50 + made.measured, dt=1.0, op_span=(0.0, 100.0))


@pytest.mark.statistics
def test_a_loop_in_which_only_pv_moves_op_excludes_nothing():
    record = held(lm.Identity(), 5)
    fit = lm.identify(record, nonlinearity="auto")
    assert fit.evidence.closed_loop
    assert fit.evidence.free_moves < 1e-6
    assert only_fed_back(fit.evidence.closed_loop, fit.evidence.free_moves, None)
    found = clean_bill(fit, 0.01, PERCENT, fed_back=True)
    assert set(found.excluded.values()) == {np.inf}
    cannot = found.weigh(said("none"), measured(), 2.0)
    assert cannot.verdict == "cannot tell"
    assert "nothing but PV moves OP" in cannot.why
    assert lm.diagnose(record).verdict != "none"


@pytest.mark.statistics
def test_where_a_smooth_sp_moves_op_it_is_not_said_that_only_pv_does():
    """SP follows a sine, PV lags behind: past OP and PV foretell what it does to OP, and that is what is said."""
    record = held(lm.Identity(), 5)
    fit = lm.identify(record, nonlinearity="auto")
    wave = np.sin(np.arange(fit.data.u.size) / 50.0)
    for sp, moved in ((None, ONLY_PV), (0.0 * wave, ONLY_PV), (wave, SMOOTH_SP)):
        asked = replace(fit, data=replace(fit.data, sp=sp))
        found = clean_bill(asked, 0.01, PERCENT, fed_back=True)
        assert found.why == f"{moved}, so that the record does not tell the process from its controller"
        unseen = SimpleNamespace(kind=kind_of("backlash"), evidence=fit.evidence, data=asked.data)
        assert fit_text._unseen(unseen, 100.0).startswith(f"{moved[0].upper()}{moved[1:]} in this record, which")


@pytest.mark.statistics
@pytest.mark.parametrize(
    ("status", "free", "excludes"),
    [
        (lm.Status.NOT_REPRODUCED, 0.9, False),
        (lm.Status.MISFIT, 0.3, False),
        (lm.Status.MISFIT, 0.6, True),  # OP is moved from outside: what it does to PV is seen all the same
        (lm.Status.OK, 0.3, True),
    ],
)
def test_a_model_that_does_not_describe_the_record_excludes_nothing(status, free, excludes):
    fit = lm.identify(loop(lm.Identity(), 3), nonlinearity="auto")
    fit = replace(fit, status=status, evidence=replace(fit.evidence, free_moves=free))
    found = clean_bill(fit, 0.01, PERCENT)
    assert (set(found.excluded.values()) != {np.inf}) == excludes
    assert ("does not describe" in found.why) != excludes


@pytest.mark.parametrize(
    ("steps", "hides"),
    [
        ((101, 103, 303, 305, 700), True),
        ((101, 103, 303, 650), False),  # three may stand there
        ((150, 250, 350, 450, 550), False),
        ((101, 150, 250, 303, 350, 450, 505, 550, 600, 650, 707, 750), True),
    ],
)
def test_steps_of_load_where_sp_moves_hide_what_the_valve_does(steps, hides):
    sp = np.zeros(900)
    for number, row in enumerate((100, 300, 500, 700)):
        sp[row:] = number + 1.0
    chosen = SimpleNamespace(loads=tuple({"step_at": row} for row in steps))
    fit = SimpleNamespace(chosen=chosen, data=SimpleNamespace(sp=sp, u=np.zeros(900)))
    assert loads_at_moves(fit) is hides
    fit.data.sp = None
    assert not loads_at_moves(fit)


@pytest.mark.statistics
def test_beside_loads_at_moves_of_sp_nothing_is_excluded():
    fit = lm.identify(loop(lm.Identity(), 3), nonlinearity="auto")
    moves = 1 + np.flatnonzero(np.diff(fit.data.sp))[:5]
    assert moves.size == 5
    loads = tuple({"step_at": float(row + 2)} for row in moves)
    found = clean_bill(replace(fit, chosen=replace(fit.chosen, loads=loads)), 0.01, PERCENT)
    assert set(found.excluded.values()) == {np.inf}
    assert "where SP moves" in found.why
