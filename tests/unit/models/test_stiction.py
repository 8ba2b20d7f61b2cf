import json
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.kernels import stiction as kernel
from tests.naive import stiction as slow
from tests.support.refusals import refusal

NAN, INF = float("nan"), float("inf")
SEEDS = range(6)
MODELS = ("choudhury", "kano", "he")
CODES = {"choudhury": kernel.CHOUDHURY, "kano": kernel.KANO, "he": kernel.HE, "he ramp": kernel.HE_RAMP}
RUNS = {"choudhury": kernel.run_choudhury, "kano": kernel.run_kano, "he": kernel.run_he}
SENSITIVITIES = {
    "choudhury": kernel.sensitivities_choudhury,
    "kano": kernel.sensitivities_kano,
    "he": kernel.sensitivities_he,
}
PAIRS = [(0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (3.0, 3.0), (1.0, 2.5), (0.0, 1.0)]


def commands(seed, n=400):
    """Noise, holds, zigzags and ramps one behind the other, in eighths so that sums are exact."""
    rng = np.random.default_rng(seed)
    walk = np.cumsum(rng.normal(size=n))
    held = np.repeat(rng.uniform(-8, 8, n // 8), 8)
    ramps = np.interp(np.arange(n), np.arange(0, n, 20), rng.uniform(-8, 8, n // 20))
    return np.round(8 * np.concatenate([walk, held, ramps, rng.integers(-5, 5, n)])) / 8


@pytest.mark.parametrize(("band", "jump"), PAIRS)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("seed", SEEDS)
def test_twin(model, seed, band, jump):
    u = commands(seed)
    for start in (u[0], u[0] + 0.5, u[0] - 6.0):
        expected = slow.MODELS[model](u, band, jump, start)
        np.testing.assert_array_equal(RUNS[model](u, band, jump, start), expected)
    np.testing.assert_array_equal(lm.Stiction(band, jump, model)(u), lm.Stiction(band, jump, model).run(u, start=u[0]))


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("seed", SEEDS)
def test_twin_of_any_numbers(model, seed):
    rng = np.random.default_rng(seed)
    u, band, jump = np.cumsum(rng.normal(size=2000)), *rng.uniform(0, 4, 2)
    expected = slow.MODELS[model](u, band, jump, u[0])
    np.testing.assert_allclose(RUNS[model](u, band, jump, u[0]), expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(("band", "jump"), PAIRS[1:])
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("seed", SEEDS)
def test_sensitivities(model, seed, band, jump):
    u = commands(seed)
    x, dx = np.full(u.size, NAN), np.full((2, u.size), NAN)
    SENSITIVITIES[model](u, band, jump, u[0], x, dx)
    np.testing.assert_array_equal(x, RUNS[model](u, band, jump, u[0]))
    np.testing.assert_allclose(dx, slow.derivatives(model, u, band, jump, u[0]), atol=1e-15)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("seed", SEEDS)
def test_sensitivities_against_finite_differences(model, seed):
    u, h = np.cumsum(np.random.default_rng(seed).normal(size=400)), 1e-7  # no break-away within h of another sample
    x, dx = np.empty(u.size), np.empty((2, u.size))
    SENSITIVITIES[model](u, 3.0, 1.0, NAN, x, dx)
    run = RUNS[model]
    by_band = (run(u, 3.0 + h, 1.0, NAN) - run(u, 3.0 - h, 1.0, NAN)) / (2 * h)
    by_jump = (run(u, 3.0, 1.0 + h, NAN) - run(u, 3.0, 1.0 - h, NAN)) / (2 * h)
    np.testing.assert_allclose(dx, [by_band, by_jump], atol=1e-6)
    assert set(np.unique(dx)) == {-0.5, 0.0, 0.5}


UP = [0.0, 2.0, 3.0, 4.0, 4.5]


@pytest.mark.parametrize(
    ("model", "u", "x"),
    [
        # band 4, jump 1: breaks away 2.5 off the middle, glides 1.5 behind
        ("choudhury", UP, [0, 0, 1.5, 2.5, 3]),
        ("kano", UP, [0, 0, 1.5, 2.5, 3]),
        ("he", UP, [0, 0, 1.5, 1.5, 3]),
        # a hold while it moves: the jump has to be overcome again
        ("choudhury", [0, 3, 3, 3.5, 4, 4.5], [0, 1.5, 1.5, 1.5, 1.5, 3]),
        ("kano", [0, 3, 3, 3.5, 4, 4.5], [0, 1.5, 1.5, 1.5, 1.5, 3]),
        ("he", [0, 3, 3, 3.5, 4, 4.5], [0, 1.5, 1.5, 1.5, 1.5, 3]),
        # down and up again inside the band: Kano still knows where it stopped, Choudhury counts anew
        ("choudhury", [0, 3, 2, 3, 4.5, 5, 7], [0, 1.5, 1.5, 1.5, 1.5, 1.5, 5.5]),
        ("kano", [0, 3, 2, 3, 4.5, 5, 7], [0, 1.5, 1.5, 1.5, 3, 3.5, 5.5]),
        ("he", [0, 3, 2, 3, 4.5, 5, 7], [0, 1.5, 1.5, 1.5, 3, 3, 5.5]),
        # a turn by more than the band in one sample moves at once
        ("choudhury", [0, 3, -1.5], [0, 1.5, 0]),
        ("kano", [0, 3, -1.5], [0, 1.5, 0]),
        ("he", [0, 3, -1.5], [0, 1.5, 0]),
    ],
)
def test_by_hand(model, u, x):
    assert lm.Stiction(4.0, 1.0, model)(u).tolist() == x


@pytest.mark.parametrize("model", MODELS)
def test_overshoot_and_stick_slip(model):
    assert lm.Stiction(2.0, 4.0, model)([0.0, 3.0, 3.5]).tolist() == [0.0, 0.0, 4.5]  # 1 beyond the command
    assert lm.Stiction(2.0, 2.0, model)([0.0, 2.0, 2.5]).tolist() == [0.0, 0.0, 2.5]  # on it


@pytest.mark.parametrize("model", MODELS)
def test_no_stiction_is_the_identity(model):
    u = commands(0)
    np.testing.assert_array_equal(lm.Stiction(0, 0, model)(u), u)


@pytest.mark.parametrize("model", ["kano", "he"])
@pytest.mark.parametrize("seed", SEEDS)
def test_without_jump_it_is_backlash(model, seed):
    u = commands(seed)
    for start in (None, 1.0):
        np.testing.assert_array_equal(
            lm.Stiction(2.0, 0.0, model).run(u, start=start), lm.Backlash(2.0).run(u, start=start)
        )


def test_choudhury_without_jump_is_backlash_where_runs_are_long():
    turns = np.random.default_rng(0).uniform(2.5, 8, 60) * (-1.0) ** np.arange(60)
    u = np.interp(np.arange(0, 59, 0.01), np.arange(60), turns)
    np.testing.assert_allclose(lm.Stiction(2.0, 0.0, "choudhury")(u), lm.Backlash(2.0)(u), atol=1e-12)


def test_choudhury_is_held_for_ever_by_small_reversals():
    u = np.cumsum(np.tile([3.0, -1.0], 50))  # climbs by 2 each time, in runs shorter than the band
    held = lm.Stiction(4.0, 1.0, "choudhury").run(u, start=0.0)
    np.testing.assert_array_equal(held, 1.5)
    assert u[-1] == 100.0
    assert np.abs(u - lm.Stiction(4.0, 1.0, "kano").run(u, start=0.0)).max() <= 2.5


@pytest.mark.parametrize("model", MODELS)
def test_missing_samples_keep_the_state(model):
    u = commands(1)[:600]
    holes = u.copy()
    holes[np.random.default_rng(0).random(u.size) < 0.1] = NAN
    holes[0] = NAN
    valve, there = lm.Stiction(2.0, 1.0, model), ~np.isnan(holes)
    x = valve(holes)
    np.testing.assert_array_equal(np.isnan(x), ~there)
    np.testing.assert_array_equal(x[there], valve(holes[there]))


@pytest.mark.parametrize("model", MODELS)
def test_step_is_run(model):
    u = commands(2)
    state = kernel.init(0.5)
    assert state.shape == (kernel.STATE_SIZE,)
    stepped = [kernel.step(CODES[model], value, 2.0, 1.0, state) for value in u]
    np.testing.assert_array_equal(stepped, lm.Stiction(2.0, 1.0, model).run(u, start=0.5))


def test_description_survives_json():
    valve = lm.Stiction(3, 1, "he")
    assert lm.Stiction.from_dict(json.loads(json.dumps(valve.to_dict()))) == valve
    assert valve.to_dict() == {"kind": "stiction", "band": 3.0, "jump": 1.0, "model": "he"}
    assert lm.Stiction.from_dict({"band": 3.0, "jump": 1.0}).model == "kano"


@pytest.mark.parametrize("name", ["band", "jump"])
@pytest.mark.parametrize("value", [NAN, INF, -1.0, None, "wide", [1.0, 2.0]])
def test_refuses_what_is_not_a_width(name, value):
    assert name in refusal(lm.ParameterError, lm.Stiction, **{"band": 1.0, "jump": 1.0, name: value})


def test_other_refusals():
    assert "'stenman'" in refusal(lm.ParameterError, lm.Stiction, 1, 1, "stenman")
    assert "model" in refusal(lm.ParameterError, lm.Stiction, 1, 1, ["he"])
    valve = lm.Stiction(1, 1)
    assert "shape (2, 3)" in refusal(lm.ParameterError, valve, np.zeros((2, 3)))
    assert "start" in refusal(lm.ParameterError, valve.run, [1.0], start=INF)
    refusal(lm.ParameterError, lm.Stiction.from_dict, {"band": 1.0})
    with pytest.raises(FrozenInstanceError):
        valve.band = 2.0
    assert valve(3.0) == 3.0
    assert valve([]).tolist() == []
