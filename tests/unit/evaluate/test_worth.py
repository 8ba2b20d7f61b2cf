"""What a study recommends follows from its numbers, and its words say which."""

import pytest

import lostmotion as lm
from lostmotion.evaluate.limit_cycle import LimitCycle
from lostmotion.evaluate.study.study_result import LoopCase, MistakeCase
from lostmotion.evaluate.study.trial import Trial
from lostmotion.evaluate.study.worth import Decision, decide

NOW, TUNED = lm.PI(1.0, 0.1), lm.PI(0.5, 0.05)
BLOCK = lm.block_from_model(lm.Backlash(2.0), 1.0, op_noise=0.1)
NOISE = 0.1


def case(ratio=1.0, cycle=0.0, controller=NOW):
    return LoopCase(
        1.0, ratio, 1.0, 1.0, 1.0, ratio, 0.001, LimitCycle(cycle, 50.0 if cycle else float("nan"), cycle), None,
        controller,
    )  # fmt: skip


def decided(without=1.0, harm=False, **cases):
    """Ratio of the IAE and amplitude of the cycle by name; `harm`: the block is worse on one plausible plant."""
    made = {
        "without": case(cycle=without),
        "with": case(cycle=without),
        "retuned": case(cycle=without, controller=TUNED),
        "with, retuned": case(cycle=without, controller=TUNED),
        "no fault": case(),
    }
    for name, (ratio, cycle) in cases.items():
        key = {"block": "with", "both": "with, retuned", "mended": "no fault"}.get(name, name)
        made[key] = case(ratio, cycle, made[key].controller)
    ratio = 1.5 if harm else 0.9
    wrong = [MistakeCase("drawn", "draw 1", ratio, 1.0, LimitCycle(), LimitCycle(), 0.01)]
    return decide(made, wrong, wrong, BLOCK, NOISE)


def test_a_block_that_helps_and_is_safe():
    assert decided(block=(0.6, 0.0)).word == "compensate"
    assert decided(block=(0.6, 0.0)).safe


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"retuned": (0.6, 1.0)}, "RETUNING is worth it; a block adds nothing."),
        ({"retuned": (0.6, 1.0), "block": (0.6, 1.0), "both": (0.55, 1.0), "harm": True}, "a block is not safe."),
        ({"retuned": (0.6, 1.0), "harm": True}, "a block adds nothing and is not safe."),
        ({"retuned": (0.5, 1.0), "block": (0.8, 1.0), "both": (0.5, 1.0)}, "a block adds nothing to that"),
        ({"mended": (0.5, 0.0), "harm": True, "block": (0.6, 1.0), "both": (0.6, 1.0)}, "helps: a block is not safe"),
        ({"mended": (0.5, 0.0)}, "helps: a block adds nothing, and tuning alone does not help."),
    ],
)
def test_the_heading_says_which_of_the_two_holds(settings, said):
    found = decided(**settings)
    assert said in found.reasons[0]
    assert found.word == ("maintain" if "mended" in settings else "retune")


def test_a_calmer_loop_is_not_worth_it_where_its_error_grows():
    assert decided(retuned=(1.04, 0.1), mended=(1.0, 1.0)).word == "leave"
    assert decided(retuned=(1.0, 0.1)).word == "retune"


def test_a_cycle_within_the_noise_is_no_reason():
    assert decided(without=0.5 * NOISE, retuned=(1.0, 0.0), mended=(1.0, 0.0)).word == "leave"
    assert decided(without=2.0 * NOISE, retuned=(1.0, 0.0), mended=(1.0, 0.0)).word == "retune"


@pytest.mark.parametrize("ratio", [0.5, 0.94, 0.96, 1.0, 1.04, 1.5])
@pytest.mark.parametrize("cycle", [0.0, 0.4, 1.0])
def test_retuning_is_never_recommended_against_its_own_line(ratio, cycle):
    found = decided(retuned=(ratio, cycle))
    line = next(text for text in found.reasons if text.startswith("Retuning alone"))
    assert (found.word == "retune") == ("not worth it" not in line)
    assert found.word != "retune" or "rises" not in line


@pytest.mark.parametrize(("ratio", "swing", "safe"), [(1.1, 0.0, True), (1.3, 0.0, False), (0.8, 0.3, False)])
def test_a_fifth_too_much_is_a_trial_of_strength(ratio, swing, safe):
    """A little more error is borne there, much more, or a cycle that was not there, is not."""
    cases = {
        "without": case(cycle=1.0), "with": case(0.6), "retuned": case(controller=TUNED),
        "with, retuned": case(controller=TUNED), "no fault": case(0.5),
    }  # fmt: skip
    wrong = [MistakeCase("20 %", "width 20 % too large", ratio, 9.0, LimitCycle(), LimitCycle(swing, 9.0, 1.0), 0.01)]
    found = decide(cases, wrong, wrong, BLOCK, NOISE)
    assert found.safe == safe
    assert found.useful
    assert found.brief[1].startswith("The block: ")
    assert found.adding("So it is.").reasons[:2] == (found.reasons[0], "So it is.")


@pytest.mark.parametrize(
    ("without", "swing", "ratio", "travel", "said"),
    [
        (0.4, 0.5, 0.7, 9.0, "on 1 a limit cycle up to 1.2 times as large as without"),
        (0.4, 0.5, 0.95, 9.0, ""),
        (0.4, 0.9, 0.7, 9.0, ""),
        (0.0, 0.05, 0.7, 9.0, ""),
        (0.0, 0.05, 0.7, 2.0, "on 1 a limit cycle, +-0.05 in PV at most, that is not there without"),
        (0.0, 0.05, 0.95, 2.0, ""),
    ],
)
def test_a_cycle_is_borne_where_the_error_is_clearly_less(without, swing, ratio, travel, said):
    """In a loop that cycles anyway, or with a valve that hardly travels more."""
    cases = {name: case(0.6 if name == "with" else 1.0) for name in ("without", "with", "retuned", "with, retuned")}
    cases["no fault"] = case(0.5)
    cycles = [LimitCycle(size, 9.0, 1.0) for size in (without, swing)]
    found = decide(cases, [MistakeCase("20 %", "band too large", ratio, travel, *cycles, 0.01)], [], BLOCK, NOISE)
    assert found.safe == bool(said)
    assert said in found.brief[2]


@pytest.mark.parametrize(("safe_below", "factor"), [(0.7, 0.6), (0.9, 0.8), (0.1, 1.0)])
def test_smaller_shares_are_tried_and_said_where_none_is_safe(safe_below, factor):
    def tried(block):
        safe = block.settings["factor"] < safe_below
        return Trial(block, {}, {}, (), (), Decision("maintain", True, safe, ("A.", "B."), ("A.",)), tried)

    found = tried(BLOCK.with_settings(factor=1.0)).or_safer(lambda share: BLOCK.with_settings(factor=share))
    assert found.block.settings["factor"] == factor
    none = "Of 80 % and 60 % of the lost motion none is safe and helps."
    assert (none in found.decision.reasons and none in found.decision.brief) == (factor == 1.0)
