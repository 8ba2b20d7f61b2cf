"""What every recursive estimator promises: each check is a function of a kind, crossed with all kinds.

An estimator that is added to ``tests.support.recursive_kinds.KINDS`` gets all checks. What only one of them does is
tested in its own file.
"""

import copy
import functools
import itertools
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
from tests.support.recursive_kinds import (
    ANY_BAD,
    INF,
    KINDS,
    LENGTH,
    NAN,
    ORDERS,
    READY,
    bytes_of_started,
    feed,
    plain_record,
)
from tests.support.refusals import refusal

ZONE = ("left", "right", "left_slope", "right_slope")
every_kind = pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
bad_data = pytest.mark.parametrize(
    "data",
    [b"", b"\x00", b"nothing like an archive" * 9, pickle.dumps([1]), b"PK\x03\x04" * 9, b"PK\x03\x04" + b"x" * 99],
)


def same(one, other):
    assert one.to_bytes() == other.to_bytes()
    assert one.samples == other.samples
    assert repr(one.estimate.parameters) == repr(other.estimate.parameters)


def same_rows(whole, parts):
    """A trajectory and the same in parts."""
    np.testing.assert_array_equal(whole.errors, np.concatenate([part.errors for part in parts]))
    np.testing.assert_array_equal(whole.samples, np.concatenate([part.samples for part in parts]))
    for name in (*ZONE, "theta"):
        np.testing.assert_array_equal(whole[name], np.concatenate([part[name] for part in parts]))


# --- one state, many ways through the samples


@pytest.mark.statistics
@every_kind
def test_update_run_and_chunks_are_the_same(kind):
    """Through the start too."""
    record = kind.record(1)
    whole, chunks, single = (kind.fresh() for _ in range(3))
    trajectory = feed(whole, record, 0, LENGTH)
    edges = [0, 1, 1, 119, 120, 121, 400, 577, LENGTH]
    parts = [feed(chunks, record, i, j) for i, j in itertools.pairwise(edges)]
    errors = [single.update(*sample) for sample in zip(*record, strict=True)]
    same(whole, chunks)
    same(whole, single)
    assert whole.started
    np.testing.assert_array_equal(trajectory.errors, errors)
    same_rows(trajectory, parts)
    np.testing.assert_array_equal(trajectory.samples, np.arange(1, LENGTH + 1))
    assert whole.samples == LENGTH


@every_kind
@settings(max_examples=8)
@given(cuts=st.lists(st.integers(0, LENGTH - READY), max_size=6), saved=st.integers(0, LENGTH - READY))
def test_any_cut_and_any_save_change_nothing(kind, cuts, saved):
    record, whole, cut = kind.record(), kind.started(), kind.started()
    feed(whole, record, READY, LENGTH)
    for i, j in itertools.pairwise([0, *sorted([*cuts, saved]), LENGTH - READY]):
        feed(cut, record, READY + i, READY + j)
        if j == saved:
            cut = kind.build.from_bytes(cut.to_bytes())
    same(whole, cut)


@every_kind
def test_every_keeps_every_so_many(kind):
    one, other = kind.started(), kind.started()
    full, thin = feed(one, kind.record(), READY, LENGTH), feed(other, kind.record(), READY, LENGTH, every=7)
    np.testing.assert_array_equal(thin.samples, READY + np.arange(7, LENGTH - READY + 1, 7))
    for name in (*ZONE, "theta"):
        np.testing.assert_array_equal(thin[name], full[name][6::7])
    np.testing.assert_array_equal(thin.errors, full.errors)
    same(one, other)
    last = one.estimate.parameters
    np.testing.assert_allclose([full[name][-1] for name in ZONE], [last[name] for name in ZONE], rtol=1e-12)
    assert feed(other, kind.record(), 0, 50, every=10**30).samples.size == 0


