"""The whole way: each gate closes it, says what opens it, and a reason goes on."""

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.cli.next_steps import command_lines
from lostmotion.cli.options import RecordOptions
from lostmotion.design.request import shortest_duration
from lostmotion.errors import GateError, ParameterError
from lostmotion.evaluate import solve as way
from lostmotion.evaluate.solution import OUTCOMES, STEPS, Solution, Step
from lostmotion.identify.actuators.choice import KindChoice
from tests.support.diagnoses import example, loop_record
from tests.support.fits import made_fit
from tests.support.refusals import refusal

solving = __import__("sys").modules["lostmotion.evaluate.solve"]
RECORD = lm.LoopRecord(50.0 + np.sin(np.arange(400.0) / 9), np.cos(np.arange(400.0) / 9), dt=0.5)


@pytest.fixture
def steps(monkeypatch):
    """The way with a diagnosis and a study made by hand."""

    def go(verdict="backlash", kind="backlash", status=lm.Status.OK, study=None, **options):
        fit = made_fit(kind, status)
        found = replace(example(), verdict=verdict, fit=fit)
        monkeypatch.setattr(solving, "diagnose", lambda *_, **__: found)
        monkeypatch.setattr(solving, "compensation_study", study or studied())
        return way(RECORD, **options)

    return go


def studied(recommendation="compensate", safe=True, useful=False):
    """A study with this result."""

    @dataclass
    class Study:
        recommendation: str
        safe: bool
        useful: bool
        block: lm.CompensatorBlock
        reasons: tuple = ("It is worth it.", "The block: better.")
        brief: tuple = ("It is worth it.", "The block: better.")
        cases = dict.fromkeys(("retuned", "with, retuned"), type("Case", (), {"controller": lm.PI(1.23456, 0.0345678)}))

        def to_dict(self):
            return {}

    def run(fit, controller, record, accept, **_):
        return Study(recommendation, safe, useful or recommendation == "compensate", fit.block(accept=accept))

    return run


def test_all_gates_open(steps):
    found = steps()
    assert (found.outcome, found.closed) == ("block", None)
    assert [step.name for step in found.steps] == list(STEPS)
    assert found.block == found.study.block
    assert not found.block.accepted
    assert found.summary().startswith("A BLOCK came out")
    assert json.loads(json.dumps(found.to_dict(), allow_nan=False))["outcome"] in OUTCOMES


def test_nothing_wrong_is_an_end_of_its_own(steps):
    found = steps(verdict="none")
    assert (found.outcome, found.block, found.closed) == ("nothing wrong", None, None)
    assert "NOTHING WRONG" in str(found)


@pytest.mark.parametrize(
    ("settings", "name"),
    [
        ({"verdict": "cannot tell"}, "diagnose"),
        ({"verdict": "other oscillation"}, "diagnose"),
        ({"verdict": "saturation", "kind": "saturation"}, "diagnose"),
        ({"verdict": "stiction"}, "identify"),
        ({"status": lm.Status.WIDE}, "identify"),
        ({"status": lm.Status.NOT_CONVERGED}, "identify"),
        ({"study": studied("leave")}, "simulate"),
        ({"study": studied("compensate", safe=False)}, "simulate"),
        ({"study": studied("compensate and retune")}, "simulate"),
    ],
)
def test_the_first_closed_gate_ends_it(steps, settings, name):
    found = steps(**settings)
    assert (found.outcome, found.closed.name, found.block) == ("closed", name, None)
    assert found.closed.remedy
    assert f"the gate at step {name!r} is closed" in found.summary()
    sized = settings.get("kind") != "saturation"
    assert found.closed.acceptable == sized
    passed = steps(**settings, accept="seen on the bench")
    assert (passed.outcome == "block") == sized
    if sized:
        assert "seen on the bench" in passed.block.accepted
        assert "seen on the bench" in passed.summary()


def rivals_of(monkeypatch, safe_up_to, retuned=False):
    """A record that stiction explains as well as the backlash that is preferred; blocks tried, by kind of valve."""
    fit = made_fit("backlash", lm.Status.OK)
    likelihoods = {"none": 0.0, "backlash": 123.0, "stiction": 124.9, "dead zone": 60.0}
    kinds = KindChoice("backlash", likelihoods, likelihoods, likelihoods, 0.99, "stiction")
    found = replace(example(), verdict="backlash", fit=replace(fit, kinds=kinds))
    tried = []

    def study(fit, *given, block=None, factor=1.0, **options):
        made = studied("compensate and retune" if retuned else "compensate", useful=True)(fit, *given, **options)
        made.block = fit.block(accept=options["accept"], factor=factor) if block is None else block
        tried.append((fit.kind.name, round(made.block.settings["factor"], 3)))
        made.safe = block is None or made.block.settings["factor"] <= safe_up_to
        return made

    monkeypatch.setattr(solving, "identify", lambda *_, nonlinearity, **__: made_fit(nonlinearity, lm.Status.OK))
    monkeypatch.setattr(solving, "diagnose", lambda *_, **__: found)
    monkeypatch.setattr(solving, "compensation_study", study)
    return tried


