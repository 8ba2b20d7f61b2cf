import numpy as np
import pytest

import lostmotion as lm
from tests.support.refusals import refusal

AMPLITUDES = (0.6, 1.0, 1.7, 3.0, 20.0)


def close(actuator, amplitude, tolerance=1e-7):
    exact, numeric = actuator.describing_function(amplitude), lm.describing_function(actuator, amplitude)
    np.testing.assert_allclose(numeric, exact, atol=tolerance)
    return exact


@pytest.mark.parametrize("amplitude", AMPLITUDES)
@pytest.mark.parametrize("width", [0.0, 0.3, 1.0, 1.9])
def test_backlash(width, amplitude):
    gain = close(lm.Backlash(width), amplitude)
    if width >= 2 * amplitude:
        assert gain == 0
    elif width > 0:
        assert 0 < gain.real < 1
        assert gain.imag < 0  # it lags


@pytest.mark.parametrize("amplitude", AMPLITUDES)
@pytest.mark.parametrize("limits", [(-1.0, 1.0), (-0.3, 2.0), (0.0, 0.5)])
def test_saturation(limits, amplitude):
    assert close(lm.Saturation(*limits), amplitude).imag == 0


@pytest.mark.parametrize("amplitude", AMPLITUDES)
@pytest.mark.parametrize("zone", [(-1.0, 1.0, 3.0, 3.0), (-0.3, 2.0, 1.0, 0.5), (0.0, 0.0, 2.0, 2.0)])
def test_dead_zone(zone, amplitude):
    assert close(lm.DeadZone(*zone), amplitude).imag == 0


@pytest.mark.parametrize("amplitude", AMPLITUDES)
@pytest.mark.parametrize(("band", "jump"), [(0.0, 0.0), (0.5, 0.2), (1.0, 0.0), (1.0, 1.0), (0.5, 0.8), (1.5, 0.3)])
def test_stiction_of_choudhury(band, jump, amplitude):
    close(lm.Stiction(band, jump, "choudhury"), amplitude, 5e-4)  # x jumps between two samples


@pytest.mark.parametrize("amplitude", AMPLITUDES)
@pytest.mark.parametrize(("band", "jump"), [(0.0, 0.0), (0.5, 0.2), (1.0, 0.0), (0.5, 0.5), (0.4, 0.6)])
def test_stiction_of_kano(band, jump, amplitude):
    close(lm.Stiction(band, jump, "kano"), amplitude, 5e-4)


def test_kano_has_two_steady_answers_to_a_small_sine():
    valve = lm.Stiction(1.5, 1.0, "kano")  # amplitude 1: less than (S + J) / 2, more than S / 2
    assert lm.describing_function(valve, 1.0) == 0
    angle = 2 * np.pi / 4000 * np.arange(-4000, 8000)
    push = np.where(angle < 0, 2.0, 1.0) * np.sin(angle)
    last = valve(push)[-4000:]
    gain = 2 / 4000 * last @ (np.sin(angle[-4000:]) + 1j * np.cos(angle[-4000:]))
    np.testing.assert_allclose(gain, valve.describing_function(1.0), atol=2e-3)


def published_stiction(band, jump, amplitude):
    """As Choudhury et al. 2005 write it."""
    phi = np.arcsin((amplitude - band) / amplitude)
    a = 0.5 * amplitude * np.sin(2 * phi) - 2 * amplitude * np.cos(phi) - amplitude * (np.pi / 2 + phi)
    a += 2 * (band - jump) * np.cos(phi)
    b = -1.5 * amplitude + 0.5 * amplitude * np.cos(2 * phi) + 2 * amplitude * np.sin(phi)
    b -= 2 * (band - jump) * np.sin(phi)
    return -(a - 1j * b) / (np.pi * amplitude)


