import itertools

import numpy as np
import pytest

import lostmotion as lm


def long_record(n):
    model = lm.Hammerstein(lm.DeadZone(-0.7, 1.2, 2.0, 1.0), lm.LinearModel([-0.8], [0.3], 1), 3.0)
    u = lm.signals.prs(n, -5, 5, 7, seed=4)
    return lm.LoopRecord(u, model.simulate(u) + np.random.default_rng(4).normal(scale=0.05, size=n), dt=1.0)


def compare(record, cuts):
    """Pieces lose only their first rows: estimates within half a standard error, errors a little larger."""
    settings = {"orders": (1, 0, 1), "noise": "white", "offset": "free"}
    whole = lm.identify(record, **settings, nonlinearity="dead zone")
    edges = [0, *cuts, len(record)]
    parts = [record.cut(start, stop) for start, stop in itertools.pairwise(edges)]
    pieces = lm.identify(parts, **settings, nonlinearity="dead zone")
    assert pieces.data.segments.tolist() == [list(pair) for pair in itertools.pairwise(edges)]
    assert pieces.status is whole.status is lm.Status.OK
    assert list(pieces.parameters) == list(whole.parameters)
    for name, error in whole.standard_errors.items():
        assert abs(pieces.parameters[name] - whole.parameters[name]) < 0.5 * error + 1e-12, name
        assert pieces.standard_errors[name] == pytest.approx(error, rel=0.15), name


def test_two_pieces_of_one_record():
    compare(long_record(400), [170])


@pytest.mark.statistics
def test_many_pieces_of_one_record():
    compare(long_record(3000), [100, 700, 1300, 1390, 2600])


def test_pieces_with_other_initial_states_are_exact_without_noise():
    """Each piece of the response begins somewhere else; without noise nothing of this may be seen."""
    model = lm.Hammerstein(lm.DeadZone(-0.7, 1.2, 2.0, 1.0), lm.LinearModel([-1.3, 0.42], [0.1, 0.2], 2), 3.0)
    u = lm.signals.prs(400, -5, 5, 7, seed=4)
    record = lm.LoopRecord(u, model.simulate(u), dt=1.0)
    fit = lm.identify(
        [record.cut(250, 390), record.cut(30, 180)], orders=(2, 1, 2), noise="white", nonlinearity="dead zone"
    )
    for name, value in {"left": -0.7, "right": 1.2, "slope_ratio": 2.0, "a1": -1.3, "b1": 0.2}.items():
        assert fit.parameters[name] == pytest.approx(value, abs=1e-8), name
