"""Where children start, and where they find modules."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from lostmotion.workers import empty_folder, isolated
from tests.support.killed import forked
from tests.support.places import ROOT

SHOW = "from lostmotion.workers.isolated import module_path; print(*module_path(), sep='\\n')"


def shown(words, folder, path=str(ROOT / "src")):
    environment = {**os.environ, "PYTHONPATH": path}
    run = [sys.executable, *words]
    return subprocess.run(
        run, cwd=folder, env=environment, capture_output=True, text=True, check=True
    ).stdout.splitlines()


def test_the_folder_is_one_empty_and_private():
    folder = empty_folder()
    assert folder == empty_folder()
    assert isolated.private(folder)
    assert list(folder.iterdir()) == []


def test_another_is_made_where_it_was_taken_away_or_opened():
    for spoil in (lambda folder: folder.rmdir(), lambda folder: folder.chmod(0o777)):
        before = empty_folder()
        spoil(before)
        assert empty_folder() != before


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks")
def test_a_fork_does_not_remove_it():
    folder = empty_folder()
    assert forked(lambda: isolated._remove(folder, os.getpid() + 1)) == 0
    assert folder.is_dir()
    words = ["-c", "from lostmotion.workers import empty_folder; print(empty_folder())"]
    (gone,) = shown(words, folder)
    assert not Path(gone).exists()


def test_the_folder_of_the_script_and_the_working_folder_are_left_out(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(SHOW)
    (tmp_path / "module.py").write_text(SHOW)
    other = tmp_path / "other"
    other.mkdir()
    for words, folder in (
        (["-c", SHOW], tmp_path), (["-m", "module"], tmp_path), ([str(script)], other), ([str(script)], tmp_path),
        (["-P", "-c", SHOW], tmp_path),
    ):  # fmt: skip
        found = shown(words, folder)
        assert str(ROOT / "src") in found
        assert not {str(tmp_path), "", "."} & set(found)


def test_what_was_named_stays(tmp_path):
    path = os.pathsep.join([str(ROOT / "src"), str(tmp_path)])
    for words in (["-c", SHOW], ["-P", "-c", SHOW]):
        assert shown(words, tmp_path, path).count(str(tmp_path)) == 1


def test_the_package_is_found_where_it_is_run_from_its_folder():
    assert str(ROOT / "src") in shown(["-c", SHOW], ROOT / "src", "")
