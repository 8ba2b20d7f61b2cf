"""RecursiveML: one state and many ways through the samples, what it says, what it refuses."""

import copy
import functools
import io
import itertools
import json
import os
import pickle
import subprocess
import sys
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lostmotion as lm
from lostmotion.errors import DataError, ParameterError, Status
from lostmotion.kernels.recursive_ml import run as kernel
from lostmotion.kernels.recursive_ml import state as ml
from tests.refusals import refusal

TANK = lm.platforms.level_tank()
GAIN = TANK.linear.gain
NAN, INF = float("nan"), float("inf")
START = 300
QUICK = lm.Hammerstein(lm.DeadZone(-1, 1, 2, 3), lm.LinearModel((-0.6,), (0.4, 0.2), 1), 0.5)


def experiment(seed, n, model=TANK, hold=10, deviation=0.03**0.5):
    """Command and noisy measurement of the paper's test."""
    u = lm.signals.prs(n, -5, 5, hold=hold, seed=seed)
    return u, model.simulate(u) + np.random.default_rng(seed + 10_000).normal(scale=deviation, size=n)


def fresh(**options):
    return lm.RecursiveML(3, 2, 3, **{"gain": GAIN, "start_samples": START, "noise": "white", **options})


def quick(**options):
    """Low orders: a start costs little without the JIT."""
    return lm.RecursiveML(1, 1, 1, **{"start_samples": 120, "noise": "white", **options})


