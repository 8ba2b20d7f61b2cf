"""A dead zone that is left with a jump, and one whose characteristic bends: the lines stay where they are."""

import numpy as np
import pytest

import lostmotion as lm

LINES, STILL = 6.0, 9.0
ROWS = 1500


def record(seed, still=STILL, bend=0.0, centre=0.0, noise=0.5):
    """Levels of OP held for ten rows, a first-order lag, PV in deviations."""
    rng = np.random.default_rng(seed)
    op = np.repeat(rng.uniform(-40.0, 40.0, ROWS // 10), 10)
    op[:10] = 0.0  # at rest
    x = np.where(np.abs(op) > still, op - LINES * np.sign(op), 0.0)
    x = x + bend * x**2 / 80.0
    pv = np.zeros(ROWS)
    for k in range(1, ROWS):
        pv[k] = 0.8 * pv[k - 1] + 0.2 * x[k - 1]
    return op + centre, pv + noise * rng.normal(size=ROWS)


@pytest.mark.parametrize("asked", [{}, {"nonlinearity": "dead zone"}])
def test_lines_and_break_points(asked, tmp_path):
    op, pv = record(100, centre=50.0)
    fit = lm.identify(op, pv, 1.0, **asked)
    assert fit.nuisances == ("break-away",)
    for name, sign, (low, high) in zip(("left", "right"), (-1, 1), fit.chosen.break_away_intervals, strict=True):
        assert fit.parameters[name] == pytest.approx(50.0 + sign * LINES, abs=0.5)
        assert low <= 50.0 + sign * STILL <= high
        assert high - low < 3.0
    assert any("begins to move at OP" in remark for remark in fit.remarks)
    fit.save(tmp_path / "fit.json")
    read = lm.read_fit(tmp_path / "fit.json")
    assert read.chosen == fit.chosen
    np.testing.assert_array_equal(read.simulate(op), fit.simulate(op))


def test_simulation_has_the_jump():
    fit = lm.identify(*record(101), 1.0)
    steps = np.repeat([0.0, 7.5, 0.0, 10.5, 0.0, -7.5, 0.0, -10.5], 40)
    moved = np.abs(fit.simulate(steps) - fit.simulate(steps)[0]).reshape(8, 40)[:, -1]
    np.testing.assert_allclose(moved, [0.0, 0.0, 0.0, 4.5, 0.0, 0.0, 0.0, 4.5], atol=0.5)


def test_a_dead_zone_without_a_jump_has_none():
    fits = [lm.identify(*record(seed, still=LINES), 1.0) for seed in range(200, 210)]
    assert [fit.nuisances for fit in fits] == [()] * 10


@pytest.mark.statistics
@pytest.mark.sampled(4)
@pytest.mark.parametrize("seed", range(110, 130))
def test_intervals(seed):
    fit = lm.identify(*record(seed), 1.0)
    low, high = fit.interval("width", 0.999)
    assert low <= 2.0 * LINES <= high
    assert all(
        low <= end <= high for end, (low, high) in zip((-STILL, STILL), fit.chosen.break_away_intervals, strict=True)
    )


@pytest.mark.parametrize("offset", ["auto", "free"])
def test_a_bend_behind_it_does_not_move_the_lines(offset):
    fit = lm.identify(*record(103, still=LINES, bend=0.4), 1.0, offset=offset)
    assert fit.nuisances == ("bent characteristic",)
    for name, sign in (("left", -1), ("right", 1)):
        low, high = fit.interval(name, 0.999)
        assert low <= sign * LINES <= high
        assert high - low < 2.0
    low, high = fit.chosen.slopes
    assert low < 0.8
    assert high > 1.2
