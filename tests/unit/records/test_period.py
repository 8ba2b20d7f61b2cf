"""RecursiveML.period(): independent points for a trend, with standard errors that hold."""

import numpy as np
import pytest

import lostmotion as lm

pytestmark = pytest.mark.statistics


@pytest.mark.parametrize("forgetting", [1.0, 0.9995])
def test_periods_scatter_as_their_standard_errors_say(forgetting):
    """In closed loop, where the break points hang on the process most."""
    points = []
    for seed in range(3):
        loop = lm.routine_operation(80_000, drift="none", seed=seed)
        estimator = lm.RecursiveML(3, 2, 3, dt=0.1, noise="white", forgetting=forgetting)
        for start in range(0, 80_000, 8000):
            estimator.run(loop.command[start : start + 8000], loop.measured[start : start + 8000], every=8000)
            values, errors, samples = estimator.period()
            assert samples <= 8000  # the first window is not in the first period
            assert values["width"] == pytest.approx(values["right"] - values["left"])
            points.append((values["width"] - 2.0) / errors["width"])
    chi_square = float(np.sum(np.square(points)))
    assert 0.3 * len(points) < chi_square < 1.6 * len(points)  # 30 points: 1.6 is exceeded in 2 % of cases
    assert abs(np.corrcoef(points[1:], points[:-1])[0, 1]) < 0.5


def test_without_information_there_is_no_point():
    loop = lm.routine_operation(10_000, drift="none", seed=0)
    estimator = lm.RecursiveML(3, 2, 3, dt=0.1, noise="white")
    assert estimator.period() is None
    estimator.run(loop.command[:8000], loop.measured[:8000])
    assert estimator.period() is not None
    assert estimator.period() is None  # no samples
    estimator.run(np.full(2000, loop.command[7999]), np.full(2000, np.nan))
    assert estimator.period() is None
    noise = np.random.default_rng(0).normal(scale=0.17, size=2000)
    estimator.run(np.full(2000, 0.3), noise)  # OP rests inside the dead zone
    assert estimator.period() is None