def holes(n, seed):
    """Command, measurement and mask of the quick plant with missing samples, a masked stretch and outliers."""
    u, y = experiment(seed, n, QUICK, deviation=0.1)
    rng = np.random.default_rng(seed)
    use = np.ones(n, dtype=bool)
    late = np.arange(n) > n // 3
    y[late & (rng.random(n) < 0.02)] = NAN
    u[late & (rng.random(n) < 0.02)] = NAN
    y[late & (rng.random(n) < 0.01)] += 3.0
    use[n // 2 : n // 2 + 17] = False
    return u, y, use


@functools.cache
def _saved(n, options):
    rml = fresh(**dict(options))
    rml.run(*experiment(0, n), every=n)
    assert rml.started
    return rml.to_bytes()


def started(n=START, **options):
    """After n samples of `experiment(0)`; the start is fitted once."""
    return lm.RecursiveML.from_bytes(_saved(n, tuple(sorted(options.items()))))


def same_state(one, other):
    assert one.to_bytes() == other.to_bytes()


# --- exact recovery


@pytest.mark.parametrize(
    ("orders", "model"),
    [
        ((3, 2, 3), TANK),
        ((1, 1, 1), QUICK),
        ((0, 0, 0), lm.Hammerstein(lm.DeadZone(0.5, 1.5, 1, 3), lm.LinearModel((), (2.0,), 0), -4.0)),
        ((2, 0, 2), lm.Hammerstein(lm.DeadZone(-2, 0.3, 3, 3), lm.LinearModel((-1.5, 0.56), (-0.3,), 2), 1.0)),
    ],
)
def test_without_noise_it_is_exact(orders, model):
    u = lm.signals.prs(600, -5, 5, hold=7, seed=1)
    rml = lm.RecursiveML(*orders, gain=model.linear.gain, start_samples=250, noise="white", false_alarms=None)
    rml.run(u, model.simulate(u), every=600)
    estimate, zone = rml.estimate, model.nonlinearity
    assert estimate.status is Status.OK
    truth = {name: getattr(zone, name) for name in ("left", "right", "left_slope", "right_slope")}
    truth |= {"width": zone.right - zone.left, "gain": model.linear.gain, "offset": model.offset}
    for name, value in truth.items():
        assert estimate.parameters[name] == pytest.approx(value, abs=1e-6), name
    np.testing.assert_allclose(estimate.linear.a, model.linear.a, atol=1e-6)
    np.testing.assert_allclose(estimate.linear.b, model.linear.b, atol=1e-6)


# --- one state, many ways through the samples


@pytest.mark.parametrize(("forgetting", "noise"), [(1.0, "white"), (0.99, 2)])
def test_update_run_and_chunks_are_the_same(forgetting, noise):
    """Through the start window too, with samples that are missing or masked."""
    u, y, use = holes(700, 3)
    whole, chunks, single = (quick(forgetting=forgetting, noise=noise) for _ in range(3))
    trajectory = whole.run(u, y, use=use)
    edges = [0, 1, 1, 119, 120, 121, 400, 577, 700]
    parts = [chunks.run(u[i:j], y[i:j], use=use[i:j]) for i, j in itertools.pairwise(edges)]
    errors = [single.update(*sample) for sample in zip(u, y, use, strict=True)]
    same_state(whole, chunks)
    same_state(whole, single)
    assert whole.started
    np.testing.assert_array_equal(trajectory.errors, errors)
    np.testing.assert_array_equal(trajectory.errors, np.concatenate([part.errors for part in parts]))
    np.testing.assert_array_equal(trajectory.samples, np.arange(1, 701))
    np.testing.assert_array_equal(trajectory.samples, np.concatenate([part.samples for part in parts]))
    for name in ("left", "right", "left_slope", "right_slope", "theta"):
        np.testing.assert_array_equal(trajectory[name], np.concatenate([part[name] for part in parts]))


@settings(max_examples=15)
@given(st.lists(st.integers(0, 500), max_size=6), st.integers(0, 500))
def test_any_cut_and_any_save_change_nothing(cuts, saved):
    u, y = experiment(0, START + 500)
    u, y = u[START:].copy(), y[START:].copy()
    y[50:55] = u[200:203] = NAN
    whole, cut = started(noise=2), started(noise=2)
    whole.run(u, y)
    for i, j in itertools.pairwise([0, *sorted([*cuts, saved]), 500]):
        if j == saved:
            cut = lm.RecursiveML.from_bytes(cut.to_bytes())
        cut.run(u[i:j], y[i:j])
    same_state(whole, cut)


@pytest.mark.statistics
def test_every_keeps_every_so_many():
    u, y = experiment(0, 800)
    full, thin = started().run(u, y), started().run(u, y, every=7)
    np.testing.assert_array_equal(thin.samples, START + np.arange(7, 801, 7))
    np.testing.assert_array_equal(thin["theta"], full["theta"][6::7])
    np.testing.assert_array_equal(thin["left"], full["left"][6::7])
    np.testing.assert_array_equal(thin.errors, full.errors)
    assert started().run(u, y, every=10**30).samples.size == 0


@pytest.mark.statistics
def test_trajectory_ends_at_the_estimate():
    rml = started(noise=2)
    trajectory, values = rml.run(*experiment(1, 300)), rml.estimate.parameters
    for name in ("left", "right", "left_slope", "right_slope"):
        assert trajectory[name][-1] == pytest.approx(values[name], rel=1e-12)


CONTINUE = """
import sys
import numpy as np
import lostmotion as lm
size, data = sys.stdin.buffer.readline(), sys.stdin.buffer.read()
rml = lm.RecursiveML.from_bytes(data[: int(size)])
u, y = np.frombuffer(data[int(size) :]).reshape(2, -1)
rml.run(u, y)
sys.stdout.buffer.write(rml.to_bytes())
"""


def elsewhere(rml, u, y):
    """The estimator after u and y in another process."""
    data = rml.to_bytes()
    job = subprocess.run(
        [sys.executable, "-c", CONTINUE],
        input=b"%d\n" % len(data) + data + np.stack([u, y]).tobytes(),
        capture_output=True,
        check=True,
        env=os.environ,
    )
    return lm.RecursiveML.from_bytes(job.stdout)


@pytest.mark.parametrize("saved", [70, 400])
def test_bytes_continue_in_another_process(saved):
    """From the middle of the start window, and after it."""
    u, y, _ = holes(700, 4)
    rml = quick(noise=2, dt=0.1)
    rml.run(u[:saved], y[:saved])
    assert rml.started is (saved > 120)
    other = elsewhere(rml, u[saved:], y[saved:])
    rml.run(u[saved:], y[saved:])
    same_state(rml, other)
    assert other.estimate.parameters == rml.estimate.parameters
    assert other.dt == 0.1


def moved(name, n, at, seed=0, by=1.0):
    """The tank whose break point, offset or gain moves at a sample; same command and noise as without."""
    u, y = experiment(seed, n)
    noise = y - TANK.simulate(u)
    zone, linear, offset = TANK.nonlinearity, TANK.linear, 0.0
    left = zone.left - by * (name == "left")
    right = zone.right + by * (name == "right")
    x = np.where(np.arange(n) < at, zone(u), lm.DeadZone(left, right, 3, 3)(u))
    if name == "process":
        x[at:] *= 1.0 + by
    if name == "offset":
        offset = by * (np.arange(n) >= at)
    return u, linear.simulate(x) + noise + offset


@pytest.mark.statistics
@pytest.mark.parametrize("forgetting", [1.0, 0.999])
def test_under_suspicion_it_can_be_cut_and_saved(forgetting):
    u, y = moved("right", 1600, 900)
    rml = fresh(forgetting=forgetting)
    rml.run(u[:900], y[:900], every=900)
    k = 900
    while rml._recursion.layout[ml.EXPLAIN_AT] == 0:
        rml.update(u[k], y[k])
        k += 1
        assert k < 1300
    assert rml.events == ()
    other, single = lm.RecursiveML.from_bytes(rml.to_bytes()), lm.RecursiveML.from_bytes(rml.to_bytes())
    last = elsewhere(rml, u[k:], y[k:])
    rml.run(u[k:], y[k:])
    for i in range(k, 1600, 13):
        other.run(u[i : i + 13], y[i : i + 13])
    for value, output in zip(u[k:], y[k:], strict=True):
        single.update(value, output)
    for twin in (other, single, last):
        same_state(rml, twin)
    assert [event.name for event in rml.events] == ["right"]
    assert (last.events, last.estimate.parameters) == (rml.events, rml.estimate.parameters)


@pytest.mark.statistics
@pytest.mark.parametrize(
    "clone",
    [lambda rml: lm.RecursiveML.from_bytes(rml.to_bytes()), lambda rml: pickle.loads(pickle.dumps(rml)), copy.deepcopy],  # noqa: S301
)
def test_copies_continue_on_their_own(clone):
    u, y = experiment(3, 400)
    rml = started()
    twin = clone(rml)
    same_state(rml, twin)
    before = rml.to_bytes()
    errors = twin.run(u, y).errors
    assert rml.to_bytes() == before
    np.testing.assert_array_equal(rml.run(u, y).errors, errors)
    same_state(rml, twin)


@pytest.mark.parametrize(("by_u", "by_y"), [(4.0, 1.0), (2.0**-20, 2.0**30), (1e-3, 7e5), (1.0, -1.0)])
def test_units_scale_the_results(by_u, by_y):
    """Powers of two change no bit of a mantissa."""
    u, y = experiment(5, 700, QUICK)
    one, other = quick(noise=1), quick(noise=1)
    errors = one.run(u, y).errors
    scaled = other.run(by_u * u, by_y * y).errors
    exact = {"rtol": 0 if by_u in (4.0, 2.0**-20) else 1e-5}
    np.testing.assert_allclose(scaled, by_y * errors, **exact, atol=0 if exact["rtol"] == 0 else 1e-6 * abs(by_y))
    values, expected = other.estimate.parameters, one.estimate.parameters
    units = {"left": by_u, "right": by_u, "width": by_u, "offset": by_y, "gain": by_y / by_u, "b0": by_y / by_u}
    units |= {"a1": 1.0, "slope_ratio": 1.0}
    for name, unit in units.items():
        assert values[name] == pytest.approx(unit * expected[name], rel=max(exact["rtol"], 1e-14)), name
        deviation = abs(unit) * one.estimate.standard_errors[name]
        assert other.estimate.standard_errors[name] == pytest.approx(deviation, rel=max(exact["rtol"], 1e-13)), name


def test_absolute_units_are_as_good():
    """50 % and 20 bar instead of deviations: only the offset's choice differs."""
    u, y = experiment(6, 700, QUICK)
    one, other = quick(offset="free"), quick(offset="free")
    one.run(u, y)
    other.run(u + 50.0, y + 2000.0)
    for name, shift in (("left", 50.0), ("right", 50.0), ("offset", 2000.0), ("a1", 0.0)):
        assert other.estimate.parameters[name] - shift == pytest.approx(one.estimate.parameters[name], abs=1e-5)
        assert other.estimate.standard_errors[name] == pytest.approx(one.estimate.standard_errors[name], rel=1e-3)


def test_inputs_are_not_touched_and_may_be_of_any_layout():
    u, y = experiment(4, 300)
    use = np.ones(300, dtype=bool)
    expected = started().run(u, y, use=use).errors
    table, wide = np.asfortranarray(np.stack([u, y], axis=1)), np.repeat(use, 2)
    for array in (u, y, use):
        array.flags.writeable = False
    kinds = [(u, y, use), (table[:, 0], table[:, 1], wide[::2]), (u.tolist(), tuple(y), [True] * 300)]
    for one, other, mask in kinds:
        np.testing.assert_array_equal(started().run(one, other, use=mask).errors, expected)


@pytest.mark.statistics
def test_a_mask_of_another_layout_compiles_nothing():
    u, y = experiment(4, 10)
    mask = np.ones(20, dtype=bool)
    mask.flags.writeable = False
    started().run(u, y)
    known = len(kernel.run.signatures)
    started().run(u, y, use=mask[:10])
    started().run(u, y, use=mask[::2])
    assert len(kernel.run.signatures) == known


@pytest.mark.statistics
def test_estimates_and_trajectories_stay_as_they_were():
    u, y = experiment(5, 600)
    rml = started()
    trajectory, estimate = rml.run(u[:300], y[:300]), rml.estimate
    rows, known = trajectory["theta"].copy(), (dict(estimate.parameters), estimate.covariance.copy())
    rml.run(u[300:], y[300:])
    np.testing.assert_array_equal(trajectory["theta"], rows)
    assert estimate.parameters == known[0]
    np.testing.assert_array_equal(estimate.covariance, known[1])
    assert estimate.samples == 600


def test_asking_changes_nothing():
    rml = started()
    before = rml.to_bytes()
    assert rml.estimate.summary() == str(rml.estimate)
    rml.to_bytes()
    assert rml.to_bytes() == before


def test_memory_does_not_grow():
    u, y = experiment(6, 1000)
    rml = started(false_alarms=None)
    rml.run(u, y)
    size, held = len(rml.to_bytes()), rml._recursion.state.size
    rml.update(u[0], y[0])
    tracemalloc.start()
    try:
        for k in range(300):
            rml.update(u[k], y[k])
        before = tracemalloc.get_traced_memory()[0]
        for k in range(300, 1000):
            rml.update(u[k], y[k])
        grown = tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()
    assert grown < 3000
    assert (len(rml.to_bytes()), rml._recursion.state.size) == (size, held)


# --- what it says


@pytest.mark.parametrize("orders", [(0, 0, 0), (1, 2, 3), (3, 2, 3)])
def test_usable_before_the_first_sample(orders):
    rml = lm.RecursiveML(*orders)
    estimate = rml.estimate
    assert rml.samples == estimate.samples == 0
    assert not rml.started
    assert estimate.status is Status.CANNOT_TELL
    assert all(np.isinf(value) for value in estimate.standard_errors.values())
    assert rml.period() is None
    assert "no number is given" in estimate.summary()
    empty = rml.run([], [])
    assert empty.errors.size == empty.samples.size == empty["left"].size == 0
    rml.update(1.0, 2.0)
    assert (rml.samples, rml.estimate.samples) == (1, 1)
    rml.reset()
    assert np.isnan(rml.run([1.0], [2.0])["right"]).all()


@pytest.mark.statistics
def test_parts_of_an_estimate():
    rml = started(dt=0.1, noise=2)
    rml.run(*experiment(7, 700), every=700)
    estimate, values = rml.estimate, rml.estimate.parameters
    assert estimate.status is Status.OK
    zone = (values[name] for name in ("left", "right", "left_slope", "right_slope"))
    assert estimate.nonlinearity == lm.DeadZone(*zone)
    a, b = tuple(values[f"a{i}"] for i in (1, 2, 3)), tuple(values[f"b{i}"] for i in range(3))
    assert estimate.linear == lm.LinearModel(a, b, 3, 0.1)
    assert values["width"] == pytest.approx(values["right"] - values["left"])
    assert values["gain"] == pytest.approx(GAIN)
    assert estimate.noise.variance == pytest.approx(0.03, rel=0.15)
    assert len(estimate.noise.d) == 2
    np.testing.assert_allclose(estimate.covariance, estimate.covariance.T, rtol=1e-9, atol=1e-15)
    assert np.linalg.eigvalsh(estimate.covariance)[0] > -1e-9
    low, high = estimate.interval("left", 0.9)
    reach = 1.6448536 * estimate.standard_errors["left"]
    assert (low, high) == pytest.approx((values["left"] - reach, values["left"] + reach))
    assert set(estimate.informed) == {"left", "right"}


def test_wrong_gain_is_said_and_unknown_gain_is_kept_apart():
    u, y = experiment(0, START)
    for gain, status in ((-GAIN, Status.WRONG_GAIN), (None, Status.OK)):
        rml = fresh(gain=gain)
        rml.run(u, y)
        estimate = rml.estimate
        assert estimate.status is status
        assert estimate.parameters["right_slope"] == 1.0
        assert estimate.parameters["gain"] == pytest.approx(3.0 * GAIN, rel=0.05)
        assert estimate.parameters["right"] == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("offset", ["auto", "free", "zero"])
def test_offset_is_as_asked(offset):
    rml = fresh(offset=offset)
    rml.run(*experiment(0, 900))
    value, deviation = rml.estimate.parameters["offset"], rml.estimate.standard_errors["offset"]
    assert (value == 0.0) is (offset != "free")
    assert (deviation == 0.0) is (offset != "free")


@pytest.mark.parametrize("offset", ["auto", "free", "zero"])
@pytest.mark.parametrize("seed", [0, 3])
@pytest.mark.statistics
def test_no_dead_zone_is_no_width(seed, offset):
    """Every estimate on the way can be asked for, and the last does not claim a width."""
    u, y = experiment(seed, 6000, lm.Hammerstein(lm.Identity(), TANK.linear))
    rml, claimed = lm.RecursiveML(3, 2, 3, offset=offset), []
    for k in range(0, 6000, 50):
        rml.run(u[k : k + 50], y[k : k + 50], every=50)
        estimate = rml.estimate
        claimed.append(estimate.status is Status.OK)
        assert not rml.started or estimate.parameters["width"] >= 0.0
        assert estimate.summary()
    assert np.mean(claimed) < 0.1
    assert estimate.status is Status.NOT_SEEN
    assert estimate.interval("width")[0] < 0.0 < estimate.interval("width")[1] < 0.1
    assert "no dead zone is seen" in estimate.summary()


def test_informed_says_since_when():
    u, y = experiment(8, 2200)
    noise = y - TANK.simulate(u)
    u[600:] = np.abs(u[600:])  # the left side is left alone
    y = TANK.simulate(u) + noise
    rml = fresh(false_alarms=None)
    rml.run(u, y, every=2200)
    informed = rml.estimate.informed
    assert 550 <= informed["left"] <= 800
    assert informed["right"] >= 2000
    summary = " ".join(rml.estimate.summary().split())
    assert f"No information about the left break point since sample {informed['left']}" in summary
    assert "right break point since" not in summary


def test_period_is_that_of_its_samples():
    u, y = experiment(9, 3000)
    rml = fresh(false_alarms=None)
    rml.run(u[:1996], y[:1996])
    rml.period()
    rml.run(u[1996:], y[1996:])
    values, errors, count = rml.period()
    assert set(values) == set(errors) == {"left", "right", "width"}
    assert values["width"] == pytest.approx(values["right"] - values["left"])
    assert count == 1004
    for name, true in {"left": -1.0, "right": 1.0, "width": 2.0}.items():
        assert abs(values[name] - true) < 5 * errors[name]
        assert 0.5 < errors[name] / rml.estimate.standard_errors[name] < 3.0
    assert rml.period() is None  # no block has closed since


@pytest.mark.statistics
def test_period_after_a_change_is_at_the_new_place():
    u, y = moved("right", 5000, 2000)
    rml = fresh()
    rml.run(u[:3000], y[:3000])
    rml.period()
    rml.run(u[3000:], y[3000:])
    values, errors, _ = rml.period()
    for name, true in {"left": -1.0, "right": 2.0, "width": 3.0}.items():
        assert abs(values[name] - true) < 5 * errors[name]


@pytest.mark.statistics
def test_period_without_a_move_says_nothing():
    rml = started()
    for seed in range(2):
        rml.period()
        rml.run(np.zeros(500), np.random.default_rng(seed).normal(scale=0.17, size=500))
    assert rml.period() is None


def test_reset_forgets_the_break_points_only():
    rml = started(900, false_alarms=None)
    before = rml.estimate
    rml.reset()
    after = rml.estimate
    for name in ("left", "right"):
        assert after.standard_errors[name] > 50 * before.standard_errors[name]
        assert after.parameters[name] == pytest.approx(before.parameters[name], abs=0.05)
    for name in ("a1", "b0"):
        assert after.standard_errors[name] < 2 * before.standard_errors[name]
    assert rml.samples == 900


@pytest.mark.parametrize("at", [901, 958])
def test_reset_forgets_the_samples_of_the_open_block_too(at):
    u, y = moved("right", 1500, at)
    rml = fresh(false_alarms=None)
    rml.run(u[:at], y[:at])
    rml.reset(("right",))
    rml.run(u[at:], y[at:])
    estimate = rml.estimate
    assert abs(estimate.parameters["right"] - 2.0) < 5 * estimate.standard_errors["right"] + 0.01


@pytest.mark.statistics
def test_reset_after_a_change_is_not_undone():
    """What is fitted again after a change may not bring back what was forgotten since."""
    u, y = moved("right", 2000, 900)
    rml = fresh()
    rml.run(u[:900], y[:900])
    k = 900
    while not rml.events:
        rml.update(u[k], y[k])
        k += 1
    rml.reset(("left", "right"))
    for _ in range(400):
        rml.update(0.0, 0.0)  # no news of either
    assert rml.estimate.standard_errors["right"] > 0.1  # it was 0.006, and its past moves still echo in the process


@pytest.mark.parametrize("names", [("lift",), "left", ("left", "widht")])
def test_reset_of_what_it_does_not_know(names):
    rml = started()
    before = rml.to_bytes()
    assert "slope_ratio" in refusal(ParameterError, rml.reset, names)
    assert rml.to_bytes() == before


# --- bad input


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"na": -1}, "na"),
        ({"nb": 1.5}, "nb"),
        ({"delay": None}, "delay"),
        ({"na": NAN}, "na"),
        ({"gain": 0}, "gain"),
        ({"gain": NAN}, "gain"),
        ({"gain": "high"}, "gain"),
        ({"forgetting": 0.95}, "forgetting"),
        ({"forgetting": 1.0001}, "forgetting"),
        ({"forgetting": NAN}, "forgetting"),
        ({"dt": 0.0}, "dt"),
        ({"noise": "pink"}, "noise"),
        ({"noise": -1}, "noise"),
        ({"noise": 1.5}, "noise"),
        ({"offset": "none"}, "offset"),
        ({"offset": None}, "offset"),
        ({"offset": np.array(["auto", "free"])}, "offset"),
        ({"start_samples": 50}, "start_samples"),
        ({"start_samples": 100.5}, "start_samples"),
        ({"outliers": 1.0}, "outliers"),
        ({"outliers": INF}, "outliers"),
        ({"outliers": "few"}, "outliers"),
        ({"false_alarms": 0.0}, "false_alarms"),
        ({"false_alarms": 0.5}, "false_alarms"),
        ({"false_alarms": NAN}, "false_alarms"),
    ],
)
def test_bad_settings(options, word):
    assert word in refusal(ParameterError, lm.RecursiveML, **{"na": 1, "nb": 0, "delay": 1, **options})


