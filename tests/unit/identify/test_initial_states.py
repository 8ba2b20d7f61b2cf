"""Initial states stay near the record where the rows that count tell nothing of them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lfilter

import lostmotion as lm
from lostmotion.evaluate import random_faulty_loop
from lostmotion.models.noise import white_share

HEAD = 30  # rows
FAR = 5.0  # times the 99 % of the rest


def autoregression(reflections: list[float]) -> np.ndarray:
    """Coefficients d1.. from reflection coefficients (Levinson)."""
    d = np.zeros(0)
    for one in reflections:
        d = np.append(d + one * d[::-1], one)
    return d


@given(st.lists(st.floats(-0.6, 0.6), max_size=4))
def test_share_of_white_noise_is_that_of_the_impulse_response(reflections: list[float]) -> None:
    d = autoregression(reflections)
    impulse = np.zeros(20_000)
    impulse[0] = 1.0
    response = lfilter([1.0], np.append(1.0, d), impulse)
    assert white_share(d) == pytest.approx(1.0 / float(response @ response), rel=1e-6)


def test_noise_that_grows_has_none() -> None:
    assert white_share(np.array([-1.01])) == 0.0
    assert white_share(np.array([-2.0, 1.0])) == 0.0


@pytest.mark.statistics
@pytest.mark.parametrize("seed", [50_003, 50_043])
def test_the_simulation_begins_near_the_record(seed: int) -> None:
    """Before these rows counted it began 7 and 97,000 times as far off as it was later."""
    loop = random_faulty_loop(seed, 2000, rough=True)
    fit = lm.identify(lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=loop.dt, op_span=(0.0, 100.0)))
    for start, stop in fit.data.segments.tolist():
        off = np.abs(fit.data.y[start:stop] - fit.simulated[start:stop])
        off = off[np.isfinite(off)]
        assert off[:HEAD].max() <= FAR * np.quantile(off[HEAD:], 0.99)
