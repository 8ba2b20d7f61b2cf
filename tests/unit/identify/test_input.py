import copy

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import DataError, InputError, ParameterError
from tests.support.refusals import refusal

NAN, INF = float("nan"), float("inf")
N = 200
MODEL = lm.Hammerstein(lm.DeadZone(-1.0, 1.0), lm.LinearModel([-0.8], [0.2], 1))
U = lm.signals.prs(N, -5, 5, 7, seed=0)
Y = MODEL.simulate(U) + np.random.default_rng(0).normal(scale=0.05, size=N)
QUICK = {"nonlinearity": "dead zone", "orders": (1, 0, 1), "noise": "white"}


def at(row, value, array):
    changed = array.copy()
    changed[row] = value
    return changed


def record(start=0, stop=N, **settings):
    return lm.LoopRecord(U[start:stop], Y[start:stop], **{"dt": 1.0, **settings})


def same(one, other):
    assert one.to_dict()["parameters"] == other.to_dict()["parameters"]
    assert one.standard_errors == other.standard_errors
    assert one.status is other.status


# signals


@pytest.mark.parametrize("name", ["u", "y"])
@pytest.mark.parametrize("bad", [NAN, INF, -INF])
def test_row_and_time_of_what_is_not_finite(name, bad):
    u, y = (at(17, bad, U), Y) if name == "u" else (U, at(17, bad, Y))
    message = refusal(DataError, lm.identify, u, y, 0.1)
    for part in (f"finite {name}", "row 17", "t = 1.7 s"):
        assert part in message


def test_number_of_bad_rows():
    bad = np.where(np.arange(N) > 196, NAN, Y)
    assert "row 197" in refusal(DataError, lm.identify, U, bad, 1.0)
    assert "3 such rows" in refusal(DataError, lm.identify, U, bad, 1.0)


@pytest.mark.parametrize("value", [0.0, 3.0, -1e-9, 1e12])
@pytest.mark.parametrize("name", ["u", "y"])
def test_constant_signal_is_named(name, value):
    u, y = (np.full(N, value), Y) if name == "u" else (U, np.full(N, value))
    message = refusal(DataError, lm.identify, u, y, 1.0)
    assert f"({name})" in message
    assert "constant" in message


def test_lengths_that_differ():
    message = refusal(DataError, lm.identify, U, Y[:-3], 1.0)
    assert "200" in message
    assert "197" in message


@pytest.mark.parametrize("n", [0, 1, 2, 59])
def test_too_short(n):
    assert str(n) in refusal(DataError, lm.identify, U[:n], Y[:n], 1.0, **QUICK)


@pytest.mark.statistics
def test_shortest_record_that_is_taken():
    assert lm.identify(U[:60], Y[:60], 1.0, **QUICK).data.u.size == 60


@pytest.mark.parametrize("bad", [np.column_stack([U, U]), 3.0, np.zeros((0, 2))])
def test_other_than_one_dimension(bad):
    assert "u " in refusal(DataError, lm.identify, bad, Y, 1.0)
    assert "y " in refusal(DataError, lm.identify, U, bad, 1.0)


@pytest.mark.parametrize("bad", [["open"] * N, [None] * N, [[1.0], [1.0, 2.0]], "FIC-101.csv", {"op": 1}])
def test_other_than_numbers(bad):
    refusal(DataError, lm.identify, bad, Y, 1.0)
    refusal(DataError, lm.identify, U, bad, 1.0)


def test_complex_numbers():
    refusal(DataError, lm.identify, U.astype(complex), Y, 1.0)


def test_masked_rows_are_missing_rows():
    masked = np.ma.masked_array(Y, mask=np.arange(N) == 17)
    assert "row 17" in refusal(DataError, lm.identify, U, masked, 1.0)


def test_one_array_alone():
    refusal(ParameterError, lm.identify, U, dt=1.0)


@pytest.mark.parametrize("dt", [None, 0, -1.0, NAN, INF, "1 s"])
def test_dt(dt):
    assert "dt" in refusal(ParameterError, lm.identify, U, Y, dt)


