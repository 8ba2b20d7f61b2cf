"""``lostmotion diagnose`` as a new user runs it: output, files, exit codes, errors."""

import json
import subprocess
import sys

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.cli.diagnose import LoopType
from lostmotion.cli.wording import as_options
from lostmotion.diagnose.audit_class import LEAST_INDEX
from lostmotion.diagnose.diagnosis import verdicts
from lostmotion.files import write_columns
from tests.support.command import run
from tests.support.diagnoses import CASES, example, loop_record, variant


def strict(text):
    def refuse(word):
        pytest.fail(f"{word} is not JSON")

    return json.loads(text, parse_constant=refuse)


def written(path, record):
    time = np.arange(len(record)) * record.dt
    return write_columns(path, {"time_s": time, "SP": record.sp, "PV": record.pv, "OP": record.op})


@pytest.fixture(scope="module")
def csv(tmp_path_factory):
    return written(tmp_path_factory.mktemp("loop") / "FC7.csv", loop_record())


@pytest.fixture
def told(monkeypatch):
    """Make the diagnosis quick and known: every loop gets the next of the given results; note how it was asked."""
    asked = []

    def install(*results):
        queue = list(results)

        def answer(record, **options):
            asked.append((record, options))
            found = queue.pop(0)
            if isinstance(found, Exception):
                raise found
            return found

        monkeypatch.setattr(lm, "diagnose", answer)
        return asked

    return install


@pytest.mark.statistics
def test_the_command_is_the_same_as_the_call(capsys, csv, tmp_path):
    out, figure = tmp_path / "found.json", tmp_path / "found.png"
    code, text, error = run(capsys, "diagnose", csv, "--loop-type", "flow", "--out", out, "--figure", figure)
    found = strict(out.read_text())
    direct = lm.diagnose(lm.read_loop(csv), loop_type="flow")
    assert found.pop("file") == str(csv)
    assert found == strict(json.dumps(direct.to_dict()))
    report = as_options(direct.summary()).strip()
    assert text.startswith(report)
    assert text.removeprefix(report).startswith(("\n", "\nNext: "))
    assert found["verdict"] in verdicts()
    assert code == (0 if found["verdict"] in ("none", "other oscillation") else 1)
    assert figure.read_bytes()[:4] == b"\x89PNG"
    assert error == ""


@pytest.mark.parametrize(("verdict", "kind"), CASES)
def test_exit_code_says_whether_the_actuator_is_cleared(capsys, csv, told, verdict, kind):
    told(variant(verdict, kind))
    code, text, _ = run(capsys, "diagnose", csv)
    assert code == (0 if verdict in ("none", "other oscillation") else 1)
    assert "What to do" in text


def test_options_reach_the_reader_and_the_diagnosis(capsys, tmp_path, told):
    record = loop_record()
    path = write_columns(tmp_path / "x.csv", {"t": np.arange(400.0), "A": record.op, "B": record.pv, "C": record.sp})
    asked = told(*[example()] * 3)
    words = ("diagnose", path, "--op", "A", "--pv", "B", "--sp", "C", "--dt", 5, "--ignore-time", "--tag", "FC9")
    run(capsys, *words, "--op-span", 10, 90, "--integrating", "--loop-type", "level", "--tolerance", 0.02)
    run(capsys, *words, "--self-regulating")
    run(capsys, *words)
    read = asked[0][0]
    assert (read.tag, read.dt, read.op_span) == ("FC9", 5.0, (10.0, 90.0))
    np.testing.assert_allclose(read.sp, record.sp)
    assert [{name: value for name, value in options.items() if name != "progress"} for _, options in asked] == [
        {"integrating": True, "loop_type": "level", "tolerance": 0.02},
        {"integrating": False, "loop_type": None, "tolerance": 0.01},
        {"integrating": None, "loop_type": None, "tolerance": 0.01},
    ]


def test_json_of_one_file_is_an_object(capsys, csv, told):
    told(variant("other oscillation", "disturbance"))
    code, text, _ = run(capsys, "diagnose", csv, "--json")
    found = strict(text)
    assert code == 0
    assert (found["verdict"], found["size"], found["file"]) == ("other oscillation", None, str(csv))


def test_several_files_are_a_line_each_and_a_table(capsys, csv, tmp_path, told):
    told(variant("none", "none"), example(), lm.DataError.expected("a record that moves", "none", "record more"))
    absent, out = tmp_path / "absent.csv", tmp_path / "all.json"
    code, text, error = run(capsys, "diagnose", csv, csv, absent, csv, "--out", out)
    lines = text.splitlines()
    assert code == 1
    assert error == ""
    assert lines[0].startswith("FC7")
    assert ("none, confidence" in lines[0], "dead zone, " in lines[1]) == (True, True)
    assert lines[2].startswith("absent")
    assert "no such file" in lines[2]
    assert "record more" in lines[3]
    assert lines[-1] == "4 loops: 1 none, 1 dead zone, 2 without a result."
    assert "Traceback" not in text
    data = strict(out.read_text())
    assert [one.get("verdict", one.get("error")) for one in data] == [
        "none", "dead zone", "FileAccessError", "DataError",
    ]  # fmt: skip


