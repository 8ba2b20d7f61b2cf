"""Profile over any operator: lag products, regression, starts."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identify.actuators.kind import kind_of
from lostmotion.identify.actuators.operator_profile import LaggedRegression
from lostmotion.identify.likelihood.arx_gram import Lags
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels.products import add_lagged_table, add_products, damped_step

SEGMENTS = np.array([[0, 250], [250, 600]])
LAGS = Lags(7, 9, 2)


def test_products_of_lags_are_those_of_the_columns():
    rng = np.random.default_rng(0)
    first, second = rng.normal(size=(2, 80))
    rows = np.arange(20, 75)
    columns = [signal[rows[:, None] - lag - np.arange(count)] for signal, lag, count in ((first, 1, 6), (second, 3, 4))]
    out = np.ones((6, 4))
    add_products(first, 1, 6, second, 3, 4, 20, 75, out)
    np.testing.assert_allclose(out, 1.0 + columns[0].T @ columns[1])


def test_damped_step_solves_the_scaled_equations():
    rng = np.random.default_rng(1)
    jacobian, errors = rng.normal(size=(30, 4)) * [1.0, 100.0, 0.0, 1e-3], rng.normal(size=30)
    hessian, gradient = jacobian.T @ jacobian, jacobian.T @ errors
    step, promised = damped_step(hessian, gradient, 1e-3)
    scale = np.where(np.diag(hessian) > 0, np.diag(hessian), 1.0)
    np.testing.assert_allclose((hessian + 1e-3 * np.diag(scale)) @ step, -gradient, atol=1e-9)
    left = errors + jacobian @ step
    assert promised == pytest.approx(errors @ errors - left @ left)


@pytest.mark.parametrize(("outputs", "delay", "inputs"), [(7, 2, 9), (1, 0, 1), (3, 5, 2)])
def test_lagged_table_by_its_columns(outputs, delay, inputs):
    rng = np.random.default_rng(7)
    y, x = rng.normal(size=(2, 90))
    k = np.arange(20, 85)
    past = np.column_stack([x[k - delay - j] for j in range(inputs)])
    left = [np.ones(k.size), *(y[k - 1 - i] for i in range(outputs)), *past.T, y[k]]
    table = np.ones((outputs + inputs + 2, inputs))  # what is there already stays
    add_lagged_table(y, outputs, x, delay, inputs, 20, 85, table)
    np.testing.assert_allclose(table, 1.0 + np.array(left) @ past, rtol=1e-12, atol=1e-10)


def test_squares_are_those_of_the_whole_regression():
    rng = np.random.default_rng(2)
    x = 0.2 * np.cumsum(rng.normal(size=600))
    y = np.convolve(x, [0.0, 0.0, 0.5, 0.3])[:600] + rng.normal(scale=0.1, size=600)
    found = LaggedRegression.on(ScaledData(x, y, SEGMENTS), LAGS)
    rows = np.concatenate([np.arange(start + LAGS.head, stop) for start, stop in SEGMENTS])
    columns = [np.ones((rows.size, 1)), y[rows[:, None] - np.arange(1, 8)]]
    columns.append(x[rows[:, None] - 2 - np.arange(9)])
    for kept, squares in ((columns[:-1], found.alone), (columns, found.squares(x))):
        table = np.concatenate(kept, axis=1)
        left = y[rows] - table @ np.linalg.lstsq(table, y[rows], rcond=None)[0]
        assert squares == pytest.approx(left @ left, rel=1e-6)
    assert found.samples == rows.size
    assert LaggedRegression.on(ScaledData(x, y, SEGMENTS), LAGS, most=300).samples == 300


@pytest.mark.statistics
@pytest.mark.parametrize("valve", [lm.Backlash(1.5), lm.Stiction(2.0, 1.0), lm.Stiction(1.0, 1.0)])
def test_the_best_start_is_near_the_truth(valve):
    rng = np.random.default_rng(3)
    u = np.cumsum(rng.normal(scale=0.3, size=1500))
    u -= np.linspace(u[0], u[-1], u.size)
    y = lm.LinearModel([-0.8], [0.2], 1, 1.0).simulate(valve(u)) + rng.normal(scale=0.02, size=u.size)
    data = ScaledData(u / u.std(), (y - y.mean()) / y.std(), np.array([[0, u.size]]))
    starts = kind_of(valve.kind).sought(data, Asked()).etas
    wanted = np.array([valve.width] if valve.kind == "backlash" else [valve.band, valve.jump])
    np.testing.assert_allclose(starts[0] * u.std(), wanted, atol=0.06 * wanted[0])