def test_input_is_not_changed_and_may_be_read_only():
    arrays = [U.copy(), Y.copy()]
    for array in arrays:
        array.setflags(write=False)
    lm.identify(*arrays, 1.0, **QUICK)
    np.testing.assert_array_equal(arrays[0], U)
    np.testing.assert_array_equal(arrays[1], Y)


def test_result_does_not_change_with_what_was_handed_in():
    u, y = U.copy(), Y.copy()
    fit = lm.identify(u, y, 1.0, **QUICK)
    before = copy.deepcopy(fit.to_dict())
    u[:] = y[:] = 0.0
    np.testing.assert_array_equal(fit.data.u, U)
    assert fit.to_dict() == before


@pytest.mark.statistics
def test_lists_strides_and_other_types_are_the_same_data():
    expected = lm.identify(U, Y, 1.0, **QUICK)
    wide = np.column_stack([U, Y])
    same(lm.identify(U.tolist(), Y.tolist(), 1, **QUICK), expected)
    same(lm.identify(wide[:, 0], wide[:, 1], np.float32(1.0), **QUICK), expected)
    whole = np.round(U).astype(int)
    same(lm.identify(whole, Y, 1.0, **QUICK), lm.identify(whole.astype(float), Y, 1.0, **QUICK))


# records


def test_record_is_the_same_data_as_its_arrays():
    fit = lm.identify(record(tag="FIC-101"), **QUICK)
    arrays = lm.identify(U, Y, 1.0, **QUICK)
    same(fit, arrays)
    same(lm.identify([record()], **QUICK), arrays)
    same(lm.identify((record(),), dt=1.0, **QUICK), arrays)
    assert fit.data.fingerprint == arrays.data.fingerprint
    assert fit.data.tag == "FIC-101"


def test_order_of_records_does_not_matter():
    parts = [record(0, 90), record(90, 200)]
    one, other = lm.identify(parts, **QUICK), lm.identify(parts[::-1], **QUICK)
    for name, value in one.parameters.items():
        assert other.parameters[name] == pytest.approx(value, abs=0.01 * one.standard_errors[name])


def test_pieces_too_short_are_left_out_and_told():
    fit = lm.identify([record(0, 140), record(150, 160)], **QUICK)
    assert fit.data.segments.tolist() == [[0, 140]]
    assert any("1 piece" in note for note in fit.data.notes)


def test_missing_sample_in_a_record():
    bad = lm.LoopRecord(U, at(17, NAN, Y), dt=0.1)
    message = refusal(DataError, lm.identify, bad, raw=True)
    for part in ("PV", "row 17", "t = 1.7 s", "split"):
        assert part in message
    assert "OP" in refusal(DataError, lm.identify, lm.LoopRecord(at(17, NAN, U), Y, dt=0.1), raw=True)
    assert lm.identify(bad.split(), raw=True, **QUICK).data.u.size == N - 18  # 17 rows are too few for a piece
    bridged = lm.identify(bad, **QUICK)
    assert bridged.data.u.size == N
    assert any(note.startswith("1 missing sample (0.5 %) bridged") for note in bridged.data.notes)


def test_gap_in_a_record():
    gap = lm.LoopRecord(U, Y, dt=0.1, gaps=(100,))
    assert "before row 100" in refusal(DataError, lm.identify, gap, raw=True)
    for fit in (lm.identify(gap.split(), raw=True, **QUICK), lm.identify(gap, **QUICK)):
        assert fit.data.segments.tolist() == [[0, 100], [100, 200]]


def test_records_that_are_too_short_together():
    refusal(DataError, lm.identify, [record(0, 20), record(20, 50)], **QUICK)
    refusal(DataError, lm.identify, [record(0, 40), record(50, 90)], **QUICK)


def test_records_and_other_arguments():
    refusal(ParameterError, lm.identify, record(), Y)
    refusal(ParameterError, lm.identify, record(), dt=2.0)
    refusal(ParameterError, lm.identify, [record(), record(dt=2.0)])
    refusal(InputError, lm.identify, [])


def test_records_with_arrays_between():
    refusal(InputError, lm.identify, [record(), U])


