import itertools

import numpy as np
import pytest

from lostmotion.kernels import (
    actuator,
    contrast,
    dead_zone,
    gradient_signals,
    likelihood,
    linear,
    loop,
    normal_equations,
    null_space,
    products,
    row_products,
    squared_errors,
    stamps,
)
from lostmotion.kernels.pole_filters import REST, all_pole, answers_of, pole_filter
from tests.naive import backlash as slow_backlash
from tests.naive import contrast as slow_contrast
from tests.naive import dead_zone as slow_zone
from tests.naive import likelihood as slow_likelihood
from tests.naive import linear as slow_linear
from tests.naive import loop as slow_loop
from tests.naive import saturation as slow_saturation
from tests.naive import stamps as slow_stamps
from tests.naive import stiction as slow_stiction

SEEDS = range(6)


def random_zone(rng):
    left, right = np.sort(rng.uniform(-3, 3, 2))
    return left, right, *np.exp(rng.uniform(-1.5, 1.5, 2))


def stable_polynomial(rng, order, radius=0.9):
    """a1 .. an with complex and real roots inside `radius`."""
    roots = []
    while len(roots) + 2 <= order and rng.random() < 0.5:
        root = rng.uniform(0.1, radius) * np.exp(1j * rng.uniform(0, np.pi))
        roots += [root, root.conjugate()]
    roots += list(rng.uniform(-radius, radius, order - len(roots)))
    return np.real(np.poly(roots))[1:] if roots else np.zeros(0)


def with_edges(rng, left, right, n=80):
    """Values everywhere, and exactly on both break points."""
    return np.concatenate([rng.uniform(-6, 6, n), [left, right, 0.0, 0.5 * (left + right)]])


@pytest.mark.parametrize("seed", SEEDS)
def test_dead_zone(seed):
    rng = np.random.default_rng(seed)
    zone = random_zone(rng)
    u = with_edges(rng, *zone[:2])
    expected = [slow_zone.dead_zone(value, *zone) for value in u]
    np.testing.assert_allclose(dead_zone.forward_run(u, *zone), expected, rtol=1e-15)
    np.testing.assert_allclose([dead_zone.forward(value, *zone) for value in u], expected, rtol=1e-15)


@pytest.mark.parametrize("seed", SEEDS)
def test_dead_zone_inverse(seed):
    rng = np.random.default_rng(seed)
    zone = random_zone(rng)
    at_zero = slow_zone.nearest_to_zero(*zone[:2])
    v = with_edges(rng, *zone[:2])
    expected = [slow_zone.inverse(value, *zone, at_zero) for value in v]
    np.testing.assert_allclose(dead_zone.inverse_run(v, *zone, at_zero), expected, rtol=1e-15)
    np.testing.assert_allclose([dead_zone.inverse(value, *zone, at_zero) for value in v], expected, rtol=1e-15)


