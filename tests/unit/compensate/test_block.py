import ast
import inspect
import json
import pickle
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.compensate import (
    SPECIFICATIONS,
    BacklashCompensator,
    CompensatorBlock,
    block_from_fit,
    block_from_model,
)
from lostmotion.errors import DataError, GateError, InputError, ParameterError, Status
from lostmotion.kernels.blocks import core as safeguards
from lostmotion.records.white_noise import noise_of
from tests.support.refusals import refusal

NAN = float("nan")
ZONE = lm.DeadZone(48, 52)
KINDS = sorted(SPECIFICATIONS)


@pytest.fixture(scope="module")
def fit():
    model = lm.Hammerstein(lm.DeadZone(-1.0, 1.0), lm.LinearModel([-0.8], [0.2], 1, 0.5))
    u = lm.signals.prs(600, -5, 5, 7, seed=0)
    y = model.simulate(u) + np.random.default_rng(0).normal(scale=0.1, size=600)
    return lm.identify(u, y, dt=0.5, orders=(1, 0, 1), noise="white", offset="zero", nonlinearity="dead zone")


@pytest.mark.parametrize("kind", KINDS)
def test_table_and_kernel_have_the_same_order(kind):
    specification = SPECIFICATIONS[kind]
    for section in ("parameter", "input", "state", "output"):
        names = [variable.name for variable in specification.section(section)]
        assert [specification.index(name) for name in names] == list(range(len(names)))
    assert len({variable.name for variable in specification.variables}) == len(specification.variables)
    assert len(specification.section("state")) == specification.module.SIZE
    assert {variable.kind for variable in specification.variables} == {"real", "bool", "int"}
    assert all(variable.meaning for variable in specification.variables)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_has_the_same_order_of_a_scan(kind):
    """The language of the PLC has no function arguments, so each kind writes it out."""
    module = SPECIFICATIONS[kind].module
    own = module.__name__.rpartition(".")[2]
    step = getattr(module.step, "py_func", module.step)
    calls = [node.func.id for node in ast.walk(ast.parse(inspect.getsource(step))) if isinstance(node, ast.Call)]
    order = ["check", f"check_{own}", "prepare", "correct", "drive", "return_path", "invert", "report"]
    taken = ["take", f"take_{own}"]
    found = [name for name in calls if name not in ("njit", *taken)]
    assert found == [name for name in order if name != "invert" or hasattr(module, "invert")]
    assert [name for name in calls if name in taken] == taken


CALLS = {"min", "max", "abs", "njit", "range"}


@pytest.mark.parametrize("module", [safeguards, *(SPECIFICATIONS[kind].module for kind in KINDS)])
def test_kernels_keep_to_the_language_of_the_plc(module):
    functions = {
        node.name: node for node in ast.parse(inspect.getsource(module)).body if isinstance(node, ast.FunctionDef)
    }
    for function in functions.values():
        for node in ast.walk(ast.Module(function.body[1:], [])):
            assert not isinstance(
                node, ast.For | ast.While | ast.Return | ast.AugAssign | ast.Tuple | ast.IfExp | ast.Pow
            )
            if isinstance(node, ast.Constant):
                assert node.value in (0.0, 1.0)
                assert type(node.value) is float
            if isinstance(node, ast.Subscript):
                assert node.value.id in ("p", "s", "i", "o")
                assert node.slice.id.isupper()
                assert node.value.id in ("s", "o") or isinstance(node.ctx, ast.Load)
            if isinstance(node, ast.Compare):
                assert len(node.ops) == 1
            if isinstance(node, ast.Call) and node.func.id not in CALLS:
                assert [argument.id for argument in node.args] == ["p", "s", "i", "o"]


@pytest.mark.parametrize("kind", KINDS)
def test_step_is_run(kind):
    block = CompensatorBlock.of(kind, 0.1, {"ramp_step": 0.5})
    rng = np.random.default_rng(1)
    op, enable = 50 + np.cumsum(rng.normal(size=60)), rng.random(60) < 0.8
    expected = block.run(op, enable)
    found = [block.step(value, on) for value, on in zip(op, enable, strict=True)]
    np.testing.assert_array_equal(found, expected.op_out)
    assert block.last["reversals"] == expected.reversals[-1]
    block.reset()
    assert block.step(op[0], enable[0]) == found[0]
    np.testing.assert_array_equal(block(op), block.run(op).op_out)
    assert len(expected) == 60


def test_a_block_saved_under_the_former_name_of_the_ramp():
    block = CompensatorBlock.of("backlash", 0.5, {"lead_up": 1.0, "ramp_step": 0.25})
    saved = block.to_dict()
    assert "ramp" not in saved["settings"]
    old = json.loads(json.dumps(saved).replace('"ramp_step"', '"ramp"'))
    assert CompensatorBlock.from_dict(old).values == block.values
    assert block.with_settings(ramp=0.5).settings["ramp_step"] == 0.5
    assert "ramp_step once" in refusal(
        ParameterError, CompensatorBlock.of, "backlash", 0.5, {"ramp": 1, "ramp_step": 1}
    )


