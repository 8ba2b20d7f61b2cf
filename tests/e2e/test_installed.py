"""What somebody has who installs the wheel: plain, and with each extra alone. The suite has all of them."""

from __future__ import annotations

import shutil
import subprocess
import zipfile

import pytest

from lostmotion.extras import EXTRAS
from tests.support.installed import Environment, build_wheel
from tests.support.plain_commands import LACKING, NAMED, WORK, assert_names, assert_needs_none, record

pytestmark = [pytest.mark.long, pytest.mark.xdist_group("installed")]  # one worker makes the environments

CALLS = {
    "plot": "lm.read_loop(loop).plot().savefig('a.png')",
    "control": "lm.LinearModel((-0.5,), (1.0,), 0, 1.0).to_control()",
    "excel": "from lostmotion.extras import need_extra; need_extra('excel')",
    "matlab": "from lostmotion.extras import need_extra; need_extra('matlab')",
    "sql": "from lostmotion.extras import extra\nwith extra('sql'): import sqlalchemy",
    "audit": "print(lm.audit(folder, 'plant.db', engine='inline').summary())",
    "postgres": "import psycopg",
    "cluster": "import lostmotion.audit.runner.engine.dask_engine",
    "web": "import lostmotion.web.server.serve, lostmotion.web.app",
    "live": "import lostmotion.live.opcua.link, lostmotion.live.opcua.demo_server",
}
# as they are looked for by a worker process, or by modules that only a command imports: there the command says it
WITHOUT_A_SENTENCE = {"postgres", "cluster", "web", "live"}


class Installed:
    """The wheel in a plain environment, with a record and its fit."""

    def __init__(self, place):
        self.place, self.wheel = place, build_wheel(place / "wheel")
        self.loop, self.fit = record(place), place / "LIC-101.json"
        (place / "home").mkdir()
        self.plain = Environment(place / "plain", place / "home")
        self.plain.install(str(self.wheel))
        done = self.plain.command("identify", self.loop, "--nonlinearity", "dead zone", "--out", self.fit)
        assert done.returncode == 0, done.stderr

    def command(self, words, given=""):
        """``lostmotion`` with words in which names stand for files."""
        names = {"loop": self.loop, "fit": self.fit, "folder": self.loop.parent}
        return self.plain.command(*(word.format(**names) for word in words), cwd=self.place, given=given)


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """A gigabyte, removed at the end."""
    place = tmp_path_factory.mktemp("installed")
    yield Installed(place)
    shutil.rmtree(place, ignore_errors=True)


@pytest.mark.skipif(shutil.which("npm") is None, reason="built without npm, a page draws trends as SVG")
def test_the_page_has_what_it_draws_with(installed):
    names = {name.rpartition("/")[2] for name in zipfile.ZipFile(installed.wheel).namelist()}
    assert {"uPlot.iife.min.js", "uPlot.min.css"} <= names


def test_commands_that_need_no_extra(installed, subtests):
    for name, words in WORK.items():
        with subtests.test("a command that needs no extra", command=name):
            done = installed.command(words, installed.loop.read_text())
            assert_needs_none(done)


def test_commands_that_need_an_extra_name_it(installed, subtests):
    for name, (extra, words) in LACKING.items():
        with subtests.test("a command that needs an extra", command=name):
            done = installed.command(words)
            assert_names(extra, done)


def test_a_first_fit_compiles_into_the_cache_folder_of_the_user(installed):
    compiled = {path.suffix for path in (installed.plain.home / "cache" / "lostmotion").rglob("*") if path.is_file()}
    assert compiled == {".nbi", ".nbc"}
    assert not list(installed.plain.site.rglob("*.nbi"))


@pytest.mark.parametrize("extra", EXTRAS)
def test_an_extra_alone(installed, extra):
    """What an extra is for works with it, and fails with its name without it."""
    loop, plain, place = installed.loop, installed.plain, installed.place
    call = f"import lostmotion as lm\nloop, folder = {str(loop)!r}, {str(loop.parent)!r}\n{CALLS[extra]}"
    lacking = plain.run("-c", call, cwd=place)
    assert lacking.returncode != 0
    assert extra in WITHOUT_A_SENTENCE or NAMED.format(extra) in lacking.stderr
    environment = Environment(place / extra, plain.home, beside=plain)
    environment.install(f"lostmotion[{extra}]")
    done = environment.run("-c", call, cwd=place)
    assert done.returncode == 0, done.stderr
    if extra == "web":
        serves(environment)
    shutil.rmtree(environment.folder)


def serves(environment):
    words = [str(environment.python), "-m", "lostmotion", "serve", "--no-open", "--port", "0"]
    process = subprocess.Popen(words, cwd=environment.home, stdout=subprocess.PIPE, text=True)
    try:
        assert "http://127.0.0.1:" in process.stdout.readline()
    finally:
        process.terminate()
        process.wait(60)
        process.stdout.close()