def test_dead_zone_keeps_nan():
    nan = np.array([np.nan])
    assert np.isnan(dead_zone.forward_run(nan, -1.0, 1.0, 1.0, 1.0)).all()
    assert np.isnan(dead_zone.inverse_run(nan, -1.0, 1.0, 1.0, 1.0, 0.0)).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_dead_zone_sensitivities(seed):
    rng = np.random.default_rng(seed)
    left, right, left_slope, _ = random_zone(rng)
    eta = np.array([left, right, np.log(left_slope)])
    u = with_edges(rng, left, right)
    x, dx = np.full(u.size, np.nan), np.full((3, u.size), np.nan)
    dead_zone.sensitivities(u, *eta, x, dx)
    np.testing.assert_allclose(x, slow_zone.actuator(eta, u).real, rtol=1e-14, atol=1e-15)
    np.testing.assert_allclose(dx, slow_zone.derivatives(eta, u), rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize(("na", "nb", "delay"), list(itertools.product(range(4), range(4), range(6))))
def test_linear_simulate(na, nb, delay):
    rng = np.random.default_rng([na, nb, delay])
    a, b = stable_polynomial(rng, na), rng.normal(size=nb + 1)
    x = rng.normal(size=60)
    expected = slow_linear.simulate(a, b, delay, x)
    result = linear.simulate(a, b, delay, x)
    np.testing.assert_allclose(result, expected, rtol=1e-11, atol=1e-12 * np.abs(expected).max())
    short = linear.simulate(a, b, delay, x[:2])
    np.testing.assert_array_equal(short, result[:2])


@pytest.mark.parametrize("order", range(7))
@pytest.mark.parametrize("seed", SEEDS)
def test_stability(seed, order):
    rng = np.random.default_rng([seed, order])
    for _ in range(20):
        a = stable_polynomial(rng, order, radius=1.3)
        largest = slow_linear.largest_root(a)
        for radius in (1.0, 0.7):
            if abs(largest - radius) > 1e-4:
                assert linear.is_stable(a, radius) == (largest < radius)


@pytest.mark.parametrize("order", range(1, linear.FEW + 1))
@pytest.mark.parametrize("seed", SEEDS)
def test_few_poles(seed, order):
    rng = np.random.default_rng([seed, order, 1])
    for _ in range(20):
        a = stable_polynomial(rng, order, radius=1.1)
        found = linear.few_poles(a)
        expected = np.roots(np.append(1.0, a))
        np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(expected), atol=1e-6)
        np.testing.assert_allclose(np.poly(found)[1:], a, atol=1e-14)


@pytest.mark.parametrize("a", [[-0.9, 0.0], [0.0, 0.0, 0.0], [-3.0, 3.0, -1.0], [0.0, 0.0, -0.5], [-1.0, 0.25, 0.0]])
def test_few_poles_at_zero_and_together(a):
    np.testing.assert_allclose(np.poly(linear.few_poles(np.array(a)))[1:], a, atol=1e-14)


@pytest.mark.parametrize("integrating", [False, True])
def test_what_is_allowed_is_stable_but_for_its_integrator(integrating):
    rules = False, np.array([100, 300]), 0.5, 0.3, 0
    for poles, stable in (([0.9, 0.5], True), ([1.05, 0.5], False)):
        a = np.poly([*poles, 1.0] if integrating else poles)[1:]
        assert linear.is_allowed(a, np.array([0.1]), integrating, 1.0 - 1e-7, *rules) == stable


def test_stability_leaves_its_argument_alone():
    a = np.array([-1.2, 0.5, 0.1])
    linear.is_stable(a, 0.9)
    assert a.tolist() == [-1.2, 0.5, 0.1]


def test_nan_is_not_stable():
    assert not linear.is_stable(np.array([np.nan]), 1.0)


