"""Commands where no package of an extra can be imported; `test_installed` does the same with the wheel."""

import subprocess
import sys

import pytest

from lostmotion.extras import EXTRAS
from tests.support.plain_commands import LACKING, WORK, assert_names, assert_needs_none, record

HIDING = """
import runpy, sys
from importlib.abc import MetaPathFinder

class Hidden(MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in HIDDEN:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

HIDDEN = set(sys.argv.pop(1).split(","))
sys.meta_path.insert(0, Hidden())
runpy.run_module("lostmotion", run_name="__main__", alter_sys=True)
"""


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """Runs a command, in whose words names stand for files, where no extra is there."""
    place = tmp_path_factory.mktemp("plain")
    loop, fit = record(place), place / "fit.json"
    names = {"loop": loop, "fit": fit, "folder": loop.parent}

    def run(words):
        hidden = ",".join(sorted({package for _, packages in EXTRAS.values() for package in packages}))
        words = [sys.executable, "-c", HIDING, hidden, *(word.format(**names) for word in words)]
        return subprocess.run(
            words, cwd=place, input=loop.read_text(), capture_output=True, text=True, timeout=300, check=False
        )

    assert run(["identify", "{loop}", "--nonlinearity", "dead zone", "--out", "{fit}"]).returncode == 0
    return run


@pytest.mark.parametrize("name", WORK)
def test_commands_that_need_none(plain, name):
    assert_needs_none(plain(WORK[name]))


@pytest.mark.parametrize("name", LACKING)
def test_commands_that_lack_one_name_it(plain, name):
    extra, words = LACKING[name]
    assert_names(extra, plain(words))
