"""Every printed command is run on the record that caused it: it works, and does not lead back to itself."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.files import write_columns
from tests.support.hints import FIRST, Walk, hints
from tests.support.shared_data import shared

pytestmark = pytest.mark.long

LAG = lm.LinearModel([-0.8], [0.2], 1)
FAST = lm.LinearModel([], [1.0], 1)
TANK = lm.LinearModel([-1.0], [0.02], 1)
PI = lm.PI(0.6, 0.1)
CASES = {  # valve, process, controller, move of SP, samples of a move
    "dead zone": (lm.DeadZone(-1.5, 1.5), LAG, PI, 3.0, 50),
    "backlash": (lm.Backlash(2.5), LAG, PI, 3.0, 50),
    "stiction": (lm.Stiction(3.0, 1.5), LAG, PI, 3.0, 50),
    "saturation": (lm.Saturation(-1.5, 1.5), LAG, PI, 3.0, 50),
    "none": (lm.Identity(), LAG, PI, 3.0, 50),
    "at rest": (lm.Identity(), LAG, PI, 0.0, 50),
    "near its limit": (lm.Identity(), LAG, lm.PI(4.0, 1.2), 0.2, 200),
    "level": (lm.Backlash(2.0), TANK, lm.PI(2.0, 0.02), 1.0, 200),
    "level at rest": (lm.Identity(), TANK, lm.PI(2.0, 0.02), 0.0, 200),
    "too slow": (lm.Identity(), FAST, lm.PI(0.2, 0.3), 0.0, 50),
    "weak dead zone": (lm.DeadZone(-1.0, 1.0), LAG, PI, 0.5, 100),
}
QUICK = ("dead zone", "backlash", "at rest", "level at rest", "too slow")
REAL = (
    "isdb26/CHEM1.csv", "isdb26/CHEM10.csv", "isdb26/PAP2.csv", "isdb26/MIN1.csv", "isdb_more/BAS6.csv",
    "isdb_more/POW1.csv", "historian_week/LIC-106.csv", "damadics/lublin_actuator3_2001-10-11_1h.csv",
)  # fmt: skip


def record(name, samples=800, dt=1.0):
    """Columns of a loop around OP 50 and PV 50."""
    valve, process, controller, size, hold = CASES[name]
    random = np.random.default_rng(7)
    sp = np.repeat(random.uniform(-size, size, samples // hold), hold)
    loop = lm.simulate_loop(lm.Hammerstein(valve, process), controller, sp, noise=0.05, seed=3, allow_unstable=True)
    return {"time_s": dt * np.arange(sp.size), "OP": 50 + loop.control, "PV": 50 + loop.measured, "SP": 50 + sp}


@pytest.fixture
def walk(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    return Walk(capsys)


def agrees(walk, dead_zone_only=True):
    assert not walk.refused
    assert not walk.circles
    if dead_zone_only:
        assert not walk.told(("design", "online", "compensate"))


def test_what_a_hint_is():
    text = (
        "Usable.\nNext: lostmotion diagnose 'a b.csv'\n  lostmotion solve a.csv --kp KP\nrun `lostmotion check` first"
    )
    assert hints(text) == [("diagnose", "a b.csv"), ("solve", "a.csv", "--kp", "1")]


@pytest.mark.parametrize("name", QUICK)
def test_hints_of_a_quick_record(walk, name):
    file = write_columns("LIC 1.csv" if "level" in name else "FIC 1.csv", record(name))
    walk.all_from(file.name, commands=("check", "identify", "diagnose"))
    agrees(walk, dead_zone_only=name in ("backlash", "level at rest", "too slow"))


@pytest.mark.statistics
@pytest.mark.parametrize("name", CASES)
def test_hints_of_every_kind(walk, name):
    file = write_columns("LIC 1.csv" if "level" in name else "FIC 1.csv", record(name, samples=2000))
    agrees(walk.all_from(file.name), dead_zone_only=name in ("backlash", "stiction", "too slow"))


@pytest.mark.statistics
@pytest.mark.parametrize("path", REAL)
def test_hints_of_real_records(walk, path):
    agrees(walk.all_from(shared(path), commands=FIRST), dead_zone_only=False)
