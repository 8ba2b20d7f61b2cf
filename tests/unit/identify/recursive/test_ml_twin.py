"""Kernels of RecursiveML against their slow twin, and against what they must be by definition."""

import numpy as np
import pytest

from lostmotion.identify.recursive.change import relinearise
from lostmotion.identify.recursive.ml_settings import Tuning
from lostmotion.identify.recursive.remembered import Memory, Stretch
from lostmotion.kernels.linear import is_stable
from lostmotion.kernels.recursive_ml import advance, bounds, change, equations, information, run
from lostmotion.kernels.recursive_ml import follow as following
from lostmotion.kernels.recursive_ml import state as ml
from tests.naive import recursive_ml as naive
from tests.naive.linear import largest_root

NAN, INF = float("nan"), float("inf")
ORDERS = [(0, 0, 0), (0, 3, 2), (1, 0, 5), (1, 2, 1), (2, 1, 0), (2, 0, 3), (3, 2, 3), (4, 3, 1)]
NOISE = {0: (), 1: (-0.7,), 3: (-0.8, 0.3, -0.1)}
VARIANCE = 0.04


def plant(na, nb, delay, p, seed):
    """Theta of a random stable plant with a dead zone and AR noise."""
    rng = np.random.default_rng([seed, na, nb, delay])
    a = np.poly(rng.uniform(-0.5, 0.8, na))[1:] if na else np.zeros(0)
    b, offset = rng.uniform(0.5, 1.5, nb + 1), rng.normal()
    return np.array([*a, *b, offset, -rng.uniform(0.3, 1), rng.uniform(0.3, 1), rng.uniform(-0.5, 0.5), *NOISE[p]])


def record(theta, na, nb, delay, n, seed, hold=3):
    """Command and measurement of that plant."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(-3, 3, n), hold)[:n]
    white = VARIANCE**0.5 * rng.normal(size=n)
    v = []  # D v = white
    for k in range(n):
        v.append(white[k] - sum(d * naive.at(v, k - j) for j, d in enumerate(theta[na + nb + 5 :], start=1)))
    return u, np.array(v) - naive.errors_from_rest([*theta[: na + nb + 5]], na, nb, delay, u, np.zeros(n))


def prepared(theta, information, na, nb, delay, tuning):
    """State and layout at rest that know `theta` with this information."""
    state, layout = tuning.allocate((na, nb, delay), theta.size - na - nb - 5)
    memory = Memory(state, layout)
    memory.theta[:] = theta
    memory.parts["ref_h"][:] = information
    memory.parts["ref_r"][:] = information @ theta
    state[ml.SQUARES], state[ml.WEIGHT] = 50 * VARIANCE, 50.0
    state[ml.LOW], state[ml.HIGH] = -2.0, 2.0
    return state, layout


def pair(orders, p, forgetting, seed, clip=3.0, offset="auto", sure=0.05, hold=3):
    """The kernel's state and its twin, both a little off the plant, with a record of the plant."""
    na, nb, delay = orders
    theta = plant(na, nb, delay, p, seed)
    rng = np.random.default_rng([seed, 1])
    near = theta + 0.2 * sure * rng.normal(size=theta.size)
    information = np.eye(theta.size) * VARIANCE / sure**2
    tuning = Tuning(forgetting, clip, INF, offset)
    block, ring, tail = tuning.memory
    state, layout = prepared(near, information, na, nb, delay, tuning)
    slow = naive.Recursion(
        near, information, na, nb, delay, block=block, ring=ring, tail=tail, keep=forgetting, clip=clip, offset=offset,
        variance=VARIANCE, weight=50.0,
    )  # fmt: skip
    return state, layout, slow, record(theta, na, nb, delay, 1400 if forgetting == 1 else 700, seed, hold)


def close(value, expected, message):
    expected = np.asarray(expected)
    room = 1e-7 * np.abs(expected).max(initial=1e-12)
    np.testing.assert_allclose(value, expected, rtol=1e-7, atol=room, err_msg=message)


def compare(state, layout, slow, k):
    memory = Memory(state, layout)
    total_h, total_r = slow.total()
    close(memory.theta, slow.theta, f"theta after sample {k}")
    close(memory.parts["shown"], slow.shown, f"shown after sample {k}")
    close(memory.parts["total_h"], total_h, f"information after sample {k}")
    close(memory.parts["total_r"], total_r, f"right-hand side after sample {k}")
    close(memory.parts["ref_h"], slow.reference[0], f"reference after sample {k}")
    close(state[[ml.LOW, ml.HIGH]], [slow.low, slow.high], f"range after sample {k}")


