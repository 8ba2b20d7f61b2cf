"""``check`` and ``identify`` of several files, ``--version`` and ``--model``, as a new user runs them."""

import json

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.files import write_columns
from tests.e2e.test_commands import run
from tests.support.diagnoses import loop_record


def table(path, record, op=None):
    time = np.arange(len(record)) * record.dt
    columns = {"time_s": time, "SP": record.sp, "PV": record.pv, "OP": record.op if op is None else op}
    return write_columns(path, columns)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("loops")
    record = loop_record(800)
    good = table(folder / "FC7.csv", record)
    still = table(folder / "FC8.csv", record, np.full(len(record), 42.0))
    return good, still, folder / "absent.csv"


def test_version(capsys):
    assert run(capsys, "--version") == (0, f"lostmotion {lm.__version__}\n", "")


def test_check_of_several_files_is_a_line_each_and_a_table(capsys, files):
    code, text, error = run(capsys, "check", *files)
    lines = text.splitlines()
    assert (code, error) == (1, "")
    assert [line.split()[0] for line in lines[:3]] == ["FC7", "FC8", "absent"]
    assert ("usable" in lines[0], "NOT USABLE" in lines[1], "no such file" in lines[2]) == (True, True, True)
    assert lines[4].startswith("loop")
    assert [line.split()[0] for line in lines[6:8]] == ["FC8", "FC7"]  # the worst first
    assert lines[-1] == "3 loops: 1 usable, 1 not usable, 1 without a result."
    assert run(capsys, "check", files[0], files[0])[0] == 0


def test_check_of_several_files_as_json_is_a_list(capsys, files):
    code, text, _ = run(capsys, "check", *files, "--json")
    data = json.loads(text)
    assert code == 1
    assert [one["file"] for one in data] == [str(file) for file in files]
    assert [one.get("usable") for one in data] == [True, False, None]
    assert data[2]["error"] == "FileAccessError"
    one = json.loads(run(capsys, "check", files[0], "--json")[1])
    assert one == {key: value for key, value in data[0].items() if key != "file"}


@pytest.mark.statistics
def test_identify_of_several_files(capsys, files, tmp_path):
    options = ("--orders", "1,0,1", "--noise", "white", "--op-span", 0, 100)
    code, text, error = run(capsys, "identify", *files, *options, "--out", tmp_path, "--figure", tmp_path)
    lines = text.splitlines()
    assert (code, error) == (1, "")
    assert lines[0].startswith("FC7")
    assert "Dead zone of width" in lines[0]
    assert ("error: " in lines[1], "no such file" in lines[2]) == (True, True)
    assert lines[-1] == "3 loops: 1 OK, 2 without a result."
    assert sorted(path.name for path in tmp_path.iterdir()) == ["FC7.json", "FC7.png"]
    fit = lm.identify(lm.read_loop(files[0], op_span=(0.0, 100.0)), orders=(1, 0, 1), noise="white")
    assert json.loads((tmp_path / "FC7.json").read_text()) == json.loads(json.dumps(fit.to_dict()))
    size = fit.parameters["width"]
    assert f"{size:.4g}" in lines[-2]
    assert run(capsys, "identify", files[0], files[0], *options)[0] == 0
    code, _, error = run(capsys, "identify", *files, *options, "--out", tmp_path)
    assert (code, "--force" in error) == (1, True)


def test_results_of_several_files_want_a_folder(capsys, files, tmp_path):
    code, out, error = run(capsys, "identify", *files, "--out", tmp_path / "all.json")
    assert (code, out) == (1, "")
    assert error.startswith("error: expected a folder for the results of several files")
    assert not (tmp_path / "all.json").exists()


@pytest.mark.parametrize("command", ["check", "identify"])
def test_one_tag_for_several_files_is_wrong_usage(capsys, files, command):
    assert run(capsys, command, *files, "--tag", "FC1")[0] == 2


MODEL = """
left = 48
right = 52
gain = 1.5
time-constant = 30   # or [30, 5]
dead_time = 4
dt = 1
noise_deviation = 0.2
"""
WORDS = ("--left", 48, "--right", 52, "--gain", 1.5, "--time-constant", 30, "--dead-time", 4, "--dt", 1)
REST = ("--op-limits", 40, 60, "--hold", 20, "--duration", 300, "--json")


def answer(capsys, *words):
    code, text, error = run(capsys, *words)
    assert code == 0, error
    return json.loads(text)


@pytest.mark.long
@pytest.mark.statistics
def test_a_model_file_is_the_same_as_its_options(capsys, tmp_path):
    toml, as_json = tmp_path / "loop.toml", tmp_path / "loop.json"
    toml.write_text(MODEL)
    as_json.write_text(
        '{"left": 48, "right": 52, "gain": 1.5, "time_constant": [30], "dead_time": 4, "dt": 1, "noise_deviation": 0.2}'
    )
    by_options = answer(capsys, "design", *WORDS, "--noise-deviation", 0.2, *REST)
    assert answer(capsys, "design", "--model", toml, *REST) == by_options
    assert answer(capsys, "design", "--model", as_json, *REST) == by_options
    other = answer(capsys, "design", "--model", toml, *REST, "--gain", 3)  # the command line wins
    assert other == answer(capsys, "design", *WORDS, "--noise-deviation", 0.2, "--gain", 3, *REST)
    words = ("simulate", "--kp", 0.4, "--ki", 0.02, "--op-now", 50, "--runs", 1, "--draws", 1, "--samples", 500)
    simulated = run(capsys, *words, "--model", toml, "--json")
    assert simulated == run(capsys, *words, *WORDS, "--noise-deviation", 0.2, "--json")
    assert simulated[2] == ""


@pytest.mark.parametrize(
    ("text", "code", "said"),
    [
        ("gian = 1.5", 2, "gian"),
        ("gain 1.5", 1, "gain = 1.5 (TOML)"),
        ('gain = "much"', 2, "--gain"),
        (None, 2, "readable"),
    ],
)
def test_a_bad_model_file_is_one_clear_error(capsys, tmp_path, text, code, said):
    path = tmp_path / "loop.toml"
    if text is not None:
        path.write_text(text)
    got, _, error = run(capsys, "design", "--model", path, "--duration", 600)
    assert got == code
    assert said in error
    assert "Traceback" not in error


def test_errors_of_several_files_speak_of_the_options_of_the_command(capsys, files, tmp_path):
    two_clocks = tmp_path / "clocks.csv"
    two_clocks.write_text("time,OP,PV,ts\n" + "".join(f"{10 * k},{k % 7},{k % 5},12\n" for k in range(100)))
    _, text, _ = run(capsys, "check", files[0], two_clocks)
    assert "--ignore-time" in text
    assert "time=False" not in text
    _, text, _ = run(capsys, "check", files[0], two_clocks, "--json")
    assert "--ignore-time" in json.loads(text)[1]["message"]
