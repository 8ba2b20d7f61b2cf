"""Every block against its slow twin, over random and adversarial scans, in double and in single precision."""

import numpy as np
import pytest

from lostmotion.compensate import SPECIFICATIONS
from tests.naive.block import NaiveBlock

NAN, INF = float("nan"), float("inf")
OUTPUTS = (
    "op_out", "offset", "back", "direction", "reversals", "state", "limited_low", "limited_high", "offset_capped",
    "ramping", "error",
)  # fmt: skip
BAD = [NAN, INF, -INF, 1e308, -1e308, 0.0, 100.0, 1e-30, 2e-13, -1e-12, 1e-12, 1e9, 2e9, -2e9, 2.0, 2.125]
eighth = 0.125


def random_settings(rng, kind):
    """Settings on a grid of eighths, mostly usable, so that sums are exact."""

    def grid(low, high):
        return eighth * rng.integers(int(8 * low), int(8 * high) + 1)

    p = {
        "factor": rng.choice([0.0, 0.5, 1.0, 1.5]), "band": grid(0, 1), "quiet": rng.choice([0.0, 0.0, 0.25]),
        "ramp_step": grid(0.125, 2), "rate": rng.choice([200.0, 200.0, 1.0]), "cap": rng.choice([200.0, 3.0]),
        "low": grid(-5, 5), "high": grid(90, 110), "hold_on_disable": float(rng.random() < 0.3), "safe": grid(0, 50),
        "count_limit": float(rng.integers(1, 9)),
    }  # fmt: skip
    centre = grid(45, 55)
    p |= {
        "dead zone": {
            "left_break": centre - grid(0, 4), "right_break": centre + grid(0, 4), "centre": centre,
            "left_slope": rng.choice([0.5, 1.0, 2.0]), "right_slope": rng.choice([0.5, 1.0, 2.0]),
            "shape": float(rng.integers(0, 3)), "zone": rng.choice([0.0, 0.5, 2.0]),
            "hunt_scans": float(rng.choice([0, 0, 5, 20])), "hunt_limit": float(rng.integers(1, 4)),
            "back_off": rng.choice([0.5, 1.0]),
        },
        "backlash": {
            "lead_up": grid(0, 3), "lead_down": grid(0, 3), "pulse": grid(0, 1),
            "pulse_scans": float(rng.integers(0, 4)),
        },
        "stiction knocker": {
            "amplitude": grid(0, 3), "pulse_scans": float(rng.integers(1, 4)),
            "period_scans": float(rng.integers(3, 8)),
        },
        "stiction two moves": {
            "overshoot": grid(0, 4), "stand": grid(-1, 2), "move_scans": float(rng.integers(1, 5)),
            "share": rng.choice([0.0, 0.5, 1.0]), "release": grid(0, 4),
        },
    }[kind]  # fmt: skip
    if rng.random() < 0.25:
        name = rng.choice(list(p))
        p[str(name)] = float(rng.choice([*BAD, -1.0]))
    return p


def random_scans(rng, n):
    """Inputs (n, 5): moves, noise, plateaus and turns on the grid of eighths, and what must never happen."""
    op = 50.0 + eighth * np.cumsum(rng.integers(-6, 7, n) * (rng.random(n) < 0.7))
    op = np.clip(op, -20.0, 120.0)
    op = np.where(rng.random(n) < 0.02, rng.choice(BAD, n), op)
    enable = np.repeat(rng.random(n // 10 + 1) < 0.8, 10)[:n] ^ (rng.random(n) < 0.03)
    good = rng.random(n) < 0.95
    track = np.repeat(rng.random(n // 10 + 1) < 0.15, 10)[:n] ^ (rng.random(n) < 0.02)
    value = np.where(rng.random(n) < 0.1, rng.choice(BAD, n), 50.0 + eighth * rng.integers(-40, 40, n))
    return np.column_stack([op, enable, good, track, value]).astype(np.float64)


def compare(kind, seed, dtype, scans=120):
    rng = np.random.default_rng([seed, len(kind)])
    specification, slow = SPECIFICATIONS[kind], NaiveBlock(kind)
    state = specification.state(dtype)
    settings = random_settings(rng, kind)
    rows = random_scans(rng, scans)
    if dtype == np.float32:
        rows[:, (0, 4)] = np.where(np.abs(rows[:, (0, 4)]) > 1e30, INF, rows[:, (0, 4)])  # beyond single precision
        rows[:, (0, 4)] = np.where(np.abs(rows[:, (0, 4)]) < 1e-30, 0.0, rows[:, (0, 4)])
    outputs = specification.outputs(1, dtype)
    for k, row in enumerate(rows):
        if rng.random() < 0.05:
            settings = random_settings(rng, kind)
        p = specification.parameters(settings).astype(dtype)
        named = dict(zip(settings_names(specification), p.tolist(), strict=True))
        specification.run(p, state, row[None].astype(dtype), outputs)
        expected = slow.scan(named, *(value if j in (0, 4) else bool(value) for j, value in enumerate(row.tolist())))
        found = dict(zip(OUTPUTS, outputs[0].tolist(), strict=True))
        for name in OUTPUTS:
            close = pytest.approx(float(expected[name]), rel=1e-12 if dtype == np.float64 else 1e-5, abs=1e-9)
            assert found[name] == close, (kind, seed, k, name, row, named)


def settings_names(specification):
    return [variable.name.lower() for variable in specification.section("parameter")]


@pytest.mark.parametrize("kind", SPECIFICATIONS)
@pytest.mark.parametrize("seed", range(12))
def test_is_its_twin(kind, seed):
    with np.errstate(all="ignore"):
        compare(kind, seed, np.float64)


@pytest.mark.parametrize("kind", SPECIFICATIONS)
@pytest.mark.parametrize("seed", range(100, 104))
def test_single_precision_is_its_twin(kind, seed):
    with np.errstate(all="ignore"):
        compare(kind, seed, np.float32)


@pytest.mark.long
@pytest.mark.statistics
@pytest.mark.parametrize("kind", SPECIFICATIONS)
def test_is_its_twin_for_long(kind):
    with np.errstate(all="ignore"):
        for seed in range(1000, 1030):
            compare(kind, seed, np.float64, scans=300)