def follow(state, layout, slow, u, y, use):
    """Step both through the record; compare every error, and everything after every block."""
    psi, rounding = np.zeros(int(layout[ml.N])), 1e-9 * np.nanmax(np.abs(y))
    for k in range(u.size):
        error, _ = run.one(u[k], y[k], bool(use[k]), state, layout, psi)
        expected = slow.step(u[k], y[k], bool(use[k]))
        np.testing.assert_allclose(error, expected, rtol=1e-7, atol=rounding, err_msg=f"error of sample {k}")
        close(state[[ml.SQUARES, ml.WEIGHT]], [slow.squares, slow.weight], f"variance after sample {k}")
        if layout[ml.FILLED] == 0:
            compare(state, layout, slow, k)


# --- the layout


def test_layout_is_that_of_saved_bytes():
    """The order of the entries and where the parts lie: states saved by earlier versions are read by it."""
    state, layout = Tuning(0.99, 4.0, INF, "auto").allocate((3, 2, 3), 2)
    sizes = [3, 3, 3, 2, 12, 6, 8, 37]
    offsets = [
        12, 24, 36, 73, 217, 229, 373, 385, 1537, 1633, 1945, 1993, 2041, 2089, 2233, 2245, 2533, 2677, 2689
    ]  # fmt: skip
    assert layout[: ml.SIZE].tolist() == [*sizes, *offsets]
    assert layout[[ml.RING_S, ml.INVERSE, ml.TEST_AFTER, ml.REFIT_AT]].tolist() == [1929, 2389, 24, 2**63 - 1]
    assert layout[[ml.WATCH, ml.EVIDENCE, ml.BANK_H, ml.BANK_R]].tolist() == [2833, 2841, 2847, 3711]
    assert state.size == layout[ml.SIZE] == 2833 + 8 + 6 + 7 * 12 * 13 + 16 + 8 + 15 + 3
    assert sum(part.size for part in ml.named(state, layout).values()) == state.size - ml.HEAD


# --- the slow twin


@pytest.mark.parametrize("forgetting", [1.0, 0.999, 0.99])
@pytest.mark.parametrize(("number", "orders"), list(enumerate(ORDERS)))
def test_twin(number, orders, forgetting):
    p = (0, 1, 3)[number % 3]
    state, layout, slow, (u, y) = pair(orders, p, forgetting, seed=number, offset=("auto", "free", "zero")[number % 3])
    size = {1.0: 200, 0.999: 600, 0.99: 300}[forgetting]  # some blocks, and more than the ring where one forgets
    u, y = u[:size], y[:size]
    follow(state, layout, slow, u, y, np.ones(u.size, dtype=bool))


@pytest.mark.parametrize("p", [0, 1, 3])
def test_twin_until_blocks_leave_the_ring(p):
    """Forgetting 1: after 1,024 samples, into a reference that only grows."""
    state, layout, slow, (u, y) = pair((1, 0, 1), p, 1.0, seed=3)
    follow(state, layout, slow, u, y, np.ones(u.size, dtype=bool))
    assert layout[ml.BLOCKS] > layout[ml.RING]


@pytest.mark.parametrize("forgetting", [1.0, 0.99])
@pytest.mark.parametrize("p", [0, 1, 3])
@pytest.mark.parametrize("orders", [(0, 0, 0), (1, 1, 2), (2, 1, 0)])
def test_twin_with_missing_and_masked_samples_and_outliers(orders, p, forgetting):
    state, layout, slow, (u, y) = pair(orders, p, forgetting, seed=5)
    u, y, use = u[:600], y[:600], np.ones(600, dtype=bool)
    rng = np.random.default_rng(7)
    y[rng.random(600) < 0.02] += 5.0
    y[rng.random(600) < 0.03] = NAN
    u[rng.random(600) < 0.01] = NAN
    for first, last in ((100, 101), (130, 132), (160, 170)):
        u[first:last] = NAN
    y[210:225] = NAN
    use[300:302] = use[340:360] = False
    u[340:360], y[340:360] = 1e4, -1e4  # whatever stands there
    u[400:402] = u[399] = u[402]  # between equal commands
    u[400:402] = NAN
    follow(state, layout, slow, u, y, use)
    assert layout[ml.CLIPPED] > 0
    assert layout[ml.MASKED] == 22