@every_kind
def test_whole_numbers_are_floats(kind):
    one, other = kind.started(), kind.started()
    for u, y in [(1, 2), (-3, 0), (2, -1), (0, 5)]:
        assert one.update(u, y) == other.update(float(u), float(y))
    same(one, other)


CONTINUE = """
import pickle, sys
import lostmotion as lm
done = []
for name, data, (u, y) in pickle.load(sys.stdin.buffer):
    estimator = getattr(lm, name).from_bytes(data)
    estimator.run(u, y)
    done.append(estimator.to_bytes())
pickle.dump(done, sys.stdout.buffer)
"""
SAVED = (70, 400)  # before the start, and after it


def begun(kind, saved):
    """An estimator that has seen so many samples, and the others."""
    record, estimator = kind.record(), kind.fresh(dt=0.1)
    feed(estimator, record, 0, saved)
    return estimator, np.stack([column[saved:] for column in record[:2]])


@pytest.fixture(scope="module")
def continued():
    """Bytes of all kinds, continued in one other process."""
    cases = [(kind, saved) for kind in KINDS for saved in SAVED]
    jobs = []
    for kind, saved in cases:
        estimator, rest = begun(kind, saved)
        jobs.append((kind.build.__name__, estimator.to_bytes(), rest))
    job = subprocess.run(
        [sys.executable, "-c", CONTINUE], input=pickle.dumps(jobs), capture_output=True, check=True, env=os.environ
    )
    names = [(kind.name, saved) for kind, saved in cases]
    return dict(zip(names, pickle.loads(job.stdout), strict=True))  # noqa: S301  of our own process


@pytest.mark.sampled(8)
@every_kind
@pytest.mark.parametrize("saved", SAVED)
def test_bytes_continue_in_another_process(kind, saved, continued):
    estimator, rest = begun(kind, saved)
    estimator.run(*rest)
    elsewhere = kind.build.from_bytes(continued[kind.name, saved])
    same(estimator, elsewhere)
    assert (elsewhere.samples, elsewhere.dt, elsewhere.started) == (LENGTH, 0.1, True)


@every_kind
@pytest.mark.parametrize(
    "clone",
    [
        lambda kind, estimator: kind.build.from_bytes(estimator.to_bytes()),
        lambda _, estimator: pickle.loads(pickle.dumps(estimator)),  # noqa: S301
        lambda _, estimator: copy.deepcopy(estimator),
    ],
    ids=["bytes", "pickle", "deepcopy"],
)
def test_copies_continue_on_their_own(kind, clone):
    estimator = kind.started()
    twin, before = clone(kind, estimator), estimator.to_bytes()
    same(estimator, twin)
    errors = feed(twin, kind.record(), READY, LENGTH).errors
    assert estimator.to_bytes() == before
    np.testing.assert_array_equal(feed(estimator, kind.record(), READY, LENGTH).errors, errors)
    same(estimator, twin)
    assert twin.estimate.linear.dt == 0.1


@every_kind
def test_inputs_are_not_touched_and_may_be_of_any_layout(kind):
    record = [column[READY:] for column in kind.record()]
    expected = feed(kind.started(), record, 0, None).errors
    before = [column.copy() for column in record]
    for column in record:
        column.flags.writeable = False
    table = np.asfortranarray(np.stack(record[:2], axis=1))
    wide = [np.repeat(column, 2)[::2] for column in record]
    for columns in (record, [table[:, 0], table[:, 1], *record[2:]], wide, [column.tolist() for column in record]):
        np.testing.assert_array_equal(feed(kind.started(), columns, 0, None).errors, expected)
    for column, kept in zip(record, before, strict=True):
        np.testing.assert_array_equal(column, kept)


@every_kind
def test_estimates_and_trajectories_stay_as_they_were(kind):
    estimator = kind.started()
    trajectory, estimate = feed(estimator, kind.record(), READY, 450), estimator.estimate
    rows, known = trajectory["theta"].copy(), (dict(estimate.parameters), estimate.covariance.copy())
    feed(estimator, kind.record(), 450, LENGTH)
    np.testing.assert_array_equal(trajectory["theta"], rows)
    assert estimate.parameters == known[0]
    np.testing.assert_array_equal(estimate.covariance, known[1])
    assert estimate.samples == 450