@pytest.mark.parametrize("amplitude", [0.8, 1.0, 5.0])
@pytest.mark.parametrize(("band", "jump"), [(0.5, 0.2), (1.0, 0.0), (1.0, 1.0), (0.5, 0.8)])
def test_stiction_as_published(band, jump, amplitude):
    found = lm.Stiction(band, jump, "choudhury").describing_function(amplitude)
    np.testing.assert_allclose(found, published_stiction(band, jump, amplitude), rtol=1e-13)


def test_stiction_has_the_published_limits():
    stick_slip = lm.Stiction(2.0, 2.0, "choudhury").describing_function(1.0 + 1e-9)
    np.testing.assert_allclose(np.angle(stick_slip), -np.pi / 2, atol=1e-3)  # a square wave, a quarter period late
    assert lm.Stiction(2.0, 2.0, "choudhury").describing_function(1.0) == 0
    same = lm.Stiction(0.7, 0.0, "choudhury").describing_function(1.0)
    assert same == lm.Backlash(0.7).describing_function(1.0)


@pytest.mark.parametrize("width", [0.3, 1.0, 1.9])
def test_against_python_control(width):
    control = pytest.importorskip("control")
    for amplitude in (1.0, 1.7, 20.0):
        theirs = control.friction_backlash_nonlinearity(width)
        ours = lm.Backlash(width).describing_function(amplitude)
        np.testing.assert_allclose(ours, theirs.describing_function(amplitude), rtol=1e-12)
        # one amplitude a call: the cycle that brings it to its steady state runs at the smallest of them only
        numeric = control.describing_function(theirs, amplitude, num_points=4000, try_method=False)
        np.testing.assert_allclose(numeric, ours, atol=1e-6)
        ours_numeric = lm.describing_function(lm.Backlash(width), amplitude, samples=4000)
        np.testing.assert_allclose(ours_numeric, numeric, atol=1e-12)


@pytest.mark.parametrize(("low", "high"), [(-1.0, 1.0)])
def test_saturation_against_python_control(low, high):
    control = pytest.importorskip("control")
    theirs = control.saturation_nonlinearity(high, low)
    for amplitude in AMPLITUDES:
        ours = lm.Saturation(low, high).describing_function(amplitude)
        np.testing.assert_allclose(ours, theirs.describing_function(amplitude), rtol=1e-12)


def test_with_a_bias():
    valve = lm.Saturation(0.0, 10.0)
    np.testing.assert_allclose(lm.describing_function(valve, 2.0, bias=5.0), 1.0, atol=1e-12)
    np.testing.assert_allclose(lm.describing_function(valve, 2.0, bias=10.0), 0.5, atol=1e-7)
    np.testing.assert_allclose(
        lm.describing_function(lm.Backlash(1.0), 2.0, bias=50.0), close(lm.Backlash(1.0), 2.0), atol=1e-7
    )


def test_a_series_lags_with_the_backlash():
    gain = lm.describing_function(lm.Series((lm.Backlash(1.0), lm.DeadZone(-0.5, 0.5))), 3.0)
    assert 0 < gain.real < 1
    assert gain.imag < 0


def test_refusals():
    for actuator in (lm.Backlash(1.0), lm.Stiction(1, 1), lm.Saturation(-1, 1), lm.DeadZone(-1, 1)):
        assert "amplitude" in refusal(lm.ParameterError, actuator.describing_function, 0.0)
        assert "amplitude" in refusal(lm.ParameterError, lm.describing_function, actuator, -1.0)
    assert "'he'" in refusal(lm.ParameterError, lm.Stiction(1, 1, "he").describing_function, 2.0)
    assert "low <= 0" in refusal(lm.ParameterError, lm.Saturation(1, 2).describing_function, 2.0)
    assert "left <= 0" in refusal(lm.ParameterError, lm.DeadZone(1, 2).describing_function, 2.0)
    assert "bias" in refusal(lm.ParameterError, lm.describing_function, lm.Identity(), 1.0, float("nan"))
    assert "samples" in refusal(lm.ParameterError, lm.describing_function, lm.Identity(), 1.0, samples=7)
    assert "periods" in refusal(lm.ParameterError, lm.describing_function, lm.Identity(), 1.0, periods=0)
