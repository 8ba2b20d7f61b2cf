"""Nothing of the working folder runs: records of others lie there, and with them whatever came along.

Each way to start a process is tried in a folder with modules that leave a mark, and with settings of packages.
"""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from tests.support.hostile_files import bases
from tests.support.patience import LONG
from tests.support.places import ROOT

MODULES = (
    "types", "signal", "json", "random", "pickle", "queue", "struct", "threading", "numpy", "sitecustomize",
    "usercustomize", "numba/__init__", "lostmotion/__init__", "lostmotion/workers", "yaml",
)  # fmt: skip
COMMAND = (
    "import sys\nfrom lostmotion.cli import main\nif __name__ == '__main__':\n    sys.exit(main())\n"  # as pip has it
)
WAYS = ("readers", "many_calls", "random_loops", "first_windows", "page", "trend", "study", "first_fits")
SHORT = WAYS[:3]


@pytest.fixture
def folder(tmp_path):
    """Records, and what came along with them."""
    here = tmp_path / "plant"
    here.mkdir()
    time, noise = np.arange(600), np.random.default_rng(0).normal(scale=0.1, size=(2, 600))
    rows = zip(time, 50 + 5 * np.sin(time / 40) + noise[0], 20 + np.sin((time - 3) / 40) + noise[1], strict=True)
    (here / "p.csv").write_text("time,OP,PV\n" + "".join(f"{t},{u:.4f},{y:.4f}\n" for t, u, y in rows))
    (here / "p.xlsx").write_bytes(bases("xlsx")[0])
    for name in MODULES:
        path = here / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(f"open({str(tmp_path / 'marks')!r}, 'a').write(__file__ + '\\n')\nraise SystemExit(99)\n")
    (here / ".numba_config.yaml").write_text(f"cache_dir: {here / 'evil'}\ndebug_jit: 1\n")
    (here / "matplotlibrc").write_text("text.usetex: True\n")
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "lostmotion").write_text(COMMAND)
    return here


def run(folder, *words, codes=(0,)):
    """What a command prints that runs in the folder and leaves no mark."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src"), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [sys.executable, *words], cwd=folder, env=environment, capture_output=True, text=True, timeout=LONG, check=False
    )
    marks = folder.parent / "marks"
    assert not marks.exists(), marks.read_text()
    assert not (folder / "evil").exists()
    assert done.returncode in codes, done.stderr
    return done.stdout


def command(folder, *words, codes=(0,)):
    return run(folder, str(folder.parent / "bin" / "lostmotion"), *words, codes=codes)


def test_the_marks_are_left_where_python_is_told_to_run_them(folder):
    with pytest.raises(AssertionError, match=r"types\.py"):
        run(folder, "-c", "import types", codes=(0, 99))


@pytest.mark.parametrize("way", [way if way in SHORT else pytest.param(way, marks=pytest.mark.long) for way in WAYS])
def test_each_way_to_start_a_process(folder, way):
    run(folder, str(ROOT / "tests" / "support" / "worker_ways.py"), way)


def test_a_check_by_the_command_and_by_safe_python(folder):
    assert "600 rows" in command(folder, "check", "p.csv", codes=(0, 1))
    assert "600 rows" in run(folder, "-P", "-m", "lostmotion", "check", "p.csv", codes=(0, 1))


@pytest.mark.long
@pytest.mark.parametrize("engine", ["processes", "dask"])
def test_an_audit(folder, engine):
    if engine == "dask":
        pytest.importorskip("distributed")
    said = command(folder, "audit", "p.csv", "--workers", "2", "--engine", engine, "--json", codes=(0, 1))
    (row,) = json.loads(said)["assessments"]
    assert (row["tag"], row["error"] or None) == ("p", None)


@pytest.mark.long
def test_a_diagnosis_with_its_figure(folder):
    """No title is run by TeX, whether it is there or not."""
    command(folder, "diagnose", "p.csv", "--figure", "p.svg", codes=(0, 1))
    assert (folder / "p.svg").is_file()
