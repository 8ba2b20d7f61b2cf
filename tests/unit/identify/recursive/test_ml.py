"""RecursiveML: one state and many ways through the samples, what it says, what it refuses."""

import functools
import io
import json
import os
import subprocess
import sys

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import DataError, ParameterError, Status
from lostmotion.kernels.recursive_ml import run as kernel
from lostmotion.kernels.recursive_ml import state as ml
from tests.support.refusals import refusal

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


def test_a_first_window_of_stretches_that_are_too_short_for_identify():
    """Those of 46 to 59 samples were left out by one part and counted by the other, where an outlier was drawn in."""
    u, y = experiment(1, 800, QUICK)
    y[65:71] = y[128] = NAN
    y[200] += 3.0
    rml = lm.RecursiveML(1, 0, 1, start_samples=300, noise="white")
    rml.run(u, y)
    assert rml.samples == 800


@pytest.mark.parametrize("lost", ["both", "u", "y"])
def test_a_state_after_more_gap_than_record_is_read_again(lost):
    """A loop that is switched off for longer than it has run: its next start must know its state."""
    u, y = experiment(1, 400, QUICK)
    rml = quick()
    rml.run(u, y)
    gap = np.full(1500, NAN)
    rml.run(np.full(1500, u[-1]) if lost == "y" else gap, np.full(1500, y[-1]) if lost == "u" else gap)
    again = lm.RecursiveML.from_bytes(rml.to_bytes())
    more = experiment(2, 200, QUICK)
    rml.run(*more)
    again.run(*more)
    assert again.to_bytes() == rml.to_bytes()
    assert again.samples == 2100


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


# --- what it says


def test_before_the_start():
    """What the contract of all recursive estimators does not ask for."""
    rml = lm.RecursiveML(1, 2, 3)
    assert rml.period() is None
    assert "no number is given" in rml.estimate.summary()
    rml.update(1.0, 2.0)
    rml.reset()
    assert rml.samples == 0
    assert np.isnan(rml.run([1.0], [2.0])["right"]).all()


@pytest.mark.parametrize("gain", [None, QUICK.linear.gain])
def test_a_trajectory_ends_at_the_estimate(gain):
    rml = quick(gain=gain)
    way, names = rml.run(*experiment(1, 400, QUICK)), ("left", "right", "left_slope", "right_slope")
    found = rml.estimate.parameters
    assert [way[name][-1] for name in names] == pytest.approx([found[name] for name in names], rel=1e-12)


@pytest.mark.statistics
def test_noise_and_information_of_an_estimate():
    rml = started(dt=0.1, noise=2)
    rml.run(*experiment(7, 700), every=700)
    estimate = rml.estimate
    assert estimate.status is Status.OK
    assert estimate.parameters["gain"] == pytest.approx(GAIN)
    assert estimate.noise.variance == pytest.approx(0.03, rel=0.15)
    assert len(estimate.noise.d) == 2
    assert np.linalg.eigvalsh(estimate.covariance)[0] > -1e-9
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


@pytest.mark.parametrize("kind", [np.float32, np.float64, np.int64])
def test_settings_of_any_number_type_can_be_saved(kind):
    rml = lm.RecursiveML(kind(1), kind(0), kind(1), kind(2), outliers=kind(4), dt=kind(1), start_samples=np.int32(500))
    assert lm.RecursiveML.from_bytes(rml.to_bytes())._settings == rml._settings


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


def test_a_slope_ratio_at_its_bound_is_no_estimate():
    """The number is that of the bound, whatever the standard error says."""
    u, y = experiment(1, 800, QUICK)
    rml = quick()
    rml.run(u[:600], y[:600])
    assert rml.estimate.status is Status.OK
    rml._recursion.state[ml.RATIO_LIMIT] = 0.1  # the true logarithm is -0.4
    rml.run(u[600:], y[600:])
    assert rml.estimate.status is Status.NOT_CONVERGED