def test_the_ramp_of_a_saved_block_is_given_in_units_of_op_a_second():
    saved = CompensatorBlock.of("backlash", 0.5, {"lead_up": 1.0})
    assert saved.changed(ramp=3.0).settings["ramp_step"] == 1.5
    assert saved.changed(ramp_step=3.0).settings["ramp_step"] == 3.0
    assert saved.changed() is saved
    assert "scan time" in refusal(ParameterError, saved.changed, scan_time=1.0)


def test_types_of_the_response():
    response = block_from_model(ZONE, 0.1).run([50.0, 51.0, NAN])
    assert response.state.tolist() == [0, 2, 4]
    assert response.limited_high.dtype == bool
    assert response.reversals.dtype == np.int64
    assert block_from_model(ZONE, 0.1).run([50.0], dtype=np.float32).op_out.dtype == np.float32
    assert isinstance(block_from_model(ZONE, 0.1)(50.0), float)


def test_manual_by_step():
    block = block_from_model(ZONE, 0.1)
    assert block.step(50.0) == 50.0
    assert block.step(50.0, track_value=30.0) == 30.0
    assert block.last["state"] == 3
    assert block.step(NAN) == 30.0


def test_dead_zone_settings():
    block = block_from_model(ZONE, 0.1, op_noise=0.1, factor=0.9)
    expected = {"left_break": 48, "centre": 50, "right_break": 52, "factor": 0.9, "shape": 2, "zone": 0.3, "high": 100}
    assert {name: block.settings[name] for name in expected} == pytest.approx(expected)
    assert block.settings["cap"] == pytest.approx(1.1 * 1.8)
    assert block.settings["ramp_step"] == pytest.approx(4 / 100)
    assert block.notes == ()
    assert "op_noise" in block_from_model(ZONE, 0.1).notes[0]


def test_backlash_and_stiction_settings():
    gear = block_from_model(lm.Backlash(2.0), 0.1, op_noise=0.1)
    assert (gear.kind, gear.settings["lead_up"], gear.settings["quiet"]) == ("backlash", 1.0, 0.25)
    knock = block_from_model(lm.Stiction(2.0, 1.0), 0.1, op_noise=0.1)
    assert (knock.kind, knock.settings["amplitude"]) == ("stiction knocker", 1.0)
    moves = block_from_model(lm.Stiction(2.0, 1.0), 0.1, op_noise=0.1, method="two moves")
    assert (moves.kind, moves.settings["stand"], moves.settings["overshoot"]) == ("stiction two moves", 0.5, 3.0)


def test_settings_of_the_caller_win():
    block = block_from_model(ZONE, 0.1, ramp=2.0, shape=1.0, zone=0.5, cap=1.5, hold_on_disable=1.0)
    expected = {"ramp_step": 0.2, "shape": 1, "zone": 0.5, "cap": 1.5, "rate": 3.0, "hold_on_disable": 1}
    assert {name: block.settings[name] for name in expected} == pytest.approx(expected)
    assert block.with_settings(factor=0.5).settings["factor"] == 0.5


def test_frozen_json_and_pickle():
    block = block_from_model(ZONE, 0.1, op_noise=0.1)
    with pytest.raises(FrozenInstanceError):
        block.scan_time = 1.0
    assert CompensatorBlock.from_dict(json.loads(json.dumps(block.to_dict()))) == block
    assert pickle.loads(pickle.dumps(block)) == block  # noqa: S301
    block.settings["factor"] = 7.0
    assert block.settings["factor"] == 1.0


@pytest.mark.parametrize(
    ("settings", "word"),
    [
        ({"left_break": 60.0}, "kind"), ({"left_slope": 0.0}, "kind"), ({"factor": -1.0}, "factor"),
        ({"low": 5.0, "high": 1.0}, "low"), ({"ramp_step": -0.1}, "ramp_step"), ({"cap": NAN}, "cap"),
        ({"wide": 1.0}, "wide"),
    ],
)  # fmt: skip
def test_refuses_settings(settings, word):
    base = {"left_break": 48.0, "centre": 50.0, "right_break": 52.0}
    assert word in refusal(ParameterError, CompensatorBlock.of, "dead zone", 0.1, {**base, **settings})


def test_refuses_the_rest():
    assert "kind" in refusal(ParameterError, CompensatorBlock.of, "wear", 0.1, {})
    assert "scan_time" in refusal(ParameterError, CompensatorBlock.of, "backlash", 0.0, {})
    assert "values" in refusal(ParameterError, CompensatorBlock, "backlash", 0.1, (1.0,))
    assert "Saturation" in refusal(ParameterError, block_from_model, lm.Saturation(0, 1), 0.1)
    assert "method" in refusal(ParameterError, block_from_model, lm.Stiction(1, 1), 0.1, method="force")
    assert "keys" in refusal(ParameterError, CompensatorBlock.from_dict, {"kind": "backlash"})
    assert "samples" in refusal(DataError, block_from_model(ZONE, 0.1).run, [1.0, 2.0], [True, False, True])
    refusal(InputError, block_from_model(ZONE, 0.1).run, "high")