@pytest.mark.parametrize("orders", ORDERS)
@pytest.mark.parametrize("p", [0, 1, 3])
def test_gradient_from_rest(orders, p):
    na, nb, delay = orders
    theta = plant(na, nb, delay, p, seed=11)
    u, y = record(theta, na, nb, delay, 60, seed=11)
    _, layout = Tuning(1.0, INF, INF, "free").allocate((na, nb, delay), p)
    theta = theta + 0.01 * np.random.default_rng(2).normal(size=theta.size)  # not where the errors are white
    filters, rows, errors = np.zeros(int(layout[ml.FILTERS])), np.zeros((60, theta.size)), np.zeros(60)
    for k in range(60):
        errors[k] = advance.advance(u[k], y[k], theta, filters, na, nb + 1, delay, p, rows[k])
    np.testing.assert_allclose(errors, naive.errors_from_rest(theta, na, nb, delay, u, y), rtol=1e-9, atol=1e-12)
    expected = naive.gradient_from_rest(theta, na, nb, delay, u, y)
    # before the first sample D meets nothing: the derivative to the offset is whole from sample p on
    expected[:p, na + nb + 1] = 1 + theta[na + nb + 5 :].sum()
    np.testing.assert_allclose(rows, expected, rtol=1e-8, atol=1e-10)


def unmoved(p, hold=3):
    """State whose parameters and variance have not moved for 19 blocks, and the errors."""
    state, layout, _, (u, y) = pair((2, 1, 2), p, 1.0, seed=2, sure=1e-9, hold=hold)
    state[ml.SQUARES], state[ml.WEIGHT] = 1e12 * VARIANCE, 1e12
    y[::31] += 3.0
    y[5::57] = NAN
    psi, used = np.zeros(int(layout[ml.N])), np.arange(1216) % 200 != 7
    return state, layout, [run.one(u[k], y[k], bool(used[k]), state, layout, psi)[0] for k in range(1216)]


@pytest.mark.parametrize("p", [0, 1, 3])
def test_replay_is_what_has_been(p):
    state, layout, errors = unmoved(p)
    memory = Memory(state, layout)
    limit = 3.0 * VARIANCE**0.5
    again = memory.replay(Stretch(16, memory.theta, onset=-1), memory.theta, limit)
    seen = np.isfinite(again.errors)
    assert 0.3 < seen.mean() < 0.95
    np.testing.assert_allclose(again.errors[seen], np.array(errors)[-1024:][seen], rtol=1e-6, atol=1e-8)
    size = np.abs(again.errors[seen])
    assert again.cost == pytest.approx(np.sum(np.where(size < limit, size**2, limit * (2 * size - limit))))
    slots = memory.slots(16)
    close(again.h, memory.parts["ring_h"][slots], "H")
    close(again.r, memory.parts["ring_r"][slots], "R")
    close(again.snapshots[:-1], memory.parts["ring_filters"][slots], "filters")
    close(again.snapshots[-1], memory.parts["filters"], "filters at the end")


@pytest.mark.parametrize("p", [0, 1, 3])
def test_filters_follow_parameters_that_have_moved(p):
    """Their X and v are then those of samples filtered with the new parameters; of a small move they stay."""
    state, layout, _ = unmoved(p, hold=40)
    memory = Memory(state, layout)
    state[ml.SQUARES] = 1e12 * VARIANCE
    held, x_at = memory.parts["filters"].copy(), layout[ml.DELAY] + 1
    memory.theta[:2] *= 1.0 + 1e-6
    following.follow(state, layout)
    np.testing.assert_array_equal(memory.parts["filters"], held)
    memory.theta[:2] *= 1.2
    following.follow(state, layout)
    again = memory.replay(Stretch(16, memory.theta, onset=-1), memory.theta, 3.0 * VARIANCE**0.5).snapshots[-1]
    moved = [
        *range(x_at, x_at + 2),
        *range(noise := advance.noise_at(2, 2, 2), noise + p),
        *range(past := noise + p + 4, past + p),
    ]
    np.testing.assert_allclose(memory.parts["filters"][moved], again[moved], rtol=1e-4, atol=1e-4)
    assert np.abs(held - again)[moved].max() > 0.01
    memory.parts["filters"][moved] = held[moved]
    np.testing.assert_array_equal(memory.parts["filters"], held)


@pytest.mark.parametrize("p", [0, 1])
def test_same_as_the_twin_where_op_rests(p):
    state, layout, slow, (u, y) = pair((2, 1, 2), p, 1.0, seed=3, sure=0.3, hold=40)
    follow(state, layout, slow, u, y, np.ones(u.size, dtype=bool))


def test_filters_stay_where_op_moves_all_the_time():
    state, layout, _ = unmoved(1)
    memory = Memory(state, layout)
    held = memory.parts["filters"].copy()
    memory.theta[:2] *= 1.2
    following.follow(state, layout)
    np.testing.assert_array_equal(memory.parts["filters"], held)