@pytest.mark.parametrize("order", range(8))
def test_all_pole(order):
    rng = np.random.default_rng(order)
    a, x = stable_polynomial(rng, order), rng.normal(size=50)
    out = np.full(50, np.nan)
    all_pole(a, x, out)
    expected = slow_linear.simulate(a, [1.0], 0, x)
    np.testing.assert_allclose(out, expected, rtol=1e-11, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("order", [1, 2, 4, 6])
def test_all_pole_decays_to_zero_itself(order):
    a, x = stable_polynomial(np.random.default_rng(order), order), np.zeros(40_000)
    x[0] = x[30_000] = 1.0
    out = np.empty(x.size)
    all_pole(a, x, out)
    for at in (0, 30_000):
        expected = slow_linear.simulate(a, [1.0], 0, x[:200])
        np.testing.assert_allclose(out[at : at + 200], expected, rtol=1e-9, atol=1e-90)
    assert out[29_999] == 0.0
    denormal = (out != 0.0) & (np.abs(out) < np.finfo(float).tiny)
    assert denormal.sum() <= 2 * REST


@pytest.mark.parametrize("order", range(7))
def test_poles_go_on_from_block_to_block(order):
    rng = np.random.default_rng(order)
    a, x, past = stable_polynomial(rng, order), rng.normal(size=90), 7
    row, at = np.concatenate([np.zeros(past), np.full(90, np.nan)]), past
    for m in (1, 8, 23, 0, 16, 42):
        pole_filter(a, answers_of(a), x[at - past : at - past + m], row, at)
        at += m
    expected = slow_linear.simulate(a, [1.0], 0, x)
    np.testing.assert_allclose(row[past:], expected, rtol=1e-11, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("m", [0, 1, 7, 8, 29, 32])
@pytest.mark.parametrize(("singles", "lags"), [(1, 1), (4, 4), (5, 7), (8, 10)])
def test_products_of_rows(m, singles, lags):
    rng = np.random.default_rng(m)
    flat = rng.normal(size=600)
    single, lagged = rng.integers(0, 500, size=singles), rng.integers(0, 500, size=lags)
    parts = np.zeros(row_products.room(singles, lags))
    for _ in range(2):
        row_products.add_row_products(flat, single, singles, lagged, lags, m, parts)
    found = row_products.added_up(parts, singles, lags)
    for i in range(singles):
        for j in range(lags):
            expected = 2.0 * flat[single[i] : single[i] + m] @ flat[lagged[j] : lagged[j] + m]
            assert found[i, j] == pytest.approx(expected, rel=1e-12, abs=1e-12)


CASES = [
    (na, nb, p, delay)
    for i, (na, nb) in enumerate([*itertools.product(range(4), range(4)), (4, 2), (5, 1), (6, 0)])
    for p, delay in [(i % 5, (3 * i) % 6), ((i + 2) % 5, (3 * i + 2) % 6)]
]


def likelihood_case(na, nb, p, delay, ne, lengths, seed, zero=0.0, early=0.0):
    """Random parameters, segments with rows between them that belong to none, and data."""
    rng = np.random.default_rng([na, nb, p, delay, ne, seed])
    orders = slow_likelihood.Orders(na, nb, ne, p, delay, first=delay + int(rng.integers(0, 3)))
    orders.zero, orders.early = zero, early
    segments, at = [], 0
    for length in lengths:
        segments.append((at, at + length))
        at += length + 3
    u, y = rng.uniform(-4, 4, at), rng.normal(size=at)
    eta = [-0.8, 0.5, 0.3][:ne]
    c = rng.normal(size=orders.initial * len(segments))
    theta = np.concatenate(
        [stable_polynomial(rng, na), rng.normal(size=nb + 1), [0.4], eta, stable_polynomial(rng, p), c]
    )
    assert theta.size == orders.size(len(segments))
    return orders, np.array(segments), u, y, theta


def actuator_arrays(orders, theta, u):
    """x and dx/deta over all rows, from the slow twin."""
    eta = theta[orders.na + orders.nb + 2 :][: orders.ne]
    return slow_zone.actuator(eta, u).real.copy(), np.ascontiguousarray(slow_zone.derivatives(eta, u))


@pytest.mark.parametrize("taps", [0, 1, 3, 4, 7, 9, 20])
@pytest.mark.parametrize("rows", [1, 15, 16, 17, 50])
def test_whitening(taps, rows):
    rng = np.random.default_rng(taps)
    room = rows + gradient_signals.TILE
    d, row, out = rng.normal(size=taps), rng.normal(size=21 + room), np.zeros(1 + room)
    gradient_signals.whiten(d, row, 21, rows, out, 1)
    expected = np.convolve(np.append(1.0, d), row)[21 : 21 + rows]
    np.testing.assert_allclose(out[1 : 1 + rows], expected, rtol=1e-12, atol=1e-13)


def check_normal_equations(orders, segments, u, y, theta):
    x, dx = actuator_arrays(orders, theta, u)
    before = theta.copy(), x.copy(), dx.copy(), y.copy()
    hessian, gradient = np.zeros((theta.size, theta.size)), np.zeros(theta.size)
    cost = normal_equations.normal_equations(
        theta, orders.na, orders.nb, orders.ne, orders.p, orders.delay, orders.first, segments, x, dx[:2],
        dx[2:], y, hessian, gradient, orders.zero, orders.early,
    )  # fmt: skip
    errors = slow_likelihood.all_errors(theta, orders, segments, u, y).real
    jacobian = slow_likelihood.jacobian(theta, orders, segments, u, y)
    np.testing.assert_allclose(cost, errors @ errors, rtol=1e-12)
    settings = orders.na, orders.nb, orders.ne, orders.p, orders.delay, orders.first
    alone = squared_errors.squared_errors(theta, *settings, segments, x, y, orders.zero, orders.early)
    same = 1e-15 if orders.early == 0.0 else 1e-13  # the search compares one with the other
    np.testing.assert_allclose(alone, cost, rtol=same)
    expected = jacobian.T @ jacobian
    np.testing.assert_allclose(hessian, expected, rtol=1e-10, atol=1e-12 * np.abs(expected).max())
    slope = jacobian.T @ errors
    np.testing.assert_allclose(gradient, slope, rtol=1e-9, atol=1e-11 * np.abs(slope).max())
    for array, copy in zip((theta, x, dx, y), before, strict=True):
        np.testing.assert_array_equal(array, copy)


@pytest.mark.parametrize(("na", "nb", "p", "delay"), CASES)
def test_prediction_errors(na, nb, p, delay):
    orders, segments, u, y, theta = likelihood_case(na, nb, p, delay, 3, [50, 35], 0)
    x, _ = actuator_arrays(orders, theta, u)
    a, b, offset, _, d, initial = slow_likelihood.unpack(theta, orders, len(segments))
    for c, (start, stop) in zip(initial, segments, strict=True):
        settings = (a, b, c, offset, d, delay, orders.first, x[start:stop], y[start:stop])
        z, errors = likelihood.prediction_errors(*settings)
        slow_z, slow_errors = slow_likelihood.segment_errors(*settings)
        np.testing.assert_allclose(z, slow_z, rtol=1e-11, atol=1e-11 * np.abs(slow_z).max())
        np.testing.assert_allclose(errors, slow_errors, rtol=1e-11, atol=1e-11 * np.abs(slow_errors).max())


@pytest.mark.parametrize(("na", "nb", "p", "delay"), CASES)
def test_normal_equations(na, nb, p, delay):
    check_normal_equations(*likelihood_case(na, nb, p, delay, 3, [50, 35], 0))


@pytest.mark.parametrize("early", [0.0, 0.3])
@pytest.mark.parametrize(("na", "nb", "p", "delay"), CASES[::3])
def test_normal_equations_with_a_zero_of_the_noise(na, nb, p, delay, early):
    check_normal_equations(*likelihood_case(na, nb, p, delay, 3, [50, 35], 0, 0.8, early))


@pytest.mark.parametrize("zero", [0.5, 0.97])
def test_prediction_errors_with_a_zero_of_the_noise(zero):
    orders, segments, u, y, theta = likelihood_case(2, 1, 2, 1, 3, [50], 0, zero)
    x, _ = actuator_arrays(orders, theta, u)
    a, b, offset, _, d, (c,) = slow_likelihood.unpack(theta, orders, len(segments))
    z, errors = likelihood.prediction_errors(a, b, c, offset, d, 1, orders.first, x[:50], y[:50], zero)
    slow_z, slow_errors = slow_likelihood.segment_errors(a, b, c, offset, d, 1, orders.first, x[:50], y[:50], zero)
    np.testing.assert_allclose(z, slow_z, rtol=1e-11, atol=1e-11 * np.abs(slow_z).max())
    np.testing.assert_allclose(errors, slow_errors, rtol=1e-11, atol=1e-11 * np.abs(slow_errors).max())


@pytest.mark.parametrize("p", range(5))
@pytest.mark.parametrize("lengths", [[60], [30, 25, 40, 28]])
def test_normal_equations_without_actuator(p, lengths):
    check_normal_equations(*likelihood_case(2, 1, p, 2, 0, lengths, 1))


@pytest.mark.parametrize("rows", [gradient_signals.BLOCK - 1, gradient_signals.BLOCK, gradient_signals.BLOCK + 1])
def test_normal_equations_at_the_edge_of_a_block(rows):
    orders = likelihood_case(2, 1, 2, 1, 3, [40], 0)[0]
    length = rows + orders.first + orders.p
    check_normal_equations(*likelihood_case(2, 1, 2, 1, 3, [length], 0))


def test_normal_equations_add_to_what_is_there():
    orders, segments, u, y, theta = likelihood_case(1, 1, 1, 1, 3, [40], 0)
    x, dx = actuator_arrays(orders, theta, u)
    settings = (theta, 1, 1, 3, 1, 1, orders.first, segments, x, dx, dx[:0], y)
    clean = np.zeros((theta.size, theta.size)), np.zeros(theta.size)
    twice = np.zeros((theta.size, theta.size)), np.zeros(theta.size)
    normal_equations.normal_equations(*settings, *clean)
    normal_equations.normal_equations(*settings, *twice)
    normal_equations.normal_equations(*settings, *twice)
    for once, both in zip(clean, twice, strict=True):
        np.testing.assert_allclose(both, 2 * once, rtol=1e-13)


@pytest.mark.parametrize(("has_zone", "has_inverse"), list(itertools.product([False, True], repeat=2)))
@pytest.mark.parametrize("limit", [np.inf, 1.5])
@pytest.mark.parametrize("seed", range(3))
def test_closed_loop(seed, limit, has_zone, has_inverse):
    rng = np.random.default_rng([seed, has_zone, has_inverse])
    a, b, delay = np.array([-1.3, 0.42]), np.array([0.05, 0.07]), 1 + seed
    zone, undo = random_zone(rng), random_zone(rng)
    undo = (*undo, slow_zone.nearest_to_zero(*undo[:2]))
    reference = np.repeat(rng.normal(size=5), 40)
    disturbance, noise = 0.3 * rng.normal(size=(2, reference.size))
    sign = 1.0 if seed % 2 == 0 else -1.0  # a negative process with a negative controller
    settings = (0.2 * sign, 0.05 * sign, -limit, limit, 0.3, reference, disturbance, noise)
    fast = loop.closed_loop(a, sign * b, delay, 0.7, np.array(zone), np.array(undo), has_zone, has_inverse, *settings)
    slow = slow_loop.closed_loop(
        a, sign * b, delay, 0.7, zone if has_zone else None, undo if has_inverse else None, *settings
    )
    for name, quick, plain in zip(("control", "command", "x", "output", "measured"), fast, slow, strict=True):
        np.testing.assert_allclose(quick, plain, rtol=1e-10, atol=1e-12, err_msg=name)


BIAS = 0.3
ACTUATORS = {
    "backlash": (actuator.BACKLASH, (0.6,), lambda u: slow_backlash.backlash(u, 0.6, BIAS)),
    "saturation": (actuator.SATURATION, (-0.4, 0.5), lambda u: slow_saturation.saturation(u, -0.4, 0.5)),
    **{
        model: (actuator.STICTION + code, (0.5, 0.3), lambda u, slow=slow: slow(u, 0.5, 0.3, BIAS))
        for code, (model, slow) in enumerate(slow_stiction.MODELS.items())
    },
}


@pytest.mark.parametrize("name", ACTUATORS)
@pytest.mark.parametrize("seed", range(2))
def test_closed_loop_with_other_actuators(seed, name):
    kind, parameters, slow_valve = ACTUATORS[name]
    rng = np.random.default_rng([seed, 7])
    a, b = np.array([-1.3, 0.42]), np.array([0.05, 0.07])
    reference = np.repeat(rng.normal(size=4), 40)
    disturbance, noise = 0.3 * rng.normal(size=(2, reference.size))
    settings = (0.2, 0.05, -np.inf, np.inf, BIAS, reference, disturbance, noise)
    held = np.zeros(5)
    held[: len(parameters)] = parameters
    fast = loop.closed_loop(a, b, 2, 0.7, held, np.zeros(5), kind, False, *settings)
    slow = slow_loop.closed_loop(a, b, 2, 0.7, slow_valve, None, *settings)
    for signal, quick, plain in zip(("control", "command", "x", "output", "measured"), fast, slow, strict=True):
        np.testing.assert_allclose(quick, plain, rtol=1e-10, atol=1e-12, err_msg=signal)


@pytest.mark.parametrize("wrap", [0.0, 500.0])
@pytest.mark.parametrize("seed", SEEDS)
def test_samples_of_stamps(seed, wrap):
    rng = np.random.default_rng(seed)
    steps = rng.choice([1.0, 1.0, 1.0, 1.2, 0.7, 0.1, 0.0, -3.0, 7.0, 2000.0, -8000.0, 4e7], 300)
    moments = 1e8 + np.cumsum(steps)
    moments[rng.random(300) < 0.05] = np.nan
    moments = moments % wrap if wrap else moments
    state, times = np.array([np.nan, 0.0, 0.0, 0.0]), np.empty(300)
    counts = [
        stamps.count_samples(part, 1.0, wrap, state, out)
        for part, out in zip(np.split(moments, [100, 101]), np.split(times, [100, 101]), strict=True)
    ]
    expected, moved, after = slow_stamps.count_samples(moments, 1.0, wrap)
    np.testing.assert_array_equal(np.concatenate(counts), expected)
    np.testing.assert_allclose(times, moved, rtol=1e-15)
    np.testing.assert_allclose(state, after, rtol=1e-12)


CONTRASTS = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 1.0]])


