"""Models as systems of python-control against our own simulation."""

import sys

import numpy as np
import pytest

import lostmotion as lm

control = pytest.importorskip("control")

U = 50.0 + np.cumsum(np.random.default_rng(1).normal(size=120))
LINEAR = lm.LinearModel([-1.2, 0.35], [0.1, 0.05], 2, 0.5)
ACTUATORS = [
    lm.Identity(), lm.DeadZone(49.0, 51.0, 2.0, 1.0), lm.Saturation(48.0, 52.0), lm.Backlash(1.5),
    *(lm.Stiction(2.0, 1.0, model) for model in ("kano", "choudhury", "he", "he ramp")),
]  # fmt: skip


def response(system, u):
    time = np.arange(u.size) * system.dt
    return control.input_output_response(system, time, u, np.zeros(system.nstates)).outputs


@pytest.mark.parametrize("valve", ACTUATORS, ids=lambda valve: f"{valve.kind} {getattr(valve, 'model', '')}")
@pytest.mark.parametrize(
    "linear",
    [LINEAR, lm.LinearModel([], [0.5, 0.2], 0), lm.LinearModel([], [0.7], 0), lm.LinearModel([-0.9], [0.1], 0)],
)
def test_as_simulated(valve, linear):
    model = lm.Hammerstein(valve, linear, 20.0)
    system = model.to_control()
    assert isinstance(system, control.NonlinearIOSystem)
    assert system.dt == linear.dt
    np.testing.assert_allclose(response(system, U), model.simulate(U), rtol=0, atol=1e-9)


def test_of_a_fit():
    model = lm.Hammerstein(lm.Backlash(2.0), LINEAR, 10.0)
    u = 50.0 + lm.signals.prs(300, -5, 5, hold=10, seed=1)
    y = model.simulate(u)
    fit = lm.identify(u[50:], y[50:] + np.random.default_rng(0).normal(scale=0.01, size=250), 0.5,
                      nonlinearity="backlash", orders=(2, 1, 2), noise="white")  # fmt: skip
    np.testing.assert_allclose(response(fit.to_control(), u), fit.model.simulate(u), rtol=0, atol=1e-8)
    assert isinstance(fit.linear.to_control(), control.TransferFunction)
    assert np.abs(response(fit.to_control(), u)[100:] - y[100:]).max() < 0.2


def test_load_of_a_level():
    model = lm.Hammerstein(lm.Backlash(1.0), lm.LinearModel([-1.0], [0.1], 1), 40.0)
    expected = model.linear.simulate(np.asarray(model.nonlinearity(U)) - 50.0) + 40.0
    np.testing.assert_allclose(response(model.to_control(load=-50.0), U), expected, rtol=0, atol=1e-9)


def test_in_a_closed_loop():
    model = lm.Hammerstein(lm.DeadZone(-1.0, 1.5), LINEAR, 0.0)
    pi = lm.PI(0.4, 0.2)
    reference = np.repeat([5.0, 8.0], 100)
    ours = lm.simulate_loop(model, pi, reference)
    states = control.nlsys(
        lambda t, x, e, p: x + 0.2 * 0.5 * e, lambda t, x, e, p: 0.4 * e + x + 0.2 * 0.5 * e,
        inputs=["e"], outputs=["OP"], states=1, dt=0.5, name="pi",
    )  # fmt: skip
    plant = model.to_control()
    plant.name = "plant"
    difference = control.summing_junction(["SP", "-PV"], "e", name="sum")
    loop = control.interconnect([states, plant, difference], inputs=["SP"], outputs=["PV"])
    found = control.input_output_response(loop, ours.time, reference, np.zeros(loop.nstates)).outputs
    np.testing.assert_allclose(found, ours.output, rtol=0, atol=1e-9)


def test_refusals(monkeypatch):
    with pytest.raises(lm.ParameterError, match="an actuator that loops can simulate, got Series"):
        lm.Hammerstein(lm.Series((lm.Backlash(1.0),)), LINEAR).to_control()
    monkeypatch.setitem(sys.modules, "control", None)
    for model in (LINEAR, lm.Hammerstein(lm.Backlash(1.0), LINEAR)):
        with pytest.raises(ImportError, match=r'pip install "lostmotion\[control\]"'):
            model.to_control()
