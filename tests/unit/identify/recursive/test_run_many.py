import copy
import threading

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import DataError, ParameterError
from lostmotion.identify.recursive import many
from tests.support.refusals import refusal

TANK = lm.platforms.level_tank()


def loops(count, n=300):
    """u and y of some level tanks, (count, n)."""
    u = np.stack([lm.signals.prs(n, -5, 5, hold=10, seed=seed) for seed in range(count)])
    noise = np.random.default_rng(0).normal(scale=0.1, size=u.shape)
    return u, np.stack([TANK.simulate(row) for row in u]) + noise


def estimators(count):
    return [lm.RecursiveIV(3, 2, 3, TANK.linear.gain, start_samples=50 + loop) for loop in range(count)]


def same(one, other):
    np.testing.assert_array_equal(one.errors, other.errors)
    np.testing.assert_array_equal(one.samples, other.samples)
    assert one.values.keys() == other.values.keys()
    for name in one.values:
        np.testing.assert_array_equal(one[name], other[name])


@pytest.mark.parametrize("workers", [1, 2, 3, 50, None])
@pytest.mark.parametrize("count", [1, 7])
def test_results_are_those_of_one_by_one(count, workers):
    u, y = loops(count)
    together, single = estimators(count), estimators(count)
    trajectories = lm.run_many(together, u, y, every=7, workers=workers)
    assert len(trajectories) == count
    for trajectory, estimator, row, output in zip(trajectories, single, u, y, strict=True):
        same(trajectory, estimator.run(row, output, every=7))
    assert [one.to_bytes() for one in together] == [one.to_bytes() for one in single]


def test_starts_are_fitted_in_processes_with_the_same_results():
    """Three that have to start (one is too short to), one that has started already."""
    u, y = loops(4, n=500)

    def made():
        ones = [lm.RecursiveML(3, 2, 3, TANK.linear.gain, start_samples=300, noise="white") for _ in u]
        ones[3].run(u[3, :300], y[3, :300])
        return ones

    lengths = [500, 450, 200, 150]
    inputs, outputs = ([row[:size] for row, size in zip(rows, lengths, strict=True)] for rows in (u, y))
    together, single = made(), made()
    assert [many._fits_first((one, row, row, 1)) for one, row in zip(single, inputs, strict=True)] == [
        True, True, False, False
    ]  # fmt: skip
    trajectories = lm.run_many(together, inputs, outputs, every=9, workers=2)
    for trajectory, estimator, row, output in zip(trajectories, single, inputs, outputs, strict=True):
        same(trajectory, estimator.run(row, output, every=9))
    assert [one.to_bytes() for one in together] == [one.to_bytes() for one in single]


def test_loops_of_different_length():
    u, y = loops(4)
    lengths = [300, 0, 20, 7]
    inputs = [row[:n].tolist() for row, n in zip(u, lengths, strict=True)]
    outputs = tuple(row[:n] for row, n in zip(y, lengths, strict=True))
    trajectories = lm.run_many(estimators(4), inputs, outputs, workers=2)
    assert [trajectory.errors.size for trajectory in trajectories] == lengths
    for trajectory, estimator, row, output in zip(trajectories, estimators(4), inputs, outputs, strict=True):
        same(trajectory, estimator.run(row, output))


def test_no_loops():
    assert lm.run_many([], [], []) == []
    assert lm.run_many([], np.empty((0, 5)), np.empty((0, 5)), workers=2) == []


def test_continues_where_the_estimators_stand():
    u, y = loops(3)
    together, single = estimators(3), estimators(3)
    lm.run_many(together, u[:, :100], y[:, :100])
    trajectories = lm.run_many(together, u[:, 100:], y[:, 100:], every=50)
    for trajectory, estimator, row, output in zip(trajectories, single, u, y, strict=True):
        estimator.run(row[:100], output[:100])
        same(trajectory, estimator.run(row[100:], output[100:], every=50))


class Watched:
    """Any object with run(u, y, every) will do; this one waits for another thread."""

    def __init__(self, meeting):
        self.meeting = meeting

    def run(self, u, y, every=1):
        self.meeting.wait(timeout=30)
        return lm.RecursiveIV(1, 0, 1).run(u, y, every)


def test_workers_run_at_the_same_time():
    u, y = loops(2, n=20)
    meeting = threading.Barrier(2)
    assert len(lm.run_many([Watched(meeting), Watched(meeting)], u, y, workers=2)) == 2


class Failing:
    def run(self, u, y, every=1):
        raise RuntimeError("no")


@pytest.mark.parametrize("workers", [1, 2])
def test_failure_of_one_loop_is_raised(workers):
    u, y = loops(3, n=20)
    with pytest.raises(RuntimeError, match="no"):
        lm.run_many([*estimators(2), Failing()], u, y, workers=workers)


def unchanged_after(error, word, change):
    u, y = loops(3, n=60)
    ones = estimators(3)
    lm.run_many(ones, u, y)
    before = [copy.deepcopy(one) for one in ones]
    assert word in refusal(error, lm.run_many, *change(ones, u.copy(), y.copy()))
    assert [one.to_bytes() for one in ones] == [one.to_bytes() for one in before]


def with_nan(u):
    u[-1, -1] = np.nan
    return u


@pytest.mark.parametrize(
    ("word", "change"),
    [
        ("u of 3 signals", lambda ones, u, y: (ones, u[:2], y)),
        ("y of 3 signals", lambda ones, u, y: (ones, u, y[:2])),
        ("y of 3 signals", lambda ones, u, y: (ones, u, np.vstack([y, y]))),
        ("y[0] with 60 samples", lambda ones, u, y: (ones, u, y[:, 1:])),
        ("y[2] with 60 samples", lambda ones, u, y: (ones, u, [y[0], y[1], y[2, :50]])),
        ("finite u[2]", lambda ones, u, y: (ones, with_nan(u), y)),
        ("finite y[2]", lambda ones, u, y: (ones, u, with_nan(y))),
        ("u of 3 signals", lambda ones, u, y: (ones, 1.0, y)),
        ("u[0] of one dimension", lambda ones, u, y: (ones, u[:, :, None], y)),
        ("u[0] of one dimension", lambda ones, u, y: (ones, u[:, 0], y[:, 0])),
        ("u[0]", lambda ones, u, y: (ones, ["a", "b", "c"], y)),
    ],
)
def test_bad_signals_change_nothing(word, change):
    unchanged_after(DataError, word, change)


@pytest.mark.parametrize(
    ("word", "change"),
    [
        ("every", lambda ones, u, y: (ones, u, y, 0)),
        ("workers", lambda ones, u, y: (ones, u, y, 1, 0)),
        ("workers", lambda ones, u, y: (ones, u, y, 1, 1.5)),
        ("different estimators", lambda ones, u, y: ([ones[0], ones[1], ones[0]], u, y)),
        ("run(u, y, every)", lambda ones, u, y: ([ones[0], ones[1], "riv"], u, y)),
    ],
)
def test_bad_settings_change_nothing(word, change):
    unchanged_after(ParameterError, word, change)
