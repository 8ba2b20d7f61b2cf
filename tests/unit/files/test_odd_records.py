"""Records without noise, with a pole outside the circle, or of strange size: a result or one line, and no warning."""

import io
import warnings

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import DataError
from tests.support.odd_records import made_of, odd_record

K = np.arange(300)


def unstable():
    u, y = lm.signals.prs(100, -5, 5, hold=8, seed=1), np.zeros(100)
    for k in range(1, 100):
        y[k] = 1.5 * y[k - 1] + u[k - 1]
    return u, y


def loop(scale):
    u = lm.signals.prs(300, -5, 5, hold=8, seed=1)
    x = np.where(u > 1, u - 1, np.where(u < -1, u + 1, 0.0))
    noise = 0.05 * np.random.default_rng(0).normal(size=300)
    return u * scale, (lm.LinearModel((-0.8,), (0.2,), 1).simulate(x) + noise) * scale


CASES = {
    "an exact sine": (np.sin(K / 7), np.cos(K / 7)), "a pole at 1.5": unstable(), "1e20": loop(1e20),
    "1e-20": loop(1e-20), "a whole period": (10 + np.sin(K * np.pi / 10), np.cos(K * np.pi / 10)),
}  # fmt: skip


@pytest.mark.statistics
@pytest.mark.parametrize("case", CASES)
def test_a_result_or_one_line(case):
    lm.identify(*CASES[case], dt=1.0).summary()


@pytest.mark.statistics
@pytest.mark.parametrize("number", [0, 92, 94, 111])
def test_odd_records(number):
    u, y, name = odd_record(number)
    assert made_of(u, y) == [], name


@pytest.mark.parametrize(
    ("scale", "said"), [(1e150, "below 1e\\+30"), (1e300, "below 1e\\+30"), (1e-150, "that moves")]
)
def test_sizes_that_no_arithmetic_holds(scale, said):
    u, y = loop(scale)
    with pytest.raises(DataError, match=said):
        lm.identify(u, y, dt=1.0)
    if scale > 1:
        with pytest.raises(DataError, match=said):
            lm.LoopRecord(op=u, pv=y, dt=1.0)


@pytest.mark.parametrize("sp", [False, True])
@pytest.mark.parametrize(("delay", "digits"), [(0, 1), (0, 2), (1, 1), (2, 1)])
def test_a_sine_without_noise_has_a_verdict_and_a_figure(sp, delay, digits):
    """A period of six samples, rounded: PV is fitted exactly, so that no variance is left to divide by."""
    k = np.arange(600)
    op, pv = (np.round(mean + size * np.sin(2 * np.pi * (k - late) / 6), digits)
              for mean, size, late in ((50, 5, 0), (20, 2, delay)))  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = lm.diagnose(lm.LoopRecord(op, pv, np.full(600, 20.0) if sp else None, dt=1.0, op_span=(0.0, 100.0)))
    assert found.verdict == "cannot tell"
    assert found.summary()
    found.plot().savefig(io.BytesIO(), format="svg")
    found.fit.plot().savefig(io.BytesIO(), format="svg")