@pytest.mark.parametrize("load", [False, True])
@pytest.mark.parametrize(("na", "nb", "p", "delay"), [(1, 0, 0, 1), (3, 1, 0, 3), (2, 1, 1, 2), (1, 2, 2, 0)])
def test_contrast_variances(na, nb, p, delay, load):
    rng = np.random.default_rng([na, nb, p, delay, load])
    eta = [-0.8, 0.5, 0.3, *([0.1] if load else [])]
    c = rng.normal(size=max(na, nb))
    theta = np.concatenate(
        [stable_polynomial(rng, na), rng.normal(size=nb + 1), [0.4], eta, stable_polynomial(rng, p), c]
    )
    u, y = rng.uniform(-4, 4, 150), rng.normal(size=150)
    prior = np.array([1e-3, 2e-3, 1e-3])
    basis = np.eye(theta.size)
    if load:  # offset and load cannot both be known: one direction of the two is left out, as in the design
        basis = np.delete(basis, na + nb + 1, axis=1)
    settings = (theta, na, nb, p, delay, load, u, y, 0.3, np.ascontiguousarray(basis), prior, CONTRASTS)
    np.testing.assert_allclose(contrast.variances(*settings), slow_contrast.variances(*settings), rtol=1e-6)


def test_contrast_without_information_is_as_wide_as_before():
    theta = np.array([-0.5, 1.0, 0.0, -1.0, 1.0, 0.0, 0.0])
    u, y = np.full(50, 0.2), np.zeros(50)  # never beyond a break point
    prior = np.array([0.25, 0.04, 1.0])
    settings = (theta, 1, 0, 0, 1, False, u, y, 1.0, np.eye(7), prior, CONTRASTS)
    np.testing.assert_allclose(contrast.variances(*settings), [4.0, 25.0, 29.0], rtol=1e-6)


