"""The commands as a new user runs them: output, files, exit codes, errors."""

import json
import subprocess
import sys

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.cli import main
from lostmotion.files import write_columns

pytestmark = pytest.mark.statistics


def run(capsys: pytest.CaptureFixture[str], *words: object) -> tuple[int, str, str]:
    with pytest.raises(SystemExit) as stop:
        main([str(word) for word in words])
    seen = capsys.readouterr()
    return int(stop.value.code or 0), seen.out, seen.err


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    loop = lm.routine_operation(3000, drift="none", seed=3)
    path = tmp_path_factory.mktemp("loop") / "LIC-7.csv"
    return write_columns(path, {"time_s": loop.time, "SP": loop.reference, "PV": loop.measured, "OP": loop.command})


def test_identify_writes_result_and_figure(capsys, record, tmp_path):
    out, figure = tmp_path / "fit.json", tmp_path / "fit.png"
    code, text, _ = run(capsys, "identify", record, "--orders", "3,2,3", "--out", out, "--figure", figure)
    assert code == 0
    assert "Dead zone of width" in text
    assert "LIC-7" in text
    assert figure.read_bytes()[:4] == b"\x89PNG"
    data = json.loads(out.read_text())
    assert data["status"] == "OK"
    assert abs(data["parameters"]["right"] - 1.0) < 4 * data["standard_errors"]["right"]


def test_json_is_the_same_result(capsys, record):
    code, text, _ = run(capsys, "identify", record, "--orders", "3,2,3", "--noise", "white", "--json")
    assert code == 0
    data = json.loads(text)
    direct = lm.identify(lm.read_loop(record), orders=(3, 2, 3), noise="white")
    assert data["parameters"] == pytest.approx(direct.parameters)


def test_compensate_undoes_the_dead_zone(capsys, record, tmp_path):
    out = tmp_path / "compensated.csv"
    code, text, _ = run(
        capsys, "compensate", record, "--left", -1, "--right", 1, "--left-slope", 3, "--right-slope", 3, "--out", out
    )
    assert code == 0
    assert "OP_compensated" in text
    table = lm.read_loop(out, op="OP_compensated", pv="OP")
    x = lm.DeadZone(-1, 1, 3, 3)(table.op)
    np.testing.assert_allclose(x, table.pv, atol=1e-12)


def test_outputs_are_not_overwritten(capsys, record, tmp_path):
    out = tmp_path / "there.csv"
    out.write_text("mine")
    code, _, error = run(capsys, "compensate", record, "--left", -1, "--right", 1, "--out", out)
    assert code == 1
    assert "--force" in error
    assert out.read_text() == "mine"
    code, _, error = run(capsys, "identify", record, "--out", out)
    assert code == 1
    assert out.read_text() == "mine"


def test_check_of_a_constant_op_is_a_finding(capsys, tmp_path):
    path = write_columns(
        tmp_path / "manual.csv", {"t_s": np.arange(300.0), "OP": np.full(300, 42.0), "PV": np.arange(300) % 7 * 1.0}
    )
    code, text, _ = run(capsys, "check", path)
    assert code == 1
    assert "constant" in text.lower()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("identify", "nothing.csv"), "no such file"),
        (("identify", "RECORD", "--orders", "3,2"), "na,nb,delay"),
        (("identify", "RECORD", "--nonlinearity", "magic"), "nonlinearity"),
        (("identify", "RECORD", "--op", "OPP"), "did you mean"),
        (("compensate", "RECORD", "--out", "x.csv"), "--fit"),
    ],
)
def test_bad_input_is_one_clear_line(capsys, record, words, said):
    code, _, error = run(capsys, *(record if word == "RECORD" else word for word in words))
    assert code == (1 if "OPP" in words else 2)
    assert error.startswith("error: expected")
    assert said in error
    assert "Traceback" not in error


def test_usage_errors_exit_with_2(capsys):
    code, _, _ = run(capsys, "identify")
    assert code == 2


@pytest.mark.parametrize("command", ["check", "identify", "compensate", "design"])
def test_help_has_an_example(capsys, command):
    code, text, _ = run(capsys, command, "--help")
    assert code == 0
    assert f"Example: lostmotion {command}" in " ".join(text.split())