@pytest.mark.parametrize("blocks", [1, 4, 16])
@pytest.mark.parametrize("p", [0, 3])
def test_relinearised_where_nothing_has_moved_is_the_same(p, blocks):
    state, layout, _ = unmoved(p)
    memory = Memory(state, layout)
    theta, slots = memory.theta.copy(), memory.slots(blocks)
    ring_h, ring_r = memory.parts["ring_h"], memory.parts["ring_r"]
    before_h, before_r = ring_h[slots].copy(), ring_r[slots].copy()
    layout[ml.FROM_BLOCK] = layout[ml.BLOCKS] - blocks - 1
    relinearise(state, layout)
    close(ring_h[slots], before_h, "H")
    close(ring_r[slots], before_r, "R")
    close(memory.theta, theta, "theta")


# --- single steps by their definition


def positive(rng, n, size=1.0):
    root = rng.normal(size=(n, n + 3))
    return size * root @ root.T


@pytest.mark.parametrize("rank", [1, 3, 8])
@pytest.mark.parametrize("tail", [0.0, 0.05, 0.9])
def test_merge(tail, rank):
    rng = np.random.default_rng(rank)
    h, r, rows = positive(rng, 8), rng.normal(size=8), rng.normal(size=(rank, 8))
    new_h, new_r = rows.T @ rows, rng.normal(size=8)
    expected_h, expected_r = naive.forgotten(h, r, new_h, new_r, tail)
    before = h.copy()
    equations.merge(h, r, new_h, new_r, tail)
    np.testing.assert_allclose(h, expected_h, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(r, expected_r, rtol=1e-9, atol=1e-9)
    # nothing is lost where nothing comes in, and information never falls below what it was by more than what came
    quiet = np.linalg.svd(rows)[2][rank:]
    np.testing.assert_allclose(np.linalg.inv(h).trace() <= np.linalg.inv(before).trace() * (1 + 1e-9), True)
    assert quiet.shape[0] == 8 - rank


def test_merge_keeps_the_estimate_of_directions_without_news():
    """The conditional estimate of the other parameters, given those that news came about, stays where it was."""
    rng = np.random.default_rng(4)
    h, theta = positive(rng, 6), rng.normal(size=6)
    r = h @ theta
    direction = rng.normal(size=6)
    equations.merge(h, r, 100.0 * np.outer(direction, direction), 100.0 * direction * (direction @ theta), 0.1)
    np.testing.assert_allclose(np.linalg.solve(h, r), theta, rtol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_informed_sides(seed):
    rng = np.random.default_rng(seed)
    h = positive(rng, 9, 10.0 ** rng.uniform(-2, 2))
    for index, name in ((5, 0), (6, 1)):
        limit = naive.room(h, index)
        for share, expected in ((0.99, True), (1.01, False)):
            found = equations.informed_sides(h, share * limit * 4.0, 5, 2.0, np.zeros((9, 9)))
            assert found[name] is expected


def test_no_information_is_no_information():
    h = np.zeros((9, 9))
    assert equations.informed_sides(h, 1.0, 5, 2.0, np.zeros((9, 9))) == (False, False)
    h[5, 5] = 100.0
    assert equations.informed_sides(h, 1.0, 5, 2.0, np.zeros((9, 9))) == (True, False)


@pytest.mark.parametrize("seed", range(4))
def test_pin_is_the_nearest_point_in_likelihood(seed):
    rng = np.random.default_rng(seed)
    h, theta, c = positive(rng, 7), rng.normal(size=7), rng.normal(size=7)
    inverse = np.linalg.inv(h)
    expected = theta - inverse @ c * (c @ theta - 0.3) / (c @ inverse @ c)
    bounds.pin(theta, np.linalg.cholesky(h), c.copy(), 0.3)
    np.testing.assert_allclose(theta, expected, rtol=1e-9)
    assert c @ theta == pytest.approx(0.3)


@pytest.mark.parametrize("seed", range(40))
def test_constrained_is_within_bounds(seed):
    rng = np.random.default_rng(seed)
    theta = rng.normal(scale=10.0 ** rng.uniform(-1, 3), size=8)
    bounds.constrain(theta, np.linalg.cholesky(positive(rng, 8)), 4, -2.0, 1.0, 3.0)
    assert -2.0 <= theta[4] <= theta[5] <= 1.0
    assert abs(theta[6]) <= 3.0 + 1e-12


@pytest.mark.parametrize("seed", range(20))
def test_step_stays_stable(seed):
    rng = np.random.default_rng(seed)
    na = int(rng.integers(1, 5))
    theta = np.array([*np.poly(rng.uniform(-0.99, 0.99, na))[1:], 1.0])
    wanted = theta + rng.normal(size=na + 1)
    before = theta.copy()
    bounds.step_to(theta, wanted, na, bounds.RADIUS)
    assert largest_root(theta[:na]) < 1.0
    share = (theta - before) / (wanted - before)
    np.testing.assert_allclose(share, share[0], rtol=1e-6, atol=1e-9)
    assert share[0] in (0.0, 1.0) or np.log2(share[0]) == pytest.approx(round(np.log2(share[0])), abs=1e-6)


@pytest.mark.parametrize("d", [(0.5,), (-1.5,), (-0.9, -0.85, -5.2), (1e6, -1e9), (0.0, 0.0, 1e300)])
def test_calmed_noise_is_stable(d):
    calmed = np.array(d)
    bounds.calm(calmed, bounds.RADIUS)
    assert is_stable(calmed, bounds.RADIUS)
    assert d != (0.5,) or calmed[0] == 0.5


@pytest.mark.parametrize("a", [(), (-0.5,), (-1.6, 0.64), (-2.3283, 1.8994, -0.5546), (-0.99999,)])
def test_settling_time(a):
    assert advance.settling_time(np.array(a)) == naive.settling_time(a)


@pytest.mark.parametrize("forgetting", [1.0, 0.99])
@pytest.mark.parametrize("shift", [0.0, 1.0])
def test_statistic_of_a_change(shift, forgetting):
    state, layout, _, (u, y) = pair((1, 1, 1), 1, forgetting, seed=8)
    theta = plant(1, 1, 1, 1, seed=8)
    theta[5] += shift
    _, other = record(theta, 1, 1, 1, u.size, seed=8)
    y[350:] = other[350:]
    for k in range(480):
        run.one(u[k], y[k], True, state, layout, np.zeros(8))
    memory = Memory(state, layout)
    information.total_information(state, layout)
    memory.parts["usual"][:] = 0.0  # mean square 1: what has been before does not count
    change.find_change(state, layout)
    ring_h = memory.parts["ring_h"]
    ring_r = memory.parts["ring_r"]
    blocks = [(ring_h[slot], ring_r[slot]) for slot in memory.slots(memory.stored)]
    total_h, total_r = memory.parts["total_h"], memory.parts["total_r"]
    expected = naive.largest_statistic(blocks, total_h, total_r, memory.variance, 1, 1)
    assert state[ml.STATISTIC] == pytest.approx(expected, rel=1e-6)
    assert bool(abs(expected) > 4.0) is (shift > 0)


@pytest.mark.parametrize("pinned", [True, False])
def test_the_shown_dead_zone_is_one(pinned):
    """The step to offset zero may not turn the break points round or leave the range."""
    rng = np.random.default_rng(0)
    for _ in range(50):
        theta = np.array([0.1, 1.0, 5.0, 0.0, 0.01, 0.0])
        state, layout = prepared(theta, positive(rng, 6), 1, 0, 1, Tuning(1.0, INF, INF, "zero" if pinned else "free"))
        state[ml.LOW], state[ml.HIGH] = -1.0, 1.0
        information.newton_step(state, layout)
        shown = Memory(state, layout).parts["shown"]
        assert -1.0 <= shown[3] <= shown[4] <= 1.0
        assert abs(shown[5]) <= state[ml.RATIO_LIMIT]
        assert pinned or shown[2] != 0.0


@pytest.mark.parametrize("seed", range(20))
def test_factor_stays_finite_where_information_spans_more_digits_than_numbers_have(seed):
    rng = np.random.default_rng(seed)
    n = 12
    jacobian = rng.normal(size=(40, n)) @ np.diag(np.geomspace(1e8, 1e-3, n)) @ rng.normal(size=(n, n))
    h = jacobian.T @ jacobian
    h -= np.outer(*[rng.normal(size=n)] * 2) * 1e-9 * np.trace(h)  # rounding: no longer positive
    root = np.zeros((n, n))
    equations.factor(h, root)
    step = rng.normal(size=n)
    equations.solve(root, step)
    assert np.isfinite(root).all()
    assert np.isfinite(step).all()
    scale = np.sqrt(np.diag(h))
    assert np.abs(root / scale[:, None]).max() < 10.0


def test_factor_is_that_of_cholesky_where_all_is_known():
    rng = np.random.default_rng(3)
    jacobian = rng.normal(size=(40, 9))
    h, root = jacobian.T @ jacobian, np.zeros((9, 9))
    equations.factor(h, root)
    np.testing.assert_allclose(root, np.linalg.cholesky(h), rtol=1e-7, atol=1e-8)
