"""Options with extreme values, typed as on a command line: one line of error, 0, 1 or 2, no traceback, no warning."""

import json
import warnings

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.compensate import block_from_model
from tests.support import extreme_options
from tests.support.command import run

MODEL = [
    "--width",
    "2",
    "--gain",
    "1.5",
    "--time-constant",
    "30",
    "--dead-time",
    "4",
    "--dt",
    "1",
    "--noise-deviation",
    "0.1",
    "--kp",
    "1",
    "--ki",
    "0.03",
]
EXTREME = [
    "5e-324",
    "1e-320",
    "1.7e308",
    "-1.7e308",
    "1e300",
    "-1",
    "nan",
    "inf",
    "9" * 20,
    "9" * 5000,
    "",
    "x",
    "\x1b",
]
EXPORT = ["export", "b.json", "--to", "st", "--name", "FY_1", "--date", "2026-01-31", "--out", "o", "--replay", "50"]


@pytest.fixture
def here(tmp_path, monkeypatch):
    rng = np.random.default_rng(1)
    rows = zip(np.repeat(rng.normal(size=40), 5), rng.normal(size=200), strict=True)
    (tmp_path / "a.csv").write_text("OP,PV\n" + "".join(f"{op:.3f},{op + pv:.3f}\n" for op, pv in rows))
    (tmp_path / "b.json").write_text(json.dumps(block_from_model(lm.Backlash(2.0), 1.0).to_dict()))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def told(capsys, *words):
    """Exit code of a command and the line of its error, if it has one."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        code, _, error = run(capsys, *words)
    assert code in (0, 1, 2)
    assert "Traceback" not in error
    lines = [line for line in error.splitlines() if line.lower().startswith("error")]
    assert len(lines) <= 1
    assert all(line.isprintable() and len(line) < 3500 for line in lines)
    return code, lines


@pytest.mark.parametrize("value", EXTREME)
def test_numbers(here, capsys, value):
    for words in (
        ["check", "a.csv", f"--dt={value}"],
        ["check", "a.csv", "--dt", "1", "--op-span", f"-{value}".replace("--", ""), value],
        [*EXPORT, f"--ramp={value}"],
        [*EXPORT, "--set", f"high={value}"],
        [*EXPORT, f"--factor={value}"],
        [*EXPORT, f"--replay={value}"],
        [*EXPORT, "--supervised", "--supervise", f"timeout={value}"],
    ):
        code, lines = told(capsys, *words)
        assert (code, bool(lines)) != (0, True)


@pytest.mark.parametrize("option", ["--gain", "--time-constant", "--dead-time", "--dt", "--kp", "--ki", "--width"])
@pytest.mark.parametrize("value", ["1.7e308", "-1.7e308", "nan", "inf", "x"])
def test_numbers_of_a_model(here, capsys, option, value):
    words = list(MODEL)
    words[words.index(option) + 1] = value
    code, lines = told(capsys, "simulate", *words, "--samples", "200", "--runs", "1")
    assert code == 2
    assert len(lines) == 1


@pytest.mark.parametrize(
    ("orders", "left"),
    [("50,50,1", 1), ("0,0,99999999999", 1), ("-1,0,0", 2), ("1,2", 2), ("a,b,c", 2), ("1e3,0,0", 2)],
)
def test_orders(here, capsys, orders, left):
    code, lines = told(capsys, "identify", "a.csv", "--dt", "1", "--orders", orders)
    assert code == left  # 1: of a longer record they could be
    assert len(lines) == 1


@pytest.mark.long
def test_a_model_of_no_order(here, capsys):
    assert told(capsys, "identify", "a.csv", "--dt", "1", "--orders", "0,0,0")[0] in (0, 1)


@pytest.mark.parametrize("address", ["postgresql://u:p@[::1/db", "postgresql://h:x/db", "sqlite://", "x://"])
def test_addresses(here, capsys, address):
    assert told(capsys, "audit", "a.csv", "--dt", "1", "--store", address)[0] in (1, 2)


SLOW = ("paper", "audit", "solve", "design")  # seconds each: in the long form


def tried(chosen):
    """Outcomes in capitals of cases."""
    bad = {}
    with extreme_options.small_folder() as folder:
        for name, words in chosen:
            found = extreme_options.outcome(name, words)
            extreme_options.tidy(folder)
            if found[:3].isupper():
                bad[name, *words] = found
    return bad


def test_some_of_all_options(capfd):
    every = [case for case in extreme_options.cases() if case[0] not in SLOW]
    assert len(every) > 5000
    with capfd.disabled():
        assert tried(every[k] for k in np.random.default_rng(3).permutation(len(every))[:120]) == {}


@pytest.mark.long
def test_more_of_all_options(capfd):
    every = list(extreme_options.cases())
    with capfd.disabled():
        assert tried(every[k] for k in np.random.default_rng(4).permutation(len(every))[:300]) == {}


@pytest.mark.parametrize(
    "words",
    [
        [*MODEL, "--samples", "200", "--runs", "1", "--seed=-1"],
        [*MODEL, "--samples", "200", "--runs", "1", "--dead-time", "9" * 20],
        [*MODEL, "--samples", "200", "--runs", "1", "--gain", "1e-320"],
    ],
)
def test_a_model_out_of_bounds(here, capsys, words):
    code, lines = told(capsys, "simulate", *words)
    assert (code, len(lines)) == (2, 1)


@pytest.mark.parametrize(
    "words",
    [["paper", "--out="], ["audit", "a.csv", "--dt", "1", "--workers", "9" * 20],
     ["demo-plant", "p", "--dt", "1e9", "--days", "0.01"], ["demo-plant", "p", "--days", str(2**63)]],
)  # fmt: skip
def test_refused_before_anything_is_done(here, capsys, words):
    code, lines = told(capsys, *words)
    assert (code, len(lines)) == (2, 1)
