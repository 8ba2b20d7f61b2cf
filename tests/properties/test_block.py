"""What must hold for any input to a compensating block, whatever it is."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.compensate import SPECIFICATIONS
from lostmotion.kernels.blocks import core as k
from tests.naive.block import sized

kinds = st.sampled_from(sorted(SPECIFICATIONS))
types = st.sampled_from([np.float64, np.float32])
anything = st.floats(allow_nan=True, allow_infinity=True, width=32) | st.sampled_from([1e308, -1e308, 1e-308])
near = st.integers(320, 480).map(lambda eighths: eighths / 8)
flags = st.sampled_from([0.0, 1.0])
rows = st.lists(st.tuples(near | anything, flags, flags, flags, near | anything), min_size=1, max_size=40)
calm = st.lists(st.tuples(near, flags, st.just(1.0), flags, near), min_size=2, max_size=60)
EXAMPLES = settings(max_examples=60)


@st.composite
def some_settings(draw, kind, broken):
    """Settings that are usable, or in which each may be anything."""
    p = {
        "ramp_step": draw(st.sampled_from([0.125, 0.5, 1.0])),
        "cap": draw(st.sampled_from([2.0, 50.0])),
        "rate": 100.0,
    }
    p |= {"band": draw(st.sampled_from([0.0, 0.5])), "quiet": draw(st.sampled_from([0.0, 0.25]))}
    p |= {"low": draw(st.sampled_from([0.0, 45.0])), "high": draw(st.sampled_from([100.0, 52.0])), "safe": 10.0}
    p |= {
        "dead zone": {
            "left_break": 48.0, "centre": 50.0, "right_break": draw(st.sampled_from([50.0, 53.0])),
            "shape": draw(st.sampled_from([0.0, 1.0, 2.0])), "zone": draw(st.sampled_from([0.0, 0.5])),
            "right_slope": draw(st.sampled_from([1.0, 2.0])),
        },
        "backlash": {"lead_up": draw(st.sampled_from([0.0, 1.5])), "lead_down": 1.0, "pulse": 0.5, "pulse_scans": 2.0},
        "stiction knocker": {"amplitude": 1.5, "pulse_scans": 2.0, "period_scans": 5.0},
        "stiction two moves": {"overshoot": 3.0, "stand": 0.5, "move_scans": 2.0, "release": 2.0},
    }[kind]  # fmt: skip
    if broken:
        for name in draw(st.sets(st.sampled_from(sorted(p)), max_size=4)):
            p[name] = draw(anything)
    return p


def play(kind, scans, dtype, state=None):
    """Outputs of scans, each a pair of settings and inputs."""
    specification = SPECIFICATIONS[kind]
    state = specification.state(dtype) if state is None else state
    outputs = specification.outputs(len(scans), dtype)
    with np.errstate(all="ignore"):
        for row, (p, inputs) in enumerate(scans):
            values = specification.parameters(p).astype(dtype)
            specification.run(values, state, np.array([inputs]).astype(dtype), outputs[row : row + 1])
    return outputs


@EXAMPLES
@given(kinds, types, rows, st.data())
def test_no_input_and_no_setting_gets_a_bad_number_to_the_valve(kind, dtype, inputs, data):
    scans = []
    p = data.draw(some_settings(kind, broken=True))
    for row in inputs:
        if data.draw(st.integers(0, 5)) == 0:
            p = data.draw(some_settings(kind, broken=True))
        scans.append((p, row))
    outputs = play(kind, scans, dtype)
    assert np.isfinite(outputs).all()
    low = high = None
    for (settings_now, _), row in zip(scans, outputs, strict=True):
        with np.errstate(all="ignore"):
            limits = np.array([settings_now[name] for name in ("low", "high", "safe", "ramp_step")]).astype(dtype)
            usable = sized(limits) and limits[0] <= limits[1] and limits[3] >= 0
        if usable:
            low, high = limits[:2]
        if low is not None:
            assert low <= row[k.OP_OUT] <= high
            assert low <= row[k.BACK] <= high


@EXAMPLES
@given(kinds, types, calm, st.data())
def test_offset_moves_by_the_ramp_while_anything_is_switched(kind, dtype, inputs, data):
    """And by the rate otherwise; only tracking may impose more."""
    scans = []
    p = data.draw(some_settings(kind, broken=False))
    for row in inputs:
        changed = data.draw(st.integers(0, 9)) == 0
        if changed:
            fresh = data.draw(some_settings(kind, broken=False))
            p = {**fresh, "low": p["low"], "high": p["high"], "ramp_step": p["ramp_step"]}
        scans.append((p, row))
    outputs = play(kind, scans, dtype)
    eps = 1e-9 if dtype is np.float64 else 1e-4
    active = np.array([row[k.ENABLE] == 1.0 and row[k.TRACK] == 0.0 for _, row in scans])
    tracked = np.array([row[k.TRACK] == 1.0 for _, row in scans])
    for now in range(1, len(scans)):
        if tracked[now]:
            continue
        moved = abs(outputs[now, k.OFFSET] - outputs[now - 1, k.OFFSET])
        switched = not active[now] or not active[now - 1] or scans[now][0] != scans[now - 1][0]
        if switched or outputs[now, k.RAMPING] or outputs[now - 1, k.RAMPING]:
            assert moved <= scans[now][0]["ramp_step"] + eps
        held = np.clip(
            np.clip(scans[now][1][0], *limits_of(scans[now])) + outputs[now, k.OFFSET], *limits_of(scans[now])
        )
        assert outputs[now, k.OP_OUT] == pytest.approx(held, abs=eps)


def limits_of(scan):
    return scan[0]["low"], scan[0]["high"]


@EXAMPLES
@given(kinds, types, calm, st.data())
def test_disabled_and_settled_it_is_a_wire(kind, dtype, inputs, data):
    p = {**data.draw(some_settings(kind, broken=False)), "low": 0.0, "high": 100.0}
    off = [(p, (row[0], 0.0, 1.0, 0.0, 0.0)) for row in inputs]
    history = [(p, row) for row in inputs]
    state = SPECIFICATIONS[kind].state(dtype)
    play(kind, history, dtype, state)
    play(kind, [off[-1]] * 400, dtype, state)  # the ramp is over
    outputs = play(kind, off, dtype, state)
    given_in = np.array([row[0] for _, row in off], dtype=dtype)
    np.testing.assert_array_equal(outputs[:, k.OP_OUT], given_in)
    np.testing.assert_array_equal(outputs[:, k.BACK], given_in)
    assert not outputs[:, k.OFFSET].any()
    assert not outputs[:, k.RAMPING].any()
    assert (outputs[:, k.STATE] == 1.0).all()


@EXAMPLES
@given(st.sampled_from(["dead zone", "backlash"]), calm, near, st.data())
def test_a_controller_that_follows_back_leaves_manual_without_a_step(kind, inputs, manual, data):
    p = {**data.draw(some_settings(kind, broken=False)), "low": 0.0, "high": 100.0, "cap": 100.0, "quiet": 0.0}
    p |= {"pulse": 0.0} if kind == "backlash" else {}
    state = SPECIFICATIONS[kind].state()
    play(kind, [(p, (row[0], 1.0, 1.0, 0.0, 0.0)) for row in inputs], np.float64, state)
    back = 50.0
    for _ in range(3):  # the controller sets its output to BACK, as one with external tracking does
        back = play(kind, [(p, (back, 1.0, 1.0, 1.0, manual))], np.float64, state)[-1, k.BACK]
    after = play(kind, [(p, (back, 1.0, 1.0, 0.0, 0.0))], np.float64, state)[0]
    inside = kind == "dead zone" and back == 50.0  # any command of the dead zone is one and the same x
    assert after[k.OP_OUT] == pytest.approx(manual, abs=1e-9 if not inside else p["ramp_step"])


@EXAMPLES
@given(st.sampled_from(["dead zone", "backlash"]), types, calm, st.data())
def test_back_is_the_input_that_gives_the_command_at_a_clamp(kind, dtype, inputs, data):
    p = {**data.draw(some_settings(kind, broken=False)), "low": 45.0, "high": 52.0, "cap": 50.0, "quiet": 0.0}
    p |= {"pulse": 0.0, "zone": 0.0}
    p = {name: value for name, value in p.items() if name in settings_of(kind)}
    state = SPECIFICATIONS[kind].state(dtype)
    play(kind, [(p, (row[0], 1.0, 1.0, 0.0, 0.0)) for row in inputs], dtype, state)
    top = play(kind, [(p, (52.0, 1.0, 1.0, 0.0, 0.0))] * 40, dtype, state)[-1]
    again = play(kind, [(p, (top[k.BACK], 1.0, 1.0, 0.0, 0.0))], dtype, state.copy())[0]
    eps = 1e-9 if dtype is np.float64 else 1e-4
    if top[k.BACK] not in (50.0, 52.0) and kind == "backlash":
        return  # going back turns a backlash
    if top[k.BACK] != 50.0:  # a clamp inside the dead zone: no OP_IN gives it, all of the dead zone is the same x
        assert again[k.OP_OUT] == pytest.approx(top[k.OP_OUT], abs=eps)


def settings_of(kind):
    return {variable.name.lower() for variable in SPECIFICATIONS[kind].section("parameter")}


@EXAMPLES
@given(kinds, calm, st.data())
def test_bad_input_holds_the_command_and_comes_back_on_the_ramp(kind, inputs, data):
    p = {**data.draw(some_settings(kind, broken=False)), "low": 0.0, "high": 100.0}
    bad = data.draw(st.sampled_from([np.nan, np.inf, -np.inf]))
    state = SPECIFICATIONS[kind].state()
    before = play(kind, [(p, (row[0], 1.0, 1.0, 0.0, 0.0)) for row in inputs], np.float64, state)[-1]
    held = play(kind, [(p, (bad, 1.0, 1.0, 0.0, 0.0))] * 3, np.float64, state)
    assert (held[:, k.OP_OUT] == before[k.OP_OUT]).all()
    assert (held[:, k.STATE] == 4.0).all()
    after = play(kind, [(p, (inputs[-1][0], 1.0, 1.0, 0.0, 0.0))], np.float64, state)[0]
    assert abs(after[k.OP_OUT] - before[k.OP_OUT]) <= p["ramp_step"] + 1e-9