@every_kind
def test_asking_changes_nothing(kind):
    for estimator in (kind.fresh(), kind.started()):
        before = estimator.to_bytes()
        assert estimator.estimate.summary() == str(estimator.estimate)
        assert estimator.to_bytes() == before


@every_kind
def test_the_state_does_not_grow(kind):
    u, y = plain_record(False, 2)
    estimator = kind.fresh()
    estimator.run(u[:300], y[:300])
    size = len(estimator.to_bytes())
    tracemalloc.start()
    try:
        for k in range(300, 450):
            estimator.update(u[k], y[k])
        before = tracemalloc.get_traced_memory()[0]
        for k in range(450, LENGTH):
            estimator.update(u[k], y[k])
        grown = tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()
    assert grown < 3000
    assert len(estimator.to_bytes()) == size


# --- what it says


@every_kind
@pytest.mark.parametrize("orders", [(0, 0, 0), (0, 2, 1), (1, 0, 1), (2, 1, 0), (1, 2, 3), (3, 2, 3)])
def test_usable_before_the_first_sample(kind, orders):
    estimator = kind.build(*orders, **kind.options)
    estimate = estimator.estimate
    assert estimator.samples == estimate.samples == 0
    assert not estimator.started
    assert estimate.status is Status.CANNOT_TELL
    assert all(np.isinf(value) for value in estimate.standard_errors.values())
    assert not np.isfinite(estimate.interval("right")).any()
    assert "CANNOT_TELL" in estimate.summary()
    empty = estimator.run([], [])
    assert empty.errors.size == empty.samples.size == empty["left"].size == 0
    assert estimator.samples == 0
    estimator.update(1.0, 2.0)
    assert (estimator.samples, estimator.estimate.samples) == (1, 1)


@functools.cache
def names_of_a_fit():
    u, y = plain_record(False, 0)
    fit = lm.identify(u[:READY], y[:READY], dt=1.0, orders=ORDERS, noise="white", nonlinearity="dead zone")
    return set(fit.parameters)


@every_kind
def test_names_are_those_of_a_fit(kind):
    parameters = names_of_a_fit()
    estimate = kind.started().estimate
    assert set(estimate.parameters) in (parameters, parameters - {"offset"})
    assert set(estimate.standard_errors) == set(estimate.parameters)
    assert hasattr(estimate, "nonlinearity")
    assert hasattr(estimate, "linear")


@every_kind
def test_parts_of_an_estimate(kind):
    estimator = kind.started()
    feed(estimator, kind.record(), READY, LENGTH)
    estimate, values = estimator.estimate, estimator.estimate.parameters
    assert estimate.samples == estimator.samples == LENGTH
    if values["left"] <= values["right"] and min(values["left_slope"], values["right_slope"]) > 0:
        assert estimate.nonlinearity == lm.DeadZone(*(values[name] for name in ZONE))
    assert estimate.linear == lm.LinearModel((values["a1"],), (values["b0"], values["b1"]), 1, 0.1)
    assert values["width"] == pytest.approx(values["right"] - values["left"])
    assert values["gain"] == pytest.approx(estimate.linear.gain)
    assert estimate.covariance.shape == (len(values), len(values))
    np.testing.assert_allclose(estimate.covariance, estimate.covariance.T, rtol=1e-6, atol=1e-12)
    low, high = estimate.interval("left", 0.9)
    reach = 1.6448536 * estimate.standard_errors["left"]
    assert (low, high) == pytest.approx((values["left"] - reach, values["left"] + reach))
    assert "rihgt" in refusal(ParameterError, estimate.interval, "rihgt")