@pytest.mark.parametrize("kind", [np.float32, np.float64, np.int64])
def test_settings_of_any_number_type_can_be_saved(kind):
    rml = lm.RecursiveML(kind(1), kind(0), kind(1), kind(2), outliers=kind(4), dt=kind(1), start_samples=np.int32(500))
    assert lm.RecursiveML.from_bytes(rml.to_bytes())._settings == rml._settings


@pytest.mark.parametrize(
    ("u", "y"), [(INF, 0.0), (0.0, -INF), ("high", 0.0), (0.0, None), (1j, 0.0), (10**400, 0.0), ([1.0, 2.0], 0.0)]
)
def test_a_bad_sample_changes_nothing(u, y):
    rml = started()
    before = rml.to_bytes()
    refusal(DataError, rml.update, u, y)
    assert rml.to_bytes() == before


def test_bad_records_change_nothing():
    rml = started()
    before = rml.to_bytes()
    assert "(3,)" in refusal(DataError, rml.run, [1.0, 2.0, 3.0], [1.0, 2.0])
    refusal(DataError, rml.run, [[1.0], [2.0]], [1.0, 2.0])
    refusal(DataError, rml.run, [1.0, 2.0], ["a", "b"])
    assert "row 1" in refusal(DataError, rml.run, [1.0, INF], [1.0, 2.0])
    refusal(DataError, rml.run, [1.0, 2.0], [1.0, -INF])
    for use in ([True], [[True], [True]], [[True], [True, False]], True):
        refusal(DataError, rml.run, [1.0, 2.0], [1.0, 2.0], use=use)
    for every in (0, -1, 1.5, "all"):
        assert "every" in refusal(ParameterError, rml.run, [1.0], [1.0], every)
    assert rml.to_bytes() == before


