"""The score test of the shape: what hinges and jumps explain of the errors, by least squares."""

import numpy as np
import pytest

from lostmotion.identify.actuators.dead_zone import DEAD_ZONE
from lostmotion.identify.actuators.fit_kind import fit_linear
from lostmotion.identify.data import collect
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.misfit import shape
from lostmotion.identify.scaled import ScaledData, Scaling
from lostmotion.kernels.linear import simulate

N, STEP = 400, 1e-6


@pytest.fixture(scope="module")
def fitted():
    """A linear fit of a process behind a characteristic with a kink."""
    rng = np.random.default_rng(3)
    u = np.repeat(rng.uniform(-2.0, 2.0, N // 5), 5)
    x, y = u + 0.8 * np.maximum(u - 0.5, 0.0), np.zeros(N)
    for k in range(1, N):
        y[k] = 0.7 * y[k - 1] + 0.3 * x[k - 1]
    data = collect(u, y + 0.1 * rng.normal(size=N), 1.0)
    scaled = ScaledData.of(data, Scaling(data.u_centre, data.u_scale, data.y_centre, data.y_scale))
    return fit_linear(scaled, Asked((1, 0, 1), 0))


def test_share_is_that_of_least_squares(fitted):
    problem, theta, parts = fitted.problem, fitted.fit.theta, fitted.parts
    first, knots = problem.structure.first, [-0.6, 0.4]

    def errors(at):
        return problem.predict(at)[1][0]

    old = [(errors(theta + STEP * way) - errors(theta - STEP * way)) / (2 * STEP) for way in np.eye(theta.size)]
    new = [simulate(parts.a, parts.b, 1, np.maximum(problem.u - knot, 0.0))[first:] for knot in knots]

    def left(columns):
        table = np.column_stack(columns)
        return np.sum((errors(theta) - table @ np.linalg.lstsq(table, errors(theta), rcond=None)[0]) ** 2)

    expected = (left(old) - left([*old, *new])) / np.sum(errors(theta) ** 2)
    p, share = shape(fitted, knots)
    assert share == pytest.approx(expected, rel=0.01)
    assert share > 0.3
    assert p < 1e-6


@pytest.mark.parametrize("size", [0.3, 1.0, 2.5])
def test_dead_zones_of_a_size_have_it(fitted, size):
    places = [own for _, own in DEAD_ZONE.of_size(fitted.problem, size)]
    assert len(places) > 1
    np.testing.assert_allclose([own[1] - own[0] for own in places], size)
