"""RecursiveML where its assumptions do not hold: drift, colour, rounded OP, glitches, integrating processes."""

import io
import json

import numpy as np
import pytest
from scipy.signal import lfilter

import lostmotion as lm
from lostmotion.errors import Status
from lostmotion.identify.recursive import ml_bytes
from lostmotion.kernels.recursive_ml import drift, watch
from lostmotion.kernels.recursive_ml import state as ml

PROCESS = lm.LinearModel((-0.6,), (0.4, 0.2), 1)
ZONE = lm.DeadZone(-1, 1, 1, 1)


def record(seed, n, half=1.0, noise=None, u=None):
    """Command, and measurement of a quick process behind a dead zone whose half-width may be one for each sample."""
    u = lm.signals.prs(n, -5, 5, hold=5, seed=seed) if u is None else u
    x = np.maximum(u - half, 0.0) + np.minimum(u + half, 0.0)
    rng = np.random.default_rng(seed + 10_000)
    return u, PROCESS.simulate(x) + (rng.normal(scale=0.1, size=n) if noise is None else noise)


def after(u, y, **options):
    rml = lm.RecursiveML(1, 1, 1, **{"start_samples": 300, "noise": "white", **options})
    rml.run(u, y, every=u.size)
    return rml


def holds(estimate, errors=3.0, half=1.0):
    """Whether both break points are within so many standard errors of the truth."""
    values, spread = estimate.parameters, estimate.standard_errors
    return all(abs(values[name] - side * half) < errors * spread[name] for name, side in (("left", -1), ("right", 1)))


# --- drift


def random_reference(seed, n=6):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(n, n + 3))
    return root @ root.T, rng.normal(size=n)