@pytest.mark.parametrize("safe_up_to", [1.0, 0.7, 0.0])
def test_a_block_must_be_safe_on_the_kind_that_is_as_likely(monkeypatch, safe_up_to):
    """Backlash is the simpler of two that explain the record as well; its block may do harm to a valve that slips."""
    tried = rivals_of(monkeypatch, safe_up_to)
    made = way(RECORD)
    shares = {1.0: [1.0], 0.7: [1.0, 0.8, 0.6], 0.0: [1.0, 0.8, 0.6]}[safe_up_to]
    assert tried == [(kind, share) for share in shares for kind in ("backlash", "stiction")]
    assert made.outcome == ("block" if safe_up_to else "closed")
    if safe_up_to == 0.7:
        words = "compensates 60 % of the lost motion: stiction explains the record as well"
        assert words in " ".join(made.summary().split())
        assert any("as likely" in note for note in made.block.notes)
        assert made.block.settings["factor"] == 0.6
    if not safe_up_to:
        assert made.closed.name == "simulate"
        assert "stiction" in made.closed.said
        assert way(RECORD, accept="anna has seen the stem").outcome == "block"


def test_a_share_that_was_asked_for_is_tried_as_it_is(monkeypatch):
    tried = rivals_of(monkeypatch, safe_up_to=0.7)
    assert way(RECORD, factor=0.9).closed.name == "simulate"
    assert tried == [("backlash", 0.9), ("stiction", 0.9)]


def test_a_block_with_a_retuned_controller_is_tried_on_it_too(monkeypatch):
    tried = rivals_of(monkeypatch, safe_up_to=0.0, retuned=True)
    assert way(RECORD, retune=True).closed.name == "simulate"
    assert tried == [("backlash", 1.0), ("stiction", 1.0)]


def test_several_gates_leave_each_reason_once(steps):
    found = steps(status=lm.Status.WIDE, study=studied("leave"), accept="the stem was seen")
    assert found.block.accepted.count("the stem was seen") == 2
    assert "WIDE" in found.block.accepted
    assert "worth it and safe" in found.block.accepted


def test_gains_that_open_it_are_said(steps):
    found = steps(study=studied("compensate and retune"))
    assert found.closed.settings == {"retune": True}
    assert "retune to Kp 1.235, Ki 0.03457 1/s when the block goes in" in found.closed.remedy
    lines = command_lines(found, Path("FIC 1.csv"), RecordOptions(op="CO", dt=0.5), {"kp": 9.0, "loop_type": "flow"})
    assert lines[0] == "lostmotion solve 'FIC 1.csv' --op CO --dt 0.5 --kp 9 --loop-type flow --retune"
    assert lines[-1].endswith('--accept "REASON"')
    block = steps(study=studied("compensate and retune"), retune=True).block
    assert block.notes[-1] == "only with the controller at Kp 1.235, Ki 0.03457 1/s"
    assert steps(study=studied("maintain"), retune=True).closed.name == "simulate"
    alone = steps(study=studied("retune")).closed
    assert "to Kp 1.235, Ki 0.03457 1/s" in alone.remedy
    assert not alone.settings


def test_a_block_that_is_safe_as_it_is_needs_no_retuning(steps):
    """It would help still more with it: that is said, and no gate."""
    found = steps(study=studied("compensate and retune", useful=True))
    assert (found.outcome, found.closed) == ("block", None)
    assert "only with the controller" not in found.block.notes[-1]
    both = steps(study=studied("compensate and retune", useful=True), retune=True)
    assert "only with the controller" in both.block.notes[-1]
    assert steps(study=studied("compensate and retune", safe=False, useful=True)).closed.name == "simulate"


def test_what_is_pasted_writes_where_it_was_to_be_written(steps):
    found = steps(study=studied("compensate and retune"))
    lines = command_lines(found, Path("a.csv"), RecordOptions(), {"out": Path("b.json")})
    assert lines[0] == "lostmotion solve a.csv --out b.json --retune"


def test_no_reason_helps_where_the_loop_cannot_be_simulated(steps):
    def refused(*_, **__):
        error = ParameterError.expected("a span that holds the OP", "(0, 1)", "give span=(low, high)")
        raise error.leads_on({"span": (-2.9, 3.1)})

    found = steps(study=refused, accept="why not")
    assert not found.closed.acceptable
    for options in (RecordOptions(), RecordOptions(op_span=(0.0, 1.0))):
        lines = command_lines(found, Path("a.csv"), options, {"known_gain": 2.0})
        assert lines == ["lostmotion solve a.csv --op-span -2.9 3.1 --known-gain 2"]

    def gate(*_, **__):
        raise GateError.expected("a model that reproduces the record", "another", "identify again")

    assert steps(study=gate).closed.acceptable