def test_default_factor_is_the_lower_end_of_the_interval(fit):
    block = fit.block(span=(-50, 50))
    low, width = fit.interval("width")[0], fit.parameters["width"]
    assert block.settings["factor"] == pytest.approx(low / width)
    assert 0.9 < block.settings["factor"] < 1.0
    assert block.scan_time == 0.5
    assert block.settings["left_break"] == fit.nonlinearity.left
    assert fit.block(span=(-50, 50), level=0.5).settings["factor"] > block.settings["factor"]
    assert fit.block(span=(-50, 50), factor=1.0, scan_time=0.1).scan_time == 0.1
    assert any("factor" in note for note in block.notes)


def test_ramp_is_the_width_in_a_time_constant_of_the_process(fit):
    scans = max(1.0 - 1.0 / np.log(abs(fit.linear.poles).max()), 10.0)
    assert fit.block(span=(-50, 50)).settings["ramp_step"] == pytest.approx(fit.nonlinearity.width / scans)
    assert fit.block(span=(-50, 50)).settings["hunt_scans"] == round(
        3 * (1.0 - 1.0 / np.log(abs(fit.linear.poles).max()))
    )
    assert block_from_model(ZONE, 0.1).settings["hunt_scans"] == 0.0


def test_noise_of_a_closed_loop_record_is_used(fit):
    loop = replace(fit, evidence=replace(fit.evidence, closed_loop=True))
    noisy = replace(loop, data=replace(fit.data, u=fit.data.u + np.random.default_rng(0).normal(scale=0.05, size=600)))
    assert any("noise of OP" in note for note in noisy.block(span=(-50, 50)).notes)
    assert noise_of(np.random.default_rng(1).normal(scale=0.2, size=5000)) == pytest.approx(0.2, rel=0.1)


@pytest.mark.parametrize("status", [Status.NOT_SEEN, Status.CANNOT_TELL, Status.ONE_SIDED, Status.NOT_CONVERGED])
def test_refuses_a_fit_that_does_not_carry_it(fit, status):
    message = refusal(ParameterError, replace(fit, status=status).block, span=(-50, 50))
    assert status.name in message


def test_refuses_a_span_that_op_leaves_and_a_width_that_may_be_nothing(fit):
    assert "span" in refusal(ParameterError, fit.block)
    vague = replace(fit, covariance=1e4 * fit.covariance)
    assert "surely above 0" in refusal(ParameterError, vague.block, span=(-50, 50))
    assert "fit" in refusal(ParameterError, lm._verbs.block, ZONE)
    assert block_from_fit(fit, span=(-50, 50)) == fit.block(span=(-50, 50))


def test_plain_backlash_compensator():
    comp = BacklashCompensator(lm.Backlash(1.0))
    v = np.array([0.0, 1.0, 1.0, 0.5, NAN, 0.7])
    np.testing.assert_array_equal(comp(v), lm.Backlash(1.0).inverse()(v))
    np.testing.assert_array_equal([comp.step(value) for value in v], comp(v))
    comp.reset()
    assert comp.step(5.0) == 5.0
    assert comp.to_dict() == {"kind": "backlash", "width": 1.0}
    assert "Backlash" in refusal(ParameterError, BacklashCompensator, ZONE)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("value", [1e308, -1e308, 1e150, 1e10, 5e-324, -5e-324, 1e-13, NAN, float("inf")])
def test_no_setting_is_beyond_what_a_block_can_have(kind, value):
    for variable in SPECIFICATIONS[kind].section("parameter"):
        with pytest.raises(ParameterError, match=variable.name.lower()):
            CompensatorBlock.of(kind, 1.0, {variable.name.lower(): value})


@pytest.mark.parametrize("factor", [2.1, 10.0, 1e300])
def test_a_factor_of_more_than_twice_the_lost_motion_is_refused(factor):
    with pytest.raises(ParameterError, match="factor"):
        block_from_model(ZONE, 1.0, factor=factor)


def test_a_factor_above_1_goes_out_with_a_reason_only():
    block = block_from_model(lm.Backlash(2.0), 1.0, factor=1.2)
    with pytest.raises(GateError, match=r"a factor up to 1, got 1.2"):
        lm.export.export(block, "st", name="FY_1", date="2026-01-01")
    done = lm.export.export(block, "st", name="FY_1", date="2026-01-01", accept="A bench")
    assert "A bench" in done.files["FY_1.st"]
    assert done.replay(200).agrees


def test_notes_tell_the_factor_in_force(fit):
    block = block_from_fit(fit, span=(-10.0, 10.0))
    assert block.notes == CompensatorBlock.from_dict(block.to_dict()).notes
    for changed in (
        block.with_settings(factor=0.5),
        CompensatorBlock.from_dict(block.to_dict() | {"settings": block.settings | {"factor": 0.5}}),
    ):
        assert [note for note in changed.notes if note.startswith("factor")] == ["factor 0.500: given"]