def test_several_files_as_json_are_a_list_and_nothing_else(capsys, csv, tmp_path, told):
    told(variant("none", "none"))
    code, text, _ = run(capsys, "diagnose", csv, tmp_path / "absent.csv", "--json")
    assert code == 1
    assert [one.get("verdict") for one in strict(text)] == ["none", None]
    told(variant("none", "none"), variant("other oscillation", "tuning"))
    assert run(capsys, "diagnose", csv, csv, "--json")[0] == 0


def test_figures_of_several_files_need_a_folder(capsys, csv, tmp_path, told):
    told(example(), example())
    other = written(tmp_path / "FC8.csv", loop_record())
    code, _, error = run(capsys, "diagnose", csv, other, "--figure", tmp_path / "none.png")
    assert (code, "a folder" in error) == (1, True)
    run(capsys, "diagnose", csv, other, "--figure", tmp_path)
    assert (tmp_path / "FC7.png").read_bytes()[:4] == (tmp_path / "FC8.png").read_bytes()[:4] == b"\x89PNG"
    code, _, error = run(capsys, "diagnose", csv, other, "--figure", tmp_path)
    assert (code, "--force" in error) == (1, True)


def test_files_that_are_there_are_kept(capsys, csv, tmp_path, told):
    told(example())
    out = tmp_path / "mine.json"
    out.write_text("mine")
    code, _, error = run(capsys, "diagnose", csv, "--out", out)
    assert (code, "--force" in error, out.read_text()) == (1, True, "mine")
    run(capsys, "diagnose", csv, "--out", out, "--force")
    assert strict(out.read_text())["verdict"] == "dead zone"


def test_a_bad_file_is_one_clear_line(capsys, tmp_path):
    path = tmp_path / "bad.csv"
    path.write_text("time_s,OP,PV\n" + "\n".join(f"{k},x,y" for k in range(50)))
    for file, expected in ((path, 1), (tmp_path / "absent.csv", 2)):
        code, out, error = run(capsys, "diagnose", file)
        assert (code, out, len(error.splitlines())) == (expected, "", 1)
        assert error.startswith("error: expected")
    still = write_columns(
        tmp_path / "still.csv", {"t_s": np.arange(300.0), "OP": np.full(300, 42.0), "PV": np.ones(300)}
    )
    code, out, error = run(capsys, "diagnose", still)
    assert (code, out, error.startswith("error: still")) == (1, "", True)


@pytest.mark.parametrize(
    "words",
    [(), ("CSV", "--loop-type", "tea"), ("CSV", "--dt", "soon"), ("CSV", "CSV", "--tag", "FC1"), ("CSV", "--magic")],
)
def test_wrong_usage_exits_with_2(capsys, csv, words):
    assert run(capsys, "diagnose", *(csv if word == "CSV" else word for word in words))[0] == 2


def test_help_has_an_example(capsys):
    code, text, _ = run(capsys, "diagnose", "--help")
    assert code == 0
    assert "Example: lostmotion diagnose" in " ".join(text.split())


def test_every_loop_type_can_be_asked_for():
    assert {one.value for one in LoopType} == set(LEAST_INDEX)


def test_silent_without_a_terminal(csv):
    done = subprocess.run(
        [sys.executable, "-m", "lostmotion", "diagnose", str(csv) + "x", str(csv) + "y"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 1
    assert done.stderr == ""
    assert done.stdout.splitlines()[-1] == "2 loops: 2 without a result."


def test_the_report_is_a_page_and_no_file_is_replaced(capsys, csv, tmp_path, told):
    told(example(), example())
    page = tmp_path / "fc7.html"
    assert run(capsys, "diagnose", csv, "--report", page)[0] == 1
    text = page.read_text(encoding="utf-8")
    assert text.startswith("<!doctype html>")
    assert f"lostmotion simulate {csv}" in text
    code, _, error = run(capsys, "diagnose", csv, "--report", page)
    assert code == 1
    assert "--force" in error
    folder = tmp_path / "pages"
    folder.mkdir()
    other = written(tmp_path / "FC8.csv", loop_record())
    told(example(), example())
    run(capsys, "diagnose", csv, other, "--report", folder)
    assert sorted(path.name for path in folder.iterdir()) == ["FC7.html", "FC8.html"]
