"""What a process under a controller can be, against a slow twin; and the sign of the controller."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lostmotion as lm
from lostmotion.identify.likelihood.feedback import feedback
from lostmotion.identify.likelihood.plausible import (
    FREE,
    LARGEST_INVERSE,
    LATE,
    LEAST_DAMPING,
    LEAST_LASTING,
    SLOWEST_RINGING,
    Held,
    plausible,
)
from lostmotion.identify.scaled import ScaledData
from tests.naive.linear import simulate

HELD = Held(True, 0)


def slowly(a, b, direction=0):
    """The same rules on a simulated step."""
    step = simulate(list(a), list(b), 0, np.ones(int(LATE[-1])))
    for late in LATE.tolist():
        part = np.asarray(step[:late])
        ahead, back = max(part.max(), 0.0), max(-part.min(), 0.0)
        left = part[late // 2 :].mean()
        if left <= 0.0:
            ahead, back = back, ahead
        if not abs(left) > LEAST_LASTING * ahead or back > LARGEST_INVERSE * ahead or left * direction > 0:
            return False
    return True


@given(
    st.lists(st.floats(0.05, 0.99), min_size=1, max_size=3),
    st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=3),
    st.sampled_from([-1, 0, 1]),
)
def test_as_the_slow_twin(poles, b, direction):
    a = np.poly(poles)[1:]
    assert Held(True, direction).allows(a, np.array(b)) == slowly(a, b, direction)


def test_the_inverse_of_a_controller_is_no_process():
    kp, ki = 2.0, 0.1
    a, b = np.array([-kp / (kp + ki)]), -np.array([1.0, -1.0]) / (kp + ki)
    assert not HELD.allows(a, b)
    assert FREE.allows(a, b)
    barely = -np.array([1.0, -0.99]) / (kp + ki)
    assert not HELD.allows(a, barely)


@pytest.mark.parametrize(
    ("a", "b"),
    [([-0.9], [0.1]), ([-1.0], [0.05]), ([-1.7, 0.72], [-0.02, 0.05]), ([-0.9], [0.3, -0.24]), ([], [2.0])],
    ids=["lag", "level", "inverse response", "lead", "gain"],
)
def test_real_processes_are_allowed_in_one_direction(a, b):
    a, b = np.array(a), np.array(b)
    assert HELD.allows(a, b)
    assert Held(True, -1).allows(a, b) != Held(True, 1).allows(a, b)


def test_the_best_that_is_allowed():
    polynomials, b = np.full((3, 1), -0.9), np.array([[0.1, -0.1], [-0.3, 0.1], [0.1, 0.1]])[:, None]
    rss, order = np.array([[1.0], [2.0], [3.0]]), np.array([0, 1, 2])
    assert HELD.best_allowed(rss, order, polynomials, b).tolist() == [1]
    assert Held(True, -1).best_allowed(rss, order, polynomials, b).tolist() == [2]
    assert Held(True, 1).best_allowed(rss, order, polynomials, b).tolist() == [1]
    assert HELD.best_allowed(rss, order[:1], polynomials, b).tolist() == [-1]
    assert FREE.best_allowed(rss, order, polynomials, b).tolist() == [0]
    assert HELD.best_allowed(rss[::-1].copy(), order, polynomials, b).tolist() == [2]
    assert rss[:, 0].tolist() == [1.0, 2.0, 3.0]


def test_poles():
    assert plausible(np.array([-1.8, 0.81]))
    assert not plausible(np.array([0.9]))  # rings at half the sampling rate
    assert not plausible(np.array([-1.99, 0.9999]))  # hardly damped


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("moves", [False, True])
def test_the_direction_of_a_controller(sign, moves):
    process = lm.LinearModel([-0.9], [0.1 * sign], 2, 1.0)
    rng = np.random.default_rng(1)
    reference = np.repeat(rng.normal(size=20), 40) if moves else np.zeros(800)
    loop = lm.simulate_loop(
        lm.Hammerstein(lm.Identity(), process), lm.PI(1.5 * sign, 0.15 * sign), reference,
        noise=rng.normal(scale=0.1, size=800), allow_unstable=True,
    )  # fmt: skip
    found = feedback(ScaledData(loop.control, loop.measured, np.array([[0, 800]])))
    assert found.closed
    assert found.direction == -sign


def test_no_direction_without_a_controller():
    rng = np.random.default_rng(2)
    u = np.repeat(rng.normal(size=80), 10)
    found = feedback(ScaledData(u, rng.normal(size=800), np.array([[0, 800]])))
    assert not found.closed
    assert found.direction == 0


def by_eigenvalues(a):
    """The same rules on the eigenvalues of the companion matrix."""
    poles = np.roots(np.append(1.0, a))
    logs = np.log(poles[np.abs(poles) > 1e-12].astype(complex))
    pairs = (np.abs(logs.imag) > 1e-9) & (-logs.real < LEAST_DAMPING * np.abs(logs))
    negative = (logs.imag > np.pi - 1e-9) & (logs.real > np.log(SLOWEST_RINGING))
    return not np.any(pairs | negative)


@pytest.mark.parametrize("order", range(6))
def test_poles_of_a_process(order):
    rng = np.random.default_rng(order)
    for _ in range(200):
        pairs = order // 2 if rng.random() < 0.5 else 0
        some = rng.uniform(0.3, 1.0, pairs) * np.exp(1j * rng.uniform(0.1, 3.0, pairs))
        a = np.real(np.poly([*some, *some.conj(), *rng.uniform(-0.9, 1.0, order - 2 * pairs)]))[1:] if order else []
        assert plausible(np.array(a)) == by_eigenvalues(np.array(a))
