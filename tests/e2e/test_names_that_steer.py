"""Commands on files, columns and tags whose names would steer a terminal: all that they print is shown only."""

import io
import json
import shlex
import subprocess
import sys
import zipfile

import numpy as np
import pytest

NAMES = ["a\x1b]0;x\x07b", "FIC\u202e101", "x\ny", "it's $(id)", "-dash", "=cmd", "\x9b31m\x7f", "caf\udce9"]


def run(words, cwd):
    """As a shell starts it; half signs stand for bytes that are no text, as in names of files."""
    command = [sys.executable, "-m", "lostmotion", *words]
    done = subprocess.run(command, cwd=cwd, capture_output=True, check=False, stdin=subprocess.DEVNULL)
    done.stdout, done.stderr = (text.decode("utf-8", "surrogateescape") for text in (done.stdout, done.stderr))
    return done


def record(op="OP", pv="PV"):
    rng = np.random.default_rng(1)
    u = np.repeat(rng.normal(size=60), 5)
    rows = "\n".join(f"{k},{x:.3f},{x + y:.3f}" for k, (x, y) in enumerate(zip(u, rng.normal(size=300), strict=True)))
    return f'time,"{op}","{pv}"\n{rows}\n'


def shown(done):
    """What a terminal gets, line by line."""
    text = done.stdout + done.stderr
    assert "Traceback" not in text
    assert text.replace("\n", "").isprintable()
    return text.splitlines()


@pytest.fixture
def plant(tmp_path):
    for name in NAMES:
        (tmp_path / f"{name}.csv").write_text(record())
    return tmp_path


def test_files(plant):
    names = sorted(path.name for path in plant.iterdir())
    lines = shown(run(["check", *(f"./{name}" for name in names)], cwd=plant))
    assert sum(" yes " in line for line in lines) == len(NAMES)
    for name in names:
        last = shown(run(["check", f"./{name}"], cwd=plant))[-1]
        assert last.startswith("Next: lostmotion diagnose ")
    shown(run(["check", "--figure", "x\x1b[1m.png", f"./{names[0]}\x1b"], cwd=plant))
    shown(run(["check", "--\x1b[1m"], cwd=plant))
    shown(run(["\x1b[1m\n"], cwd=plant))


def test_a_plant(plant):
    assert len(shown(run(["audit", ".", "--workers", "1"], cwd=plant))) > len(NAMES)
    proposed = run(["audit", "--propose", "."], cwd=plant)
    (plant / "loops.csv").write_text(proposed.stdout, encoding="utf-8", errors="surrogateescape")
    again = shown(run(["audit", ".", "--loops", "loops.csv", "--workers", "1"], cwd=plant))
    assert any(f"of {len(NAMES)} loops could be judged" in line for line in again)


@pytest.mark.parametrize("column", ["PV\x1b[31m", "PV\u202e", "PV\n(m3/h)", "PV\x7f"])
def test_columns(tmp_path, column):
    (tmp_path / "a.csv").write_text(record(pv=column))
    shown(run(["check", "a.csv"], cwd=tmp_path))
    shown(run(["check", "a.csv", "--pv", "nothing\x1b"], cwd=tmp_path))
    done = run(["check", "a.csv", "--pv", " ".join(column.split("\n")), "--json"], cwd=tmp_path)
    assert json.loads(done.stdout)
    shown(done)


def test_members_of_an_archive(tmp_path):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name in ("a\x1b[31m.csv", "b\u202e.csv"):
            archive.writestr(name, record())
    (tmp_path / "a.zip").write_bytes(packed.getvalue())
    lines = shown(run(["check", "a.zip"], cwd=tmp_path))
    (command,) = [line.strip() for line in lines if line.strip().startswith("lostmotion check")]
    assert shlex.split(command.replace("$'", "'"))[:3] == ["lostmotion", "check", "a.zip"]
