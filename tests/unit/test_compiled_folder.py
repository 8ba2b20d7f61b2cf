"""Numba unpickles what it has compiled: nobody but this user may write there."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from lostmotion import compiled_folder
from lostmotion.compiled_folder import VARIABLE, trusted_folder
from tests.support.places import ROOT

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="it lies in the profile of the user there")


@pytest.fixture(autouse=True)
def _environment(monkeypatch):
    monkeypatch.setenv(VARIABLE, "")  # put back afterwards


@pytest.fixture
def users(monkeypatch, tmp_path):
    """The cache folder of the user."""
    monkeypatch.setattr(compiled_folder, "user_cache_path", lambda *_, **__: tmp_path / "cache")
    return tmp_path / "cache"


def test_the_folder_of_the_user_is_made_for_him_alone(users):
    assert trusted_folder("") is None
    assert users.stat().st_mode & 0o777 == 0o700


def test_it_is_closed_and_what_others_may_have_written_is_gone(users):
    (users / "kernels-1" / "inner").mkdir(parents=True)
    (users / "kernels-1").chmod(0o755)
    users.chmod(0o755)
    assert trusted_folder("") is None
    assert users.stat().st_mode & 0o777 == 0o700
    assert (users / "kernels-1").is_dir()
    users.chmod(0o777)
    assert trusted_folder("") is None
    assert not (users / "kernels-1").is_dir()


@pytest.mark.parametrize("part", ["", "kernels-1", "kernels-1/inner"])
@pytest.mark.parametrize("mode", [0o777, 0o775, 0o1777])
def test_a_chosen_folder_that_others_can_write_to_is_not_used(tmp_path, part, mode):
    (tmp_path / "kernels-1" / "inner").mkdir(parents=True)
    assert trusted_folder(str(tmp_path)) is None
    (tmp_path / part).chmod(mode)
    with pytest.warns(RuntimeWarning, match="others can write to"):
        made = trusted_folder(str(tmp_path))
    assert made.stat().st_mode & 0o777 == 0o700
    assert os.environ[VARIABLE] == str(made)
    assert (tmp_path / "kernels-1").is_dir()
    made.rmdir()


@pytest.mark.skipif(not hasattr(os, "getuid") or os.getuid() != 0, reason="only the administrator gives folders away")
def test_a_folder_of_another_user_is_not_used(tmp_path):
    os.chown(tmp_path, 12345, -1)
    with pytest.warns(RuntimeWarning, match="others can write to"):
        trusted_folder(str(tmp_path)).rmdir()


def test_a_relative_folder_is_the_same_for_workers(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert trusted_folder("here") == tmp_path / "here"
    assert os.environ[VARIABLE] == str(tmp_path / "here")


def test_a_folder_that_cannot_be_made_is_left_to_numba(tmp_path):
    (tmp_path / "file").write_text("in its place")
    assert trusted_folder(str(tmp_path / "file" / "in")) is None


NUMBA = """
import os, sys
{first}
import lostmotion
from numba.core import config
os.chdir({folder!r})
config.reload_config()
print(config.CACHE_DIR, config.DEBUG_JIT, os.getcwd())
"""


@pytest.mark.parametrize("first", ["", "import numba"])
@pytest.mark.parametrize("text", ["cache_dir: evil\ndebug_jit: 1", "[no yaml: {", ""])
def test_numba_takes_nothing_from_the_working_folder(tmp_path, first, text):
    if first and "no yaml" in text:
        pytest.skip("it ends the import that is not ours")
    (tmp_path / ".numba_config.yaml").write_text(text)
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    environment.pop(VARIABLE)
    words = [sys.executable, "-c", NUMBA.format(first=first, folder=str(tmp_path))]
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout == f" 0 {tmp_path}\n"
    assert [one.name for one in Path(tmp_path).iterdir()] == [".numba_config.yaml"]
