"""A status that is earned: what the record cannot show is not OK, and another kind is named."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lostmotion as lm
from lostmotion.errors import Status
from lostmotion.identify.actuators.every_kind import likely_kinds
from lostmotion.identify.data import collect
from lostmotion.identify.earned import fit_without_drift, same_signal
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.scaled import ScaledData, Scaling

FIRST = lm.LinearModel([-0.8], [0.3], 1, 1.0)
QUICK = {"orders": (1, 0, 1), "noise": "white"}


def prs(n=500, hold=7, seed=2):
    return lm.signals.prs(n, -5, 5, hold, seed)


def measured(actuator, u, deviation=0.05, linear=FIRST):
    model = lm.Hammerstein(actuator, linear, 1.0)
    return model.simulate(u) + np.random.default_rng(u.size).normal(scale=deviation, size=u.size)


@pytest.mark.statistics
@pytest.mark.parametrize("found", ["dead zone", "backlash"])
def test_a_likelier_kind_is_named(found):
    """And the result says it wherever it goes: text, dictionary, file."""
    actuators = {"dead zone": lm.DeadZone(-1, 1), "backlash": lm.Backlash(2.0)}
    u = prs()
    y = measured(actuators[found], u)
    wrong = lm.identify(u, y, 1.0, nonlinearity="backlash" if found == "dead zone" else "dead zone", **QUICK)
    assert wrong.status is Status.OTHER_KIND
    assert not wrong.status.ok
    name, ahead = wrong.evidence.other_kind
    assert wrong.preferred == name == found
    assert wrong.shown_size is None
    assert ahead > 3.0
    assert f"{found} fits better by {ahead:.0f}" in wrong.summary()
    again = lm.FitFacts.from_dict(json.loads(json.dumps(wrong.to_dict())))
    assert again.preferred == found
    assert again.evidence == wrong.evidence
    right = lm.identify(u, y, 1.0, nonlinearity=found, **QUICK)
    assert right.status is Status.OK
    assert right.evidence.other_kind is None
    assert lm.identify(u, y, 1.0, **QUICK).preferred == found


@pytest.mark.statistics
def test_the_default_compares_the_kinds():
    u = prs()
    fit = lm.identify(u, measured(lm.Backlash(2.0), u), 1.0, **QUICK)
    assert fit.kinds is not None
    assert fit.settings["nonlinearity"] == "auto"
    assert fit.preferred == "backlash"


@pytest.mark.statistics
@pytest.mark.parametrize("kind", ["auto", "dead zone", "stiction", "none"])
@pytest.mark.parametrize(
    "y",
    [
        lambda u: u.copy(),
        lambda u: 3.0 * u - 7.0,
        lm.DeadZone(-1, 1),
        lambda u: (u + 6.0) ** 2,
    ],
)
def test_one_signal_is_no_loop(kind, y):
    """OP and PV from one column, or PV computed from OP."""
    u = prs(1500, hold=2)
    fit = lm.identify(u, y(u), 1.0, nonlinearity=kind)
    assert fit.status is Status.SAME_SIGNAL
    assert fit.preferred == "cannot tell"
    assert "one signal" in fit.summary()


def test_a_static_characteristic_can_be_asked_for():
    u = prs()
    fit = lm.identify(u, lm.DeadZone(-1, 1)(u), 1.0, nonlinearity="dead zone", orders=(0, 0, 0), noise="white")
    assert fit.status is Status.OK


@given(seed=st.integers(0, 10_000), slow=st.floats(0.0, 0.98), deviation=st.sampled_from([0.0, 1e-3, 0.3]))
@settings(max_examples=60, deadline=None)
def test_a_process_is_never_one_signal(seed, slow, deviation):
    """One sample of delay is enough, without any noise too."""
    rng = np.random.default_rng(seed)
    u = np.cumsum(rng.normal(size=400))
    y = lm.LinearModel([-slow], [1.0 - slow], 1, 1.0).simulate(u) + rng.normal(size=400) * deviation
    assert not same_signal(u, y)
    assert same_signal(u, -2.0 * u + 1.0)
    assert same_signal(y, y)


def test_a_loop_that_has_settled_is_not_one_signal():
    plant = lm.Hammerstein(lm.DeadZone(-1, 1), lm.LinearModel([-0.95], [0.05], 2, 1.0), 0.0)
    load = np.where(np.arange(2000) < 50, 0.0, 3.0)
    loop = lm.simulate_loop(plant, lm.PI(0.5, 0.1), np.zeros(2000), disturbance=load)
    assert not same_signal(loop.command, loop.measured)


@pytest.mark.statistics
def test_exact_feedback_without_noise_tells_nothing():
    """Nothing moves OP but its controller, and the model leaves rounding."""
    plant = lm.Hammerstein(lm.Identity(), lm.LinearModel([-0.95], [0.05], 2, 1.0), 0.0)
    load = np.where(np.arange(600) < 50, 0.0, 3.0)
    loop = lm.simulate_loop(plant, lm.PI(0.5, 0.1), np.zeros(600), disturbance=load)
    for kind in ("auto", "dead zone", "none"):
        fit = lm.identify(loop.command, loop.measured, 1.0, nonlinearity=kind)
        assert not fit.status.ok, (kind, fit.status)


@pytest.mark.statistics
def test_a_size_near_the_range_is_refused():
    u = lm.signals.prs(1500, -1.13, 1.13, 7, 3)
    fit = lm.identify(u, measured(lm.DeadZone(-1, 1), u, 0.001), 1.0, nonlinearity="dead zone", **QUICK)
    assert fit.parameters["width"] == pytest.approx(2.0, abs=0.02)
    assert fit.status is Status.NEAR_RANGE
    assert fit.preferred == "cannot tell"
    assert "Build nothing on this dead zone" in fit.summary()


def test_a_process_slower_than_the_record_is_refused():
    """Orders that allow no other: it was not seen to settle."""
    u = prs(400)
    slow = lm.LinearModel([-0.9985], [0.05], 1, 1.0)
    fit = lm.identify(u, measured(lm.Identity(), u, 0.05, slow), 1.0, nonlinearity="none", integrating=False, **QUICK)
    assert fit.status is Status.NO_PROCESS
    assert fit.preferred == "cannot tell"


def test_a_model_that_does_not_reproduce_pv_is_refused():
    u = prs(600)
    fit = lm.identify(u, measured(lm.Identity(), u), 1.0, nonlinearity="none", **QUICK)
    assert fit.status is Status.OK
    rows = fit.data.segments
    assert fit_without_drift(fit.data.y, fit.simulated, rows) > 80.0
    drift = 50.0 * np.sin(np.arange(600) / 90.0)
    assert fit_without_drift(fit.data.y + drift, fit.simulated, rows) > 30.0
    assert fit_without_drift(fit.data.y, -fit.simulated, rows) < 0.0


def test_texts_of_what_is_not_earned():
    u = prs()
    zone = lm.identify(u, measured(lm.DeadZone(-1, 1), u), 1.0, nonlinearity="dead zone", **QUICK)
    plain = lm.identify(u, measured(lm.Identity(), u), 1.0, nonlinearity="none", **QUICK)
    for status in (Status.NEAR_RANGE, Status.NO_PROCESS, Status.NOT_REPRODUCED, Status.SAME_SIGNAL, Status.OTHER_KIND):
        for fit in (zone, plain):
            told = replace(fit, status=status)
            assert told.preferred == "cannot tell"
            assert status.name in told.summary()
            assert "preferred to the linear model" not in told.summary()
            assert lm.FitFacts.from_dict(json.loads(json.dumps(told.to_dict()))).status is status
    assert "Linear model, as requested." in replace(plain, status=Status.MISFIT).summary()
    assert replace(plain, status=Status.MISFIT).preferred == "cannot tell"


@pytest.mark.statistics
@pytest.mark.parametrize("kind", ["auto", "saturation", "backlash"])
@pytest.mark.parametrize("spike", [1, 20, 300])
def test_one_step_or_spike_of_op_shows_no_fault(kind, spike):
    u = np.zeros(600)
    u[300 : 300 + spike] = 1.0
    y = FIRST.simulate(u) + np.random.default_rng(spike).normal(scale=0.02, size=600)
    fit = lm.identify(u, y, 1.0, nonlinearity=kind)
    assert fit.preferred in ("none", "cannot tell")


@pytest.mark.statistics
def test_kinds_of_a_long_record_are_compared_on_the_same_rows():
    """The search for a dead zone takes all rows, those for the others take the first."""
    u = prs(9000, seed=5)
    data = collect(u, measured(lm.DeadZone(-1, 1), u), 1.0)
    scaled = ScaledData.of(data, Scaling(data.u_centre, data.u_scale, data.y_centre, data.y_scale))
    assert next(iter(likely_kinds(scaled, Asked((1, 0, 1), 0)))) == "dead zone"


@pytest.mark.statistics
def test_a_staircase_by_hand_is_no_series_of_loads():
    """Steps of load at the moves of OP would imitate any actuator."""
    u = np.repeat(np.concatenate([np.arange(-8, 9, 2), np.arange(6, -9, -2)] * 2).astype(float), 150)
    y = measured(lm.DeadZone(-3, 3), u, 0.02, lm.LinearModel([-0.97], [0.03], 1, 1.0))
    fit = lm.identify(u, y, 1.0)
    assert fit.preferred == "dead zone"
    assert fit.parameters["width"] == pytest.approx(6.0, rel=0.05)


@pytest.mark.statistics
@pytest.mark.parametrize("samples", [60, 75, 100, 150])
def test_short_records_are_compared_as_well(samples):
    """No rows can be left out of them for a second opinion."""
    u = prs(samples, hold=4)
    fit = lm.identify(u, measured(lm.DeadZone(-1, 1), u, 0.02), 1.0, **QUICK)
    assert fit.kinds is not None
    assert fit.preferred in ("dead zone", "cannot tell")


@pytest.mark.parametrize("start", [0.0, 0.37123])
def test_binary_op_says_nothing_of_a_dead_zone(start):
    rng = np.random.default_rng(1)
    u = np.repeat(rng.choice([-1.0, 1.0], 400), 10)
    u[:3] = start
    riv = lm.RecursiveIV(1, 0, 1)
    riv.run(u, FIRST.simulate(u) + rng.normal(scale=0.05, size=u.size))
    assert riv.estimate.status is Status.CANNOT_TELL
    again = lm.RecursiveIV.from_bytes(riv.to_bytes())
    assert again.estimate.status is Status.CANNOT_TELL
    again.run(prs(3000), FIRST.simulate(prs(3000)))
    assert again.to_bytes() == lm.RecursiveIV.from_bytes(again.to_bytes()).to_bytes()


@pytest.mark.sampled(4)
@pytest.mark.statistics
@pytest.mark.parametrize("seed", range(1000, 1004))
@pytest.mark.parametrize("cause", ["backlash", "stiction"])
def test_no_dead_zone_of_a_valve_that_sticks(cause, seed):
    """However it is called: by default, or with the wrong kind; 200 loops: docs/wrong-inverse.md."""
    loop = lm.evaluate.random_faulty_loop(seed, 2000, cause=cause, rough=bool(seed % 2))
    for kind in ("auto", "dead zone"):
        fit = lm.identify(lm.LoopRecord(loop.op, loop.pv, dt=loop.dt), nonlinearity=kind)
        assert not (fit.status.ok and fit.preferred == "dead zone")
