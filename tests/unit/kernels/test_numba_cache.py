"""Kernels compiled from older sources are not used again; where they are kept, and that compiling is counted."""

import os
import subprocess
import sys

import pytest

from lostmotion.kernels.numba_cache import MAX_FOLDERS, cache_folder, prepare_folder
from tests.support.places import ROOT

SOURCE = ROOT / "src"


@pytest.fixture
def sources(tmp_path):
    """Two sources in two folders."""
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "callee.py").write_text("A = 1\n")
    (inner / "caller.py").write_text("B = 1\n")
    return tmp_path


@pytest.mark.parametrize("change", ["longer", "same size", "gone", "another"])
def test_any_change_of_any_source_is_another_folder(sources, change):
    before, callee = cache_folder(sources), sources / "callee.py"
    assert cache_folder(sources) == before
    if change == "longer":
        callee.write_text("A = 123\n")
    elif change == "same size":
        callee.write_text("A = 2\n")
    elif change == "gone":
        callee.unlink()
    else:
        (sources / "new.py").write_text("")
    assert cache_folder(sources) != before


def test_the_oldest_folders_are_removed(tmp_path):
    folders = [tmp_path / f"kernels-{number}" for number in range(MAX_FOLDERS + 2)]
    for age, folder in enumerate(folders):
        folder.mkdir()
        os.utime(folder, (age, age))
    prepare_folder(tmp_path / "kernels-now")
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        [*(folder.name for folder in folders[2:]), "kernels-now"]
    )


def test_a_folder_that_cannot_be_made_is_left(tmp_path):
    (tmp_path / "file").write_text("in its place")
    prepare_folder(tmp_path / "file" / "kernels-now")
    assert not (tmp_path / "file").is_dir()


def reports_of_compiling(folder):
    """What a process that runs a kernel is told of compiling."""
    code = (
        "import sys; told = []\n"
        "from lostmotion.kernels.compile_progress import compile_reports\n"
        "with compile_reports(told.append):\n"
        "    import numpy as np, lostmotion as lm\n"
        "    lm.LinearModel((-0.5,), (1.0,), 0, 1.0).simulate(np.ones(4))\n"
        "print(told)"
    )
    environment = {**os.environ, "PYTHONPATH": str(SOURCE), "NUMBA_DISABLE_JIT": "0", "NUMBA_CACHE_DIR": str(folder)}
    run = [sys.executable, "-c", code]
    return subprocess.run(run, env=environment, capture_output=True, text=True, check=True, timeout=300).stdout.strip()


def test_compiling_is_counted_once_and_kept_in_the_folder_that_was_asked_for(tmp_path):
    assert reports_of_compiling(tmp_path).startswith("[1")
    assert len(list(tmp_path.glob("kernels-*/*/*.nbi"))) > 0
    assert reports_of_compiling(tmp_path) == "[]"


def test_a_caller_follows_its_callee_in_another_file(tmp_path):
    """The case itself: with one folder for both sources the second run still says 2."""
    package = tmp_path / "kernel_pair"
    package.mkdir()
    (package / "__init__.py").write_text("")
    head = (
        "from pathlib import Path\n"
        "from lostmotion.kernels.numba_cache import cache_folder, njit\n"
        "FOLDER = cache_folder(Path(__file__).parent)\n"
    )
    (package / "caller.py").write_text(
        f"{head}from kernel_pair.callee import value\n\n\n@njit(FOLDER)\ndef twice():\n    return 2 * value()\n"
    )
    found = []
    for value in (1, 7):
        (package / "callee.py").write_text(f"{head}\n\n@njit(FOLDER)\ndef value():\n    return {value}\n")
        path = os.pathsep.join([str(tmp_path), str(SOURCE)])
        run = [sys.executable, "-c", "from kernel_pair.caller import twice; print(twice())"]
        environment = {
            **os.environ, "PYTHONPATH": path, "NUMBA_DISABLE_JIT": "0", "NUMBA_CACHE_DIR": str(tmp_path / "cache"),
        }  # fmt: skip
        found.append(
            subprocess.run(run, env=environment, capture_output=True, text=True, check=True, timeout=300).stdout
        )
    assert found == ["2\n", "14\n"]


def test_of_two_processes_that_compile_one_function_none_runs_the_code_of_the_other(tmp_path):
    """Each for its own type at the same time: the index that one keeps names no code of the other."""
    (tmp_path / "twice.py").write_text(
        "import sys\nfrom pathlib import Path\nfrom lostmotion.kernels.numba_cache import njit\n"
        "@njit(folder=Path(sys.argv[1]))\ndef twice(x):\n    return 2 * x\nprint(twice(eval(sys.argv[2])))\n"
    )
    folder, environment = tmp_path / "kept", {**os.environ, "PYTHONPATH": str(SOURCE), "NUMBA_DISABLE_JIT": "0"}

    def said(value):
        run = [sys.executable, str(tmp_path / "twice.py"), str(folder), value]
        return subprocess.run(
            run, env=environment, capture_output=True, text=True, check=True, timeout=300
        ).stdout.strip()

    assert said("3") == "6"
    (index,) = folder.rglob("*.nbi")
    of_the_first = index.read_bytes()
    index.unlink()  # the second has looked before the first wrote it
    assert said("1.5") == "3.0"
    index.write_bytes(of_the_first)
    assert said("4") == "8"
    assert said("2.5") == "5.0"