def test_installed_as_a_module(record):
    done = subprocess.run(
        [sys.executable, "-m", "lostmotion", "check", str(record), "--json"], capture_output=True, text=True, check=True
    )
    assert json.loads(done.stdout)["usable"]
    assert done.stderr == ""


MODEL = (
    *("design", "--left", 48, "--right", 52, "--gain", 1.5, "--time-constant", 30, "--dead-time", 4, "--dt", 1),
    *("--noise-deviation", 0.2, "--pv-now", 30, "--hold", 20),
)
OPEN = (*MODEL, "--op-limits", 40, 60)


@pytest.mark.long
def test_design_writes_set_points_result_and_figure(capsys, tmp_path):
    out, figure = tmp_path / "test.csv", tmp_path / "test.png"
    words = (*OPEN, "--duration", 600, "--pv-limits", 22, 38, "--out", out, "--figure", figure)
    code, text, error = run(capsys, *words, "--json")
    assert code == 0
    assert error == ""
    data = json.loads(text)
    assert data["reached"]
    assert data["expected_95"]["width"] * 1.5 < data["prs_expected_95"]["width"]
    assert figure.read_bytes()[:4] == b"\x89PNG"
    table = np.genfromtxt(out, delimiter=",", names=True)
    assert table.dtype.names == ("time_s", "OP")
    assert len(table) == 600
    assert table["OP"].min() >= 40.0
    assert table["OP"].max() <= 60.0
    assert run(capsys, *words)[0] == 1  # not overwritten
    code, text, _ = run(capsys, *words, "--force", "--steps")
    assert code == 0
    assert "Expected 95 % interval of the width" in text
    assert len(out.read_text().splitlines()) == len(data["steps"]) + 1


@pytest.mark.long
def test_design_in_closed_loop_and_for_an_interval(capsys, tmp_path):
    out = tmp_path / "test.csv"
    loop = ("--loop", "closed", "--kp", 0.5, "--ki", 0.02, "--sp-limits", 27, 33)
    code, text, _ = run(capsys, *MODEL, *loop, "--interval", 0.2, "--out", out)
    assert code == 0
    assert "REACHED" in text
    assert out.read_text().startswith("time_s,SP")


def test_design_that_cannot_reach_says_so_and_exits_with_1(capsys):
    code, text, _ = run(capsys, *OPEN, "--interval", 0.001, "--duration", 600)
    assert code == 1
    assert "NOT REACHED" in text
    assert "To relax: " in text


def test_design_from_a_fit_and_what_its_record_can_tell(capsys, record, tmp_path):
    fit = tmp_path / "fit.json"
    code, text, _ = run(capsys, "identify", record, "--orders", "3,2,3", "--json")
    fit.write_text(text)
    code, text, _ = run(capsys, "design", "--fit", fit, "--op-limits", -5, 5, "--hold", 1, "--duration", 60, "--json")
    assert code == 0
    assert json.loads(text)["settings"]["roughness"] == "drawn from the covariance of the fit"
    code, text, _ = run(capsys, "design", "--fit", fit, "--achievable", record)
    assert code == 0
    assert "cannot give the width better than" in text


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((*MODEL, "--duration", 600), "--op-limits"),
        ((*MODEL, "--op-limits", 60, 40, "--duration", 600), "low < high"),
        ((*MODEL, "--op-limits", 40, 49, "--op-now", 50, "--duration", 600), "op_now inside op_limits"),
        ((*OPEN, "--pv-limits", 29.9, 30.1, "--duration", 600), "pv_limits that hold PV at rest"),
        (OPEN, "duration"),
        ((*OPEN, "--duration", 100), "duration of at least 240 s"),
        ((*OPEN, "--duration", 600, "--target", "gain"), "target"),
        ((*OPEN, "--interval", 0.2, "--loop", "closed"), "controller"),
        (("design", "--op-limits", 40, 60, "--duration", 600), "--fit, or --gain"),
        (("design", "--fit", "nothing.json", "--op-limits", 40, 60, "--duration", 600), "readable nothing.json"),
    ],
)
def test_bad_design_requests_are_one_clear_line(capsys, words, said):
    code, _, error = run(capsys, *words)
    assert code == 2
    assert error.startswith("error: expected")
    assert said in error
    assert error.count("\n") == 1
