"""PV from a fit: simulated from OP alone, and predicted from PV up to some samples before."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lostmotion as lm
from lostmotion.errors import DataError, ParameterError
from lostmotion.identify.predicted import Predictor
from lostmotion.records import prepare
from tests.support.fits import VALVES, made_fit

DT, DELAY = 0.5, 2
KINDS = list(VALVES)


def held(n=400, seed=3, low=45.0, high=55.0):
    return np.repeat(np.random.default_rng(seed).uniform(low, high, n // 10), 10)


def twin(linear, x, before):
    """y(k) = sum b x - sum a y, sample by sample; x rests at `before` for ever before the first sample."""
    rest = linear.gain * before
    y = []
    for k in range(len(x)):
        past = [x[k - linear.delay - i] if k - linear.delay - i >= 0 else before for i in range(len(linear.b))]
        older = [y[k - 1 - j] if k - 1 - j >= 0 else rest for j in range(len(linear.a))]
        y.append(float(np.dot(linear.b, past) - np.dot(linear.a, older)))
    return np.array(y)


def coloured(n, d, seed, deviation=0.1):
    e = deviation * np.random.default_rng(seed).standard_normal(n)
    v = np.zeros(n)
    for k in range(n):
        v[k] = e[k] - sum(d[i] * v[k - 1 - i] for i in range(min(len(d), k)))
    return v, e


@pytest.mark.parametrize("kind", KINDS)
def test_an_array_begins_at_rest(kind):
    fit, u = made_fit(kind), held()
    x = np.asarray(fit.nonlinearity(u))
    np.testing.assert_allclose(fit.simulate(u), twin(fit.linear, x, x[0]) + 20.0, atol=1e-9)
    lower = twin(fit.linear, x, (11.0 - 20.0) / fit.linear.gain) + 20.0
    assert lower[0] == pytest.approx(11.0)
    np.testing.assert_allclose(fit.simulate(u, pv=11.0), lower, atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_a_record_without_noise_is_reproduced(kind):
    """Whatever came before it: the record is a part of a longer one."""
    fit, u = made_fit(kind), held(600)
    y, start = fit.model.simulate(u), 200
    record = lm.LoopRecord(u[start:], y[start:], dt=DT)
    simulated = fit.simulate(record)
    assert np.isnan(simulated[:DELAY]).all()
    np.testing.assert_allclose(simulated[DELAY:], y[start + DELAY :], rtol=0.0, atol=1e-9)
    for steps in (1, 7):
        predicted = fit.predict(record, horizon=steps)
        assert np.isnan(predicted[: DELAY + steps]).all()
        np.testing.assert_allclose(predicted[DELAY + steps :], y[start + DELAY + steps :], rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("kind", ["backlash", "stiction"])
@pytest.mark.parametrize("rest", [-0.9, -0.33, 0.0, 0.47, 0.8])
def test_where_a_valve_rests_is_found(kind, rest):
    """The first rows of a valve that had come from somewhere."""
    fit, u = made_fit(kind), held(600, seed=5)
    valve = fit.nonlinearity
    reach = 0.5 * sum(getattr(valve, name) for name in valve.own)
    u[:40] = u[0]
    x = valve.run(u, u[0] + rest * reach)
    record = lm.LoopRecord(u, twin(fit.linear, x, x[0]) + 20.0, dt=DT)
    simulated = fit.simulate(record)
    seen = np.isfinite(simulated)  # where OP and PV both rest, without noise, the recording may have stopped
    assert seen.sum() > 500
    np.testing.assert_allclose(simulated[seen], record.pv[seen], atol=1e-9)


def test_an_integrating_process_keeps_its_load_and_its_level():
    fit, u = made_fit("backlash", integrating=True), held(600)
    y = fit.linear.simulate(fit.nonlinearity(u - 50.0) + 0.3 + 50.0) + 7.0
    record = lm.LoopRecord(u, y, dt=DT)
    np.testing.assert_allclose(fit.simulate(record)[DELAY:], y[DELAY:], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(fit.simulate(u, pv=7.0), y, rtol=1e-9)
    assert fit.simulate(u)[0] == fit.model.offset


def test_an_integrating_process_of_unknown_load():
    """A record shows it; in an array the first OP holds the level."""
    fit, u = made_fit("none", integrating=True), held(600)
    del fit.parameters["load"]
    record = lm.LoopRecord(u, fit.linear.simulate(u - 49.3) + 7.0, dt=DT, gaps=(300,))
    simulated = fit.simulate(record)
    seen = np.isfinite(simulated)
    assert seen.sum() == 600 - 2 * DELAY
    np.testing.assert_allclose(simulated[seen], record.pv[seen], rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(fit.simulate(np.full(50, 48.0), pv=3.0), 3.0)


def test_prediction_of_white_noise_is_the_simulation():
    fit = replace(made_fit("dead zone"), noise=lm.NoiseModel((), 0.01))
    u = held()
    record = lm.LoopRecord(u, fit.model.simulate(u) + np.random.default_rng(1).normal(size=u.size), dt=DT)
    for steps in (1, 3, 1000):
        np.testing.assert_array_equal(fit.predict(record, horizon=steps), fit.simulate(record))


@pytest.mark.parametrize("d", [(-0.9,), (-1.2, 0.5), (-0.5, 0.2, -0.3)])
def test_prediction_of_coloured_noise(d):
    """Against the recursion with e = 0 from k - steps on, row by row."""
    fit = replace(made_fit("dead zone"), noise=lm.NoiseModel(d, 0.01))
    u = held()
    record = lm.LoopRecord(u, fit.model.simulate(u) + coloured(u.size, d, 2)[0], dt=DT)
    z = fit.simulate(record)
    v = record.pv - z
    for steps in (1, 2, 5):
        expected = np.full(u.size, np.nan)
        for k in range(DELAY + steps + len(d) - 1, u.size):
            known = v[DELAY : k - steps + 1].tolist()
            for _ in range(steps):
                known.append(-sum(d[i] * known[-1 - i] for i in range(len(d))))
            expected[k] = z[k] + known[-1]
        np.testing.assert_allclose(fit.predict(record, horizon=steps), expected, atol=1e-9)
    far = fit.predict(record, horizon=300)
    assert np.isfinite(far).sum() == 400 - 300 - DELAY - len(d) + 1
    np.testing.assert_allclose(far[-90:], z[-90:], atol=1e-9)


@pytest.mark.statistics
def test_errors_grow_as_theory_says():
    """Variance of errors k steps ahead: that of e times the sum of squares of the first k of 1/D."""
    d, n = (-1.2, 0.5), 40_000
    fit = replace(made_fit("dead zone"), noise=lm.NoiseModel(d, 0.01))
    u = np.tile(held(4000), 10)
    record = lm.LoopRecord(u, fit.model.simulate(u) + coloured(n, d, 4)[0], dt=DT)
    impulse = [1.0]
    while len(impulse) < 10:
        impulse.append(1.2 * impulse[-1] - 0.5 * (impulse[-2] if len(impulse) > 1 else 0.0))
    for steps in (1, 2, 10):
        errors = (record.pv - fit.predict(record, horizon=steps))[100:]
        assert np.var(errors) == pytest.approx(0.01 * np.sum(np.square(impulse[:steps])), rel=0.05)
    assert (
        abs(np.corrcoef((record.pv - fit.predict(record))[100:-1], (record.pv - fit.predict(record))[101:])[0, 1])
        < 0.02
    )


@pytest.mark.statistics
@pytest.mark.parametrize("noise", ["white", 2])
def test_one_step_ahead_leaves_the_residuals_of_the_fit(noise):
    tank = lm.platforms.level_tank()
    u = lm.signals.prs(800, -5, 5, hold=10, seed=1)
    y = tank.simulate(u) + coloured(800, (-0.6,), 3)[0]
    fit = lm.identify(u, y, 0.1, nonlinearity="dead zone", orders=(3, 2, 3), noise=noise)
    record = lm.LoopRecord(u, y, dt=0.1)
    skipped = 800 - fit.residuals.size
    begun = 30 if noise else 0  # the likelihood takes the first rows as given, a prediction does not
    np.testing.assert_allclose((y - fit.predict(record))[skipped:][begun:], fit.residuals[begun:], atol=1e-3)
    seen = np.isfinite(fit.simulated)
    np.testing.assert_allclose(fit.simulate(record)[seen], fit.simulated[seen], atol=3e-3)


def test_pieces_between_gaps_and_holes():
    fit, u = made_fit("dead zone"), held(600)
    y = fit.model.simulate(u)
    op, pv = u.copy(), y.copy()
    op[100:110] = np.nan  # ten rows: nobody knows where the valve was
    pv[300:340] = np.nan  # PV is simulated all the same, and not predicted from
    op[203] = np.nan  # held, as the fit does
    record = lm.LoopRecord(op, pv, dt=DT, gaps=(450,))
    simulated = fit.simulate(record)
    holes = np.zeros(600, bool)
    for start in (0, 110, 450):
        holes[start : start + DELAY] = True
    holes[100:110] = True
    np.testing.assert_array_equal(np.isnan(simulated), holes)
    np.testing.assert_allclose(simulated[~holes], y[~holes], atol=1e-9)
    predicted = fit.predict(record, horizon=2)
    assert np.isnan(predicted[302:342]).all()
    for start, stop in ((4, 100), (114, 302), (342, 450), (454, 600)):
        np.testing.assert_allclose(predicted[start:stop], y[start:stop], atol=1e-9)


def test_rows_that_no_identification_trusts():
    """A wild PV and one that stuck are not predicted from; OP that did not reach the valve is unknown."""
    random = np.random.default_rng(2)
    fit, u = made_fit("dead zone"), held(1000) + 0.02 * random.standard_normal(1000)
    y = fit.model.simulate(u) + 0.2 * random.standard_normal(1000)
    pv, mode = y.copy(), np.full(1000, "AUTO")
    pv[50], pv[300:400] = y[50] + 40.0, y[300]
    mode[600:640] = "LO"  # a local override: OP need not be what the valve had
    record = lm.LoopRecord(u, pv, mode=mode, dt=DT)
    assert {"outlier", "stuck PV", "mode"} <= {part.kind for part in prepare(record).left_out}
    simulated = fit.simulate(record)
    assert np.std((simulated - y)[DELAY:600]) < 0.25
    assert np.isnan(simulated[600:640]).all()
    predicted = fit.predict(record)
    assert np.isnan(predicted[[51, *range(310, 390)]]).all()
    assert np.std((y - predicted)[700:]) < 0.25


@pytest.mark.parametrize("hole", [(0, 40), (3, 40), (30, 200)])
def test_a_state_is_not_told_by_what_is_left_of_it(hole):
    """PV that comes late, or has a hole soon: the simulation begins with it, and its noise is not blown up."""
    fit, u = made_fit("dead zone"), held(600)
    y = fit.model.simulate(u)
    pv = y + 0.1 * np.random.default_rng(0).standard_normal(600)
    pv[slice(*hole)] = np.nan
    simulated = fit.simulate(lm.LoopRecord(u, pv, dt=DT))
    first = hole[1] if hole[0] < 10 else DELAY
    assert np.isfinite(simulated).tolist() == [k >= first for k in range(600)]
    assert np.abs(simulated - y)[first:].max() < 0.5


def test_a_piece_that_tells_nothing_begins_at_rest():
    fit = made_fit("none")
    record = lm.LoopRecord(np.full(50, 50.0), np.full(50, np.nan), dt=DT)
    np.testing.assert_allclose(fit.simulate(record), fit.model.offset + 50.0 * fit.linear.gain)


def test_op_beyond_its_span_ends_there():
    fit = made_fit("none")
    u = held(400, low=90.0, high=110.0)
    y = fit.model.simulate(np.minimum(u, 100.0))
    record = lm.LoopRecord(u, y, dt=DT, op_span=(0.0, 100.0))
    np.testing.assert_allclose(fit.simulate(record)[DELAY:], y[DELAY:], atol=1e-9)


def test_the_scans_of_a_faster_record():
    fit, u = made_fit("dead zone"), held() + 0.01 * np.random.default_rng(0).normal(size=400)
    y = fit.model.simulate(u)
    slow = np.repeat(u, 4)[1:], np.repeat(y, 4)[1:]
    simulated = fit.simulate(lm.LoopRecord(*slow, dt=DT / 4))
    rows = np.flatnonzero(np.isfinite(simulated))
    assert np.unique(np.diff(rows)).tolist() == [4]
    np.testing.assert_allclose(simulated[rows], slow[1][rows], atol=1e-6)


def test_files_frames_and_saved_fits(tmp_path):
    fit, u = made_fit("dead zone"), held()
    y = fit.model.simulate(u)
    frame = pd.DataFrame({"t_s": DT * np.arange(u.size), "OP": u, "PV": y})
    path = tmp_path / "FIC-1.csv"
    frame.to_csv(path, index=False)
    fit.save(tmp_path / "fit.json")
    for one in (fit, fit.facts, lm.read_fit(tmp_path / "fit.json")):
        for source in (path, str(path), frame, lm.LoopRecord(u, y, dt=DT)):
            np.testing.assert_allclose(one.simulate(source)[DELAY:], y[DELAY:], atol=1e-9)
            np.testing.assert_allclose(one.predict(source)[DELAY + 1 :], y[DELAY + 1 :], atol=1e-9)


@pytest.mark.statistics
def test_recursive_estimates_simulate():
    tank = lm.platforms.level_tank()
    u = lm.signals.prs(3000, -5, 5, hold=10, seed=1)
    estimator = lm.RecursiveIV(na=3, nb=2, delay=3, gain=tank.linear.gain)
    estimator.run(u, tank.simulate(u))
    simulated = estimator.estimate.simulate(u)
    assert np.abs(simulated - tank.simulate(u))[50:].max() < 0.05 * np.ptp(tank.simulate(u))
    with pytest.raises(ParameterError, match="an estimate with a noise model"):
        estimator.estimate.predict(lm.LoopRecord(u, u, dt=0.1))


def test_refusals():
    fit = made_fit("dead zone")
    record = lm.LoopRecord(held(), held(seed=8), dt=1.0)
    with pytest.raises(ParameterError, match=r"one sample every 0\.5 s, got one every 1 s; resample"):
        fit.simulate(record)
    same = replace(record, dt=DT)
    with pytest.raises(ParameterError, match="no pv beside a record"):
        fit.simulate(same, pv=1.0)
    for steps in (0, -1, 1.5, "two"):
        with pytest.raises(ParameterError, match="horizon as a whole number >= 1"):
            fit.predict(same, horizon=steps)
    with pytest.raises(ParameterError, match="a record with OP and PV"):
        fit.predict(held())
    with pytest.raises(ParameterError, match="no pv beside a record"):
        fit.predict(same, 5)
    with pytest.raises(DataError, match="expected"):
        fit.predict(held(), held()[:-1])
    with pytest.raises(DataError, match="finite op"):
        fit.simulate([1.0, np.nan])
    with pytest.raises(ParameterError, match="no initial beside a record"):
        fit.simulate(same, initial=[1.0])
    with pytest.raises(ParameterError, match="pv or initial, got both"):
        fit.simulate(held(), 1.0, initial=[1.0])
    with pytest.raises(ParameterError, match="samples of PV as initial, got 1"):
        fit.simulate(held(), initial=[1.0])
    with pytest.raises(ParameterError, match="finite pv"):
        fit.simulate([1.0, 2.0], pv=np.inf)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**31), st.integers(3, 60), st.integers(1, 80), st.sampled_from(KINDS))
def test_any_record_gives_its_rows(seed, n, steps, kind):
    """Short, with holes, with steps beyond its end: never an error, never another length."""
    random = np.random.default_rng(seed)
    op, pv = 50.0 + random.normal(size=(2, n))
    op[random.random(n) < 0.1] = np.nan
    pv[random.random(n) < 0.2] = np.nan
    fit = made_fit(kind)
    record = lm.LoopRecord(op, pv, dt=DT, gaps=(1,) if random.random() < 0.5 else ())
    assert fit.simulate(record).shape == fit.predict(record, horizon=steps).shape == (n,)
    scans = Predictor(fit.model, fit.noise)
    assert scans.on_record(record).shape == (n,)


@pytest.mark.parametrize("kind", KINDS)
def test_a_simulation_begins_where_the_first_pv_are(kind):
    """The protocol of benchmarks of nonlinear identification: a few PV, and OP from there on."""
    fit, op = made_fit(kind), held()
    whole = fit.simulate(op, pv=float(fit.simulate(op)[0]) + 3.0)
    later = fit.simulate(op, initial=whole[:40])
    assert later.shape == whole.shape
    if kind in ("none", "dead zone", "saturation"):
        np.testing.assert_allclose(later, whole, atol=1e-6)
    assert abs(later[0] - whole[0]) < 0.5


def test_arrays_are_predicted_as_a_record_is():
    fit = made_fit("dead zone")
    op = held()
    pv = fit.simulate(op) + 0.1 * np.random.default_rng(4).normal(size=op.size)
    record = lm.LoopRecord(op, pv, dt=DT)
    np.testing.assert_allclose(fit.predict(op, pv, 3), fit.predict(record, horizon=3), atol=1e-9)
