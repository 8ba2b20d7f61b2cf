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
    assert code == 1
    assert error.startswith("error: expected")
    assert said in error
    assert "Traceback" not in error


def test_usage_errors_exit_with_2(capsys):
    code, _, _ = run(capsys, "identify")
    assert code == 2


@pytest.mark.parametrize("command", ["check", "identify", "compensate"])
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
