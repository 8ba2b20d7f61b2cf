"""Kernels compiled from older sources are not used again."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from lostmotion.kernels.compiled_before import forget_stale


@pytest.fixture
def kernels(tmp_path):
    """Two sources in two folders, with an index of the second."""
    inner = tmp_path / "inner"
    (inner / "__pycache__").mkdir(parents=True)
    (tmp_path / "callee.py").write_text("A = 1\n")
    (inner / "caller.py").write_text("B = 1\n")
    forget_stale(tmp_path)
    index = inner / "__pycache__" / "caller.f-1.py311.nbi"
    index.write_text("index")
    return tmp_path, index


def test_unchanged_sources_keep_what_was_compiled(kernels):
    folder, index = kernels
    assert not forget_stale(folder)
    assert index.is_file()


@pytest.mark.parametrize("change", ["newer", "longer", "gone", "another"])
def test_any_change_of_any_source_forgets_it(kernels, change):
    folder, index = kernels
    callee = folder / "callee.py"
    if change == "newer":
        os.utime(callee, ns=(callee.stat().st_atime_ns, callee.stat().st_mtime_ns + 1_000))
    elif change == "longer":
        callee.write_text("A = 123\n")
    elif change == "gone":
        callee.unlink()
    else:
        (folder / "new.py").write_text("")
    assert forget_stale(folder)
    assert not index.exists()
    assert not forget_stale(folder)
    assert [path.name for path in (folder / "__pycache__").iterdir()] == ["kernels.stamp"]


def test_a_folder_that_cannot_be_written_is_left(tmp_path):
    (tmp_path / "callee.py").write_text("A = 1\n")
    (tmp_path / "__pycache__").write_text("a file in its place")
    assert not forget_stale(tmp_path)


def test_a_caller_follows_its_callee_in_another_file(tmp_path):
    """The case itself: without it the second run still says 1."""
    package = tmp_path / "kernel_pair"
    package.mkdir()
    source = Path(__file__).resolve().parents[2] / "src"
    (package / "__init__.py").write_text(
        "from pathlib import Path\n"
        "from lostmotion.kernels.compiled_before import forget_stale\n"
        "forget_stale(Path(__file__).parent)\n"
    )
    (package / "caller.py").write_text(
        "from numba import njit\nfrom kernel_pair.callee import value\n\n\n"
        "@njit(cache=True)\ndef twice():\n    return 2 * value()\n"
    )
    found = []
    for value in (1, 20):
        (package / "callee.py").write_text(
            f"from numba import njit\n\n\n@njit(cache=True)\ndef value():\n    return {value}\n"
        )
        path = os.pathsep.join([str(tmp_path), str(source)])
        run = [sys.executable, "-c", "from kernel_pair.caller import twice; print(twice())"]
        environment = {**os.environ, "PYTHONPATH": path, "NUMBA_DISABLE_JIT": "0"}
        found.append(
            subprocess.run(run, env=environment, capture_output=True, text=True, check=True, timeout=300).stdout
        )
    assert found == ["2\n", "40\n"]
