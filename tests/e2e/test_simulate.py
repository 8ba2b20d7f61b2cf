"""``lostmotion simulate`` as a new user runs it."""

import json

import pytest

import lostmotion as lm
from lostmotion.files import write_columns
from tests.e2e.test_commands import run

pytestmark = pytest.mark.statistics
NUMBERS = (
    *("simulate", "--width", 2, "--gain", 1, "--time-constant", 10, "--dead-time", 2, "--dt", 0.5),
    *("--noise-deviation", 0.02, "--op-now", 50, "--runs", 2, "--samples", 1500),
)


def test_record_to_block_and_figure(capsys, tmp_path):
    loop = lm.routine_operation(2000, drift="mild", seed=3)
    record = write_columns(
        tmp_path / "LIC-7.csv", {"time_s": loop.time, "SP": loop.reference, "PV": loop.measured, "OP": loop.command}
    )
    figure, block, out = tmp_path / "a.png", tmp_path / "block.json", tmp_path / "a.json"
    words = ("--op-span", -50, 50, "--runs", 3, "--draws", 4)
    code, text, error = run(
        capsys, "simulate", record, "--nonlinearity", "dead zone", "--known-gain", 2.2222, *words,
        "--figure", figure, "--block-out", block, "--out", out,
    )  # fmt: skip
    assert code == 0
    assert error == ""
    assert "COMPENSATION is worth it." in text
    assert "estimated from the record" in text
    assert figure.read_bytes()[:4] == b"\x89PNG"
    assert json.loads(out.read_text())["safe"]
    code, text, _ = run(
        capsys, "export", block, "--name", "FY_7", "--date", "2026-01-31", "--out", tmp_path, "--replay", 500
    )
    assert code == 0


def test_fit_beside_its_record(capsys, tmp_path):
    loop = lm.routine_operation(2000, drift="none", seed=3)
    record = write_columns(
        tmp_path / "LIC-7.csv", {"time_s": loop.time, "SP": loop.reference, "PV": loop.measured, "OP": loop.command}
    )
    fit = tmp_path / "fit.json"
    run(capsys, "identify", record, "--orders", "3,2,3", "--noise", "white", "--out", fit)
    words = ("simulate", fit, "--record", record, "--op-span", -50, 50, "--runs", 2, "--draws", 2, "--json")
    code, text, _ = run(capsys, *words)
    data = json.loads(text)
    assert code == 1  # without the known gain the block leaves the slope in the loop, which needs other settings
    assert data["recommendation"] == "compensate and retune"
    assert data["controller"]["source"].startswith("estimated")


def test_numbers_of_a_model(capsys):
    code, text, _ = run(capsys, *NUMBERS, "--kp", 2, "--ki", 0.5, "--json")
    data = json.loads(text)
    assert code == 0
    assert data["cases"]["with"]["iae_ratio"] < 0.5
    assert data["cases"]["without"]["limit_cycle"]["amplitude"] > 0.1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (NUMBERS, "controller"),
        (("simulate",), "a file"),
        (("simulate", "--width", 1, "--band", 1), "none or several"),
        (("simulate", "nothing.json"), "readable nothing.json"),
        (("simulate", "nothing.csv"), "no such file"),
        ((*NUMBERS, "--kp", 1, "--block", "nothing.json"), "readable nothing.json"),
    ],
)
def test_bad_input_is_one_clear_line(capsys, words, said):
    code, _, error = run(capsys, *words)
    assert code == 2
    assert error.startswith("error: expected")
    assert said in error
    assert error.count("\n") == 1


def test_usage_and_help(capsys):
    assert run(capsys, "simulate", "--runs", "many")[0] == 2
    code, text, _ = run(capsys, "simulate", "--help")
    assert code == 0
    assert "Example: lostmotion simulate" in " ".join(text.split())