@pytest.mark.parametrize("kind", ["dead zone", "none"])
def test_where_the_record_does_not_tell_a_test_is_designed(steps, kind):
    found = steps(verdict="cannot tell", kind=kind, status=lm.Status.WIDE)
    lines = command_lines(found, Path("a.csv"), RecordOptions(), {})
    assert lines[0].startswith("lostmotion identify a.csv")
    assert lines[1].startswith("lostmotion design --fit a.fit.json")
    assert ("--left" in lines[1]) == (kind != "dead zone")


@pytest.mark.parametrize(
    ("verdict", "kind"), [("cannot tell", "backlash"), ("stiction", "stiction"), ("backlash",) * 2]
)
def test_a_kind_that_design_does_not_know_has_its_test_in_words(steps, verdict, kind):
    found = steps(verdict=verdict, kind=kind, status=lm.Status.WIDE)
    lines = command_lines(found, Path("a.csv"), RecordOptions(), {})
    assert not any("design" in line for line in lines)
    assert "in manual, step OP from" in lines[0]


@pytest.mark.parametrize("kind", ["dead zone", "none"])
def test_what_is_known_of_the_loop_is_said_in_all_lines(steps, kind):
    found = steps(verdict="cannot tell", kind=kind, status=lm.Status.WIDE)
    known = {"known_gain": 2.0, "integrating": False, "loop_type": "flow"}
    identify, _, diagnose, *_ = command_lines(found, Path("a.csv"), RecordOptions(), known)
    assert "--self-regulating" in identify
    assert ("--gain 2" in identify) == (kind == "dead zone")
    assert diagnose == "lostmotion diagnose a.csv --loop-type flow --self-regulating"
    again = command_lines(found, Path("a.csv"), RecordOptions(), {"integrating": True})
    assert "--integrating" in again[0]


def printed(fit, linear):
    """Lines for a record that does not tell, whose fit without a fault is another."""
    found = Solution("closed", (Step("diagnose", False, "no", "test"),), replace(example(), verdict="cannot tell"), fit)
    return command_lines(found, Path("a.csv"), RecordOptions(), {}, lambda: linear)


def test_the_test_lasts_as_long_as_design_asks():
    slow = lm.LinearModel.from_continuous([1.0], [1.0, 1.0], 30.0, 0.5)
    facts = made_fit("none").facts
    facts = replace(facts, model=replace(facts.model, linear=slow))
    words = printed(made_fit("none"), facts)[1].split()
    assert float(words[words.index("--duration") + 1]) >= shortest_duration(slow) > 120.0


def test_no_test_is_designed_for_a_process_that_is_not_known_or_takes_days():
    facts = made_fit("none").facts
    days = lm.LinearModel.from_continuous([1.0], [1e5, 1.0], 0.0, 10.0)
    for linear in (
        replace(facts, status=lm.Status.NO_PROCESS),
        replace(facts, model=replace(facts.model, linear=days)),
    ):
        lines = printed(made_fit("none"), linear)
        assert not any(line.startswith(("lostmotion design", "lostmotion identify")) for line in lines)
        assert "in manual, step OP from" in lines[0]


def test_a_level_is_tested_within_limits_of_pv():
    fit = made_fit("dead zone", lm.Status.WIDE, integrating=True)
    diagnosis = replace(example(), verdict="cannot tell", fit=fit)
    found = Solution("closed", (Step("diagnose", False, "no", "test"),), diagnosis, fit)
    words = command_lines(found, Path("a.csv"), RecordOptions(), {})[1].split()
    low, high = (float(words[words.index("--pv-limits") + place]) for place in (1, 2))
    assert low < float(words[words.index("--pv-now") + 1]) < high
    assert high - low < 1.2 * np.ptp(fit.data.y)


def test_a_record_that_cannot_be_used_ends_at_the_check():
    found = way(lm.LoopRecord(np.full(300, 42.0), np.arange(300.0) % 7, dt=1.0))
    assert found.closed.name == "check"
    assert command_lines(found, Path("a.csv"), RecordOptions(), {}) == ["lostmotion check a.csv"]
    assert "reason in words" in refusal(ParameterError, way, loop_record(), accept=" ")


def test_a_span_of_other_units_is_no_saturation():
    op = 2.0 * np.sin(np.arange(400) / 9.0)
    found = lm.solve(lm.LoopRecord(op, np.r_[0.0, op[:-1]], dt=1.0, op_span=(0.0, 100.0)))
    assert found.closed.name == "check"
    assert "runs from -2 to 2" in found.closed.remedy
    lines = command_lines(found, Path("a.csv"), RecordOptions(op_span=(0.0, 100.0)), {})
    assert lines == ["lostmotion solve a.csv"]


def test_the_span_that_is_proposed_holds_op_and_what_the_block_adds():
    fit = made_fit("dead zone")
    (least, most), half = fit.facts.op_range, 0.5 * fit.parameters["width"]
    with pytest.raises(ParameterError) as caught:
        fit.block(span=(least + 1e-3, most))
    low, high = caught.value.ways[0]["span"]
    assert low <= least - half
    assert most + half <= high
    assert high - low < 1.25 * (most - least + 2.0 * half)
    assert fit.block(span=(low, high)).kind == "dead zone"