@pytest.mark.parametrize("q", [0.0, 1e-6, 0.3, 1e6])
def test_walk_adds_its_variance_to_the_break_points_alone(q):
    h, r = random_reference(0)
    spread = np.linalg.inv(h) + q * np.diag([0, 0, 0, 1.0, 1.0, 0])
    theta = np.linalg.solve(h, r)
    drift.walk(h, r, 3, q)
    np.testing.assert_allclose(h, np.linalg.inv(spread), rtol=1e-7, atol=1e-8)
    np.testing.assert_allclose(r, h @ theta, rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("seed", range(3))
def test_foretold_is_the_likelihood_of_the_samples(seed):
    """The difference between two references, with the samples written out."""
    rng, variance = np.random.default_rng([seed, 1]), 0.3
    rows, y = rng.normal(size=(9, 6)), rng.normal(size=9)
    found, expected = [], []
    for number in range(2):
        h, r = random_reference(10 * seed + number)
        mean, covariance = rows @ np.linalg.solve(h, r), variance * (np.eye(9) + rows @ np.linalg.solve(h, rows.T))
        miss = y - mean
        expected.append(-0.5 * (np.linalg.slogdet(covariance)[1] + miss @ np.linalg.solve(covariance, miss)))
        found.append(drift.foretold(h, r, rows.T @ rows, rows.T @ y, rng.normal(size=6), variance))
        rng = np.random.default_rng([seed, 2])  # theta about which the sums are taken is the same for both
    again = [
        drift.foretold(*random_reference(10 * seed + number), rows.T @ rows, rows.T @ y, np.zeros(6), variance)
        for number in range(2)
    ]
    assert again[1] - again[0] == pytest.approx(expected[1] - expected[0], rel=1e-6)


@pytest.mark.statistics
@pytest.mark.parametrize("forgetting", [1.0, 0.9998])
@pytest.mark.parametrize("seed", range(3))
def test_a_dead_zone_that_grows_is_followed_and_the_interval_holds_it(seed, forgetting):
    n = 60_000
    half = 0.5 + np.arange(n) / n
    u, y = record(seed, n, half)
    rml = lm.RecursiveML(1, 1, 1, forgetting=forgetting, start_samples=300, noise="white")
    held = []
    for k in range(0, n, 2_000):
        rml.run(u[k : k + 2_000], y[k : k + 2_000], every=2_000)
        held.append(holds(rml.estimate, 1.96, half[k + 1_999]))
    assert np.mean(held[3:]) >= 0.85
    assert holds(rml.estimate, 4.0, 1.5)
    assert rml.estimate.parameters["right"] == pytest.approx(1.5, abs=0.05)
    assert rml._recursion.layout[ml.DRIFT] > 0
    assert len(rml.events) <= 2


@pytest.mark.statistics
@pytest.mark.parametrize("seed", range(4))
def test_a_dead_zone_that_stays_is_taken_to_stay(seed):
    rml = after(*record(seed, 30_000))
    assert rml._recursion.layout[ml.DRIFT] == 0
    assert rml.estimate.standard_errors["right"] < 0.002
    assert holds(rml.estimate, 4.0)


# --- colour


@pytest.mark.statistics
@pytest.mark.parametrize("seed", range(3))
def test_too_low_an_order_of_the_noise_is_said_and_is_no_change(seed):
    n = 20_000
    noise = lfilter([1.0], [1.0, -1.4, 0.45], np.random.default_rng(seed).normal(size=n))
    u, y = record(seed, n, noise=0.2 * noise / noise.std())
    told, untold = after(u, y, noise=2, start_samples=1000), after(u, y, start_samples=1000)
    assert told.estimate.status is Status.OK
    assert untold.estimate.status is Status.COLOURED
    assert len(told.events) == 0
    assert len(untold.events) <= 1
    assert holds(untold.estimate, 4.0)


def test_white_errors_are_not_called_coloured():
    assert after(*record(3, 1_200)).estimate.status is Status.OK


# --- rounded OP


@pytest.mark.statistics
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("step", [0.5, 1.0])
def test_rounded_op_is_known_to_its_step(step, seed):
    """The valve gets what the record has lost."""
    u, y = record(seed, 3_000)
    rounded = after(np.round(u / step) * step, y).estimate
    whole = after(u, y).estimate
    assert rounded.standard_errors["right"] >= step / 12**0.5
    assert rounded.standard_errors["width"] >= step / 6**0.5
    assert holds(rounded, 1.96)
    assert whole.standard_errors["right"] < 0.02


def test_two_levels_of_op_tell_nothing():
    u = np.where(lm.signals.prs(1_500, -1, 1, hold=7, seed=0) > 0, 3.0, -3.0)
    _, y = record(0, u.size, u=u)
    riv = lm.RecursiveIV(1, 1, 1, start_samples=200)
    riv.run(u, y)
    for estimate in (riv.estimate, after(u, y).estimate):
        assert estimate.status is Status.CANNOT_TELL
        assert min(estimate.standard_errors[name] for name in ("left", "right")) > 1.0


# --- glitches


@pytest.mark.statistics
@pytest.mark.parametrize("at", [100, 297, 1_500])
@pytest.mark.parametrize("which", ["op", "pv", "both"])
@pytest.mark.parametrize("value", [1e6, -1e29])
def test_a_glitch_is_survived(value, which, at):
    u, y = record(4, 4_000)
    clean = after(u, y).estimate
    u, y = u.copy(), y.copy()
    for signal in {"op": [u], "pv": [y], "both": [u, y]}[which]:
        signal[at : at + 5] = value
    rml = after(u, y)
    estimate = rml.estimate
    assert estimate.status is Status.OK
    assert holds(estimate, 4.0)
    assert estimate.standard_errors["right"] < 1.5 * clean.standard_errors["right"]
    assert estimate.noise.variance == pytest.approx(0.01, rel=0.2)
    assert rml._recursion.layout[ml.CLIPPED] < 60
    assert rml.events == ()


@pytest.mark.statistics
def test_a_command_that_stays_far_out_is_believed():
    """A loop at rest, and then in another place: missing for a block, and learned from again."""
    u, y = record(5, 4_000)
    rml = lm.RecursiveML(1, 1, 1, start_samples=300, noise="white")
    rml.run(u, y)
    rml.run(np.full(200, 200.0), np.random.default_rng(0).normal(100.0, 0.1, 200))
    assert rml._recursion.memory.span[1] * rml._recursion.scales[0] == pytest.approx(200.0)
    rml.run(np.full(200, 1e9), np.full(200, 100.0))
    assert rml._recursion.memory.span[1] * rml._recursion.scales[0] == pytest.approx(200.0)


# --- integrating processes


def level(seed, n):
    """A tank in a PI loop: the process integrates."""
    rng = np.random.default_rng(seed)
    sp = np.repeat(rng.choice([-1.0, 0.0, 1.0], n // 100 + 1), 100)[:n]
    e, y, u = rng.normal(scale=0.02, size=n), np.zeros(n), np.zeros(n)
    now, integral = 0.0, 0.0
    for k in range(n):
        now += 0.05 * float(ZONE(u[k - 2])) if k >= 2 else 0.0
        y[k] = now + e[k]
        integral += 0.002 * (sp[k] - y[k])
        u[k] = 2.0 * (sp[k] - y[k]) + integral
    return u, y


@pytest.mark.statistics
def test_an_integrating_process_is_refused_and_its_differences_are_followed():
    u, y = level(0, 3_000)
    refused = lm.RecursiveML(1, 0, 2, start_samples=500)
    refused.run(u, y)
    assert not refused.started
    assert refused.estimate.status is Status.INTEGRATING
    assert "differences of PV" in " ".join(refused.estimate.summary().split())
    assert lm.RecursiveML.from_bytes(refused.to_bytes()).estimate.status is Status.INTEGRATING
    followed = after(u[1:], np.diff(y), noise="auto", start_samples=500)
    assert followed.estimate.status is Status.OK
    assert followed.estimate.parameters["right"] == pytest.approx(1.0, abs=0.1)


# --- PV that is stuck


def masked_by_definition(y, share):
    """PV without what comes again more often in a row than chance allows, and the share of new ones that do."""
    kept, again = y.copy(), 0
    for k in range(1, len(y)):
        if y[k] == y[k - 1]:
            again += 1
            if share < 0.1 and share**again < 1e-4:
                kept[k] = np.nan
            share += (1 - share) / 1000 if again == 1 else 0.0
        else:
            share *= 1 - 1 / 1000 if again == 0 and np.isfinite(y[k] + y[k - 1]) else 1.0
            again = 0
    return kept, share


@pytest.mark.parametrize("step", [1e-9, 0.03, 0.1, 0.5])
def test_repeats_are_left_out_as_defined(step):
    y = np.round(np.random.default_rng(0).normal(size=3_000) / step) * step
    for at, length in ((0, 3), (100, 2), (200, 40), (900, 5), (2_990, 10)):
        y[at : at + length] = y[at]
    y[[50, 1_000, 1_001]] = np.nan
    new = np.flatnonzero(np.isfinite(y[2:] + y[1:-1]) & (y[1:-1] != y[:-2])) + 2
    new = np.concatenate([[1], new])
    expected, share = masked_by_definition(y, np.mean(y[new] == y[new - 1]))
    found = np.empty(ml.REPEATS_SIZE)
    np.testing.assert_array_equal(watch.without_stuck(y, found), expected)
    assert found[[ml.LAST_Y, ml.SHARE]] == pytest.approx([y[-1], share], rel=1e-9)
    assert np.isnan(expected).sum() > 40 if step < 0.3 else np.isnan(expected).sum() == 3


@pytest.mark.statistics
@pytest.mark.parametrize("at", [50, 250, 800])
def test_a_stuck_pv_is_missing(at):
    u, y = record(4, 1_500)
    y[at : at + 60] = y[at]
    missing = y.copy()
    missing[at + 1 : at + 60] = np.nan
    if at < 300:  # by then its share is one of some hundreds, and that is not rare enough for one repeat
        missing[at + 1] = y[at]
    told, found = after(u, missing), after(u, y)
    assert found.estimate.parameters == told.estimate.parameters
    assert not found.events


@pytest.mark.statistics
def test_a_rounded_pv_is_not_stuck():
    u, y = record(5, 3_000)
    rounded = after(u, np.round(y, 1))  # steps of one deviation of the noise
    assert rounded._recursion.layout[ml.MISSING] == 0
    assert holds(rounded.estimate)


@pytest.mark.parametrize(("equal", "expected"), [(1, 1.0), (8, 1.0), (9, (8 / 9) ** 2), (800, 1e-4)])
def test_weight_of_a_rounded_pv_that_comes_again(equal, expected):
    repeats = np.array([0.0, equal - 1.0, watch.ROUNDED])
    assert watch.news(repeats, 0) == pytest.approx(expected, rel=1e-12)
    assert watch.stuck(0.0, repeats, 0) is False
    assert repeats.tolist() == [0.0, equal, watch.ROUNDED]
    repeats[ml.REPEATED], repeats[ml.SHARE] = equal, 1.0
    assert watch.news(repeats, 0) == 1.0


def test_mean_weight_is_that_of_the_samples():
    y = np.repeat([1.0, np.nan, 2.0, 1.0], [3, 5, 20, 1])
    expected = (3 + 8 + np.sum((8 / np.arange(9, 21)) ** 2) + 1) / 24
    assert watch.mean_news(y, np.array([1.0, 7.0, watch.ROUNDED])) == pytest.approx(expected, rel=1e-12)


def at_rest(hold, seed, step, n=20_000, wider=0.0):
    """Tank whose OP rests for long, PV rounded to so many deviations of its noise; wider by half of the record."""
    tank = lm.platforms.level_tank()
    u = lm.signals.prs(n, -5, 5, hold=hold, seed=seed)
    x = np.maximum(u - 1.0 - np.where(np.arange(n) < n // 2, 0.0, wider), 0.0) + np.minimum(u + 1.0, 0.0)
    y = tank.linear.simulate(x) + np.random.default_rng(seed).normal(scale=0.003, size=n)
    return u, 0.003 * step * np.round(y / (0.003 * step))


def followed_tank(u, y):
    rml = lm.RecursiveML(3, 2, 3)
    rml.run(u, y, every=u.size)
    return rml


@pytest.mark.statistics
@pytest.mark.parametrize(("hold", "seed", "step"), [(600, 7, 3), (600, 7, 5), (600, 3, 10), (200, 2, 5), (60, 7, 5)])
def test_rounding_that_lasts_is_no_change(hold, seed, step):
    """Its error stays while OP rests and was counted as many: 6 to 32 events, where nothing had changed."""
    rml = followed_tank(*at_rest(hold, seed, step))
    assert not rml.events
    assert rml._recursion.layout[ml.MISSING] == 0
    assert rml.estimate.status in (Status.OK, Status.COLOURED)
    assert holds(rml.estimate, errors=4.0)
    again = lm.RecursiveML.from_bytes(rml.to_bytes())
    assert again.estimate.parameters == rml.estimate.parameters
    assert again._recursion.memory.parts["repeats"][ml.SHARE] == watch.ROUNDED


@pytest.mark.statistics
def test_a_change_is_seen_through_rounding():
    rml = followed_tank(*at_rest(60, 1, 3, wider=0.5))
    assert [event.name for event in rml.events] == ["right"]
    assert 10_000 < rml.events[0].sample < 10_600
    assert rml.estimate.parameters["right"] == pytest.approx(1.5, abs=0.01)


# --- states of earlier formats


def as_format(name, data):
    with np.load(io.BytesIO(data)) as stored:
        parts = {part: stored[part] for part in stored.files}
    header = json.loads(parts["header"].tobytes())
    header["format"] = name
    size, first_new = (ml.SECOND_SIZE, ml.REPEATS) if name == ml_bytes.SECOND_FORMAT else (ml.FIRST_SIZE, ml.WATCH)
    if name == ml_bytes.FIRST_FORMAT:
        del header["integrating"]
    parts["header"] = np.frombuffer(json.dumps(header).encode(), dtype=np.uint8)
    if parts["state"].size:
        parts["state"] = parts["state"][: parts["layout"][first_new]]
        parts["layout"] = parts["layout"][:size]
        parts["layout"][ml.SIZE] = parts["state"].size
    buffer = io.BytesIO()
    np.savez(buffer, **parts)
    return buffer.getvalue()


@pytest.mark.parametrize("name", [ml_bytes.FIRST_FORMAT, ml_bytes.SECOND_FORMAT])
@pytest.mark.parametrize("n", [100, 700])
def test_states_of_earlier_formats_are_read(n, name):
    u, y = record(6, 1_000)
    rml = after(u[:n], y[:n], false_alarms=None)
    older = lm.RecursiveML.from_bytes(as_format(name, rml.to_bytes()))
    for one in (rml, older):
        one.run(u[n:], y[n:])
    for parameter, value in rml.estimate.parameters.items():
        assert older.estimate.parameters[parameter] == pytest.approx(value, rel=1e-9), parameter
    assert lm.RecursiveML.from_bytes(older.to_bytes()).to_bytes() == older.to_bytes()