@pytest.mark.parametrize("data", [b"", b"\x00", b"nothing like an archive" * 9, pickle.dumps([1]), b"PK\x03\x04" * 9])
def test_garbage_bytes(data):
    assert f"{len(data)} other bytes" in refusal(DataError, lm.RecursiveML.from_bytes, data)


@settings(max_examples=60)
@given(st.data())
def test_damaged_bytes(data):
    """Refused, or what was saved: parts of an archive mean nothing."""
    whole = started().to_bytes()
    kind = data.draw(st.sampled_from(["cut", "flip", "insert", "garbage"]))
    at = data.draw(st.integers(0, len(whole) - 1))
    damaged = {
        "cut": whole[:at],
        "flip": whole[:at] + bytes([whole[at] ^ data.draw(st.integers(1, 255))]) + whole[at + 1 :],
        "insert": whole[:at] + data.draw(st.binary(min_size=1, max_size=20)) + whole[at:],
        "garbage": data.draw(st.binary(max_size=200)),
    }[kind]
    try:
        rml = lm.RecursiveML.from_bytes(damaged)
    except DataError:
        return
    assert rml.to_bytes() == whole


def forged(**changes):
    """Bytes of an honest archive in which some parts have been replaced."""
    with np.load(io.BytesIO(started().to_bytes())) as stored:
        parts = {name: stored[name] for name in stored.files}
    for name, change in changes.items():
        parts[name] = change(parts[name])
    buffer = io.BytesIO()
    np.savez(buffer, **parts)
    return buffer.getvalue()


