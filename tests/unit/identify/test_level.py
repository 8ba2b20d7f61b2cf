"""A level under control whose load drifts: what sticks is seen as a load that turns with OP."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

import lostmotion as lm
from lostmotion.errors import Status

ROWS, GAIN, KP, RESET = 6000, 0.01, 2.0, 200.0


def level(width: float, jump: float = 0.0, seed: int = 1, rows: int = ROWS) -> tuple[np.ndarray, np.ndarray]:
    """OP and PV under PI, without moves of the set point, behind He's valve or a play of this width."""
    rng = np.random.default_rng(seed)
    load = lfilter([1.0], [1.0, -0.999], rng.normal(scale=0.1, size=rows))
    noise = rng.normal(scale=0.05, size=rows)
    op, pv = np.zeros(rows), np.zeros(rows)
    place = state = integral = force = before = 0.0
    for row in range(rows):
        pv[row] = state + noise[row]
        integral -= KP * pv[row] / RESET
        op[row] = integral - KP * pv[row]
        if jump:
            force += op[row] - before
            if abs(force) > 0.5 * (width + jump):
                force = np.sign(force) * 0.5 * (width - jump)
                place = op[row] - force
        else:
            place = min(max(place, op[row] - 0.5 * width), op[row] + 0.5 * width)
        before = op[row]
        state += GAIN * (place + load[row])
    return op + 50.0, pv + 40.0


@pytest.fixture(scope="module")
def backlash() -> lm.HammersteinFit:
    return lm.identify(*level(3.0), 1.0)


def test_backlash_behind_a_drifting_load_is_sized(backlash):
    assert (backlash.status, backlash.preferred) == (Status.OK, "backlash")
    low, high = backlash.size_interval
    assert 2.0 < low < 3.0 < high < 4.0
    assert backlash.linear.b[0] == pytest.approx(GAIN, rel=0.2)
    assert backlash.evidence.load_drifts
    assert not backlash.evidence.only_fed_back


def test_its_size_asked_for_is_the_same(backlash):
    named = lm.identify(*level(3.0), 1.0, nonlinearity="backlash")
    assert named.size_interval == pytest.approx(backlash.size_interval)


def test_noise_of_a_level_is_said_and_saved(backlash, tmp_path):
    assert "a drifting load disturbance and white measurement noise" in " ".join(str(backlash).split())
    backlash.save(tmp_path / "fit.json")
    again = lm.read_fit(tmp_path / "fit.json")
    assert again.noise == backlash.noise
    assert again.noise.c
    assert again.evidence == backlash.evidence


def test_a_healthy_valve_is_told_where_all_sizes_are_excluded():
    fit = lm.identify(*level(0.0, seed=2), 1.0)
    largest = max(fit.kinds.excluded[kind] for kind in ("backlash", "stiction"))
    told = largest <= 0.1 * np.ptp(fit.data.u)
    assert (fit.status, fit.preferred) == ((Status.OK, "none") if told else (Status.CANNOT_TELL, "cannot tell"))


def test_a_size_that_is_true_is_not_excluded():
    for seed in (2, 3):
        fit = lm.identify(*level(1.0, seed=seed), 1.0)
        assert fit.preferred != "none" or fit.kinds.excluded["backlash"] > 1.0


def test_stiction_is_told_from_backlash_by_its_jump():
    fit = lm.identify(*level(3.0, 1.5), 1.0)
    assert fit.preferred == "stiction"
    low, high = fit.size_interval
    assert low < 3.0 < high


def test_moves_of_the_set_point_leave_the_rest_to_predictions():
    op, pv = level(3.0)
    assert lm.identify(op, pv, 1.0, noise="ar").evidence.load_drifts is False
    assert lm.identify(op, pv, 1.0, integrating=False).evidence.load_drifts is False