@pytest.mark.parametrize("terms", range(10))
@pytest.mark.parametrize("length", [0, 1, 3, 4, 5, 7, 8, 40])
def test_add_lagged_of_any_number_of_terms(terms, length):
    rng = np.random.default_rng(terms)
    coefficients, x, out = rng.normal(size=terms), rng.normal(size=length), rng.normal(size=length)
    expected = out + np.convolve(np.append(coefficients, 0.0), np.append(x, 0.0))[:length]
    likelihood.add_lagged(coefficients, x, out)
    np.testing.assert_allclose(out, expected, atol=1e-13)


@pytest.mark.parametrize("size", [1, 2, 7, 30])
def test_regression_by_cholesky(size):
    rng = np.random.default_rng(size)
    columns, y = rng.normal(size=(50, size)), rng.normal(size=50)
    gram, target = columns.T @ columns, columns.T @ y
    gains = np.linalg.solve(gram, target)
    explained = products.factorise(gram, target)
    assert explained == pytest.approx(gains @ columns.T @ y, rel=1e-12)
    products.solve_behind(gram, target)
    np.testing.assert_allclose(target, gains, rtol=1e-9)


def test_a_column_twice_explains_as_much_as_once():
    rng = np.random.default_rng(0)
    columns, y = rng.integers(-3, 4, size=(40, 3)).astype(float), rng.normal(size=40)
    twice = columns[:, [0, 1, 1, 2]]
    once = products.factorise(columns.T @ columns, columns.T @ y)
    assert products.factorise(twice.T @ twice, twice.T @ y) == pytest.approx(once, rel=1e-9)