@pytest.mark.parametrize("name", ["op", "pv"])
def test_constant_record(name):
    settings = {"op": U, "pv": Y, name: np.full(N, 50.0)}
    message = refusal(DataError, lm.identify, lm.LoopRecord(**settings, dt=1.0))
    assert name.upper() in message


# settings


@pytest.mark.parametrize("kind", ["deadzone", "Dead Zone", "", None, 3])
def test_nonlinearity(kind):
    message = refusal(ParameterError, lm.identify, U, Y, 1.0, nonlinearity=kind)
    assert "dead zone" in message
    assert repr(kind) in message


@pytest.mark.parametrize(
    "orders",
    [
        "automatic", "", None, 3, (1, 0), (1, 0, 1, 1), (-1, 0, 1), (1, -1, 1), (1, 0, -1), (1.5, 0, 1),
        (1, 0, 1.5), ("a", 0, 1), (NAN, 0, 1), (INF, 0, 1), (1, None, 1),
    ],
)  # fmt: skip
def test_orders(orders):
    assert "orders" in refusal(ParameterError, lm.identify, U, Y, 1.0, orders=orders)


@pytest.mark.parametrize("orders", [(30, 30, 1), (1, 0, 80), (1, 0, 10**9), (200, 200, 200)])
def test_orders_too_large_for_the_record(orders):
    message = refusal(InputError, lm.identify, U, Y, 1.0, orders=orders)
    assert "200" in message


def test_too_few_samples_for_the_orders_is_about_the_data():
    refusal(DataError, lm.identify, U, Y, 1.0, orders=(30, 30, 1))


@pytest.mark.parametrize("noise", ["pink", "", "4", None, -1, 1.5, True, NAN, INF, [1], (1, 2)])
def test_noise(noise):
    assert "noise" in refusal(ParameterError, lm.identify, U, Y, 1.0, orders=(1, 0, 1), noise=noise)


def test_noise_order_too_large_for_the_record():
    refusal(InputError, lm.identify, U, Y, 1.0, orders=(1, 0, 1), noise=100)


@pytest.mark.parametrize("gain", [0, 0.0, NAN, INF, "2.2", [1.0, 2.0]])
def test_gain(gain):
    assert "gain" in refusal(ParameterError, lm.identify, U, Y, 1.0, gain=gain, **QUICK)


@pytest.mark.parametrize("sign", [-1, 1])
def test_gain_of_the_wrong_sign(sign):
    message = refusal(ParameterError, lm.identify, U, sign * Y, 1.0, gain=-sign, **QUICK)
    assert "sign" in message


@pytest.mark.parametrize("offset", ["none", "", None, 0, 0.0, True])
def test_offset(offset):
    assert "offset" in refusal(ParameterError, lm.identify, U, Y, 1.0, offset=offset)


def test_unknown_settings():
    with pytest.raises(TypeError, match="order"):
        lm.identify(U, Y, 1.0, order=(1, 0, 1), nonlinearity="dead zone")


@pytest.mark.parametrize("orders", [(0, 0, 0), (0, 0, 1), (0, 2, 1), (1, 0, 0), [1, 0, 1], np.array([1, 0, 1])])
def test_orders_that_are_allowed(orders):
    fit = lm.identify(U, Y, 1.0, orders=orders, noise=1, nonlinearity="dead zone")
    assert (len(fit.linear.a), len(fit.linear.b) - 1, fit.linear.delay) == tuple(orders)
    assert fit.noise.order == 1
    assert np.isfinite(list(fit.parameters.values())).all()


# interval


@pytest.fixture(scope="module")
def fit():
    return lm.identify(U, Y, 1.0, **QUICK)


@pytest.mark.parametrize("name", ["Right", "dead zone", "", None])
def test_interval_of_an_unknown_name(fit, name):
    assert "right" in refusal(ParameterError, fit.interval, name)


@pytest.mark.parametrize("level", [0, 1, -0.5, 95, NAN])
def test_interval_at_an_impossible_level(fit, level):
    assert "level" in refusal(ParameterError, fit.interval, "right", level)