def with_entry(index, value):
    def change(layout):
        layout[index] = value
        return layout

    return change


def with_setting(name, value):
    def change(header):
        known = json.loads(header.tobytes())
        known["settings"][name] = value
        return np.frombuffer(json.dumps(known).encode(), dtype=np.uint8)

    return change


@pytest.mark.parametrize(
    "changes",
    [
        *({"layout": with_entry(getattr(ml, name), value)} for name, value in (
            ("FILLED", 10**6), ("FILLED", -1), ("BLOCKS", -3), ("WINDOW", 99), ("INVERSE", 10**9), ("RING_S", -5),
            ("RING_H", 10**9), ("P", 10**6), ("P", -1), ("DELAY", 50), ("NA", 2),
        )),
        {"layout": lambda layout: layout.astype(float)},
        {"layout": lambda layout: layout[:30]},
        {"state": lambda state: state[:-1]},
        {"state": lambda state: state.astype(np.float32)},
        {"scales": lambda scales: scales[:1]},
        {"gathered": lambda gathered: gathered[:1]},
        {"header": with_setting("na", 2)},
        {"header": with_setting("forgetting", 7.0)},
        {"header": with_setting("forgetting", 0.99)},
        {"header": with_setting("surprise", 1)},
        {"header": lambda header: header[:-5]},
    ],
)  # fmt: skip
def test_forged_bytes(changes):
    """The kernel does not look where it writes."""
    refusal(DataError, lm.RecursiveML.from_bytes, forged(**changes))


def test_honest_bytes_of_the_forger():
    same_state(lm.RecursiveML.from_bytes(forged()), started())


def test_memory_gives_views():
    rml = started()
    rml._recursion.memory.theta[0] = 0.123
    assert rml._recursion.state[rml._recursion.layout[ml.THETA]] == 0.123