def test_a_long_record_whose_initial_state_has_gone():
    orders, segments, u, y, theta = likelihood_case(2, 2, 2, 1, 3, [3 * gradient_signals.BLOCK + 7], 0)
    theta[:2] = np.poly([0.5, 0.3])[1:]
    check_normal_equations(orders, segments, u, y, theta)


@pytest.mark.parametrize(("na", "nb", "shift"), [(1, 0, 0), (2, 1, 3), (3, 2, 1), (2, 2, 29), (1, 0, 40)])
def test_weighted_null_space(na, nb, shift):
    """Against whitening with the root of the covariance of A B_n - B A_n, written out as a matrix."""
    rng = np.random.default_rng(na)
    m, n = 30, 32
    half = rng.normal(size=(2 * n, 3 * n))
    covariance, regressors = half @ half.T / 3.0 / n, rng.normal(size=(m, na + nb + 1))
    a, b, target = rng.normal(size=na), rng.normal(size=nb + 1), rng.normal(size=m)
    found, misfit = null_space.weighted(a, b, shift, covariance, n, regressors, target)
    rows, transfer = np.arange(m), np.zeros((m, 2 * n))
    for lag, value in enumerate([1.0, *a]):
        transfer[rows[lag:], n + rows[: m - lag]] += value
    for lag, value in enumerate(b, shift + 1):
        if lag < m:
            transfer[rows[lag:], rows[: m - lag]] -= value
    values, vectors = np.linalg.eigh(transfer @ covariance @ transfer.T)
    root = (vectors / np.sqrt(values)).T
    expected, left, *_ = np.linalg.lstsq(root @ regressors, root @ target)
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-8)
    np.testing.assert_allclose(misfit, left[0], rtol=1e-6)


def test_weighted_null_space_leaves_out_what_is_nothing():
    regressors = np.zeros((10, 2))
    regressors[:, 0] = np.arange(10.0)
    found, misfit = null_space.weighted(np.zeros(1), np.zeros(1), 0, np.eye(20), 10, regressors, 2.0 * np.arange(10.0))
    np.testing.assert_allclose(found, [2.0, 0.0], atol=1e-9)
    assert misfit < 1e-12


def test_weighted_null_space_of_what_is_no_covariance():
    """Rounding in a record without noise leaves one with negative variances."""
    rng = np.random.default_rng(0)
    some = rng.normal(size=(40, 40))
    found, misfit = null_space.weighted(
        rng.normal(size=2), rng.normal(size=2), 1, some + some.T, 20, rng.normal(size=(20, 4)), rng.normal(size=20)
    )
    assert np.isfinite(found).all()
    assert np.isfinite(misfit)