@pytest.mark.parametrize("kind", [KINDS[0], *KINDS[-2:]], ids=lambda kind: kind.name)
def test_it_is_near_the_truth(kind):
    """Roughly: how near is a matter of each one's own tests."""
    estimator = kind.started()
    feed(estimator, kind.record(), READY, LENGTH)
    estimate = estimator.estimate
    assert estimate.status is Status.OK
    assert estimate.parameters["left"] == pytest.approx(-1.0, abs=0.5)
    assert estimate.parameters["right"] == pytest.approx(1.0, abs=0.5)


# --- bad input


@every_kind
def test_bad_settings(kind):
    for options, word in [*ANY_BAD, *kind.bad]:
        message = refusal(ParameterError, kind.build, **{"na": 1, "nb": 0, "delay": 1, **options})
        assert word in message, options


BAD_NUMBERS = [(INF, 0.0), (0.0, -INF)]
NO_NUMBERS = [("high", 0.0), (0.0, None), (1j, 0.0), (10**400, 0.0), ([1.0, 2.0], 0.0)]


@every_kind
@pytest.mark.parametrize("ready", [False, True])
def test_a_bad_sample_changes_nothing(kind, ready):
    estimator = kind.started() if ready else kind.fresh()
    before = estimator.to_bytes()
    numbers = BAD_NUMBERS if kind.missing else [*BAD_NUMBERS, (NAN, 0.0), (0.0, NAN)]
    for u, y in [*numbers, *NO_NUMBERS]:
        assert "u and y" in refusal(DataError, estimator.update, u, y)
    for u, y in numbers:
        refusal(DataError, estimator.run, [0.0, 1.0, u], [0.0, 1.0, y])
    assert estimator.to_bytes() == before


@every_kind
def test_bad_records_change_nothing(kind):
    estimator = kind.started()
    before = estimator.to_bytes()
    assert "3" in refusal(DataError, estimator.run, [1.0, 2.0, 3.0], [1.0, 2.0])
    refusal(DataError, estimator.run, [[1.0], [2.0]], [1.0, 2.0])
    refusal(DataError, estimator.run, [1.0, 2.0], ["a", "b"])
    for every in (0, -1, 1.5, "all"):
        assert "every" in refusal(ParameterError, estimator.run, [1.0], [1.0], every)
    for use in ([True], [[True], [True]], [[True], [True, False]], True) if kind.missing else ():
        refusal(DataError, estimator.run, [1.0, 2.0], [1.0, 2.0], use=use)
    assert estimator.to_bytes() == before


@every_kind
@bad_data
def test_garbage_bytes(kind, data):
    assert f"{len(data)} other bytes" in refusal(DataError, kind.build.from_bytes, data)


@every_kind
def test_bytes_of_others(kind):
    array = b"\x93NUMPY\x01\x00v\x00{'descr': '<f8', 'fortran_order': False, 'shape': (1,), }".ljust(127) + b"\n"
    strangers = [other.fresh().to_bytes() for other in KINDS if other.build is not kind.build]
    for data in (array + bytes(8), kind.fresh().to_bytes()[:-100], *strangers):
        refusal(DataError, kind.build.from_bytes, data)


@every_kind
@settings(max_examples=30)
@given(st.data())
def test_damaged_bytes(kind, data):
    """Refused, or what was saved: parts of an archive mean nothing."""
    whole = bytes_of_started(kind.name)
    how = data.draw(st.sampled_from(["cut", "flip", "insert", "garbage"]))
    at = data.draw(st.integers(0, len(whole) - 1))
    damaged = {
        "cut": whole[:at],
        "flip": whole[:at] + bytes([whole[at] ^ data.draw(st.integers(1, 255))]) + whole[at + 1 :],
        "insert": whole[:at] + data.draw(st.binary(min_size=1, max_size=20)) + whole[at:],
        "garbage": data.draw(st.binary(max_size=200)),
    }[how]
    try:
        estimator = kind.build.from_bytes(damaged)
    except DataError:
        return
    assert estimator.to_bytes() == whole
